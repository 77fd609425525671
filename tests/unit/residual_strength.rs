//! Residual strength where no handbook knows K, and its table.

use perilife_base::units::{MPA, MPA_SQRT_M};
use perilife_growth::predict::StopReason;
use perilife_growth::predict::judgement::breaks_at_once;
use perilife_growth::predict::residual_strength::{check_strength, residual_strength};
use perilife_plate::specimen::handbook::handbook;
use perilife_results::run::strength_table as table;

use crate::support::hand_cases::{ALL, PANEL, hand_case, hand_run, try_hand_case};
use crate::support::rows::assert_refusal;
use crate::support::{made_up_case, made_up_run};

#[test]
fn a_plate_has_the_strength_its_own_k_leaves_it() {
    let (mut case, run) = (made_up_case::case(), made_up_run::prediction(0.0));
    assert!(check_strength(&case).unwrap_err().to_string().contains("give material.toughness_mpa_sqrt_m"));
    // A yield strength alone says what the sections bear.
    case.material.yield_strength = Some(345e6);
    check_strength(&case).unwrap();
    case.material.toughness = Some(50e6);
    let curve = residual_strength(&case, &run.curve).unwrap();
    assert_eq!(curve.len(), run.curve.len());
    for (strength, point) in curve.iter().zip(&run.curve) {
        // ΔK of this run is 0.9 K_max (R = 0.1), the load 70 MPa.
        let expected = 70e6 * 50e6 / (point.delta_k / 0.9);
        assert!((strength.load() / expected - 1.0).abs() < 1e-12 && strength.by_net_section.is_none());
        assert_eq!(strength.governed_by(), StopReason::Toughness);
    }
}

#[test]
fn the_table_names_the_unit_of_the_load() {
    for specimen in ALL {
        let set = ["material.yield_strength_mpa=345", "material.toughness_mpa_sqrt_m=45"];
        let case = hand_case(specimen, &set);
        let text = table(&case, &residual_strength(&case, &hand_run(specimen, &set).curve).unwrap()).csv();
        let unit = if specimen.contains("compact") { "_kn" } else { "_mpa" };
        assert!(text.starts_with(&format!("crack_length_mm,residual_strength{unit},by_toughness{unit}")), "{text}");
        let row: Vec<&str> = text.lines().nth(1).unwrap().split(',').collect();
        let [least, toughness, net_section] = [1, 2, 3].map(|column| row[column].parse::<f64>().unwrap());
        assert_eq!(least, toughness.min(net_section), "{specimen}");
        assert!(text.lines().count() > 100 && text.lines().last().unwrap().ends_with("net_section_yield"), "{text}");
    }
}

/// A life ends where the plate no longer bears the load that it has to: K of that load is the toughness, or its net section yields, whatever
/// comes first, and before that of the cycles does.
#[test]
fn a_required_load_ends_the_life() {
    for specimen in ALL {
        let strengths = ["material.toughness_mpa_sqrt_m=60", "material.yield_strength_mpa=345"];
        let plain = hand_run(specimen, &strengths);
        for factor in [1.0, 1.4, 2.0] {
            let key = format!("stop.limit_load_factor={factor}");
            let set = [strengths[0], strengths[1], &key];
            let (case, run) = (hand_case(specimen, &set), hand_run(specimen, &set));
            assert_eq!(run.stop, StopReason::RequiredStrength, "{specimen}");
            let (a, load) = (run.crack_length_final(), factor * case.loading.maximum);
            let k = handbook(&case.specimen).unwrap().k_i(a, load) / (60.0 * MPA_SQRT_M);
            let section = case.specimen.net_section_stress(a, load).unwrap() / (345.0 * MPA);
            assert!((k.max(section) - 1.0).abs() < 1e-9, "{specimen}: {k} {section}");
            if factor == 1.0 {
                assert_eq!((run.life(), a), (plain.life(), plain.crack_length_final()), "{specimen}");
            } else {
                assert!(run.life().unwrap() < plain.life().unwrap(), "{specimen}");
            }
        }
    }
    // The same load as a gross stress: 48.28 MPa of range at R = 0.2 has a largest stress of 60.35 MPa.
    let toughness = "material.toughness_mpa_sqrt_m=60";
    let [by_factor, by_stress] = ["stop.limit_load_factor=2", "stop.required_strength_mpa=120.7"]
        .map(|key| hand_run(PANEL, &[toughness, key]).life().unwrap());
    assert!((by_factor / by_stress - 1.0).abs() < 1e-12);
}

/// K_max of the message is that under the required strength, not of the cycles.
#[test]
fn a_required_strength_that_the_plate_never_has_is_named() {
    let set = ["material.toughness_mpa_sqrt_m=60", "stop.required_strength_mpa=700"];
    let words = breaks_at_once(&hand_case(PANEL, &set), &hand_run(PANEL, &set)).unwrap();
    assert!(words.starts_with("fails under the required strength, at the start: K_max "), "{words}");
}

#[test]
fn a_required_load_that_says_nothing_is_refused() {
    let toughness = "material.toughness_mpa_sqrt_m=60";
    let wrong: [(&str, &[&str], &str); 5] = [
        (PANEL, &[toughness, "stop.required_strength_mpa=50"], "below the maximum load of the cycle"),
        (PANEL, &[toughness, "stop.limit_load_factor=0.9"], "below the maximum load of the cycle"),
        (PANEL, &["stop.limit_load_factor=2"], "requires material.toughness or material.yield_strength"),
        (
            PANEL,
            &[toughness, "stop.limit_load_factor=2", "stop.required_strength_mpa=150"],
            "conflicts with required_strength_mpa; give exactly one of",
        ),
        (ALL[3], &[toughness, "stop.required_strength_mpa=150"], "set stop.limit_load_factor"),
    ];
    for (specimen, set, words) in wrong {
        assert_refusal(try_hand_case(specimen, set), &[words]);
    }
}
