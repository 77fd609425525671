//! What is said of a plate that its first load breaks, that lives on where its curve ends, or whose formula does not hold.

use std::fs;

use serde_json::Value;
use tempfile::tempdir;

use crate::interface::cli::{perilife, texts};

const PANEL: &str =
    "[specimen]\nkind = \"middle_tension\"\nwidth_mm = 100\nlength_mm = 300\nthickness_mm = 2\ncrack_length_mm = 20\n";
const COMPACT: &str = "[specimen]\nkind = \"compact_tension\"\nwidth_mm = 50\nthickness_mm = 12.5\ncrack_length_mm = 4\n";
const SHEET: &str = "[specimen]\nkind = \"plate\"\nwidth_mm = 40\nlength_mm = 60\nthickness_mm = 2\n\
                     cracks = [{ from_mm = [-20, 0], to_mm = [-12, 0] }]\n";
const HOLE: &str = "[specimen]\nkind = \"plate\"\nwidth_mm = 40\nlength_mm = 60\nthickness_mm = 2\n\
                    cracks = [{ from_mm = [-20, 0], to_mm = [-12, 0] }]\nholes = [{ x_mm = 0, y_mm = 0, diameter_mm = 10 }]\n";

struct Ending {
    specimen: &'static str,
    loading: &'static str,
    method: &'static str,
    exit: i32,
    stop: &'static str,
    is_lower_bound: bool,
    words: &'static str,
}

/// Runs a case; its exit code, `result.json`, and what it says.
fn run(ending: &Ending) -> (Option<i32>, Value, String) {
    let dir = tempdir().unwrap();
    let Ending { specimen, loading, method, .. } = ending;
    let text = format!(
        "{specimen}[material]\nyoungs_modulus_gpa = 71\npoisson_ratio = 0.33\nplane = \"stress\"\nyield_strength_mpa = 345\n\
         toughness_mpa_sqrt_m = 30\n[loading]\nstress_ratio = 0.1\n{loading}\n[model]\n{method}\n\
         [fatigue]\nparis_c_mm_per_cycle = 1e-8\nparis_m = 3\n"
    );
    fs::write(dir.path().join("case.toml"), text).unwrap();
    let output = perilife(dir.path(), &["predict", "case.toml", "--out", "run"]);
    let (stdout, stderr) = texts(&output);
    let result = fs::read_to_string(dir.path().join("run/result.json")).unwrap_or_else(|_| panic!("{stderr}"));
    (output.status.code(), serde_json::from_str(&result).unwrap(), stdout + &stderr)
}

#[test]
fn how_lives_end() {
    let (handbook, points) = ("method = \"handbook\"", "spacing_mm = 1");
    let endings = [
        // K_max of the secant formula: 120 √(π 0.02 / cos(0.2 π)) = 33.44 MPa√m; 30 / 33.44 of 120 MPa is 107.65.
        Ending {
            specimen: PANEL,
            loading: "stress_max_mpa = 120",
            method: handbook,
            exit: 3,
            stop: "toughness",
            is_lower_bound: false,
            words: "it would bear 107.6",
        },
        Ending {
            specimen: PANEL,
            loading: "stress_max_mpa = 120",
            method: "spacing_mm = 2",
            exit: 3,
            stop: "toughness",
            is_lower_bound: false,
            words: "it would bear 107.",
        },
        Ending {
            specimen: SHEET,
            loading: "stress_max_mpa = 900",
            method: points,
            exit: 3,
            stop: "toughness",
            is_lower_bound: false,
            words: "beyond the limit load of what the cracks leave, 215.49 MPa",
        },
        Ending {
            specimen: HOLE,
            loading: "stress_max_mpa = 5",
            method: points,
            exit: 0,
            stop: "entered_hole",
            is_lower_bound: true,
            words: "cycles to the hole",
        },
        Ending {
            specimen: COMPACT,
            loading: "force_max_kn = 6",
            method: handbook,
            exit: 0,
            stop: "toughness",
            is_lower_bound: false,
            words: "% of the life lies outside the range of ASTM E647",
        },
    ];
    for ending in endings {
        let (code, result, said) = run(&ending);
        let name = format!("{} {} {}: {said}", ending.specimen, ending.loading, ending.method);
        assert_eq!(code, Some(ending.exit), "{name}");
        assert_eq!(result["stop_reason"], ending.stop, "{name}");
        assert_eq!(result["life_is_lower_bound"], ending.is_lower_bound, "{name}");
        assert!(said.contains(ending.words), "{name}");
        if ending.exit == 3 {
            assert_eq!(result["life_cycles"], 0.0, "{name}");
        }
    }
}

/// `check` says it before any run.
#[test]
fn check_says_that_the_first_load_breaks_the_plate() {
    let dir = tempdir().unwrap();
    let text = format!(
        "{PANEL}[material]\nyoungs_modulus_gpa = 71\npoisson_ratio = 0.33\nplane = \"stress\"\ntoughness_mpa_sqrt_m = 30\n\
         [loading]\nstress_ratio = 0.1\nstress_max_mpa = 120\n[fatigue]\nparis_c_mm_per_cycle = 1e-8\nparis_m = 3\n"
    );
    fs::write(dir.path().join("case.toml"), text).unwrap();
    let (stdout, stderr) = texts(&perilife(dir.path(), &["check", "case.toml"]));
    assert!((stdout + &stderr).contains("K_max 33.44 MPa√m is beyond the toughness 30.00 MPa√m"));
}
