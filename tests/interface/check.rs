//! `perilife check` and `perilife list`.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

use tempfile::tempdir;

use crate::interface::cli::{SMALL_CASE, assert_refused, perilife, texts};
use crate::support::desk::{desk, done};
use crate::support::rows::assert_says;

#[test]
fn a_case_is_told_in_words_and_in_json() {
    let dir = desk(&[("small.toml", &SMALL_CASE)]);
    let (stdout, _) = done(dir.path(), "check small.toml -v --set model.spacing_mm=1.9 --picture p.svg");
    // 60 mm / 1.9 mm = 31.6: 32 columns of 1.875 mm, 64 rows.
    assert_says(&stdout, &["2048 and", "spacing 1.875 mm (1.9 asked for)", "crack length 20 mm", "small.toml: valid input\n"]);
    assert!(fs::read_to_string(dir.path().join("p.svg")).unwrap().starts_with("<svg"));
    let (stdout, _) = texts(&perilife(dir.path(), "check small.toml --json"));
    let object: serde_json::Value = serde_json::from_str(&stdout).unwrap();
    assert_eq!((&object["ok"], &object["kind"]), (&true.into(), &"case".into()));
    assert_refused(&perilife(dir.path(), "check small.toml --picture no/p.svg"), 4, &["no/p.svg", "cannot write"]);
}

#[test]
fn a_tip_held_by_a_no_fail_zone_is_told() {
    let dir = tempdir().unwrap();
    // A crack 3 mm above the held edge of a plate: bonds within a horizon (6 mm) of it do not fail.
    let text = SMALL_CASE.replace("kind = \"middle_tension\"", "kind = \"plate\"").replace(
        "crack_length_mm = 12.0\n",
        "cracks = [{ from_mm = [-15, -57], to_mm = [5, -57] }, { from_mm = [-10, 0], to_mm = [10, 0] }]\n",
    );
    let text =
        text.replace("crack_length_mm = 20.0", "crack_length_mm = 60.0") + "[supports]\nbottom = { fix = [\"x\", \"y\"] }\n";
    fs::write(dir.path().join("held.toml"), text).unwrap();
    let (_, stderr) = done(dir.path(), "check held.toml");
    let held = |tip: &str| format!("the crack tip at {tip} mm is inside the no-failure zone of a load or support");
    assert_says(&stderr, &["(-15, -57)", "(5, -57)"].map(held));
    assert_eq!(stderr.matches("crack tip at").count(), 2, "the other crack is free: {stderr}");
    // Where no tip can grow there is no result.
    let only = "specimen.cracks=[{ from_mm = [-15, -57], to_mm = [5, -57] }]";
    let bonds = "fatigue.driver=bond_strain";
    let output = perilife(dir.path(), &["predict", "held.toml", "--set", only, "--set", bonds, "--out", "run"]);
    assert_refused(&output, 3, &["load or support", "held: "]);
    assert!(!dir.path().join("run").exists());
}

#[test]
fn mechanics_that_show_before_a_run_are_wrong_input() {
    let plate = SMALL_CASE.replace("kind = \"middle_tension\"", "kind = \"plate\"").replace("crack_length_mm = 20.0\n", "");
    let whole_width = "cracks = [{ from_mm = [-30, 0], to_mm = [0, 0] }, { from_mm = [30, 2], to_mm = [-1, 2] }, \
                       { from_mm = [-0.5, -6], to_mm = [-0.5, 8] }]\n";
    let crossing = plate.replace("crack_length_mm = 12.0\n", whole_width);
    let dir = desk(&[("cut.toml", &crossing)]);
    assert_refused(&perilife(dir.path(), "check cut.toml"), 2, &["cut.toml"]);
}

/// What a scene at the rim of the model is told, and the codes of runs in which nothing happens.
#[test]
fn coarse_models_are_told_their_error() {
    let dir = desk(&[("small.toml", &SMALL_CASE)]);
    let check = |set: &str| perilife(dir.path(), &["check", "small.toml", "--set", "fatigue.driver=bond_strain", "--set", set]);
    for (set, words) in [
        ("model.horizon_ratio=1.5", "is too small: with the same A the life is about 40 % too short"),
        ("model.horizon_ratio=2", "up to 15 % off"),
    ] {
        let output = check(set);
        assert!(output.status.success() && texts(&output).1.contains(words), "{set}: {}", texts(&output).1);
    }
    assert_refused(&check("model.horizon_ratio=1.4"), 2, &["model.horizon_ratio", "1.4"]);
    assert_refused(&check("specimen.crack_length_mm=1"), 2, &["model.spacing_mm", "larger than the crack"]);
    let arguments =
        ["predict", "small.toml", "--out", "run", "--json", "--set", "fatigue.a=1e-30", "--set", "stop.cycles_max=1e6"];
    let (stdout, _) = done(dir.path(), &arguments);
    let result: serde_json::Value = serde_json::from_str(&stdout).unwrap();
    assert_eq!((&result["stop_reason"], &result["life_cycles"]), (&"run_out".into(), &1e6.into()));
    assert_eq!(result["crack_length_final_mm"], 12.0);
}

#[test]
fn a_calibration_is_checked_with_its_measured_files() {
    let dir = tempdir().unwrap();
    let calibration = SMALL_CASE.split("[fatigue]").next().unwrap().to_owned() + "[measured]\nfiles = [\"m.csv\"]\n";
    fs::write(dir.path().join("calibration.toml"), calibration).unwrap();
    let check = || perilife(dir.path(), "check calibration.toml");
    assert_refused(&check(), 4, &["m.csv", "cannot read"]);
    let rows = "cycles,crack_length_mm\n0,12\n1000,12.5\n2000,13.1\n3000,13.8\n4000,14.6\n";
    fs::write(dir.path().join("m.csv"), rows.replace("3000,13.8", "1500,13.8")).unwrap();
    assert_refused(&check(), 2, &["m.csv:5", "1500"]);
    fs::write(dir.path().join("m.csv"), rows).unwrap();
    let (stdout, _) = done(dir.path(), "check calibration.toml");
    assert!(stdout.contains("5 readings from 12 to 14.6 mm in 4000 cycles"), "{stdout}");
}

/// A reader that goes away (`| head -1`) is no trouble, a full disk is.
#[test]
#[cfg(unix)]
fn stdout_that_closes_or_is_full() {
    let program = env!("CARGO_BIN_EXE_perilife");
    let case = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/cases/compact_tension.toml");
    let case = case.to_str().unwrap();
    for arguments in [&["list"][..], &["list", "--json"], &["check", case], &["check", case, "--json"]] {
        let mut child = Command::new(program).args(arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        drop(child.stdout.take());
        let (code, stderr) = (child.wait().unwrap().code(), child.wait_with_output().unwrap().stderr);
        assert_eq!(code, Some(0), "{arguments:?}: {}", String::from_utf8_lossy(&stderr));
    }
    if let Ok(full) = fs::OpenOptions::new().write(true).open("/dev/full") {
        let output = Command::new(program).args(["list"]).stdout(full).output().unwrap();
        assert_eq!(output.status.code(), Some(4), "{}", String::from_utf8_lossy(&output.stderr));
    }
}

/// An I of thin arms: a third of a million points among two hundred million places, which ran out of memory; refused by what is free.
const THIN_ARMS: &str = r#"
specimen = { kind = "plate", outline_mm = [[0, 0], [7000, 0], [7000, 4], [3502, 4], [3502, 6996], [7000, 6996], [7000, 7000], [0, 7000], [0, 6996], [3498, 6996], [3498, 4], [0, 4]], thickness_mm = 2.0, cracks = [{ from_mm = [3498, 3500], to_mm = [3499, 3500] }] }
material = { name = "al2024-t3" }
loading = { stress_max_mpa = 50.0, stress_ratio = 0.1 }
model = { spacing_mm = 0.5 }
fatigue = { paris_c_mm_per_cycle = 1e-7, paris_m = 3.0 }
"#;

#[test]
fn what_does_not_fit_into_memory_is_refused_before_it_is_laid_out() {
    let dir = desk(&[("arms.toml", &THIN_ARMS), ("small.toml", &SMALL_CASE)]);
    let within = |arguments: &str| {
        let call = format!("ulimit -v 2000000; exec '{}' {arguments}", env!("CARGO_BIN_EXE_perilife"));
        Command::new("sh").current_dir(dir.path()).args(["-c", &call]).output().unwrap()
    };
    for command in ["check arms.toml", "predict arms.toml --out run", "sif arms.toml"] {
        let words = ["arms.toml", "model.spacing_mm = 0.5", "lattice positions", "GB of memory; limit", "give about"];
        assert_refused(&within(command), 2, &words);
    }
    assert!(!dir.path().join("run").exists());
    assert_eq!(within("check small.toml").status.code(), Some(0), "what fits is let through");
}

/// Bonds are counted, not drawn, where there are many.
#[test]
fn a_check_of_many_bonds_is_quick() {
    let dir = desk(&[("small.toml", &SMALL_CASE)]);
    let started = std::time::Instant::now();
    let sets = ["model.spacing_mm=0.135", "model.horizon_ratio=12", "model.surface_correction=volume_and_surface"];
    let sets: Vec<&str> = sets.iter().flat_map(|set| ["--set", *set]).collect();
    let output = perilife(dir.path(), &[&["check", "small.toml", "-v"], &sets[..]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", texts(&output).1);
    assert!(texts(&output).0.contains("about 39"), "{}", texts(&output).0);
    assert!(started.elapsed().as_secs_f64() < 3.0, "{:.2} s", started.elapsed().as_secs_f64());
}
