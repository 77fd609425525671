//! `perilife verify`, `validate`, `chart` and `stability`: files, columns, resumption, refusals.

use std::fs;

use serde_json::Value;
use tempfile::tempdir;

use crate::interface::cli::{assert_refused, perilife, texts};
use crate::support::daily::{PANEL, inputs, names};
use crate::support::desk::done;

// `perilife verify`.

/// The table is the same text however long its rows took; JSON names both bounds of every row.
#[test]
fn rows_are_written_as_markdown_and_as_json() {
    let dir = tempdir().unwrap();
    let tables = ["first.md", "second.md"].map(|file| {
        let (stdout, _) = done(dir.path(), &format!("verify golden --json --markdown {file}"));
        let object: Value = serde_json::from_str(&stdout).expect("one JSON object and nothing else");
        let rows = object["rows"].as_array().unwrap();
        assert!(rows.len() >= 12, "{}", rows.len());
        for row in rows {
            assert!(row["bound_percent"].is_f64() && row.get("miss_bound_percent").is_some_and(Value::is_null), "{row}");
        }
        fs::read_to_string(dir.path().join(file)).unwrap()
    });
    assert!(tables[0].contains("\n## golden\n") && tables[0].contains("247200"), "{}", tables[0]);
    assert_eq!(tables[0], tables[1]);
    assert_refused(&perilife(dir.path(), "verify gold"), 2, &["NAME", "gold", "golden_peridynamics"]);
    assert_refused(&perilife(dir.path(), "verify golden --json --markdown ."), 2, &["--markdown", "folder"]);
}

// `perilife validate`.

const SOURCE: &str = "[source]\ntitle = \"Panel\"\nreference = \"=1+1\"\nobtained = \"o\"\nassumed = \"a\"\nuncertainty = \"u\"\nlicence = \"l\"\n";

/// A built-in set and a folder of one's own, with two specimens, a path beside the line of the crack, and a case that fails beside them.
#[test]
fn own_tests_stand_beside_published_ones() {
    let dir = inputs();
    let put = |name: &str, text: &str| fs::write(dir.path().join("own").join(name), text).unwrap();
    fs::create_dir(dir.path().join("own")).unwrap();
    put("panel.toml", PANEL);
    put("broken.toml", &PANEL.replace("crack_length_mm = 9.0", "crack_length_mm = 90.0"));
    let tests = "[[test]]\nkind = \"library\"\ncase = \"panel.toml\"\nlife_cycles = [200000, 280000]\npath_mm = [[12, 0.5], [20, -0.25]]\n\
                 others = \"hand\"\nothers_life = 120000\n";
    put("source.toml", &format!("{SOURCE}{tests}"));
    let call = ["validate", "own", "aa3003_bm_later", "--json", "--out", "out", "--markdown", "page.md"];
    let (stdout, _) = done(dir.path(), &call);
    let object: Value = serde_json::from_str(&stdout).expect("one JSON object and nothing else");
    let row = &object["rows"][0];
    let run: Value = serde_json::from_str(&texts(&perilife(dir.path(), "predict panel.toml --json --out run")).0).unwrap();
    let near =
        |value: &Value, wanted: f64| assert!((value.as_f64().unwrap() / wanted - 1.0).abs() < 1e-9, "{value} for {wanted}");
    near(&row["measured"], 240_000.0);
    near(&row["predicted"], run["life_cycles"].as_f64().unwrap());
    near(&row["others_ratio"], 0.5);
    near(&row["path_mean_mm"], 0.375);
    near(&row["path_largest_mm"], 0.5);
    assert_eq!((&row["lives_measured"], &row["lives_inside"]), (&2.into(), &Value::Null));
    assert_eq!((&object["rows"][1]["lives_inside"], &object["rows"][1]["kind"]), (&1.into(), &"later_life".into()));
    assert_eq!(names(&dir.path().join("out")), [".perilife", "validate.csv", "validate.json", "validate.md", "validate.svg"]);
    let read = |name: &str| fs::read_to_string(dir.path().join(name)).unwrap();
    assert_eq!(read("out/validate.md"), read("page.md"));
    assert!(read("page.md").contains("### own\n\nPanel. =1+1.") && read("page.md").contains("## Kinds without a measured test"));
    assert_eq!(read("out/validate.csv").lines().count(), 3);

    // One failing case is a row, and the others stand.
    put(
        "source.toml",
        &format!(
            "{SOURCE}{tests}[[test]]\nkind = \"library\"\ncase = \"broken.toml\"\nlife_cycles = [1e5]\n\
                           [[test]]\nkind = \"spectrum\"\ncase = \"panel.toml\"\nlife_passes = [1e2]\n\
                           [[test]]\nkind = \"same_lot\"\ncase = \"panel.toml\"\nhalves = 3\n"
        ),
    );
    let output = perilife(dir.path(), &call);
    let (stdout, stderr) = texts(&output);
    assert_eq!(output.status.code(), Some(3), "{stderr}");
    assert!(stderr.contains("own: broken.toml: ") && stderr.contains("crack_length_mm"), "{stderr}");
    assert!(stderr.contains("own: panel.toml: ") && stderr.contains("test.life_passes"), "{stderr}");
    assert!(stderr.contains("test.halves: needs readings of at least four specimens"), "{stderr}");
    let object: Value = serde_json::from_str(&stdout).unwrap();
    assert!(object["rows"][0]["failure"].is_null() && object["rows"][1]["failure"].is_string(), "{object}");
    assert!(read("page.md").contains("failed: "));
}

#[test]
fn sets_that_cannot_be_read_are_refused_before_any_run() {
    let dir = inputs();
    let own = dir.path().join("own");
    fs::create_dir(&own).unwrap();
    assert_refused(&perilife(dir.path(), "validate nothing"), 2, &["NAME", "nothing", "perilife list"]);
    assert_refused(&perilife(dir.path(), "validate own"), 4, &["source.toml"]);
    let test = |more: &str| format!("{SOURCE}[[test]]\nkind = \"path\"\ncase = \"panel.toml\"\n{more}\n");
    for (text, words) in [
        (SOURCE.replace("licence", "license"), ["source.license", "licence"]),
        (SOURCE.to_owned(), ["test", "is missing"]),
        (format!("{SOURCE}[tests]\n"), ["tests", "source, test"]),
        (test(""), ["test[0]", "has 0 measured lives"]),
        (test("life_cycles = [1e5]\nlife_passes = [10]"), ["test[0]", "has 2 measured lives"]),
        (test("life_cycles = [-1e5]"), ["test[0]", "above zero"]),
        (test("halves = 0"), ["test[0]", "counts above zero"]),
        (test("life_cycles = [1e5]\nlifes = 1"), ["test[0].lifes", "life_cycles"]),
        (test("halves = 3").replace("\"path\"", "\"paths\""), ["test[0].kind", "other_condition"]),
        (test("path_mm = [[1, nan]]"), ["test[0]", "finite"]),
    ] {
        fs::write(own.join("source.toml"), &text).unwrap();
        assert_refused(&perilife(dir.path(), "validate own --out out"), 2, &words);
        assert!(!dir.path().join("out").exists());
    }
    fs::write(own.join("source.toml"), test("halves = 3").replace("[[test]]", "calibration = \"fit.toml\"\n[[test]]")).unwrap();
    assert_refused(&perilife(dir.path(), "validate own"), 4, &["fit.toml"]);
}

// `perilife chart`: files, columns, resumption, front. Speed itself is never asserted.

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
    let measured: Vec<&csv::StringRecord> = rows.iter().filter(|row| &row[column("status")] == "measured").collect();
    assert!(measured.len() >= 4, "{table}");
    for row in &measured {
        let all = ["error_percent", "wall_s", "time_ratio", "memory_mb", "points"].map(|name| number(row, name));
        assert!(all.iter().all(|value| value.is_finite() && *value > 0.0), "{row:?}");
        assert!(row[column("command")].starts_with("perilife chart tension_plate --once"), "{row:?}");
    }
    for row in measured.iter().filter(|row| &row[column("on_front")] == "true") {
        let place = |row: &csv::StringRecord| (number(row, "wall_s"), number(row, "error_percent"));
        let (own, beats) = (place(row), |other: (f64, f64), own: (f64, f64)| other.0 < own.0 && other.1 < own.1);
        assert!(!measured.iter().any(|other| beats(place(other), own)), "{row:?} is beaten");
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
fn bad_calls_are_refused() {
    let dir = tempdir().unwrap();
    fs::create_dir(dir.path().join("other")).unwrap();
    fs::write(dir.path().join("other/notes.txt"), "mine").unwrap();
    let (stdout, _) = done(dir.path(), "chart tension_plate --once --set model.spacing_mm=4");
    assert!(stdout.contains("error") && stdout.contains("MB"), "a point is repeated by its command: {stdout}");
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

// `perilife stability`.

/// Columns that users rely on, a row a run, pictures, and a name that is no sweep.
#[test]
fn a_sweep_is_written_as_table_and_pictures() {
    let dir = tempdir().unwrap();
    let (stdout, _) = done(dir.path(), "stability density_factor reading_count --quick --json --out map");
    let object: Value = serde_json::from_str(&stdout).expect("one JSON object and nothing else");
    let read = |name: &str| fs::read_to_string(dir.path().join("map").join(name)).unwrap();
    let table = read("stability.csv");
    assert!(table.starts_with("sweep,method,parameter,value,status,error_percent,boundary,reason,version\n"), "{table}");
    let runs: usize = object["records"].as_array().unwrap().iter().map(|record| record["points"].as_array().unwrap().len()).sum();
    assert!(table.lines().count() == runs + 1 && runs > 8, "{runs}");
    let rows: Vec<&str> = table.lines().filter(|line| line.starts_with("density_factor")).collect();
    // Too little density is unstable by theory, and says so; the density of the bound is not.
    assert!(rows[0].contains(",failed,") && rows[0].contains("unstable after"), "{}", rows[0]);
    assert!(rows.iter().any(|row| row.contains(",1.000000000,stable,")), "{rows:?}");
    for picture in ["stability.svg", "density_factor.svg", "reading_count.svg"] {
        let svg = read(picture);
        assert!(svg.starts_with("<svg") && svg.ends_with("</svg>\n") && svg.contains("<rect"), "{picture}");
    }
    assert_eq!(read("boundaries.csv").lines().count(), 3);
    assert_refused(&perilife(dir.path(), "stability density"), 2, &["NAME", "density", "density_factor"]);
    let listed = perilife(dir.path(), "list");
    assert!(texts(&listed).0.contains("stability NAME"));
}
