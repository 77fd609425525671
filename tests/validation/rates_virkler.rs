//! Growth rates of the Virkler panels against figures that another program computed from the same readings.

use std::collections::HashMap;

use perilife_base::input::Folder;
use perilife_base::units::{MM, MM_PER_CYCLE, MPA};
use perilife_calibration::rates::{RateMethod, RatePoint, add_delta_k, paris_line, rates};
use perilife_growth::case::Case;
use perilife_measured::{Import, MeasuredCurve, read};

use crate::support::shared::shared;

/// ΔK of the panel: secant width correction, stress range 48.28 MPa, width 152.4 mm.
fn delta_k(a: f64) -> f64 {
    let pi = std::f64::consts::PI;
    48.28 * MPA * (pi * a / (pi * a / (152.4 * MM)).cos()).sqrt()
}

/// The panel of Virkler et al. (1979) under its load.
fn panel() -> Case {
    let text = "specimen = { kind = \"middle_tension\", width_mm = 152.4, length_mm = 300.0, thickness_mm = 2.54, crack_length_mm = 9.0 }
        material = { youngs_modulus_gpa = 71.0, poisson_ratio = 0.33, yield_strength_mpa = 345.0 }
        loading = { stress_max_mpa = 60.35, stress_ratio = 0.2 }
        model = { method = \"handbook\" }
        fatigue = { paris_c_mm_per_cycle = 1e-8, paris_m = 3.0 }";
    Case::from_toml(text, "panel", Folder::none(), &[]).unwrap()
}

fn rates_with_delta_k(curve: &MeasuredCurve, method: RateMethod) -> Vec<RatePoint> {
    let mut points = rates(curve, method);
    add_delta_k(&mut points, &panel(), &delta_k);
    points
}

/// Reference rates on `median.csv`: seven-point 1.64009e-4 mm/cycle at 19.997 mm, secant 1.67574e-4 at 20.1 mm, computed
/// from that file by an independent script.
#[test]
fn rates_of_the_median_curve_match_the_reference() {
    let Some(path) = shared("virkler/median.csv") else { return };
    let curve = &read(&[path], &Import::default()).unwrap().curves[0];
    for (method, length, rate) in [(RateMethod::Polynomial7, 19.997, 1.64009e-4), (RateMethod::Secant, 20.1, 1.67574e-4)] {
        let points = rates_with_delta_k(curve, method);
        let near = points.iter().find(|point| (point.crack_length / MM - length).abs() < 5e-4).unwrap();
        assert!((near.rate / MM_PER_CYCLE / rate - 1.0).abs() < 4e-6, "{method}: {}", near.rate / MM_PER_CYCLE);
        // Read every 0.2 mm up to 36.2 mm: too short a step by E647, and flagged as such.
        let short = |point: &&RatePoint| point.flags.short_step;
        assert!(points.iter().filter(|point| point.crack_length < 36.0 * MM).all(|point| point.flags.short_step), "{method}");
        assert!(points.iter().rev().take(10).filter(short).count() == 0, "{method}");
        assert!(points.iter().all(|point| !point.flags.yielding && !point.flags.not_growing), "{method}");
    }
}

/// `paris_fits.csv`: m and log10 C of each specimen, four decimals.
#[test]
fn paris_lines_of_every_specimen_match_the_reference() {
    let (Some(curves), Some(fits)) = (shared("virkler/virkler.csv"), shared("virkler/paris_fits.csv")) else { return };
    let mut reader = csv::Reader::from_path(fits).unwrap();
    let fits: HashMap<String, HashMap<String, String>> = reader
        .deserialize::<HashMap<String, String>>()
        .map(|row| row.unwrap())
        .map(|row| (row["specimen"].clone(), row))
        .collect();
    let curves = read(&[curves], &Import::default()).unwrap().curves;
    assert_eq!(curves.len(), fits.len());
    for curve in &curves {
        let reference = |column: &str| fits[&curve.specimen][column].parse::<f64>().unwrap();
        for (method, name) in [(RateMethod::Polynomial7, "poly7"), (RateMethod::Secant, "secant")] {
            let law = paris_line(&rates_with_delta_k(curve, method)).unwrap();
            let figures = [("m", law.slope), ("log10C", law.intercept), ("resid", law.scatter)];
            for (quantity, computed) in figures {
                let given = reference(&format!("{quantity}_{name}"));
                // Half of the last decimal; the reference's scatter may divide by n instead of n - 2 (1.3 % of 0.1).
                let bound = if quantity == "resid" { 1.4e-3 } else { 0.51e-4 };
                assert!((computed - given).abs() < bound, "{} {name}: {quantity} {computed} against {given}", curve.specimen);
            }
        }
    }
}
