//! What is said about the fit behind a run.

use perilife::predict::plastic_zone::{plastic_zone, warnings};
use perilife::report::{fit_use, json};

use crate::hand_cases::{PANEL, hand_case, hand_run};
use crate::{made_up_case, made_up_run};

#[test]
fn life_near_the_lowest_fitted_delta_k_is_labelled_unless_a_threshold_is_given() {
    let (mut case, mut run) = (made_up_case::case(), made_up_run::prediction(0.0));
    assert!(fit_use::labels(&case, &run).is_empty(), "an inline law has no lowest ΔK");
    // ΔK rises linearly from 10 to 20 MPa√m over 100 cycles; 1.5 times 8 is 12.
    run.curve.truncate(2);
    for (point, (cycles, delta_k)) in run.curve.iter_mut().zip([(0.0, 10e6), (100.0, 20e6)]) {
        (point.cycles, point.delta_k) = (cycles, delta_k);
    }
    case.law = made_up_case::fitted(8.0, 25.0);
    let share = fit_use::life_share_near_threshold(&case, &run).unwrap();
    assert!((share - 0.2).abs() < 1e-5, "{share}");
    let labels = fit_use::labels(&case, &run);
    assert!(labels.len() == 1 && labels[0].contains("20.0 %") && labels[0].contains("12.00 MPa√m"), "{labels:?}");
    assert!(json::result(&case, &run)["warnings"].as_array().unwrap().iter().any(|line| line == &labels[0]));
    // Above 1.5 times the lowest value there is nothing to label.
    case.law = made_up_case::fitted(6.0, 25.0);
    assert!(fit_use::labels(&case, &run).is_empty());
    case.law = made_up_case::fitted(8.0, 25.0);
    case.fatigue.threshold = 3e6;
    assert!(fit_use::labels(&case, &run).is_empty() && fit_use::life_share_near_threshold(&case, &run).is_none());
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
