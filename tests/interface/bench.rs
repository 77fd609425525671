//! `perilife bench`: files, columns, errors, front. Speed itself is never asserted.

use std::fs;

use serde_json::Value;
use tempfile::tempdir;

use crate::cli::{assert_refused, perilife, texts};

#[test]
fn the_smallest_group_leaves_table_and_chart() {
    let dir = tempdir().unwrap();
    let output = perilife(dir.path(), &["bench", "tension_plate", "--quick", "--json", "--out", "out"]);
    let (stdout, stderr) = texts(&output);
    assert_eq!(output.status.code(), Some(0), "{stderr}");
    let object: Value = serde_json::from_str(&stdout).expect("one JSON object and nothing else");
    for file in ["bench.csv", "figures.csv", "bench.json", "bench.md", "bench.svg", ".perilife"] {
        assert!(fs::metadata(dir.path().join("out").join(file)).unwrap().len() > 0, "{file}");
    }
    let written: Value = serde_json::from_str(&fs::read_to_string(dir.path().join("out/bench.json")).unwrap()).unwrap();
    assert_eq!(written, object);
    let bits = object["simd_bits"].as_u64().unwrap();
    assert!(bits >= 64 && object["threads"].as_u64().unwrap() > 0 && object["reference_s"].as_f64().unwrap() > 0.0);

    let rows = object["rows"].as_array().unwrap();
    let table = fs::read_to_string(dir.path().join("out/bench.csv")).unwrap();
    assert_eq!(table.lines().count(), rows.len() + 1);
    for column in ["scene", "varied", "choice", "wall_s", "cpu_s", "ratio", "repeats", "error_percent", "on_front"] {
        assert!(table.lines().next().unwrap().split(',').any(|name| name == column), "{column}");
    }
    let place = |row: &Value| {
        let [time, error] = ["ratio", "error_percent"].map(|key| row[key].as_f64().unwrap_or(f64::NAN));
        assert!(time > 0.0 && time.is_finite() && error.is_finite() && error >= 0.0, "{row}");
        (time, error)
    };
    let (front, beaten): (Vec<&Value>, Vec<&Value>) = rows.iter().partition(|row| row["on_front"] == true);
    assert!(!front.is_empty() && rows.len() > 8, "{stdout}");
    let front: Vec<(f64, f64)> = front.into_iter().map(place).collect();
    for (i, a) in front.iter().enumerate() {
        let dominated = |(j, b): (usize, &(f64, f64))| i != j && b.0 <= a.0 && b.1 <= a.1;
        assert!(!front.iter().enumerate().any(dominated), "{a:?} is beaten on {front:?}");
    }
    for row in beaten {
        let b = place(row);
        // Beaten up to the round-off between solvers that are equally exact.
        assert!(front.iter().any(|a| a.0 <= b.0 && a.1 * (1.0 - 1e-3) <= b.1), "{row} belongs to {front:?}");
    }
    let svg = fs::read_to_string(dir.path().join("out/bench.svg")).unwrap();
    assert!(svg.contains("plate in uniform tension") && svg.contains(&format!("{bits} bits")));
}

#[test]
fn one_size_answers_with_its_figures() {
    let dir = tempdir().unwrap();
    let output = perilife(dir.path(), &["bench", "--first-solve", "two_parameter:1200"]);
    let (stdout, stderr) = texts(&output);
    assert_eq!(output.status.code(), Some(0), "{stderr}");
    let size: Value = serde_json::from_str(&stdout).unwrap();
    assert_eq!((size["points"].as_u64(), size["iterations"].as_u64().map(|i| i > 0)), (Some(1200), Some(true)), "{stdout}");
}

#[test]
fn bad_calls_are_refused() {
    let dir = tempdir().unwrap();
    let calls: [(&[&str], &[&str]); 4] = [
        (&["bench", "nothing"], &["nothing", "tension_plate", "first_solve"]),
        (&["bench", "--quick", "--seconds-per-row", "0"], &["--seconds-per-row", "above zero"]),
        (&["bench", "--first-solve", "two_parameter"], &["--first-solve", "bond_based:30000"]),
        (&["bench", "--first-solve", "bogus:100"], &["bogus", "bond_based"]),
    ];
    for (arguments, words) in calls {
        assert_refused(&perilife(dir.path(), arguments), 2, words);
    }
}
