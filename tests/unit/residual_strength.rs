//! Residual strength where no handbook knows K, and its table.

use perilife::predict::StopReason;
use perilife::predict::residual_strength::{check_strength, residual_strength};
use perilife::report::run::strength_table as table;

use crate::support::hand_cases::{ALL, hand_case, hand_run};
use crate::support::{made_up_case, made_up_run};

#[test]
fn a_plate_has_the_strength_its_own_k_leaves_it() {
    let (mut case, run) = (made_up_case::case(), made_up_run::prediction(0.0));
    assert!(check_strength(&case).unwrap_err().to_string().contains("give material.toughness_mpa_sqrt_m"));
    // The net section of a plate is not known: its yield strength alone says nothing.
    case.material.yield_strength = Some(345e6);
    assert_eq!(check_strength(&case).unwrap_err().exit_code(), 2);
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
        let text = table(&case, &residual_strength(&case, &hand_run(specimen, &set).curve).unwrap());
        let unit = if specimen.contains("compact") { "_kn" } else { "_mpa" };
        assert!(text.starts_with(&format!("crack_length_mm,residual_strength{unit},by_toughness{unit}")), "{text}");
        let row: Vec<&str> = text.lines().nth(1).unwrap().split(',').collect();
        let [least, toughness, net_section] = [1, 2, 3].map(|column| row[column].parse::<f64>().unwrap());
        assert_eq!(least, toughness.min(net_section), "{specimen}");
        assert!(text.lines().count() > 100 && text.lines().last().unwrap().ends_with("net_section_yield"), "{text}");
    }
}
