//! Growth rates of curves whose rate is known.

use perilife_base::units::{MM, MPA};
use perilife_calibration::rates::{RateMethod, RatePoint, add_delta_k, paris_line, rates, threshold};
use perilife_growth::case::Case;
use perilife_measured::MeasuredCurve;
use perilife_plate::material::Material;
use perilife_plate::specimen::SpecimenKind;

use super::misfit::{delta_k, exact_curve};
use crate::support::median::virkler_panel as panel;

fn curve(cycles: Vec<f64>, lengths_mm: &[f64]) -> MeasuredCurve {
    let crack_length = lengths_mm.iter().map(|a| a * MM).collect();
    MeasuredCurve::new("S", cycles, crack_length)
}

#[test]
fn a_straight_curve_has_one_rate_by_every_method() {
    let cycles: Vec<f64> = [0.0, 1.0, 2.5, 3.0, 5.0, 6.0, 7.5, 9.0, 10.0].iter().map(|n| n * 1e4).collect();
    let lengths: Vec<f64> = cycles.iter().map(|n| 10.0 + 2e-4 * n).collect();
    for &method in RateMethod::ALL {
        let points = rates(&curve(cycles.clone(), &lengths), method);
        assert_eq!(points.len(), if method == RateMethod::Secant { 8 } else { 3 }, "{method}");
        for point in points {
            assert!((point.rate / 2e-7 - 1.0).abs() < 1e-9, "{method}: {point:?}");
            assert!((point.crack_length - (10.0 * MM + 2e-7 * point.cycles)).abs() < 1e-12, "{method}: {point:?}");
        }
    }
}

#[test]
fn the_polynomial_is_exact_on_a_parabola_of_uneven_readings() {
    let cycles: Vec<f64> = [0.0, 1.0, 2.0, 4.0, 5.0, 7.0, 8.0, 9.5].iter().map(|n| n * 1e4).collect();
    let lengths: Vec<f64> = cycles.iter().map(|n| 10.0 + 1e-4 * n + 1e-9 * n * n).collect();
    for point in rates(&curve(cycles, &lengths), RateMethod::Polynomial7) {
        let rate = (1e-4 + 2e-9 * point.cycles) * MM;
        assert!((point.rate / rate - 1.0).abs() < 1e-9, "{point:?}");
    }
}

#[test]
fn rates_of_a_paris_curve_give_back_its_law() {
    let (a, p) = (8.95e-11, 2.87);
    for &method in RateMethod::ALL {
        let mut points = rates(&exact_curve("exact", a, p), method);
        add_delta_k(&mut points, &panel(), &delta_k);
        let law = paris_line(&points).unwrap();
        assert!((law.slope - p).abs() < 0.01, "{method}: m = {}", law.slope);
        // C belongs to ΔK = 1, far outside the data: compare rates inside, at 15 MPa√m.
        let rate = 10_f64.powf(law.at(15_f64.log10()));
        assert!((rate / (1e3 * a * 15_f64.powf(p)) - 1.0).abs() < 0.01, "{method}: rate {rate}");
    }
}

#[test]
fn short_steps_and_falling_readings_are_flagged() {
    let points = rates(&curve(vec![0.0, 1e3, 2e3, 3e3, 4e3], &[10.0, 10.25, 10.45, 10.40, 10.80]), RateMethod::Secant);
    let words: Vec<String> = points.iter().map(|point| point.flags.words()).collect();
    assert_eq!(words, ["", "step_under_0.25_mm", "step_under_0.25_mm not_growing", ""]);
    let falling: Vec<&RatePoint> = points.iter().filter(|point| point.rate <= 0.0).collect();
    assert_eq!(falling.len(), 1);
}

/// M(T): W - 2a ≥ 1.25 P_max / (B σ_YS); for the Virkler panel with 345 MPa up to a = (152.4 - 33.324) / 2 = 59.54 mm.
/// C(T): W - a ≥ (4/π) (K_max/σ_YS)².
#[test]
fn the_ligament_must_hold_its_plastic_zone() {
    let holds = |case: &Case, a: f64, k_max: f64| {
        let strength = case.material.yield_strength.unwrap();
        case.specimen.small_scale_yielding(a * MM, case.loading.maximum, k_max, strength)
    };
    let middle = panel();
    assert!(holds(&middle, 59.5, 0.0) && !holds(&middle, 59.7, 0.0));
    let mut compact = panel();
    compact.specimen.kind = SpecimenKind::CompactTension;
    let limit = 345.0 * MPA * ((152.4 - 100.0) * MM * std::f64::consts::PI / 4.0).sqrt();
    assert!(holds(&compact, 100.0, 0.999 * limit) && !holds(&compact, 100.0, 1.001 * limit));
    // Rates say so, and where no strength is known, nothing.
    let strength = |case: Case, yield_strength| {
        let mut points = rates(&curve(vec![0.0, 1e4, 2e4], &[58.0, 59.0, 62.0]), RateMethod::Secant);
        let material = Material { yield_strength, ..case.material.clone() };
        add_delta_k(&mut points, &Case { material, ..case }, &delta_k);
        points.iter().map(|point| point.flags.yielding).collect::<Vec<bool>>()
    };
    assert_eq!(strength(panel(), Some(345.0 * MPA)), [false, true]);
    assert_eq!(strength(panel(), None), [false, false]);
}

/// Near a threshold steps down to ten times the precision count; K that falls too fast, and ΔK_th, are told.
#[test]
fn tests_to_the_threshold() {
    let short = |rate: f64, step: f64, noise: f64, precision: Option<f64>| {
        let lengths: Vec<f64> = (0..30).map(|i| 15.0 + step * f64::from(i) + noise * f64::from(i % 3 - 1)).collect();
        let cycles = (0..30).map(|i| step * f64::from(i) / rate).collect();
        let points =
            rates(&MeasuredCurve { precision: precision.map(|p| p * MM), ..curve(cycles, &lengths) }, RateMethod::Polynomial7);
        points.iter().filter(|point| point.flags.short_step).count()
    };
    for (rate, step, noise, precision, flagged) in [
        (1e-6, 0.1, 0.0, None, 0),
        (1e-4, 0.1, 0.0, None, 24),
        (1e-4, 0.1, 0.0, Some(0.01), 24),
        (1e-6, 0.1, 0.02, None, 24),
        (1e-6, 0.1, 0.0, Some(0.01), 0),
        (1e-6, 0.1, 0.0, Some(0.011), 24),
        (1e-6, 0.3, 0.0, Some(0.1), 0),
    ] {
        assert_eq!(short(rate, step, noise, precision), flagged, "{rate} {step} {noise} {precision:?}");
    }
    let line = |k: f64| 1e-7 * (k / 3.0_f64).powi(12);
    let slow: Vec<(f64, f64)> = (0..8).map(|i| 3.0 + 0.05 * f64::from(i)).map(|k| (k, line(k))).collect();
    let (k, words) = threshold(slow.iter().copied()).unwrap();
    assert!((k / 3.0 - 1.0).abs() < 1e-9 && words.contains("ΔK_th = 3.000 MPa√m"), "{words}");
    assert!(threshold(slow.iter().take(4).copied()).is_none());
    assert!(threshold(slow.iter().map(|(k, rate)| (*k, 10.0 * rate))).is_none());
    let flagged = |gradient: f64| {
        let of = |i: usize| {
            let a = 15.0 + 0.3 * i as f64;
            RatePoint {
                crack_length: a * MM,
                load_factor: (gradient * (a - 15.0)).exp(),
                ..RatePoint::of_rate(f64::NAN, 1e-9, 0.2)
            }
        };
        let mut points: Vec<RatePoint> = (0..12).map(of).collect();
        add_delta_k(&mut points, &panel(), &|_| 10.0 * MPA);
        points.iter().filter(|point| point.flags.words() == "k_gradient").count()
    };
    assert_eq!([0.1, -0.079, -0.0801, -0.09].map(flagged), [0, 0, 0, 12]);
}
