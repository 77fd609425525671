//! What is said about the fit behind a run.

use std::path::Path;

use perilife_growth::case::Case;
use perilife_growth::predict::fit_use;
use perilife_growth::predict::plastic_zone::{plane_warning, plastic_zone};
use perilife_growth::predict::{Silent, predict};
use perilife_results::checks::{Verdict, of_run};

use crate::support::hand_cases::{PANEL, hand_case, hand_run};
use crate::support::{made_up_case, made_up_run};

#[test]
fn life_outside_the_tested_range_is_a_check_a_side_with_a_remedy() {
    let (mut case, mut run) = (made_up_case::case(), made_up_run::prediction(0.0));
    // ΔK rises linearly from 10 to 20 MPa√m over 100 cycles.
    run.curve.truncate(2);
    for (point, (cycles, delta_k)) in run.curve.iter_mut().zip([(0.0, 10e6), (100.0, 20e6)]) {
        (point.cycles, point.delta_k) = (cycles, delta_k);
    }
    case.law = made_up_case::fitted(12.0, 17.0);
    let found = |case: &Case, name: &str| of_run(case, &run).into_iter().find(|check| check.name == name).unwrap();
    let below = found(&case, "extrapolation_below");
    assert_eq!(below.words, "Extrapolation: 20.0 % of life at ΔK below 12.00 MPa√m, the lowest tested (usually conservative)");
    assert!(below.remedy.unwrap().contains("threshold_mpa"));
    assert!(found(&case, "extrapolation_above").words.contains("30.0 % of life at ΔK above 17.00 MPa√m"));
    case.fatigue.threshold = 3e6;
    assert!(!found(&case, "extrapolation_below").remedy.unwrap().contains("threshold_mpa"));
    // The tested specimen itself is within the range.
    case.law = made_up_case::fitted(10.0, 20.0);
    assert_eq!(found(&case, "extrapolation_below").verdict, Verdict::Passed);
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
    let told = &made_up_run::result(&case, &run)["plastic_zone"];
    assert!((told["first"]["over_thickness"].as_f64().unwrap() - zone.first.size / 2.54e-3).abs() < 1e-9);
    assert_eq!(told["small_scale_yielding"], false);
    // In the range of the tests it holds.
    let stop = "stop.crack_length_mm=49.8";
    assert!(hand_run(PANEL, &[strong, stop]).warnings.is_empty());
    // Plane strain in 2.54 mm of this alloy: 2.5 (K/σ_Y)² = 2.2 mm at the start, but not at half the strength.
    let strain = ["material.plane=strain", "material.yield_strength_mpa=200", stop];
    let line = plane_warning(&hand_case(PANEL, &strain), &hand_run(PANEL, &strain).curve).unwrap();
    assert!(line.contains("plane strain at the tip needs a thickness of 6.5"), "{line}");
    // Without a yield strength nothing is known.
    assert!(
        plastic_zone(&hand_case(PANEL, &[]), &run.curve).is_none()
            && made_up_run::result(&hand_case(PANEL, &[]), &run)["plastic_zone"].is_null()
    );
}

/// A crack of 1.5 mm at the hole of a lug whose ligament is 13.5 mm, less what the chords of its head take: the crack is what is too short, until it has grown.
#[test]
fn a_short_crack_at_a_rim_is_not_called_a_ligament() {
    let case = |force: f64| {
        let text = format!(
            "[specimen]\nkind = \"lug\"\nhead = \"round\"\nwidth_mm = 50\nlength_mm = 100\nthickness_mm = 5\nhole_diameter_mm = 20\n\
             crack_length_mm = 1.5\ncracks = 2\n[material]\nname = \"al2024-t3\"\n[loading]\nforce_max_kn = {force}\nstress_ratio = 0.1\n\
             [fatigue]\nparis_c_mm_per_cycle = 8.95422e-8\nparis_m = 2.874\n"
        );
        Case::from_toml(&text, "lug", Path::new("."), &[]).unwrap()
    };
    // K of a row is set by hand: 4/π (K/345)² = 1.75 mm at 12.79 MPa√m, and 1.0 mm later.
    let mut run = predict(&case(10.0), &Silent).unwrap();
    run.curve.truncate(2);
    let (first, last) = (run.curve[0].crack_length, run.curve[1].crack_length);
    for (row, needed) in run.curve.iter_mut().zip([1.75e-3_f64, 1.0e-3]) {
        row.delta_k = 0.9 * 345e6 * (needed * std::f64::consts::FRAC_PI_4).sqrt();
    }
    let zone = plastic_zone(&case(10.0), &run.curve).unwrap();
    assert!((zone.first.ligament - 13.5e-3).abs() < 5e-6 && (zone.first.crack - 1.5e-3).abs() < 1e-9, "{:?}", zone.first);
    assert_eq!((zone.first.room().1, zone.too_small), ("crack length", "crack length"));
    assert!(zone.too_large_from.is_some_and(|from| (from - first).abs() < 1e-12), "{zone:?}");
    assert!(zone.too_large_to.is_some_and(|to| to > first && to < last) && zone.life_share_too_large < 1.0, "{zone:?}");
    let check = of_run(&case(10.0), &run).into_iter().find(|check| check.name == "small_scale_yielding").unwrap();
    assert!(check.words.contains("not valid from a = 1.5 mm to 1.5 mm (") && !check.words.contains("100.0 %"), "{check:?}");
    let told = &made_up_run::result(&case(10.0), &run)["plastic_zone"];
    // With too little ligament at the end as well it still holds in between.
    let mut long = predict(&case(10.0), &Silent).unwrap();
    long.curve.truncate(3);
    for (row, needed) in long.curve.iter_mut().zip([1.75e-3_f64, 1.0e-3, 30.0e-3]) {
        row.delta_k = 0.9 * 345e6 * (needed * std::f64::consts::FRAC_PI_4).sqrt();
    }
    let check = of_run(&case(10.0), &long).into_iter().find(|check| check.name == "small_scale_yielding").unwrap();
    let is_valid_between =
        check.verdict != Verdict::Failed && check.words.contains("not valid from a = 1.5 mm and again at the end (");
    assert!(is_valid_between && !check.words.contains("100.0 %"), "{check:?}");
    assert!((told["first"]["ligament_mm"].as_f64().unwrap() - 13.5).abs() < 5e-3, "{told}");
    assert!(told["first"]["over_crack"].as_f64().unwrap() > told["first"]["over_ligament"].as_f64().unwrap());
}
