//! The panels of Virkler et al. (1979): medians, rates and fits against what others computed from the same readings.

use std::collections::HashMap;
use std::path::Path;

use perilife_base::units::{MM, MM_PER_CYCLE, MPA};
use perilife_calibration::calibrate::calibrate;
use perilife_calibration::case::CalibrationCase;
use perilife_calibration::criterion::Criterion;
use perilife_calibration::fit::{Fit, FitTask, fit};
use perilife_calibration::median::pointwise_median_at;
use perilife_calibration::power_law::PowerLaw;
use perilife_calibration::rates::{RateMethod, RatePoint, add_delta_k, paris_line, rates};
use perilife_growth::predict::Silent;
use perilife_measured::{Import, Measured, MeasuredCurve, read};

use crate::support::median::{pointwise_median, virkler_panel as panel};
use crate::support::shared::shared;
use std::fmt::Write as _;

// The committed median table is the pointwise median of the measured curves, and a fit to it sees what the full one sees.

const TABLE: &str = "calibration/al2024-t3/measured/virkler_median.csv";

fn measured() -> Option<Vec<MeasuredCurve>> {
    let path = shared("virkler/virkler.csv")?;
    let measured = read(&[path], &Import::default()).unwrap();
    assert!(measured.warnings.is_empty(), "{:?}", measured.warnings);
    assert_eq!(measured.curves.len(), 34);
    Some(measured.curves)
}

#[test]
fn the_committed_table_is_the_median_every_0_8_mm() {
    let Some(curves) = measured() else { return };
    let lengths: Vec<f64> = (0..=51).map(|i| (9.0 + 0.8 * f64::from(i)) * MM).collect();
    let median = pointwise_median_at(&curves, &lengths).unwrap();
    let mut table = String::from("specimen,cycles,crack_length_mm\n");
    for (cycles, length) in median.cycles.iter().zip(&lengths) {
        writeln!(table, "median,{cycles:.0},{:.1}", length / MM).unwrap();
    }
    let committed = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(TABLE)).unwrap_or_default();
    assert!(committed == table, "{TABLE} should read\n{table}");
}

/// `median.csv` was computed from the same curves by another program.
#[test]
fn the_median_at_every_reading_is_the_shared_one() {
    let (Some(curves), Some(path)) = (measured(), shared("virkler/median.csv")) else { return };
    let theirs = &read(&[path], &Import::default()).unwrap().curves[0];
    let ours = pointwise_median(&curves).unwrap();
    assert_eq!(ours.cycles.len(), 164);
    assert_eq!(ours.cycles, theirs.cycles);
}

// Growth rates of the Virkler panels against figures that another program computed from the same readings.

/// ΔK of the panel: secant width correction, stress range 48.28 MPa, width 152.4 mm.
pub fn delta_k(a: f64) -> f64 {
    let pi = std::f64::consts::PI;
    48.28 * MPA * (pi * a / (pi * a / (152.4 * MM)).cos()).sqrt()
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

// The calibration on real curves, with hand calculation (Paris growth, handbook K) in the place of the peridynamic model: what the search, the specimens and the confidence do on real scatter, in a second.

fn fit_to(file: &str, criterion: Criterion) -> Option<Fit> {
    let measured = read(&[shared(file)?], &Import::default()).unwrap();
    measured.check_lengths(76.2 * MM, "half width").unwrap();
    let Measured { curves, .. } = measured.window(Some(9.0 * MM), Some(49.8 * MM)).unwrap();
    let model = PowerLaw::new(9.0 * MM, 49.8 * MM, &delta_k).unwrap();
    Some(fit(&FitTask { curves: &curves, fixed_p: None, criterion, delta_k: &delta_k }, &model).unwrap())
}

#[test]
fn the_median_is_fitted_to_one_percent_of_life() {
    let Some(fit) = fit_to("virkler/median.csv", Criterion::BothEnds) else { return };
    println!("{:?}\n{:?} rms {}", fit.record.constants, fit.paris, fit.record.rms_life_error());
    println!("{:?}, p ± {}", fit.confidence, fit.p_error());
    assert!(fit.record.rms_life_error() < 0.02);
    assert!((fit.record.life_fitted() / fit.record.life_measured() - 1.0).abs() < 0.025);
    assert!((2.7..3.3).contains(&fit.paris.m), "m = {}", fit.paris.m);
    // The rate there by fits of rates and of life: 9.40e-5 to 9.63e-5 mm/cycle at 11.4 MPa√m.
    let rate = fit.paris.c * 11.4_f64.powf(fit.paris.m);
    assert!((9.3e-5..9.8e-5).contains(&rate), "rate at 11.4: {rate}");
}

/// `m_integrated` and `log10C_integrated` of `paris_fits.csv` are plain least squares on the integrated curve of each specimen.
#[test]
fn every_specimen_gets_the_constants_of_an_independent_fit() {
    let (Some(fit), Some(fits)) = (fit_to("virkler/virkler.csv", Criterion::FirstReading), shared("virkler/paris_fits.csv"))
    else {
        return;
    };
    let mut reader = csv::Reader::from_path(fits).unwrap();
    for (row, specimen) in reader.deserialize::<std::collections::HashMap<String, String>>().zip(&fit.specimens) {
        let row = row.unwrap();
        assert_eq!(row["specimen"], specimen.name);
        let number = |column: &str| row[column].parse::<f64>().unwrap();
        let (m, rms) = (number("m_integrated"), number("rms_rel_integrated"));
        assert!((specimen.constants.p - m).abs() < 0.02, "{}: p {} against {m}", specimen.name, specimen.constants.p);
        assert!(
            (specimen.rms_life_error() - rms).abs() < 1e-3,
            "{}: rms {} against {rms}",
            specimen.name,
            specimen.rms_life_error()
        );
        assert!((specimen.life_measured() - number("cycles_to_49_8mm")).abs() < 0.5);
    }
}

// The calibration of the engine on the median panel of Virkler et al. (1979).

pub fn calibration(set: &[String]) -> CalibrationCase {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("calibration/al2024-t3/case.toml");
    CalibrationCase::from_file(&file, set).unwrap()
}

pub fn engine_fit(calibration: &CalibrationCase, curves: &[MeasuredCurve]) -> Fit {
    let mut calibration = calibration.clone();
    calibration.curves = curves.to_vec();
    calibrate(&calibration, &Silent).unwrap()
}

#[test]
fn the_median_panel_is_fitted_within_two_percent_of_life() {
    let calibration = calibration(&[]);
    let found = engine_fit(&calibration, &calibration.curves);
    let life = found.record.life_fitted() / found.record.life_measured();
    assert!(found.record.rms_life_error() <= 0.02);
    assert!((life - 1.0).abs() <= 0.025);
    assert!((2.7..=3.3).contains(&found.paris.m));
    // The error of p by hand calculation on the same curve is about 0.1.
    assert!(found.p_error() < 0.2, "p ± {}", found.p_error());
}

/// Without a method, and without a key of points, the panel is fitted to the K of its handbook; A and p are those of bonds by β.
#[test]
fn what_the_program_chooses_gives_the_constants_of_bonds() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("calibration/al2024-t3");
    let text = std::fs::read_to_string(folder.join("case.toml")).unwrap();
    let left_open = text.replace("spacing_mm = 1.0", "");
    assert_ne!(left_open, text);
    let chosen = CalibrationCase::from_text(&left_open, "median", folder.as_path()).unwrap();
    assert!(chosen.case.chosen.as_ref().is_some_and(|why| why.contains("Feddersen")), "{:?}", chosen.case.chosen);
    let on_points = calibration(&[]);
    let [chosen, on_points] = [&chosen, &on_points].map(|case| engine_fit(case, &case.curves));
    let [a, b] = [&chosen, &on_points].map(|fit| fit.record.constants);
    // The spacing that the program takes is the one of the file, so that both A belong to one horizon. K of the two differs by up to 0.5 %.
    assert!((chosen.bonds.unwrap().horizon / on_points.bonds.unwrap().horizon - 1.0).abs() < 1e-9);
    assert!((a.a / b.a - 1.0).abs() < 0.02 && (a.p - b.p).abs() < 0.01, "{a:?} {b:?}");
}
