//! `perilife chart`: files, columns, resumption, front. Speed itself is never asserted.

use std::fs;

use serde_json::Value;
use tempfile::tempdir;

use crate::interface::cli::{assert_refused, perilife};
use crate::support::desk::done;

#[test]
fn a_quick_scene_leaves_table_picture_and_summary() {
    let dir = tempdir().unwrap();
    let call = ["bench", "tension_plate", "--quick", "--json", "--out", "out"];
    let (stdout, _) = done(dir.path(), &call);
    let object: Value = serde_json::from_str(&stdout).expect("one JSON object and nothing else");
    let read = |file: &str| fs::read_to_string(dir.path().join("out").join(file)).unwrap();
    let table = read("chart.csv");
    let rows: Vec<csv::StringRecord> = csv::Reader::from_reader(table.as_bytes()).records().map(Result::unwrap).collect();
    let header: Vec<&str> = table.lines().next().unwrap().split(',').collect();
    let column = |name: &str| header.iter().position(|column| *column == name).unwrap_or_else(|| panic!("no column {name}"));
    assert_eq!(object["points"].as_u64(), Some(rows.len() as u64));
    let number = |row: &csv::StringRecord, name: &str| row[column(name)].parse::<f64>().unwrap_or(f64::NAN);
    let done: Vec<&csv::StringRecord> = rows.iter().filter(|row| &row[column("status")] == "measured").collect();
    assert!(done.len() >= 4, "{table}");
    for row in &done {
        let all = ["error_percent", "wall_s", "time_ratio", "memory_mb", "points"].map(|name| number(row, name));
        assert!(all.iter().all(|value| value.is_finite() && *value > 0.0), "{row:?}");
        assert!(row[column("command")].starts_with("perilife chart tension_plate --once"), "{row:?}");
    }
    for row in done.iter().filter(|row| &row[column("on_front")] == "true") {
        let place = |row: &csv::StringRecord| (number(row, "wall_s"), number(row, "error_percent"));
        let (own, beats) = (place(row), |other: (f64, f64), own: (f64, f64)| other.0 < own.0 && other.1 < own.1);
        assert!(!done.iter().any(|other| beats(place(other), own)), "{row:?} is beaten");
    }
    for (file, words) in [
        ("chart.svg", "plate in uniform tension"),
        ("summary.md", "# Choice of method"),
        ("runs.jsonl", "\"scene\":\"tension_plate\""),
        (".perilife", "chart.svg"),
    ] {
        assert!(read(file).contains(words), "{words} in {file}");
    }
    // Again: nothing is left to run, not even a line that was broken off; the table stays but for what the machine says of itself.
    let runs = read("runs.jsonl");
    fs::write(dir.path().join("out/runs.jsonl"), format!("{runs}{{\"request\":")).unwrap();
    done(dir.path(), &call);
    assert_eq!(read("chart.csv"), table);
}

#[test]
fn a_point_is_repeated_by_its_command() {
    let dir = tempdir().unwrap();
    let (stdout, _) = done(dir.path(), &["chart", "tension_plate", "--once", "--set", "model.spacing_mm=4"]);
    assert!(stdout.contains("error") && stdout.contains("MB"), "{stdout}");
}

#[test]
fn bad_calls_are_refused() {
    let dir = tempdir().unwrap();
    fs::create_dir(dir.path().join("other")).unwrap();
    fs::write(dir.path().join("other/notes.txt"), "mine").unwrap();
    let calls: [(&[&str], &[&str]); 6] = [
        (&["chart", "nothing"], &["nothing", "tension_plate", "hole_entered"]),
        (&["chart", "--once"], &["SCENE", "one scene"]),
        (&["chart", "tension_plate", "--once", "--set", "model.spacing_mm=-1"], &["model.spacing_mm", "-1"]),
        (&["chart", "tension_plate", "--set", "model.spacing_mm=1"], &["--once"]),
        (&["chart", "tension_plate", "--once", "--quick"], &["--quick"]),
        (&["chart", "tension_plate", "--quick", "--out", "other"], &["notes.txt"]),
    ];
    for (arguments, words) in calls {
        assert_refused(&perilife(dir.path(), arguments), 2, words);
    }
}

#[test]
fn runs_of_another_version_are_not_mixed_in() {
    let dir = tempdir().unwrap();
    let call = ["chart", "tension_plate", "--quick", "--out", "out"];
    done(dir.path(), &call);
    let file = dir.path().join("out/runs.jsonl");
    let other = fs::read_to_string(&file).unwrap().replacen("\"version\":\"", "\"version\":\"0.0.", 1);
    fs::write(&file, other).unwrap();
    assert_refused(&perilife(dir.path(), &call), 2, &["--out", "another version"]);
}
