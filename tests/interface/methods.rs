//! Cases by method and driver as a user calls them: their files, their refusals.

use std::fs;
use std::process::Output;

use perilife_results::curve::read_a_n;
use serde_json::Value;
use tempfile::tempdir;

use crate::interface::cli::{SMALL_CASE, assert_refused, perilife, texts};
use crate::support::daily::PANEL;
use crate::support::desk::{desk, done, json};
use crate::support::rows::assert_says;

// `fatigue.driver = "tip_field"` as a user calls it: chosen by C and m, its files, its refusals.

const PLATE: &str = include_str!("../reference/cases/tip_field.toml");

#[test]
fn constants_of_k_choose_the_driver_of_tips() {
    let dir = desk(&[("plate.toml", &PLATE)]);
    let (stdout, _) = done(dir.path(), "predict plate.toml --out run --json");
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
    let again = perilife(dir.path(), "predict plate.toml --out again --json --set fatigue.driver=tip_field");
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
    let refused = |arguments: &str, words: &[&str]| {
        let all: Vec<&str> = "predict --out run".split(' ').chain(arguments.split(' ')).collect();
        assert_refused(&perilife(dir.path(), &all), 2, words);
        assert!(!dir.path().join("run").exists(), "{arguments}");
    };
    let ageing = "plate.toml --set fatigue.driver=tip_field --set fatigue.ageing=crack_tip";
    refused(ageing, &["fatigue.ageing", "applies only to fatigue bonds", "bond_strain"]);
    refused("plate.toml --set fatigue.driver=tips", &["fatigue.driver", "tip_field, bond_strain"]);
    refused("slot.toml --set fatigue.driver=tip_field", &["fatigue.driver", "sharp cracks", "bond_strain"]);
    let steep = "bonds.toml --set fatigue.driver=tip_field --set fatigue.p=9";
    refused(steep, &["fatigue.p = 9", "1 to 8", "paris_c_mm_per_cycle"]);
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
        assert_says(&stdout, &["small: unlimited life (", "no crack grows under these loads"]);
    }
}

// The element-free Galerkin method as users meet it: files of a run, keys that do not go together, `sif`, `check`.

const CASE: &str = "[specimen]\nkind = \"plate\"\nwidth_mm = 60\nlength_mm = 100\nthickness_mm = 2\n\
                    cracks = [{ from_mm = [-7, -5], to_mm = [7, 5] }]\n\
                    [material]\nyoungs_modulus_gpa = 71\npoisson_ratio = 0.33\nplane = \"stress\"\n\
                    [loading]\nstress_max_mpa = 60\nstress_ratio = 0.1\n\
                    [model]\nmethod = \"element_free_galerkin\"\n\
                    [fatigue]\nparis_c_mm_per_cycle = 1e-8\nparis_m = 3\n[stop]\ncrack_length_mm = 30\n";

#[test]
fn a_run_on_nodes_has_its_files() {
    let dir = desk(&[("case.toml", &CASE.replace("crack_length_mm = 30", "crack_length_mm = 20"))]);
    let (stdout, _) = done(dir.path(), "predict case.toml --out run --paraview");
    assert!(stdout.contains("  Method         element_free_galerkin, "), "{stdout}");
    for file in ["a_n.csv", "crack_path.csv", "a_n.svg", "nodes.svg", "stress.svg", "paraview/run.pvd"] {
        assert!(dir.path().join("run").join(file).is_file(), "{file}");
    }
    let result = json(dir.path().join("run/result.json"));
    assert_eq!(result["model"]["method"], "element_free_galerkin", "{result}");
    assert_eq!(result["stop_reason"], "crack_length_reached");
    let checked = perilife(dir.path(), "check case.toml -v");
    let (stdout, stderr) = texts(&checked);
    assert!(stdout.contains("unknowns") && stderr.is_empty(), "{stdout}{stderr}");
    let sif = perilife(dir.path(), "sif case.toml --method element_free_galerkin");
    assert!(texts(&sif).0.contains(" nodes "), "{:?}", texts(&sif));
}

#[test]
fn keys_that_do_not_go_together_are_refused_by_name() {
    let dir = desk(&[("case.toml", &CASE)]);
    let own = "model.bond_law=two_parameter model.horizon_ratio=4 model.solver=direct model.symmetry=off model.kernel=conical \
               model.surface_correction=none model.node_layout=rings fatigue.driver=bond_strain fatigue.ageing=everywhere \
               model.influence_radius=1.2 model.influence_radius=7 model.nodes=10 model.spacing_mm=40 model.tolerance_percent=0.01 \
               model.enrichment=strong model.basis=cubic";
    let of_nodes = "model.nodes=500 model.enrichment=tip model.influence_radius=2.5";
    for (keys, method, is_own) in [(own, "element_free_galerkin", true), (of_nodes, "peridynamics", false)] {
        for key in keys.split_whitespace() {
            let method = format!("model.method={method}");
            let output = perilife(dir.path(), &format!("predict case.toml --set {method} --set {key} --out run"));
            let words = if is_own { key.split('=').next().unwrap() } else { "element_free_galerkin" };
            assert_refused(&output, 2, &[words.trim_start_matches("model.")]);
            assert!(!dir.path().join("run").exists(), "{key}");
        }
    }
}

#[test]
fn cracks_that_nodes_do_not_know_are_refused_with_what_does() {
    let cracks = "cracks = [{ from_mm = [-7, -5], to_mm = [7, 5] }]";
    let (predict, check) = (&["predict", "case.toml", "--out", "run"][..], &["check", "case.toml"][..]);
    for (instead, call, words) in [
        ("cracks = [{ from_mm = [70, 5], to_mm = [80, 5] }]", predict, ["(70, 5) mm", "inside the plate"]),
        ("notches = [{ from_mm = [-30, 0], to_mm = [-20, 0], width_mm = 2 }]", predict, ["end of a slot", "\"peridynamics\""]),
        ("holes = [{ x_mm = 0, y_mm = 0, diameter_mm = 9 }]", predict, ["specimen.cracks", "perilife sif"]),
        ("holes = [{ x_mm = 0, y_mm = 0, diameter_mm = 9 }]", check, ["specimen.cracks", "perilife sif"]),
    ] {
        let dir = desk(&[("case.toml", &CASE.replace(cracks, instead))]);
        assert_refused(&perilife(dir.path(), call), 2, &words);
    }
}

/// `sif` of two cracks side by side with this gap, far closer than the spacing of the plate.
fn side_by_side(gap: &str) -> Output {
    let dir = tempdir().unwrap();
    let pair = format!("{{ from_mm = [-7, 0], to_mm = [7, 0] }}, {{ from_mm = [-7, {gap}], to_mm = [7, {gap}] }}");
    let text = CASE.replace("{ from_mm = [-7, -5], to_mm = [7, 5] }", &pair);
    fs::write(dir.path().join("case.toml"), text).unwrap();
    perilife(dir.path(), "sif case.toml --method element_free_galerkin --json")
}

/// Nodes follow the gap.
#[test]
fn cracks_side_by_side_are_resolved() {
    let resolved = side_by_side("0.1");
    let (stdout, stderr) = texts(&resolved);
    assert_eq!(resolved.status.code(), Some(0), "{stderr}");
    let found: Value = serde_json::from_str(&stdout).unwrap();
    let k = |tip: usize, mode: &str| found["tips"][tip]["methods"]["element_free_galerkin"][mode].as_f64().unwrap();
    // The mirror image about the middle of the gap, and together the energy of one crack: 2 (K_I² + K_II²) = σ² π a sec(π a/W).
    assert!((k(0, "k_i_mpa_sqrt_m") / k(2, "k_i_mpa_sqrt_m") - 1.0).abs() < 0.01, "{found}");
    let squares: f64 = [0, 2].iter().map(|&tip| k(tip, "k_i_mpa_sqrt_m").powi(2) + k(tip, "k_ii_mpa_sqrt_m").powi(2)).sum();
    let angle = std::f64::consts::PI * 7.0 / 60.0;
    let one = 60.0_f64.powi(2) * std::f64::consts::PI * 0.007 / angle.cos();
    // The plate of finite length adds some; at a gap of 1 mm both are 4 % above.
    assert!((squares / one - 1.0).abs() < 0.015, "{squares} for {one}: {found}");
}

/// A gap beyond all means is told.
#[test]
#[ignore = "long: ten seconds; cargo test side_by_side -- --ignored"]
fn cracks_side_by_side_are_refused_with_the_gap() {
    let refused = side_by_side("0.0001");
    assert_refused(&refused, 3, &["features 1.00e-4 mm apart", "move apart, or join"]);
}

#[test]
fn too_few_nodes_for_a_basis_are_named() {
    let dir = desk(&[("case.toml", &CASE)]);
    let set = ["model.basis=quadratic", "model.enrichment=none", "model.influence_radius=1.5"];
    let sets: Vec<&str> = set.iter().flat_map(|set| ["--set", *set]).collect();
    let output = perilife(dir.path(), &[&["predict", "case.toml", "--out", "run"], &sets[..]].concat());
    assert_refused(&output, 3, &["too few nodes", "radii of influence up to", "model.influence_radius"]);
}

/// The case with this in place of its crack.
fn without_crack(extra: &str) -> String {
    CASE.replace("cracks = [{ from_mm = [-7, -5], to_mm = [7, 5] }]\n", extra)
        .replace("[stop]\ncrack_length_mm = 30\n", "")
        .replace("length_mm = 100", "length_mm = 200")
}

#[test]
fn a_plate_without_cracks_has_the_stress_of_its_holes() {
    let dir = tempdir().unwrap();
    let hole = without_crack("holes = [{ x_mm = 0, y_mm = 0, diameter_mm = 12 }]\n");
    fs::write(dir.path().join("hole.toml"), &hole).unwrap();
    let output = perilife(dir.path(), "sif hole.toml --method ring --out run");
    assert_refused(&output, 2, &["--out", "--method element_free_galerkin"]);
    let by_nodes = ["sif", "hole.toml", "--method", "element_free_galerkin", "--out", "run"];
    let (stdout, stderr) = done(dir.path(), &[&by_nodes[..], &["--json", "--paraview"]].concat());
    let found: Value = serde_json::from_str(&stdout).unwrap();
    let rim = &found["stresses"]["rims"][0];
    // Peterson's fit at d/W = 0.2: (3.00 - 3.14 x + 3.667 x² - 1.527 x³)/(1 - x), 0.5 %.
    let concentration = rim["largest"]["stress_concentration"].as_f64().unwrap();
    assert!((concentration / 3.133 - 1.0).abs() < 0.01, "{rim}");
    // Beside the hole, on the line across the load.
    let [x, y] = ["x_mm", "y_mm"].map(|key| rim["largest"][key].as_f64().unwrap());
    assert!((x.abs() - 6.0).abs() < 0.02 && y.abs() < 0.5 && rim["rim"] == "holes[0]", "{rim}");
    // Above and below it the rim is pressed together along itself.
    assert!(rim["least"]["stress_mpa"].as_f64().unwrap() < -0.9 * 60.0, "{rim}");
    for file in ["result.json", "stress.svg", "nodes.svg", "paraview/run.pvd", "case.toml"] {
        assert!(dir.path().join("run").join(file).is_file(), "{file}");
    }
    let kept = json(dir.path().join("run/result.json"));
    assert_eq!(kept["stresses"], found["stresses"]);
    // Nothing is said but how far the peak has settled.
    assert!(stderr.lines().all(|line| line.contains("still changed by")), "{stderr}");
    // A square end has no finite stress.
    let slot = without_crack("notches = [{ from_mm = [-30, 0], to_mm = [-20, 0], width_mm = 3 }]\n");
    fs::write(dir.path().join("slot.toml"), slot).unwrap();
    let (stdout, stderr) = texts(&perilife(dir.path(), "sif slot.toml --method element_free_galerkin"));
    assert!(stdout.contains("notches[0]") && stdout.contains("outline"), "{stdout}{stderr}");
    assert!(stderr.contains("sharp corner is singular"), "{stdout}{stderr}");
}

// `model.method = "handbook"` as a user calls it, and the residual-strength curve of either method.

/// The panel of every day, until it breaks, by a law that holds everywhere.
fn panel() -> String {
    PANEL.replace("allow_extrapolation = true\n[stop]\ncrack_length_mm = 49.8\n", "")
}

#[test]
fn a_hand_calculation_leaves_the_files_of_a_run() {
    let dir = desk(&[("panel.toml", &panel())]);
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
    done(dir.path(), "export run --points 50 --out e.csv");
    let (stdout, _) = texts(&perilife(dir.path(), "check panel.toml -v"));
    assert!(stdout.contains("Handbook K") && stdout.contains("8.95422e-8") && !stdout.contains("ageing"), "{stdout}");
    let (stdout, _) = texts(&perilife(dir.path(), "predict panel.toml --out run"));
    assert!(stdout.contains("  Method         handbook K (Feddersen secant), "), "{stdout}");
    assert!(!run.join("residual_strength.csv").exists(), "only on request");
}

#[test]
fn a_plate_is_refused_with_the_remedy() {
    let dir = tempdir().unwrap();
    let plate = panel()
        .replace("middle_tension", "plate")
        .replace("crack_length_mm = 9.0", "cracks = [{ from_mm = [-9, 0], to_mm = [9, 0] }]");
    fs::write(dir.path().join("plate.toml"), plate).unwrap();
    for command in [&["predict", "plate.toml", "--out", "run"][..], &["check", "plate.toml"]] {
        let words = ["plate.toml:13", "model.method = \"handbook\"", "(plate)", "remove it (nodes find K)"];
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
    let sets = "--set fatigue.driver=bond_strain --set material.yield_strength_mpa=300 --set material.toughness_mpa_sqrt_m=30 -v";
    let (stdout, stderr) = done(dir.path(), &call.into_iter().chain(sets.split(' ')).collect::<Vec<_>>());
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
    let dir = desk(&[("panel.toml", &panel().replace("method = \"handbook\"", ""))]);
    let (stdout, _) = done(dir.path(), "predict panel.toml --out run --cross-check");
    assert_says(
        &stdout,
        &["handbook K (Feddersen secant)", "numerical error ≤ 0.9 % of life (estimate)", "Cross-check    element_free_galerkin"],
    );
    let read = || -> Value { serde_json::from_slice(&fs::read(dir.path().join("run/result.json")).unwrap()).unwrap() };
    let result = read();
    assert!((0.5..1.5).contains(&result["error_estimate_percent"].as_f64().unwrap()), "{result}");
    assert!(result["cross_check"]["difference_percent"].as_f64().unwrap().abs() < 0.5, "{result}");
    assert!(result["model"]["why"]["method"].as_str().unwrap().contains("Feddersen"));
    // Nothing is said that was not asked for.
    let output = perilife(dir.path(), "predict panel.toml --out run --no-estimate");
    assert!(!texts(&output).0.contains("Accuracy"), "{:?}", texts(&output));
    assert!(read()["error_estimate_percent"].is_null() && read().get("cross_check").is_none());
}
