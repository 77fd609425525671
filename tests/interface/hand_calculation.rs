//! `model.method = "handbook"` as a user calls it, and the residual-strength curve of either method.

use std::fs;

use perilife_results::curve::read_a_n;
use serde_json::Value;
use tempfile::tempdir;

use crate::interface::cli::{SMALL_CASE, assert_refused, perilife, texts};
use crate::support::desk::{desk, done};

const PANEL: &str = r#"
[specimen]
kind = "middle_tension"
width_mm = 152.4
length_mm = 300.0
thickness_mm = 2.54
crack_length_mm = 9.0
[material]
name = "al2024-t3"
[loading]
stress_range_mpa = 48.28
stress_ratio = 0.2
[model]
method = "handbook"
[fatigue]
paris_c_mm_per_cycle = 8.95422e-8
paris_m = 2.874
"#;

#[test]
fn a_hand_calculation_leaves_the_files_of_a_run() {
    let dir = desk(&[("panel.toml", &PANEL)]);
    let arguments = ["predict", "panel.toml", "--out", "run", "--residual-strength", "--json", "-v"];
    let (stdout, stderr) = done(dir.path(), &arguments);
    // Yield strength of the material file: 345 MPa.
    let result: Value = serde_json::from_str(&stdout).unwrap();
    let passed = |check: &Value| check["name"] == "small_scale_yielding" && check["verdict"] == "passed";
    assert!(result["checks"].as_array().unwrap().iter().any(passed) && result["verdict_kind"] == "reservations", "{result}");
    // What concerns half a percent of the life is no message.
    assert!(stderr.contains("Fracture: not checked (no toughness given)") && !stderr.contains("LEFM"), "{stderr}");
    assert_eq!((&result["stop_reason"], &result["model"]["method"]), (&"net_section_yield".into(), &"handbook".into()));
    assert!((result["life_cycles"].as_f64().unwrap() / 254_287.0 - 1.0).abs() < 1e-3);
    assert_eq!((&result["points"], &result["solves"]), (&0.into(), &0.into()));
    assert!(result["model"]["formula"].as_str().unwrap().contains("secant"));
    let run = dir.path().join("run");
    let rows = read_a_n(&run.join("a_n.csv")).unwrap();
    assert_eq!(rows.len() as u64, 1 + result["blocks"].as_u64().unwrap());
    assert!((rows[0].crack_length_mm, rows[0].cycles) == (9.0, 0.0) && rows.iter().all(|row| row.da_dn_mm_per_cycle > 0.0));
    for file in ["crack_path.csv", "a_n.svg", "da_dn.svg", "residual_strength.svg"] {
        assert!(fs::metadata(run.join(file)).unwrap().len() > 0, "{file}");
    }
    assert!(!run.join("paraview").exists() && !run.join("damage.svg").exists(), "there are no points to draw");

    // The residual strength: no toughness is given, so the net section governs; it starts at 345 (1 - 18/152.4) MPa.
    let table = fs::read_to_string(run.join("residual_strength.csv")).unwrap();
    let mut lines = table.lines();
    assert_eq!(lines.next(), Some("crack_length_mm,residual_strength_mpa,by_toughness_mpa,by_net_section_mpa,governed_by"));
    let first: Vec<&str> = lines.next().unwrap().split(',').collect();
    assert!((first[1].parse::<f64>().unwrap() - 345.0 * (1.0 - 18.0 / 152.4)).abs() < 1e-6, "{first:?}");
    assert_eq!((first[2], first[4]), ("", "net_section_yield"));

    // Export and check know it as well.
    done(dir.path(), &["export", "run", "--points", "50", "--out", "e.csv"]);
    let (stdout, _) = texts(&perilife(dir.path(), &["check", "panel.toml", "-v"]));
    assert!(stdout.contains("Handbook K") && stdout.contains("8.95422e-8") && !stdout.contains("ageing"), "{stdout}");
    let (stdout, _) = texts(&perilife(dir.path(), &["predict", "panel.toml", "--out", "run"]));
    assert!(stdout.contains("  Method         handbook K (Feddersen secant), "), "{stdout}");
    assert!(!run.join("residual_strength.csv").exists(), "only on request");
}

#[test]
fn a_plate_is_refused_with_the_remedy() {
    let dir = tempdir().unwrap();
    let plate = PANEL
        .replace("middle_tension", "plate")
        .replace("crack_length_mm = 9.0", "cracks = [{ from_mm = [-9, 0], to_mm = [9, 0] }]");
    fs::write(dir.path().join("plate.toml"), plate).unwrap();
    for command in [&["predict", "plate.toml", "--out", "run"][..], &["check", "plate.toml"]] {
        let words = ["plate.toml:14", "model.method = \"handbook\"", "(plate)", "method = \"peridynamics\""];
        assert_refused(&perilife(dir.path(), command), 2, &words);
    }
    assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 1);
}

#[test]
fn the_engine_writes_plastic_zone_and_residual_strength_too() {
    let dir = desk(&[("small.toml", &SMALL_CASE)]);
    // Refused before anything is computed: no strength is given.
    let call = ["predict", "small.toml", "--out", "run", "--residual-strength", "--json"];
    let output = perilife(dir.path(), &call);
    let (stdout, stderr) = texts(&output);
    let error = &serde_json::from_str::<Value>(&stdout).unwrap()["error"];
    assert_eq!((output.status.code(), &error["code"], &error["key"]), (Some(2), &2.into(), &"--residual-strength".into()));
    assert!(stderr.contains("error: --residual-strength: needs") && stderr.contains("toughness_mpa_sqrt_m"), "{stderr}");
    assert!(!dir.path().join("run").exists());
    let call = [
        &call[..],
        &[
            "--set",
            "fatigue.driver=bond_strain",
            "--set",
            "material.yield_strength_mpa=300",
            "--set",
            "material.toughness_mpa_sqrt_m=30",
            "-v",
        ],
    ]
    .concat();
    let (stdout, stderr) = done(dir.path(), &call);
    let result: Value = serde_json::from_str(&stdout).unwrap();
    let zone = &result["plastic_zone"]["last"];
    let [size, over_horizon] = ["size_mm", "over_horizon"].map(|key| zone[key].as_f64().unwrap());
    // The horizon of this case: 3.015 times 2 mm.
    assert!(size > 0.0 && (size / over_horizon / 6.03 - 1.0).abs() < 1e-6, "{zone}");
    assert!(dir.path().join("run/residual_strength.csv").is_file());
    // The crack is two horizons long: nobody is to take what that does to its first growth for physics.
    assert!(stderr.contains("the initial crack is only 2.0 horizons long"), "{stderr}");
}

/// What the program chooses, how wrong the life may be, and what the other engine says of it.
#[test]
fn a_life_comes_with_its_error_and_a_second_opinion() {
    let dir = desk(&[("panel.toml", &PANEL.replace("method = \"handbook\"", ""))]);
    let (stdout, _) = done(dir.path(), &["predict", "panel.toml", "--out", "run", "--cross-check"]);
    for words in
        ["handbook K (Feddersen secant)", "numerical error ≤ 0.9 % of life (estimate)", "Cross-check    element_free_galerkin"]
    {
        assert!(stdout.contains(words), "{words}: {stdout}");
    }
    let read = || -> Value { serde_json::from_slice(&fs::read(dir.path().join("run/result.json")).unwrap()).unwrap() };
    let result = read();
    assert!((0.5..1.5).contains(&result["error_estimate_percent"].as_f64().unwrap()), "{result}");
    assert!(result["cross_check"]["difference_percent"].as_f64().unwrap().abs() < 0.5, "{result}");
    assert!(result["model"]["why"]["method"].as_str().unwrap().contains("Feddersen"));
    // Nothing is said that was not asked for.
    let output = perilife(dir.path(), &["predict", "panel.toml", "--out", "run", "--no-estimate"]);
    assert!(!texts(&output).0.contains("Accuracy"), "{:?}", texts(&output));
    assert!(read()["error_estimate_percent"].is_null() && read().get("cross_check").is_none());
}
