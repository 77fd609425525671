//! The calibration finds the constants of curves that the engine itself computed.

use crate::support::fatigue_test::distance_squared;
use perilife_base::units::MM;
use perilife_calibration::calibrate::in_terms_of_bonds;
use perilife_calibration::criterion::Criterion;
use perilife_calibration::fit::{Fit, FitTask, fit};
use perilife_calibration::power_law::PowerLaw;
use perilife_calibration::search::Constants;
use perilife_growth::case::Case;
use perilife_growth::predict::factor_curve::FactorCurve;
use perilife_growth::predict::{RunFigures, Silent, predict};
use perilife_growth::rate_constant::rate_constant;
use perilife_laws::FatigueLaw;
use perilife_laws::paris::ParisLaw;
use perilife_measured::MeasuredCurve;
use perilife_plate::specimen::handbook::handbook;

use crate::support::noise::Noise;
use crate::support::plates::case;

/// The panel of Virkler et al. (1979) on a coarse lattice.
const PANEL: &str = "kind=\"middle_tension\"\nwidth_mm=152.4\nlength_mm=240\nthickness_mm=2.54\ncrack_length_mm=12\n";
const A: f64 = 5200.0;
const P: f64 = 2.87;
/// 95 % quantile of χ² with two degrees of freedom.
const ELLIPSE_95: f64 = 5.991;

/// A curve of the engine with known constants, read at its rows at least 1 mm apart, with relative noise on the cycles between
/// readings.
fn curve(spacing: f64, exact: &[(f64, f64)], scatter: f64, seed: u64) -> MeasuredCurve {
    let mut noise = Noise::new(seed);
    let (mut crack_length, mut cycles, mut before) = (vec![exact[0].1], vec![0.0], exact[0]);
    for &row in exact {
        if row.1 >= before.1 + 1.0 * MM {
            cycles.push(cycles[cycles.len() - 1] + (row.0 - before.0) * (1.0 + scatter * noise.normal()));
            crack_length.push(row.1);
            before = row;
        }
    }
    MeasuredCurve::new(format!("seed {seed} at {spacing} mm"), cycles, crack_length)
}

/// The panel, figures of its run, and fits of C and m to curves of several seeds, all from one run with the known constants.
fn fits(spacing: f64, scatter: f64, seeds: u64) -> (Case, RunFigures, Vec<Fit>) {
    let set = [format!("model.spacing_mm={spacing}"), format!("fatigue.a={A}"), format!("fatigue.p={P}")];
    let set: Vec<&str> = set.iter().map(String::as_str).chain(["fatigue.driver=tip_field", "stop.crack_length_mm=44"]).collect();
    let panel = case(PANEL, &set);
    let exact: Vec<(f64, f64)> = predict(&panel, &Silent).unwrap().curve.iter().map(|p| (p.cycles, p.crack_length)).collect();
    let formula = handbook(&panel.specimen).unwrap();
    let delta_k = |length: f64| formula.delta_k(length, panel.loading.maximum, panel.loading.range_share());
    let factors = FactorCurve::of(&panel, &Silent).unwrap();
    let of_field = |length: f64| panel.loading.range_share() * factors.at(length);
    let law = PowerLaw::new(panel.specimen.crack_length, panel.stop.crack_length, &of_field).unwrap();
    let fit_to = |seed: u64| {
        let curves = [curve(spacing, &exact, scatter, seed)];
        fit(&FitTask { curves: &curves, fixed_p: None, criterion: Criterion::BothEnds, delta_k: &delta_k }, &law).unwrap()
    };
    let found = (1..=seeds).map(fit_to).collect();
    (panel, factors.figures, found)
}

/// The law at the horizon that the fit belongs to.
fn known(horizon: f64) -> (f64, f64) {
    (A * (horizon / (3.015 * MM)).powf((P - 2.0) / 2.0), P)
}

#[test]
fn the_engine_recovers_its_own_constants() {
    let (panel, figures, mut found) = fits(4.0, 0.0, 1);
    let found = in_terms_of_bonds(found.remove(0), &panel, [figures.horizon, figures.spacing]).unwrap();
    let (a, p) = known(figures.horizon);
    let constants = found.record.constants;
    let (rms, life) = (found.record.rms_life_error(), found.record.life_fitted() / found.record.life_measured());
    println!("A {} against {a}, p {} against {p}, rms {rms}, life {life}", constants.a, constants.p);
    // Blocks of a run are good to 0.2 % in cycles.
    assert!((constants.p - p).abs() < 0.02, "p = {}", constants.p);
    assert!(rms < 1e-3, "{rms}");
    assert!((life - 1.0).abs() < 1e-3, "{life}");
}

#[test]
fn truth_lies_inside_the_95_percent_ellipse_of_engine_fits() {
    let (panel, figures, found) = fits(3.0, 0.05, 200);
    let horizon = figures.horizon;
    let beta = rate_constant(panel.points().bond_law.kernel, P).unwrap();
    let truth = ParisLaw::of_bonds(&FatigueLaw { a: known(horizon).0, p: P, horizon }, beta, panel.material.plane_modulus());
    let is_inside = |fit: &&Fit| {
        let Constants { a: c, p: m } = fit.record.constants;
        distance_squared(fit.confidence.covariance, [(truth.c / c).ln(), truth.m - m]) < ELLIPSE_95
    };
    let inside = found.iter().filter(is_inside).count();
    let mean_p = found.iter().map(|fit| fit.record.constants.p).sum::<f64>() / found.len() as f64;
    println!("{} readings: inside {inside} of 200, mean p {mean_p:.4} (given {P})", found[0].record.crack_length.len());
    assert!(inside >= 170, "{inside} of 200 inside");
    assert!((mean_p / P - 1.0).abs() < 0.03, "mean p = {mean_p}");
}
