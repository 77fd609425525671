//! What is said of a plate that its first load breaks, that lives on where its curve ends, or whose formula does not hold.

use std::fs;

use serde_json::Value;

use crate::interface::cli::{perilife, texts};
use crate::support::desk::desk;

const PANEL: &str =
    "[specimen]\nkind = \"middle_tension\"\nwidth_mm = 100\nlength_mm = 300\nthickness_mm = 2\ncrack_length_mm = 20\n";
const COMPACT: &str = "[specimen]\nkind = \"compact_tension\"\nwidth_mm = 50\nthickness_mm = 12.5\ncrack_length_mm = 4\n";
const SHEET: &str = "[specimen]\nkind = \"plate\"\nwidth_mm = 40\nlength_mm = 60\nthickness_mm = 2\n\
                     cracks = [{ from_mm = [-20, 0], to_mm = [-12, 0] }]\n";
const HOLE: &str = "[specimen]\nkind = \"plate\"\nwidth_mm = 40\nlength_mm = 60\nthickness_mm = 2\n\
                    cracks = [{ from_mm = [-20, 0], to_mm = [-12, 0] }]\nholes = [{ x_mm = 0, y_mm = 0, diameter_mm = 10 }]\n";

#[test]
fn how_lives_end() {
    let (handbook, points, tough) = ("method = \"handbook\"", "spacing_mm = 1", "toughness_mpa_sqrt_m = 30\n");
    // Specimen, load, model, exit code, why it stops, whether the life is a lower bound, what is said.
    let endings = [
        // K_max of the secant formula: 120 √(π 0.02 / cos(0.2 π)) = 33.44 MPa√m; 30 / 33.44 of 120 MPa is 107.65.
        (PANEL, "stress_max_mpa = 120", handbook, 3, "toughness", false, "the limit at this crack length is 107.6"),
        (PANEL, "stress_max_mpa = 120", "spacing_mm = 2", 3, "toughness", false, "the limit at this crack length is 107."),
        (SHEET, "stress_max_mpa = 900", points, 3, "toughness", false, "collapse load of the net section, 215.49 MPa"),
        (HOLE, "stress_max_mpa = 5", points, 0, "entered_hole", true, "cycles until the crack enters the hole"),
        (COMPACT, "force_max_kn = 6", handbook, 0, "toughness", false, "% of life outside the range of ASTM E647"),
    ];
    for (specimen, load, model, exit, stop, is_lower_bound, words) in endings {
        let text = format!("{specimen}{MATERIAL}{tough}[loading]\nstress_ratio = 0.1\n{load}\n[model]\n{model}\n{LAW}");
        let (code, result, said) = predicted(&text, &[]);
        let name = format!("{specimen} {load} {model}: {said}");
        assert_eq!(code, Some(exit), "{name}");
        assert_eq!((&result["stop_reason"], &result["life_is_lower_bound"]), (&stop.into(), &is_lower_bound.into()), "{name}");
        assert!(said.contains(words) && (exit == 0 || result["life_cycles"] == 0.0), "{name}");
        if model == handbook && exit == 3 {
            let dir = desk(&[("case.toml", &text)]);
            let (stdout, stderr) = texts(&perilife(dir.path(), "check case.toml"));
            assert!((stdout + &stderr).contains("K_max 33.44 MPa√m exceeds the toughness 30.00 MPa√m"));
        }
    }
}

const MATERIAL: &str =
    "[material]\nyoungs_modulus_gpa = 71\npoisson_ratio = 0.33\nplane = \"stress\"\nyield_strength_mpa = 345\n";
const LAW: &str = "[fatigue]\nparis_c_mm_per_cycle = 1e-8\nparis_m = 3\n";

/// Exit code, `result.json` and what is said of a case with these lines.
fn predicted(text: &str, more: &[&str]) -> (Option<i32>, Value, String) {
    let dir = desk(&[("case.toml", &text)]);
    let output = perilife(dir.path(), &[&["predict", "case.toml", "--out", "run", "-v"], more].concat());
    let (stdout, stderr) = texts(&output);
    // A run that is refused before anything is written has none.
    let result =
        fs::read_to_string(dir.path().join("run/result.json")).map_or(Value::Null, |text| serde_json::from_str(&text).unwrap());
    (output.status.code(), result, stdout + &stderr)
}

/// The same edge crack as a standard specimen and drawn, with a hole and without: the ligament of any plate has a limit load.
#[test]
fn the_section_of_a_drawn_plate_ends_its_life() {
    let specimens = [
        (
            "kind = \"single_edge_tension\"\nends = \"uniform_stress\"\nwidth_mm = 40\nlength_mm = 60\nthickness_mm = 2\ncrack_length_mm = 8\n",
            "215.49",
        ),
        (SHEET.strip_prefix("[specimen]\n").unwrap(), "215.49"),
        // The hole takes 10 of 32 mm.
        (HOLE.strip_prefix("[specimen]\n").unwrap(), "1"),
    ];
    for (specimen, limit) in specimens {
        let text = |stress: f64| {
            format!(
                "[specimen]\n{specimen}{MATERIAL}[loading]\nstress_ratio = 0.1\nstress_max_mpa = {stress}\n[model]\nspacing_mm = 1\n{LAW}"
            )
        };
        let (code, result, said) = predicted(&text(240.0), &[]);
        let found = (code, &result["stop_reason"], &result["life_cycles"]);
        assert_eq!(found, (Some(3), &"net_section_yield".into(), &0.0.into()), "{said}");
        assert!(said.contains(&format!("plastic collapse load of the net section, {limit}")), "{said}");
        assert!(said.contains("no life: the plate fails in the first cycle") && result["verdict_kind"] == "not_valid", "{said}");
        let (code, result, said) = predicted(&text(100.0), &[]);
        assert_eq!((code, &result["stop_reason"]), (Some(0), &"net_section_yield".into()), "{said}");
        assert_eq!(result["critical"]["criterion"], "net_section_yield", "{said}");
        let off = predicted(&text(100.0), &["--set", "stop.net_section=false"]).1;
        assert!(off["life_cycles"].as_f64() > result["life_cycles"].as_f64(), "{off}");
    }
}

#[test]
fn a_hole_is_a_bound_only_where_the_plate_was_shown_to_bear_its_load() {
    for (strengths, is_bound) in [("", false), ("toughness_mpa_sqrt_m = 60\n", true)] {
        let text = format!(
            "{HOLE}{MATERIAL}{strengths}[loading]\nstress_ratio = 0.1\nstress_max_mpa = 5\n[model]\nspacing_mm = 1\n{LAW}"
        );
        let (code, result, said) = predicted(&text, &[]);
        assert_eq!((code, &result["stop_reason"]), (Some(0), &"entered_hole".into()), "{said}");
        let found = (result["life_is_lower_bound"] == true, said.contains("Fracture: not checked"));
        assert_eq!(found, (is_bound, !is_bound), "{said}");
    }
}

/// One crack has the length that its specimen gives it, from the load line of WOL, and not that from its mouth in the front face.
#[test]
fn one_crack_is_as_long_as_its_specimen_says() {
    let text = format!(
        "[specimen]\nkind = \"wedge_opening\"\nwidth_mm = 50\nthickness_mm = 10\ncrack_length_mm = 20\n{MATERIAL}[loading]\n\
         stress_ratio = 0.1\nforce_max_n = 2000\n{LAW}[stop]\ncrack_length_mm = 21\n"
    );
    let (code, _, said) = predicted(&text, &[]);
    assert_eq!(code, Some(0), "{said}");
    assert!(said.contains("Crack length   20.0 → 21.0 mm"), "{said}");
}

/// In a plate with several cracks the length of the crack of a tip is asked for, not that of all.
#[test]
fn inspections_are_of_the_crack_of_a_tip() {
    let two = "[specimen]\nkind = \"plate\"\nwidth_mm = 80\nlength_mm = 120\nthickness_mm = 2\n\
               cracks = [{ from_mm = [-40, 25], to_mm = [-32, 25] }, { from_mm = [40, -25], to_mm = [35, -25] }]\n";
    let text = format!("{two}{MATERIAL}[loading]\nstress_ratio = 0.1\nstress_max_mpa = 60\n[model]\nspacing_mm = 1.25\n{LAW}");
    let inspect = |more: &[&str]| predicted(&text, &[&["--inspect-from", "9"], more].concat());
    let (code, result, said) = inspect(&[]);
    assert_eq!(code, Some(0), "{said}");
    let leading = &result["inspection"];
    assert_eq!((&leading["tip"], &leading["crack_length_mm"]), (&0.into(), &9.0.into()), "{leading}");
    assert!((leading["crack_length_governing_mm"].as_f64().unwrap() - 9.0).abs() < 1e-9, "{leading}");
    assert!(said.contains(" mm (tip 0 governs)\n") && said.contains("All cracks     13.0 → "), "{said}");
    // The shorter crack has not come so far when the longer one breaks the plate.
    let (code, result, said) = inspect(&["--tip", "1"]);
    assert!(code == Some(2) && result.is_null() && said.contains("--inspect-from"), "{said}");
    assert!(said.contains("the crack of tip 1 has 5.0000 to "), "{said}");
    let (code, _, said) = inspect(&["--tip", "7"]);
    assert!(code == Some(2) && said.contains("is not a crack tip of this plate"), "{said}");
}
