//! `perilife validate`.

use std::fs;

use serde_json::Value;
use tempfile::tempdir;

use crate::interface::cli::{assert_refused, perilife, texts};
use crate::support::daily::{PANEL, names, write_inputs};
use crate::support::desk::done;

const SOURCE: &str = "[source]\ntitle = \"Panel\"\nreference = \"=1+1\"\nobtained = \"o\"\nassumed = \"a\"\nuncertainty = \"u\"\nlicence = \"l\"\n";

/// A built-in set and a folder of one's own, with two specimens, a path beside the line of the crack, and a case that fails beside them.
#[test]
fn own_tests_stand_beside_published_ones() {
    let dir = tempdir().unwrap();
    write_inputs(dir.path());
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
    let run: Value =
        serde_json::from_str(&texts(&perilife(dir.path(), &["predict", "panel.toml", "--json", "--out", "run"])).0).unwrap();
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
    let dir = tempdir().unwrap();
    write_inputs(dir.path());
    let own = dir.path().join("own");
    fs::create_dir(&own).unwrap();
    assert_refused(&perilife(dir.path(), &["validate", "nothing"]), 2, &["NAME", "nothing", "perilife list"]);
    assert_refused(&perilife(dir.path(), &["validate", "own"]), 4, &["source.toml"]);
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
        assert_refused(&perilife(dir.path(), &["validate", "own", "--out", "out"]), 2, &words);
        assert!(!dir.path().join("out").exists());
    }
    fs::write(own.join("source.toml"), test("halves = 3").replace("[[test]]", "calibration = \"fit.toml\"\n[[test]]")).unwrap();
    assert_refused(&perilife(dir.path(), &["validate", "own"]), 4, &["fit.toml"]);
}
