//! How large the cycles are and where they act.

use std::path::Path;

use perilife_growth::case::Case;
use perilife_plate::loading::Loading;
use perilife_plate::specimen::pin::{LOOSE_PIN, SNUG_PIN};
use perilife_plate::specimen::{Bearing, Load, Support};

use crate::support::rows::{assert_refusal, rows};

const PANEL: &str = "kind = \"middle_tension\"\nwidth_mm = 100\nlength_mm = 300\nthickness_mm = 2\ncrack_length_mm = 10";
const PLATE: &str = "kind = \"plate\"\nwidth_mm = 100\nlength_mm = 200\nthickness_mm = 2\ncracks = [{ from_mm = [-5, 0], to_mm = [5, 0] }]\n\
                     holes = [{ x_mm = 0, y_mm = 80, diameter_mm = 10 }, { x_mm = 0, y_mm = -80, diameter_mm = 10 }, { x_mm = 30, y_mm = 0, diameter_mm = 10 }]";

fn case(specimen: &str, loading: &str) -> Result<Case, perilife_base::error::Error> {
    let text = format!(
        "[specimen]\n{specimen}\n[material]\nname = \"al2024-t3\"\n[model]\nspacing_mm = 1\n[fatigue]\na = 1\np = 2\nhorizon_mm = 1\n[loading]\n{loading}"
    );
    Case::from_toml(&text, "test", Path::new(""), &[])
}

#[test]
fn every_way_to_say_the_same_load() {
    // 50 MPa on 100 x 2 mm² = 10 kN; range = maximum (1 - R).
    let ways = "stress_max_mpa 50, stress_range_mpa 40, force_max_n 10000, force_range_n 8000, force_max_kn 10, force_range_kn 8";
    for way in ways.split(", ") {
        let loading = case(PANEL, &format!("{}\nstress_ratio = 0.2", way.replace(' ', " = "))).unwrap().loading;
        assert!((loading.maximum / 50e6 - 1.0).abs() < 1e-12, "{way}: {loading:?}");
    }
}

#[test]
fn range_of_a_reversed_cycle() {
    // R = -1: range 80 is maximum 40; only the opening half counts.
    let loading = case(PANEL, "stress_range_mpa = 80\nstress_ratio = -1").unwrap().loading;
    assert!((loading.maximum - 40e6).abs() < 1e-3);
    assert!((loading.range_share() - 1.0).abs() < 1e-12);
    assert!((Loading { ratio: 0.2, ..loading }.range_share() - 0.8).abs() < 1e-12);
}

#[test]
fn a_floating_plate_is_loaded_on_both_ends_and_a_held_one_on_one() {
    let floating = case(PLATE, "stress_max_mpa = 10\nstress_ratio = 0").unwrap().specimen;
    assert_eq!((floating.loads.len(), floating.supports.len()), (2, 0));
    let support = "[supports]\nbottom = { rows_mm = 3, fix = [\"x\", \"y\"] }";
    let held = case(PLATE, &format!("stress_max_mpa = 10\nstress_ratio = 0\n{support}")).unwrap().specimen;
    assert_eq!(held.loads, [Load::Edge { from: [0.05, 0.1], to: [-0.05, 0.1], traction: [0.0, 1.0] }]);
    assert_eq!(held.supports, [Support::Fixed { from: [-0.05, -0.1], to: [0.05, -0.1], depth: 0.003, x: true, y: true }]);
}

#[test]
fn stress_along_the_crack_loads_the_sides() {
    let sides = case(PANEL, "stress_max_mpa = 10\nstress_ratio = 0\nstress_parallel_ratio = 0.5").unwrap().specimen.loads;
    let tractions: Vec<[f64; 2]> =
        sides.iter().map(|load| if let Load::Edge { traction, .. } = load { *traction } else { [9.0; 2] }).collect();
    assert_eq!(tractions, [[0.0, 1.0], [0.0, -1.0], [-0.5, 0.0], [0.5, 0.0]]);
}

#[test]
fn loads_must_balance() {
    let with_ratio = |text: &str| match text.split_once("\n[") {
        Some((loading, rest)) => format!("{loading}\nstress_ratio = 0\n[{rest}"),
        None => format!("{text}\nstress_ratio = 0"),
    };
    for loading in rows::<Vec<String>>("loading", "good") {
        case(PLATE, &with_ratio(&loading)).unwrap_or_else(|error| panic!("{loading}: {error}"));
    }
    for [loading, words] in rows::<Vec<[String; 2]>>("loading", "unbalanced") {
        assert_refusal(case(PLATE, &with_ratio(&loading)), &["not in equilibrium", &words]);
    }
}

/// Plates and C(T) have the same default; an arc is given, or a pin from which it follows.
#[test]
fn a_pin_touches_over_at_most_half_its_hole() {
    let pins = |half_angle: &str| {
        let pin = |hole, y| format!("{{ hole = {hole}, direction = [0, {y}]{half_angle} }}");
        case(PLATE, &format!("force_max_n = 10\nstress_ratio = 0\npins = [{}, {}]", pin(0, 1), pin(1, -1)))
    };
    let compact = |keys: &str| {
        let specimen = "kind = \"compact_tension\"\nwidth_mm = 50\nthickness_mm = 5\ncrack_length_mm = 20\n";
        case(&format!("{specimen}{keys}"), "force_max_n = 10\nstress_ratio = 0")
    };
    let bearing = |case: Case| {
        if let Load::Pin { contact, .. } = &case.specimen.loads[0] { contact.clone() } else { panic!("no pin") }
    };
    for unknown in [pins(""), compact("")] {
        assert_eq!(bearing(unknown.unwrap()), Bearing::Unknown(LOOSE_PIN));
    }
    // A pin that something else holds against, as in a lug, fits its hole.
    let lug = "kind = \"lug\"\nwidth_mm = 50\nlength_mm = 100\nthickness_mm = 5\nhead = \"round\"\nhole_diameter_mm = 20\ncrack_length_mm = 3\n";
    assert_eq!(bearing(case(lug, "force_max_n = 10\nstress_ratio = 0").unwrap()), Bearing::Unknown(SNUG_PIN));
    for given in [pins(", contact_half_angle_deg = 40"), compact("pin_half_angle_deg = 40")] {
        assert!((bearing(given.unwrap()).half_angle().unwrap() - 40_f64.to_radians()).abs() < 1e-9);
    }
    let hole = 1e3 * compact("").unwrap().specimen.holes[0].radius * 2.0;
    let wrong = [
        (pins(", contact_half_angle_deg = 0"), "loading.pins[0].contact_half_angle_deg", "0"),
        (pins(", contact_half_angle_deg = 120"), "loading.pins[0].contact_half_angle_deg", "120"),
        (pins(", pin_diameter_mm = 1, contact_half_angle_deg = 20"), "loading.pins[0].contact_half_angle_deg", "pin_diameter_mm"),
        (pins(", pin_poisson_ratio = 0.3"), "loading.pins[0].pin_diameter_mm", "clearance"),
        (pins(", pin_diameter_mm = 1, friction = 0.1"), "loading.pins[0].friction = 0.1", "pins are frictionless"),
        (compact("pin_diameter_mm = 12\npin_friction = 0.1"), "specimen.pin_friction = 0.1", "pins are frictionless"),
        (compact(&format!("pin_diameter_mm = {}", 1.01 * hole)), "specimen.pin_diameter_mm", "larger than the hole"),
        (compact("pin_diameter_mm = 12\npin_poisson_ratio = 0.6"), "specimen.pin_poisson_ratio", "0.6"),
    ];
    for (case, key, word) in wrong {
        assert_refusal(case, &[key, word]);
    }
}

#[test]
fn a_roller_presses_uniformly_on_its_contact() {
    let rollers = |first: &str| {
        let text = format!(
            "force_max_n = 10\nstress_ratio = 0\nrollers = [{{ {first} }}, {{ at_mm = [10, -100], contact_width_mm = 5 }}]"
        );
        case(PLATE, &text)
    };
    let loads = rollers("at_mm = [10, 100], contact_width_mm = 8").unwrap().specimen.loads;
    let Load::Edge { from, to, traction } = loads[0] else { panic!("{loads:?}") };
    // 8 mm x 2 mm of contact carry the whole force, into the plate.
    let near = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).abs() < 1e-9 && (a[1] - b[1]).abs() < 1e-9;
    assert!(near(from, [0.014, 0.1]) && near(to, [0.006, 0.1]), "{loads:?}");
    assert!((traction[1] * 16e-6 + 1.0).abs() < 1e-9 && traction[0].abs() < 1e-9, "{loads:?}");
    for (wrong, key) in [
        ("at_mm = [10, 90], contact_width_mm = 8", "loading.rollers[0].at_mm"),
        ("at_mm = [49, 100], contact_width_mm = 8", "loading.rollers[0].contact_width_mm"),
        ("at_mm = [10, 100], contact_width_mm = 0", "loading.rollers[0].contact_width_mm"),
        ("at_mm = [10, 100], contact_width_mm = 8, direction = [0, 1]", "loading.rollers[0].direction"),
        ("at_mm = [10, 100], contact_width_mm = 8, direction = [0, 0]", "loading.rollers[0].direction"),
    ] {
        assert_refusal(rollers(wrong), &[key]);
    }
    assert_refusal(case(PLATE, "force_max_n = 10\nstress_ratio = 0\nrollers = []"), &["loading.rollers", "applies no load"]);
}

/// Every wrong way to give a direction, a pressure on cracks or a displacement names what is wrong.
#[test]
fn directions_pressures_and_displacements_that_are_refused() {
    let two = "kind = \"plate\"\nwidth_mm = 100\nlength_mm = 200\nthickness_mm = 2\n\
               cracks = [{ from_mm = [-50, 0], to_mm = [-40, 0] }, { from_mm = [50, 0], to_mm = [40, 0] }]";
    for [specimen, loading, words] in rows::<Vec<[String; 3]>>("loading", "refused") {
        let specimen = match &*specimen {
            "two cracks" => two,
            "panel" => PANEL,
            _ => PLATE,
        };
        let error = case(specimen, &loading).map(|_| ()).expect_err(&loading).to_string();
        assert!(error.contains(&words), "{loading}: {error}");
    }
}

/// Loads that only growth by K of the tips knows are refused elsewhere.
#[test]
fn loads_of_one_driver() {
    let loads = [
        ("kind = \"displacement\"\ndisplacement_max_mm = 0.1", "cycles of 0.1 mm are known to"),
        ("crack_pressure_mpa = 5", "pressure on cracks is known to"),
    ];
    for (loading, words) in loads {
        let text = format!(
            "[specimen]\n{PLATE}\n[material]\nname = \"al2024-t3\"\n[fatigue]\na = 1\np = 2\nhorizon_mm = 3\n[loading]\nstress_ratio = 0\n{loading}"
        );
        let read = |set: &[&str]| {
            Case::from_toml(&text, "test", Path::new(""), &set.iter().map(|s| (*s).to_owned()).collect::<Vec<_>>())
        };
        read(&[]).unwrap();
        assert_refusal(read(&["fatigue.driver=\"bond_strain\""]), &[words]);
        if loading.contains("displacement") {
            let plain = ["fatigue.driver=\"tip_field\"", "model.surface_correction=\"none\""];
            assert_refusal(read(&plain), &["does not know where an edge is"]);
            read(&[&plain[..], &["loading.grip=\"mean\""]].concat()).unwrap();
        }
    }
}
