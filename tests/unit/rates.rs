//! Growth rates of curves whose rate is known.

use perilife::calibration::rates::{RateMethod, RatePoint, TestPiece, add_delta_k, paris_line, rates};
use perilife::measured::MeasuredCurve;
use perilife::specimen::SpecimenKind;
use perilife::units::{MM, MPA};

use super::misfit::{delta_k, exact_curve};

fn curve(cycles: Vec<f64>, lengths_mm: &[f64]) -> MeasuredCurve {
    let crack_length = lengths_mm.iter().map(|a| a * MM).collect();
    MeasuredCurve::new("S", cycles, crack_length)
}

fn piece(kind: SpecimenKind, yield_strength: Option<f64>) -> TestPiece<'static> {
    TestPiece {
        kind,
        width: 152.4 * MM,
        thickness: 2.54 * MM,
        force_max: 60.35 * MPA * 152.4 * MM * 2.54 * MM,
        k_max_over_range: 1.25,
        ratio: 0.2,
        yield_strength,
        delta_k: &delta_k,
    }
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
        add_delta_k(&mut points, &piece(SpecimenKind::MiddleTension, None));
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
    let middle = piece(SpecimenKind::MiddleTension, Some(345.0 * MPA));
    assert!(middle.small_scale_yielding(59.5 * MM, 0.0, 1.0));
    assert!(!middle.small_scale_yielding(59.7 * MM, 0.0, 1.0));
    assert!(piece(SpecimenKind::MiddleTension, None).small_scale_yielding(70.0 * MM, 0.0, 1.0));
    let compact = piece(SpecimenKind::CompactTension, Some(345.0 * MPA));
    let ligament = 152.4 * MM - 100.0 * MM;
    let limit = 345.0 * MPA * (ligament * std::f64::consts::PI / 4.0).sqrt();
    assert!(compact.small_scale_yielding(100.0 * MM, 0.999 * limit, 1.0));
    assert!(!compact.small_scale_yielding(100.0 * MM, 1.001 * limit, 1.0));
}
