//! `perilife fracture` from file to files.

use std::fs;

use serde_json::Value;
use tempfile::TempDir;

use crate::interface::cli::{assert_refused, perilife, texts};
use crate::support::desk::{desk, done, json};
use crate::support::rows::{assert_holds, assert_says};

/// A plate torn apart in time, small enough for a tenth of a second.
pub const SCENE: &str = include_str!("../reference/cases/fracture.toml");

fn folder() -> TempDir {
    desk(&[("torn.toml", &SCENE)])
}

#[test]
fn a_scene_writes_what_it_promises() {
    let dir = folder();
    let (stdout, _) = done(dir.path(), "fracture torn.toml --out out/run --json --paraview");
    let printed: Value = serde_json::from_str(&stdout).expect("one JSON object and nothing else");
    let run = dir.path().join("out/run");
    let written = json(run.join("result.json"));
    assert_eq!(printed, written);
    let charts = ["load_displacement.svg", "load_time.svg", "energies.svg", "broken_bonds.svg"];
    for file in ["damage_first.svg", "damage.svg", "paraview/run.pvd"].iter().chain(&charts) {
        assert!(run.join(file).is_file(), "{file}");
    }
    for file in charts {
        assert!(!fs::read_to_string(run.join(file)).unwrap().contains("NaN"), "{file}");
    }
    // The keys that are promised, and what a plate that is torn in two must say.
    for key in ["peak_load_n", "onset_step", "separated_step", "stop_reason", "points", "wall_s"] {
        assert!(!written[key].is_null(), "{key}");
    }
    assert_eq!((&written["points"], &written["name"]), (&400.into(), &"torn".into()));
    assert_eq!(written["model"]["kernel"], "constant");
    assert_eq!(written["model"]["why"]["kernel"], "default: as published");
    assert_eq!(written["model"]["why"]["spacing_mm"], "set in the file");
    assert_eq!(written["case"]["loading"]["velocity_mm_s"], 5000);
    assert!(written["onset_step"].as_u64() < written["separated_step"].as_u64());
    assert!(written["fronts"][0]["x_mm"].as_f64().unwrap() > 0.0, "the crack grew: {}", written["fronts"]);
}

/// Columns as promised, at least ten digits, steps and time that rise, and the sums that stand in `result.json`.
#[test]
fn tables_hold_the_histories() {
    let dir = folder();
    done(dir.path(), "fracture torn.toml --out run --quiet");
    let run = dir.path().join("run");
    let history = fs::read_to_string(run.join("history.csv")).unwrap();
    let mut lines = history.lines();
    assert_eq!(lines.next(), Some("step,time_s,displacement_mm,load_n,broken_bonds,kinetic_j,strain_j,fracture_j,work_j"));
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    let number = |text: &str| text.parse::<f64>().unwrap_or_else(|_| panic!("{text}"));
    assert!(rows.len() > 50 && rows.iter().all(|row| row.len() == 9));
    let digits = |text: &str| {
        text.split('e').next().unwrap().trim_start_matches(['-', '0', '.']).chars().filter(char::is_ascii_digit).count()
    };
    for row in &rows {
        for column in [1, 2, 3, 5, 6, 7, 8] {
            assert!(number(row[column]) == 0.0 || digits(row[column]) >= 10, "{}", row[column]);
        }
    }
    for pair in rows.windows(2) {
        assert!(number(pair[0][0]) < number(pair[1][0]) && number(pair[0][1]) < number(pair[1][1]));
        assert!(number(pair[0][4]) <= number(pair[1][4]), "broken bonds never fall");
    }
    // Both sides at 5000 mm/s over 20 µs: 0.2 mm, to the last time step.
    let last = rows.last().unwrap();
    assert!((number(last[2]) - 1e4 * number(last[1])).abs() < 1e-9 && (number(last[1]) - 2e-5).abs() < 2e-7);
    let result = json(run.join("result.json"));
    let peak = rows.iter().map(|row| number(row[3])).fold(0.0, f64::max);
    assert!((result["peak_load_n"].as_f64().unwrap() - peak).abs() < 1e-9 * peak);
    assert_eq!(result["broken_bonds"].as_f64(), Some(number(last[4])));

    let path = fs::read_to_string(run.join("crack_path.csv")).unwrap();
    let mut lines = path.lines();
    assert_eq!(lines.next(), Some("tip,step,time_s,x_mm,y_mm,damage,speed_m_s"));
    assert!(lines.next().unwrap().starts_with("0,0,0,0,0,"), "the tip of the start: {path}");
    assert!(lines.all(|line| line.split(',').skip(1).all(|field| field.parse::<f64>().is_ok())));
}

#[test]
fn keys_are_overridden_and_the_folder_replaced() {
    let dir = folder();
    let call = |set: &str| perilife(dir.path(), &["fracture", "torn.toml", "--out", "run", "--set", set]);
    let (stdout, _) = texts(&call("loading.duration_s=1e-6"));
    assert_says(&stdout, &["peak load", "done", "separated      never", "400 points", "Results        run"]);
    assert!(json(dir.path().join("run/result.json"))["separated_step"].is_null());
    assert_eq!(call("model.spacing_mm=2").status.code(), Some(0));
    assert_eq!(json(dir.path().join("run/result.json"))["points"], 100);
    assert_refused(&call("model.spacing_mm=nan"), 2, &["torn.toml", "model.spacing_mm", "--set"]);
    assert_eq!(json(dir.path().join("run/result.json"))["points"], 100, "the earlier result stands");
    // A time step above the stable one shows only once points and bonds stand; it is wrong input all the same.
    assert_refused(&call("loading.time_step_s=1e-6"), 2, &["loading.time_step_s", "stable step"]);
    assert_refused(&perilife(dir.path(), "fracture no.toml --out a"), 4, &["no.toml: cannot read"]);
    assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 2, "nothing stays behind");
}

#[test]
fn check_understands_a_scene() {
    let dir = folder();
    let (stdout, _) = done(dir.path(), "check torn.toml -v --picture p.svg");
    assert_holds(
        &stdout,
        "1 crack, 0 slots, 0 holes, 1 tip | one_bond_two_parameter, kernel constant, rotation free | \
        400 and | motion over 2e-5 s | velocity (0, 5000) mm/s on top | velocity (0, -5000) mm/s on bottom | \
        critical_energy, fracture energy 204 J/m² | torn.toml: valid input\n",
    );
    let picture = fs::read_to_string(dir.path().join("p.svg")).unwrap();
    assert!(picture.starts_with("<svg") && picture.contains("blue: velocity (0, 5000) mm/s on top") && !picture.contains("NaN"));
    let (stdout, _) = texts(&perilife(dir.path(), "check torn.toml --json"));
    let object: Value = serde_json::from_str(&stdout).unwrap();
    assert_eq!((&object["ok"], &object["kind"]), (&true.into(), &"fracture".into()));
    assert!(object["understood"]["load"].as_str().unwrap().contains("on top; velocity"));
}

/// Points stand at odd halves of a millimetre: boxes and parts of sides between them hold none, which shows once points stand.
#[test]
fn a_load_or_support_without_points_is_refused() {
    let dir = folder();
    let box_between = "{ from_mm = [5.9, 5.9], to_mm = [6.1, 6.1], fix = [\"x\"] }";
    let edges = "edges = [\"top\", \"bottom\"]";
    for (old, new, line, words) in [
        ("[damage]", format!("[supports]\npin = {box_between}\n[damage]"), 22, ["supports.pin", "(5.9, 5.9) to (6.1, 6.1) mm"]),
        (
            "[damage]",
            "[supports]\nleft = { range_mm = [5.9, 6.1], fix = [\"x\"] }\n[damage]".to_owned(),
            22,
            ["supports.left.range_mm", "left from 5.9 to 6.1 mm"],
        ),
        (
            edges,
            "regions = [{ from_mm = [5.9, 5.9], to_mm = [6.1, 6.1] }]\ndirection = [0, 1]".to_owned(),
            18,
            ["loading.regions[0]", "(5.9, 5.9) to (6.1, 6.1) mm"],
        ),
        (edges, "edges = [\"top\"]\nrange_mm = [5.9, 6.1]".to_owned(), 19, ["loading.range_mm", "top from 5.9 to 6.1 mm"]),
    ] {
        let text = SCENE.replacen(old, &new, 1);
        assert_ne!(text, SCENE);
        fs::write(dir.path().join("loose.toml"), text).unwrap();
        for command in [&["fracture", "loose.toml", "--out", "run"][..], &["check", "loose.toml"]] {
            let place = format!("loose.toml:{line}: ");
            let output = perilife(dir.path(), command);
            assert_refused(&output, 2, &[&place, words[0], words[1], "no point", "spacing 1 mm", "model.spacing_mm"]);
        }
        assert!(!dir.path().join("run").exists());
    }
}
