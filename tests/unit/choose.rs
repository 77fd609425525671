//! What `model.method = "auto"` takes, and that it says why.

use std::path::Path;

use perilife_growth::case::{Case, Method};
use perilife_growth::predict::tip_factors::stress_intensity;

use crate::support::rows::rows;

const REST: &str = "[material]\nyoungs_modulus_gpa = 70\npoisson_ratio = 0.3\nplane = \"stress\"\n\
                    [loading]\nkind = \"constant_amplitude\"\nstress_max_mpa = 60\nstress_ratio = 0.1\n\
                    [fatigue]\nparis_c_mm_per_cycle = 1e-8\nparis_m = 3\n";

fn case(specimen: &str, set: &[&str]) -> Case {
    let set: Vec<String> = set.iter().map(|key| (*key).to_owned()).collect();
    let text = format!("[specimen]\nwidth_mm = 100\nlength_mm = 300\nthickness_mm = 2\n{specimen}\n{REST}");
    Case::from_toml(&text, "chosen", Path::new("."), &set).unwrap()
}

const MIDDLE: &str = "kind = \"middle_tension\"\ncrack_length_mm = 10";
const AT_HOLES: &str = "kind = \"crack_at_hole\"\nhole_diameter_mm = 8\ncrack_length_mm = 1\ncracks = 2";

/// A formula stands beside other results where it is of the same load.
#[test]
fn formulas_stand_beside_the_loads_that_they_know() {
    let bent = "loading.edge_bending_ratio=1";
    for (specimen, set, is_known) in [
        (AT_HOLES, "loading.stress_ratio=0.2", true),
        (AT_HOLES, bent, false),
        (AT_HOLES, "loading.crack_pressure_mpa=10", false),
        (AT_HOLES, "loading.residual_stress=\"-20\"", false),
        (MIDDLE, "loading.stress_ratio=0.2", true),
        (MIDDLE, "loading.residual_stress=\"-20\"", false),
    ] {
        let tips = stress_intensity(&case(specimen, &[set, "fatigue.walker_gamma=0.5"]), &[]).unwrap();
        assert_eq!(tips[0].handbook_k_i.is_some(), is_known, "{specimen} {set}");
    }
    let compact = "[specimen]\nwidth_mm = 50\nthickness_mm = 10\nkind = \"compact_tension\"\ncrack_length_mm = 15";
    let plate = format!("[specimen]\nwidth_mm = 100\nlength_mm = 300\nthickness_mm = 2\n{AT_HOLES}");
    for (specimen, rest, set, words) in [
        (plate.as_str(), REST.to_owned(), bent, "has no K(a) for this specimen (crack_at_hole)"),
        (
            compact,
            REST.replace("stress_max_mpa = 60", "force_max_n = 1000"),
            "specimen.pin_half_angle_deg=90",
            "that of its own pins",
        ),
    ] {
        let set = [set.to_owned(), "model.method=handbook".to_owned()];
        let by_hand = Case::from_toml(&format!("{specimen}\n{rest}"), "by hand", Path::new("."), &set);
        assert!(by_hand.as_ref().is_err_and(|error| error.to_string().contains(words)), "{set:?}: {by_hand:?}");
    }
}

#[test]
fn no_more_of_a_model_than_a_scene_needs() {
    for (specimen, set, method, why) in rows::<Vec<(String, Vec<String>, String, String)>>("choose", "chosen") {
        let set: Vec<&str> = set.iter().map(String::as_str).collect();
        let by_choice = case(&specimen, &set);
        assert_eq!(by_choice.model.method().name(), method, "{specimen} {set:?}");
        assert!(by_choice.chosen.as_ref().is_some_and(|words| words.contains(&why)), "{set:?}: {:?}", by_choice.chosen);
        // By its name it is the same model, and nothing was chosen.
        let by_name = format!("model.method={method}");
        let named = case(&specimen, &[&[by_name.as_str()], &set[..]].concat());
        assert!(named.chosen.is_none() && named.model == by_choice.model, "{set:?}");
    }
}

#[test]
fn a_notch_root_beside_a_crack_stays_and_is_named() {
    let slot = "kind = \"plate\"\nnotches = [{ from_mm = [-10, 0], to_mm = [10, 0], width_mm = 2 }]\ncracks = [{ from_mm = [10, 0], to_mm = [13, 0] }]";
    let [of_crack, of_bonds] = [case(slot, &[]), case(slot, &["fatigue.driver=bond_strain"])];
    let named = |case: &Case| {
        case.warnings.iter().filter(|message| message.contains("cracks: none starts at the notch root (-10.0000, 0")).count()
    };
    assert_eq!((of_crack.specimen.tips.len(), named(&of_crack)), (1, 1), "{:?}", of_crack.warnings);
    assert_eq!((of_bonds.specimen.tips.len(), named(&of_bonds)), (2, 0));
}

/// The formula of three rollers is for a/W of 0.25 and more; that of pure bending holds for all short cracks.
#[test]
fn a_formula_is_taken_within_its_range() {
    use Method::{ElementFreeGalerkin, Handbook};
    for (span, length, method) in [
        ("", 2.0, ElementFreeGalerkin),
        ("", 4.99, ElementFreeGalerkin),
        ("", 5.01, Handbook),
        ("", 10.0, Handbook),
        ("span_mm = 160\ninner_span_mm = 60\n", 2.0, Handbook),
    ] {
        let text = format!(
            "[specimen]\nkind = \"single_edge_bend\"\nwidth_mm = 20\nthickness_mm = 10\n{span}crack_length_mm = {length}\n{}",
            REST.replace("stress_max_mpa = 60", "force_max_n = 1000")
        );
        let bent = Case::from_toml(&text, "bent", Path::new("."), &[]).unwrap();
        assert_eq!(bent.model.method(), method, "{span}a {length} mm: {:?}", bent.chosen);
    }
}
