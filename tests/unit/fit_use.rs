//! What is said about the fit behind a run.

use perilife::predict::plastic_zone::{plastic_zone, warnings};
use perilife::report::{fit_use, json};

use crate::support::hand_cases::{PANEL, hand_case, hand_run};
use crate::support::{made_up_case, made_up_run};

#[test]
fn life_outside_the_fitted_range_is_told_side_by_side_with_a_remedy() {
    let (mut case, mut run) = (made_up_case::case(), made_up_run::prediction(0.0));
    assert!(fit_use::extrapolated(&case, &run).is_empty(), "an inline law has no fitted range");
    // ΔK rises linearly from 10 to 20 MPa√m over 100 cycles.
    run.curve.truncate(2);
    for (point, (cycles, delta_k)) in run.curve.iter_mut().zip([(0.0, 10e6), (100.0, 20e6)]) {
        (point.cycles, point.delta_k) = (cycles, delta_k);
    }
    case.law = made_up_case::fitted(12.0, 17.0);
    let told = fit_use::extrapolated(&case, &run);
    assert!(told.len() == 2, "{told:?}");
    // The larger share first.
    assert!(told[0].starts_with("30.0 % of the life is spent at ΔK above 17.00 MPa√m"), "{told:?}");
    assert!(
        told[1].starts_with("20.0 % of the life is spent at ΔK below 12.00 MPa√m") && told[1].contains("threshold_mpa"),
        "{told:?}"
    );
    let all = &json::result(&case, &run)["warnings"];
    assert!(told.iter().all(|line| all.as_array().unwrap().iter().any(|told| told == line)), "{all}");
    case.fatigue.threshold = 3e6;
    assert!(!fit_use::extrapolated(&case, &run)[1].contains("threshold_mpa"));
    // The calibrated specimen itself is not warned about.
    case.law = made_up_case::fitted(10.0, 20.0);
    assert!(fit_use::extrapolated(&case, &run).is_empty());
}

#[test]
fn a_fitted_law_is_told_with_its_errors() {
    let mut case = made_up_case::case();
    assert_eq!(fit_use::law_line(&case), None);
    case.law = made_up_case::fitted(8.0, 25.0);
    let line = fit_use::law_line(&case).unwrap();
    for words in ["3.4000e-5 mm/cycle ± 1.0 %", "15.00 MPa√m", "p = 3.0000 ± 0.0200", "m = 3.0000 ± 0.0200"] {
        assert!(line.contains(words), "{words} in {line}");
    }
}

/// Irwin: `(K_max/σ_Y)²/π`. The panel's ligament is too small from W - 2a = 1.25 P_max / (B σ_Y) on, a = 59.538 mm.
#[test]
fn the_plastic_zone_is_told_and_warned_about() {
    let strong = "material.yield_strength_mpa=345";
    let (case, run) = (hand_case(PANEL, &[strong]), hand_run(PANEL, &[strong]));
    let zone = plastic_zone(&case, &run.curve).unwrap();
    // K_max = 60.35 √(π 0.009 / cos(π 9/152.4)) = 10.2360 MPa√m.
    assert!((zone.first.size / ((10.2360_f64 / 345.0).powi(2) / std::f64::consts::PI) - 1.0).abs() < 1e-4);
    assert!((zone.first.ligament - 0.1344).abs() < 1e-12);
    let from = zone.too_large_from.unwrap();
    assert!((0.059538..0.0600).contains(&from), "{from}");
    // Lives to 59.54 and to 62.87 mm differ by half a percent.
    assert!((0.003..0.007).contains(&zone.life_share_too_large), "{}", zone.life_share_too_large);
    assert!(run.warnings.iter().any(|line| line.contains("small-scale yielding does not hold")), "{:?}", run.warnings);
    let told = &json::result(&case, &run)["plastic_zone"];
    assert!((told["first"]["over_thickness"].as_f64().unwrap() - zone.first.size / 2.54e-3).abs() < 1e-9);
    assert_eq!(told["small_scale_yielding"], false);
    // In the range of the tests it holds.
    let stop = "stop.crack_length_mm=49.8";
    assert!(hand_run(PANEL, &[strong, stop]).warnings.is_empty());
    // Plane strain in 2.54 mm of this alloy: 2.5 (K/σ_Y)² = 2.2 mm at the start, but not at half the strength.
    let strain = ["material.plane=strain", "material.yield_strength_mpa=200", stop];
    let lines = warnings(&hand_case(PANEL, &strain), &hand_run(PANEL, &strain).curve);
    assert!(lines.iter().any(|line| line.contains("plane strain at the crack tip asks for a thickness of 6.5")), "{lines:?}");
    // Without a yield strength nothing is known.
    assert!(
        plastic_zone(&hand_case(PANEL, &[]), &run.curve).is_none()
            && json::result(&hand_case(PANEL, &[]), &run)["plastic_zone"].is_null()
    );
}
