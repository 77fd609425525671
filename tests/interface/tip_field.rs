//! `fatigue.driver = "tip_field"` as a user calls it: chosen by C and m, its files, its refusals.

use std::fs;

use serde_json::Value;

use crate::interface::cli::{SMALL_CASE, assert_refused, perilife, texts};
use crate::support::desk::{desk, done};

const PLATE: &str = r#"
[specimen]
kind = "plate"
width_mm = 40.0
length_mm = 60.0
thickness_mm = 2.0
holes = [{ x_mm = 6.0, y_mm = 7.0, diameter_mm = 8.0 }]
cracks = [{ from_mm = [-20.0, 0.0], to_mm = [-8.0, 0.0] }]
[material]
youngs_modulus_gpa = 73.1
poisson_ratio = 0.33
[loading]
stress_max_mpa = 40.0
stress_ratio = 0.2
[model]
spacing_mm = 1.0
[fatigue]
paris_c_mm_per_cycle = 8.95422e-8
paris_m = 2.874
"#;

#[test]
fn constants_of_k_choose_the_driver_of_tips() {
    let dir = desk(&[("plate.toml", &PLATE)]);
    let (stdout, _) = done(dir.path(), &["predict", "plate.toml", "--out", "run", "--json"]);
    let result: Value = serde_json::from_str(&stdout).unwrap();
    assert_eq!(result["model"]["driver"], "tip_field");
    assert_eq!(result["model"]["surface_correction"], "balanced");
    assert_eq!(result["model"]["solver"], "multigrid", "bonds do not break one by one: no window is condensed");
    assert!(result["life_cycles"].as_f64().unwrap() > 1e3, "{stdout}");
    let table = fs::read_to_string(dir.path().join("run/a_n.csv")).unwrap();
    let mut lines = table.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let column = |name: &str| header.iter().position(|column| *column == name).unwrap();
    let first: Vec<f64> = lines.next().unwrap().split(',').map(|field| field.parse().unwrap_or(f64::NAN)).collect();
    let k_i = first[column("tip0_k_i_mpa_sqrt_m")];
    // dK = (1 - R) K_eq, and K_II of an edge crack with a hole far beside it is small.
    assert!((first[column("delta_k_mpa_sqrt_m")] / (0.8 * k_i) - 1.0).abs() < 0.01, "{first:?}");
    assert!(first[column("tip0_k_ii_mpa_sqrt_m")].abs() < 0.1 * k_i, "{first:?}");
    // da/dN is C dK^m of the same row.
    let rate = 8.95422e-8 * first[column("delta_k_mpa_sqrt_m")].powf(2.874);
    assert!((first[column("da_dn_mm_per_cycle")] / rate - 1.0).abs() < 1e-6, "{first:?}");
    assert!(dir.path().join("run/plate.svg").exists() && dir.path().join("run/crack_path.csv").exists());

    // The same again, as a driver that is asked for.
    let again = perilife(dir.path(), &["predict", "plate.toml", "--out", "again", "--json", "--set", "fatigue.driver=tip_field"]);
    let again: Value = serde_json::from_str(&texts(&again).0).unwrap();
    assert_eq!(again["life_cycles"], result["life_cycles"]);
}

#[test]
fn what_does_not_go_with_the_driver_is_refused() {
    let dir = desk(&[("plate.toml", &PLATE)]);
    let slot = PLATE.replace(
        "cracks = [{ from_mm = [-20.0, 0.0], to_mm = [-8.0, 0.0] }]",
        "notches = [{ from_mm = [-20.0, 0.0], to_mm = [-8.0, 0.0], width_mm = 2.0 }]",
    );
    fs::write(dir.path().join("slot.toml"), slot).unwrap();
    let bonds = PLATE.replace("paris_c_mm_per_cycle = 8.95422e-8\nparis_m = 2.874", "a = 6450.0\np = 2.87\nhorizon_mm = 3.015");
    fs::write(dir.path().join("bonds.toml"), bonds).unwrap();
    let refused = |arguments: &[&str], words: &[&str]| {
        let all = [arguments, &["--out", "run"]].concat();
        assert_refused(&perilife(dir.path(), &all), 2, words);
        assert!(!dir.path().join("run").exists(), "{arguments:?}");
    };
    refused(
        &["predict", "plate.toml", "--set", "fatigue.driver=tip_field", "--set", "fatigue.ageing=crack_tip"],
        &["fatigue.ageing", "applies only to fatigue bonds", "bond_strain"],
    );
    refused(&["predict", "plate.toml", "--set", "fatigue.driver=tips"], &["fatigue.driver", "tip_field, bond_strain"]);
    refused(&["predict", "slot.toml", "--set", "fatigue.driver=tip_field"], &["fatigue.driver", "sharp cracks", "bond_strain"]);
    refused(
        &["predict", "bonds.toml", "--set", "fatigue.driver=tip_field", "--set", "fatigue.p=9"],
        &["fatigue.p = 9", "1 to 8", "paris_c_mm_per_cycle"],
    );
}

/// A crack below its threshold is not told to be dead after 0 cycles: its life has no end, whatever computes it.
#[test]
fn a_crack_that_stands_still_has_no_life_that_ends() {
    let dir = desk(&[("small.toml", &SMALL_CASE)]);
    for set in ["fatigue.driver=tip_field", "fatigue.driver=bond_strain", "model.method=handbook"] {
        let threshold = "fatigue.delta_k_threshold_mpa_sqrt_m=90";
        let call = ["predict", "small.toml", "--out", "run", "--set", set, "--set", threshold];
        let (stdout, _) = done(dir.path(), &[&call[..], &["--json"]].concat());
        let result: Value = serde_json::from_str(&stdout).unwrap();
        assert_eq!(result["stop_reason"], "nothing_ages", "{set}");
        assert!(result["life_cycles"].is_null() && result.get("life_cycles").is_some(), "{set}: {stdout}");
        let (stdout, _) = texts(&perilife(dir.path(), &call));
        assert!(
            stdout.contains("small: unlimited life (") && stdout.contains("no crack grows under these loads"),
            "{set}: {stdout}"
        );
    }
}
