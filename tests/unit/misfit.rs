//! Search, misfit and Paris equivalents against models with a known answer.

use perilife_base::error::Result;
use perilife_base::units::{MM, MPA, MPA_SQRT_M};
use perilife_calibration::criterion::{Criterion, inverse_a, misfit, rms_life_error};
use perilife_calibration::fit::{Fit, FitTask, fit};
use perilife_calibration::median::cycles_since_first;
use perilife_calibration::power_law::PowerLaw;
use perilife_measured::MeasuredCurve;

use crate::support::rows::{assert_refusal, assert_says};

/// ΔK of the Virkler panel, Pa√m.
pub fn delta_k(a: f64) -> f64 {
    let width = 152.4 * MM;
    48.28 * MPA * (std::f64::consts::PI * a / (std::f64::consts::PI * a / width).cos()).sqrt()
}

/// Lengths from 9.0 to 49.8 mm every 0.8 mm.
pub fn lengths() -> Vec<f64> {
    (0..=51).map(|i| (9.0 + 0.8 * f64::from(i)) * MM).collect()
}

pub fn paris_model() -> PowerLaw {
    PowerLaw::new(9.0 * MM, 49.8 * MM, &delta_k).unwrap()
}

/// The exact curve of da/dN = A ΔK^p (m/cycle, MPa√m).
pub fn exact_curve(name: &str, a: f64, p: f64) -> MeasuredCurve {
    let crack_length = lengths();
    let cycles = paris_model().cycles(p, &crack_length).unwrap().iter().map(|n| n / a).collect();
    MeasuredCurve::new(name, cycles, crack_length)
}

pub fn fit_to(curves: &[MeasuredCurve], fixed_p: Option<f64>, law: &PowerLaw) -> Result<Fit> {
    fit_by(Criterion::BothEnds, curves, fixed_p, law)
}

pub fn fit_by(criterion: Criterion, curves: &[MeasuredCurve], fixed_p: Option<f64>, law: &PowerLaw) -> Result<Fit> {
    fit(&FitTask { curves, fixed_p, criterion, delta_k: &delta_k }, law)
}

#[test]
fn least_squares_in_cycles_gives_a_of_a_scaled_curve() {
    let model = [0.0, 1.0, 3.0, 7.0];
    let measured = [0.0, 20.0, 60.0, 140.0];
    for &criterion in Criterion::ALL {
        assert!((inverse_a(criterion, &model, &measured) - 20.0).abs() < 1e-12, "{criterion}");
        assert!(misfit(criterion, &model, &measured) < 1e-15, "{criterion}");
    }
}

/// No A near the one of least squares comes nearer to a curve that the model cannot follow.
#[test]
fn least_squares_is_the_minimum_of_every_criterion() {
    let (model, measured) = ([0.0, 1.0, 3.0, 7.0, 9.0], [0.0, 26.0, 60.0, 131.0, 190.0]);
    for &criterion in Criterion::ALL {
        let best = inverse_a(criterion, &model, &measured);
        let away = |factor: f64| -> f64 {
            let lives = criterion.lives(&model).into_iter().zip(criterion.lives(&measured));
            lives.zip(criterion.weights(&measured)).map(|((n, m), w)| w * (n * best * factor - m).powi(2)).sum()
        };
        assert!(away(1.0) < away(1.001) && away(1.0) < away(0.999), "{criterion}");
        let whole: f64 = criterion.lives(&measured).iter().zip(criterion.weights(&measured)).map(|(m, w)| w * m * m).sum();
        assert!((misfit(criterion, &model, &measured) - (away(1.0) / whole).sqrt()).abs() < 1e-12, "{criterion}");
    }
}

#[test]
fn lives_are_counted_from_the_first_reading_and_to_the_last() {
    let cycles = [0.0, 10.0, 16.0, 20.0];
    assert_eq!(Criterion::FirstReading.lives(&cycles), [10.0, 16.0, 20.0]);
    assert_eq!(Criterion::BothEnds.lives(&cycles), [10.0, 16.0, 20.0, 10.0, 4.0]);
    assert_eq!(Criterion::BothEnds.weights(&cycles), [0.1, 1.0 / 16.0, 0.05, 0.1, 0.25]);
    // Turned round, from the last reading to the first, a curve has the same lives.
    let turned: Vec<f64> = cycles.iter().rev().map(|n| 20.0 - n).collect();
    let sorted = |mut lives: Vec<f64>| {
        lives.sort_by(f64::total_cmp);
        lives
    };
    assert_eq!(sorted(Criterion::BothEnds.lives(&turned)), sorted(Criterion::BothEnds.lives(&cycles)));
}

#[test]
fn rms_life_error_follows_its_definition() {
    // Errors +2 and -4 of a life of 100, over the two readings after the first: √((0.02² + 0.04²) / 2).
    let error = rms_life_error(&[0.0, 52.0, 96.0], &[0.0, 50.0, 100.0]);
    assert!((error - (0.001_f64).sqrt()).abs() < 1e-12, "{error}");
}

#[test]
fn exact_curves_give_back_their_constants() {
    for p in [1.6, 2.0, 2.87, 4.0, 6.0] {
        let a = 1e-10;
        let plain = fit_by(Criterion::FirstReading, &[exact_curve("exact", a, p)], None, &paris_model()).unwrap();
        assert!((plain.record.constants.p - p).abs() < 0.003, "p = {p}: {:?}", plain.record.constants);
        let fit = fit_to(&[exact_curve("exact", a, p)], None, &paris_model()).unwrap();
        assert!((fit.record.constants.p - p).abs() < 0.003, "p = {p}: {:?}", fit.record.constants);
        assert!(fit.record.rms_life_error() < 1e-3, "p = {p}: rms {}", fit.record.rms_life_error());
        // A Paris model is its own equivalent, C in mm/cycle.
        assert!((fit.paris.m - fit.record.constants.p).abs() < 0.01, "m = {}, p = {p}", fit.paris.m);
        assert!((fit.paris.c / (1e3 * fit.record.constants.a) - 1.0).abs() < 0.02, "C = {}", fit.paris.c);
        assert!((fit.paris.delta_k_min - delta_k(9.0 * MM) / MPA_SQRT_M).abs() < 1e-9);
    }
}

#[test]
fn each_specimen_gets_its_own_constants() {
    let exponents = [2.4, 2.6, 2.75, 2.9, 3.0, 3.05, 3.1, 3.2, 3.4, 3.7];
    let curves: Vec<MeasuredCurve> =
        exponents.iter().enumerate().map(|(i, &p)| exact_curve(&format!("S{i}"), 2.2e-10 * 11.4_f64.powf(2.9 - p), p)).collect();
    let fit = fit_to(&curves, None, &paris_model()).unwrap();
    for (specimen, p) in fit.specimens.iter().zip(exponents) {
        assert!((specimen.constants.p - p).abs() < 1e-6, "{}: p = {}, given {p}", specimen.name, specimen.constants.p);
        assert!(specimen.rms_life_error() < 1e-6, "{}: rms {}", specimen.name, specimen.rms_life_error());
    }
}

#[test]
fn a_fixed_p_leaves_a() {
    let law = paris_model();
    let fit = fit_to(&[exact_curve("exact", 1e-10, 2.87)], Some(2.87), &law).unwrap();
    assert!((fit.record.constants.a / 1e-10 - 1.0).abs() < 1e-6);
    assert_eq!(fit.confidence.covariance[1][1], 0.0);
    assert!((fit.paris.m - 2.87).abs() < 0.01);
    assert!(fit_to(&[exact_curve("exact", 1e-10, 2.87)], Some(12.0), &law).unwrap_err().to_string().contains("fit.p = 12"));
}

/// Derivatives are those of the cycles.
#[test]
fn cycles_change_with_p_as_they_say() {
    let (law, step) = (paris_model(), 1e-4);
    let at = |p: f64| law.cycles(p, &lengths()).unwrap();
    for ((slope, above), below) in
        law.cycles_per_p(2.87, &lengths()).unwrap().iter().zip(at(2.87 + step)).zip(at(2.87 - step)).skip(1)
    {
        assert!((slope / ((above - below) / (2.0 * step)) - 1.0).abs() < 1e-6);
    }
}

/// A curve that no exponent follows has no law; a specimen of that kind beside others is told.
#[test]
fn an_exponent_at_an_end_of_its_range_is_no_fit() {
    // Rates that fall as the crack grows.
    let mut odd = exact_curve("odd", 1e-10, 2.87);
    let increments: Vec<f64> = odd.cycles.windows(2).map(|pair| pair[1] - pair[0]).rev().collect();
    for (i, increment) in increments.into_iter().enumerate() {
        odd.cycles[i + 1] = odd.cycles[i] + increment;
    }
    let error = fit_to(&[odd.clone()], None, &paris_model()).unwrap_err();
    assert_eq!(error.exit_code(), 3);
    let said = error.to_string();
    let words = ["odd: ", "p = 1.000, at the limit of the search range 1 to 8", "measured.from_crack_length_mm", "fix p"];
    assert_says(&said, &words);
    assert!(fit_to(&[odd.clone()], Some(3.0), &paris_model()).is_ok(), "p was fixed");
    let steep = exact_curve("steep", 1e-15, 9.0);
    assert_refusal(fit_to(&[steep], None, &paris_model()), &["p = 8.000, at the limit"]);
    let good = ["A", "B", "C"].map(|name| exact_curve(name, 1e-10, 2.87));
    let fit = fit_to(&[&good[..], &[odd]].concat(), None, &paris_model()).unwrap();
    // Its rates lie on no line either.
    assert!(fit.warnings.iter().all(|line| line.contains("specimen odd")), "{:?}", fit.warnings);
    assert!(fit.warnings.iter().any(|line| line.starts_with("exponent: specimen odd: best fit")), "{:?}", fit.warnings);
}

#[test]
fn a_narrow_window_says_that_p_is_not_identified() {
    let mut curve = exact_curve("short", 1e-10, 2.87);
    curve.cycles.truncate(12);
    curve.crack_length.truncate(12);
    let fit = fit_to(&[curve], None, &paris_model()).unwrap();
    assert!(fit.warnings.iter().any(|warning| warning.contains("m cannot be determined")), "{:?}", fit.warnings);
}

#[test]
fn a_run_that_ends_too_early_is_named() {
    let short = PowerLaw::new(9.0 * MM, 30.0 * MM, &delta_k).unwrap();
    let error = fit_to(&[exact_curve("long", 1e-10, 2.87)], None, &short).unwrap_err();
    assert_eq!(error.exit_code(), 3);
    assert!(error.to_string().contains("the run ends at 30.0000 mm"), "{error}");
}

#[test]
fn cycles_are_interpolated_between_points_of_a_run() {
    let curve = [(0.0, 9.0 * MM), (10.0, 9.5 * MM), (12.0, 9.5 * MM), (22.0, 10.0 * MM)];
    let at = [9.0 * MM, 9.25 * MM, 9.5 * MM, 9.75 * MM, 10.0 * MM];
    let cycles = cycles_since_first(&curve, &at).unwrap();
    for (cycles, expected) in cycles.iter().zip([0.0, 5.0, 10.0, 17.0, 22.0]) {
        assert!((cycles - expected).abs() < 1e-9, "{cycles} against {expected}");
    }
    assert!(cycles_since_first(&curve, &[8.9 * MM]).is_err());
}
