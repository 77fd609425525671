//! Broken measured curves: every one ends with words that name file, line, column, value and what would be right.

use std::fs;

use tempfile::tempdir;

use super::cli::{assert_refused, perilife, texts};

/// A panel of half width 76.2 mm.
const PANEL: &str = "[specimen]\nkind = \"middle_tension\"\nwidth_mm = 152.4\nlength_mm = 300\nthickness_mm = 2.54\ncrack_length_mm = 9\n\
                     [material]\nname = \"al2024-t3\"\n[loading]\nkind = \"constant_amplitude\"\nstress_range_mpa = 48.28\nstress_ratio = 0.2\n";

const HEADER: &str = "specimen,cycles,crack_length_mm\n";

/// Four good rows, so that a fifth decides.
const ROWS: &str = "S1,0,9.0\nS1,1000,9.2\nS1,2000,9.4\nS1,3000,9.6\n";

/// Name, bytes of the file, and the words the message must hold: place, column and value, problem, remedy.
fn broken() -> Vec<(&'static str, Vec<u8>, [&'static str; 4])> {
    let rows = |last: &str| format!("{HEADER}{ROWS}{last}\n").into_bytes();
    let text = |text: &str| text.as_bytes().to_vec();
    vec![
        ("word for cycles", rows("S1,many,9.8"), [":6: ", "cycles = many", "is not a number", "give a plain number"]),
        ("word for length", rows("S1,4000,long"), [":6: ", "crack_length_mm = long", "is not a number", "give a plain number"]),
        ("unit behind a number", rows("S1,4000,9.8 mm"), [":6: ", "crack_length_mm = 9.8 mm", "is not a number", "plain number"]),
        (
            "not a number by name",
            rows("S1,4000,NaN"),
            [":6: ", "crack_length_mm = NaN", "is not a finite number", "remove the row"],
        ),
        ("infinite", rows("S1,inf,9.8"), [":6: ", "cycles = inf", "is not a finite number", "remove the row"]),
        ("too large", rows("S1,1e999,9.8"), [":6: ", "cycles = 1e999", "is not a finite number", "remove the row"]),
        (
            "absurd cycles",
            rows("S1,1e300,9.8"),
            [":6: ", "cycles = 1e300", "more than 1e15 cycles", "check the number and its unit"],
        ),
        (
            "absurd length",
            rows("S1,4000,1e300"),
            [":6: ", "crack_length_mm = 1e300", "more than 100 m", "check the number and its unit"],
        ),
        ("negative cycles", rows("S1,-4000,9.8"), [":6: ", "cycles = -4000", "is negative", "count cycles from 0"]),
        (
            "falling cycles",
            rows("S1,2500,9.8"),
            [":6: ", "cycles = 2500", "is below the previous reading (3000)", "sort the readings"],
        ),
        (
            "repeated cycles",
            rows("S1,3000,9.8"),
            [":6: ", "cycles = 3000", "repeats the cycles", "remove duplicate cycle counts"],
        ),
        ("negative length", rows("S1,4000,-9.8"), [":6: ", "crack_length_mm = -9.8", "is not above 0", "give the crack length"]),
        ("zero length", rows("S1,4000,0"), [":6: ", "crack_length_mm = 0", "is not above 0", "give the crack length"]),
        (
            "beyond the half width",
            rows("S1,4000,80.5"),
            [":6: ", "crack_length_mm = 80.5", "half width is 76.2 mm", "check the number, its unit"],
        ),
        (
            "full width in inches",
            text("cycles,crack_length_in\n0,1\n1,2\n2,2.5\n3,2.9\n4,3.5\n"),
            [":6: ", "crack_length_in = 3.5", "half width is 76.2 mm", "its unit"],
        ),
        ("empty cell", rows("S1,,9.8"), [":6: ", "cycles = \"\"", "is empty", "remove the row"]),
        ("no name", rows(",4000,9.8"), [":6: ", "specimen = \"\"", "is empty", "name the specimen in every row"]),
        ("short row", rows("S1,4000"), [":6: ", "S1,4000", "has 2 columns where the header has 3", "one value a column"]),
        ("long row", rows("S1,4000,9.8,7"), [":6: ", "S1,4000,9.8,7", "has 4 columns where the header has 3", "semicolons"]),
        (
            "decimal comma between commas",
            rows("S1,4000,9,8"),
            [":6: ", "S1,4000,9,8", "has 4 columns", "with decimal commas separate the columns by semicolons"],
        ),
        (
            "thousands separator",
            text("cycles;crack_length_mm\n0;9\n1.000,5;9,5\n"),
            ["thousands separator.csv: ", "specimen = thousands separator", "has 2 readings", "at least 5"],
        ),
        (
            "other separator in a row",
            rows("S1;4000;9.8"),
            [":6: ", "S1;4000;9.8", "mixes separators", "as the header is separated"],
        ),
        (
            "mixed separators in the header",
            text("cycles;crack_length_mm,x\n0;9\n"),
            [":1: ", "header = cycles", "no column of crack length", "measured.columns"],
        ),
        (
            "few readings",
            format!("{HEADER}{ROWS}").into_bytes(),
            ["few readings.csv: ", "specimen = S1", "has 4 readings", "at least 5 readings"],
        ),
        ("few readings of one", rows("S2,0,9.0"), [".csv: ", "specimen = S1", "has 4 readings", "at least 5 readings"]),
        ("empty file", Vec::new(), ["empty file.csv: ", "", "is empty", "give a header line"]),
        ("only blank lines", text("\n\r\n  \n"), ["only blank lines.csv: ", "", "is empty", "give a header line"]),
        ("header only", text(HEADER), ["header only.csv: ", "", "has a header but no rows", "at least 5 readings"]),
        (
            "no header",
            text("0,9.0\n1000,9.2\n2000,9.4\n3000,9.6\n4000,9.8\n"),
            [": header = column 1", "unknown column", "known columns: specimen, cycles", "line 1: 0 | 9.0"],
        ),
        (
            "one column",
            text("cycles\n0\n1000\n"),
            [":1: ", "cycles", "is not a table of 2 to 4096 columns", "at least the columns cycles and crack_length_mm"],
        ),
        (
            "unknown column",
            text("time_s,crack_length_mm,load_kn\n0,9,1\n"),
            [":1: ", "header = crack_length_mm", "no column of cycles", "known columns: specimen, cycles"],
        ),
        (
            "misspelt column",
            text("cycels,crack_length_mm\n0,9\n"),
            [":1: ", "header = cycels", "unknown column", "known columns: specimen, cycles"],
        ),
        (
            "unknown unit",
            text("cycles,crack_length_furlong\n0,9\n"),
            [":1: ", "header = crack_length_furlong", "unknown column", "crack_length_inch"],
        ),
        (
            "no unit",
            text("cycles,crack_length\n0,9\n"),
            [
                ":1: ",
                "header = crack_length",
                "has no unit",
                "name one of mm, inch, m in the header, or set measured.length_unit (--length-unit)",
            ],
        ),
        ("no length", text("specimen,cycles\nS1,0\n"), [":1: ", "header = cycles", "no column of crack length", "known columns"]),
        (
            "no cycles",
            text("specimen,crack_length_mm\nS1,9\n"),
            [":1: ", "header = crack_length_mm", "no column of cycles", "known columns"],
        ),
        (
            "two columns of a name",
            text("cycles,cycles,crack_length_mm\n0,0,9\n"),
            [":1: ", "header = cycles", "occurs twice", "its own name"],
        ),
        (
            "two columns of a meaning",
            text("cycles,kilocycles,crack_length_mm\n0,0,9\n"),
            [":1: ", "header = kilocycles", "duplicates an earlier column", "measured.columns = { cycles = \"kilocycles\" }"],
        ),
        ("a picture", b"cycles,crack_length_mm\n\x89PNG\xff\xd8\0,1\n".to_vec(), [":2: ", "", "is not text", "CSV in UTF-8"]),
        (
            "an open quote",
            text("cycles,crack_length_mm\n0,9\n\"1000,9.2\n2000,9.4\n"),
            [":3: ", "\"1000,9.2", "has 1 column", "one value a column"],
        ),
        ("wide without unit", text("cycles,A1,A2\n0,9,9\n"), [":1: ", "header = A1", "has no unit", "measured.length_unit"]),
        (
            "wide with falling cycles",
            text("crack_length_mm,A1,A2\n9,0,0\n10,50,60\n11,40,70\n"),
            [":4: ", "A1 = 40", "is below the previous reading (50)", "sort"],
        ),
    ]
}

#[test]
fn every_broken_curve_is_refused_with_place_value_and_remedy() {
    let folder = tempdir().unwrap();
    fs::write(folder.path().join("panel.toml"), PANEL).unwrap();
    let cases = broken();
    assert!(cases.len() >= 20);
    for (name, bytes, words) in cases {
        let file = format!("{name}.csv");
        fs::write(folder.path().join(&file), bytes).unwrap();
        let output = perilife(folder.path(), &["rates", &file, "--specimen", "panel.toml", "--out", "rates.csv"]);
        assert_refused(&output, 2, &[&file]);
        assert_refused(&output, 2, &words);
        let (_, stderr) = texts(&output);
        // A table of unknown shape shows its first rows.
        let lines = stderr.trim_end().lines().filter(|line| !line.starts_with("  line "));
        assert_eq!(lines.count(), 1, "{name}: one message: {stderr}");
        assert!(!folder.path().join("rates.csv").exists(), "{name}: nothing half-written");
    }
}

#[test]
fn files_that_cannot_be_read_end_with_four() {
    let folder = tempdir().unwrap();
    fs::create_dir(folder.path().join("folder.csv")).unwrap();
    for file in ["missing.csv", "folder.csv", "no/such/folder/x.csv", "missing.parquet"] {
        let output = perilife(folder.path(), &["rates", file]);
        assert_refused(&output, 4, &[file, "cannot read"]);
    }
}

#[test]
fn unusual_but_right_files_are_read() {
    let folder = tempdir().unwrap();
    fs::write(folder.path().join("panel.toml"), PANEL).unwrap();
    let plain = format!("{HEADER}{ROWS}S1,4000,9.9\n");
    let crlf = plain.replace('\n', "\r\n");
    let decimal_comma = plain.replace(',', ";").replace('.', ",");
    let bom = format!("\u{feff}{plain}");
    let together = format!("\u{feff}{}", decimal_comma.replace('\n', "\r\n"));
    let rates = |name: &str, text: &str| {
        fs::write(folder.path().join(name), text).unwrap();
        let output = perilife(folder.path(), &["rates", name, "--specimen", "panel.toml", "--method", "secant"]);
        assert_eq!(output.status.code(), Some(0), "{name}: {}", texts(&output).1);
        texts(&output).0
    };
    let expected = rates("plain.csv", &plain);
    assert!(
        expected.starts_with(
            "specimen,cycles,crack_length_mm,delta_k_mpa_sqrt_m,da_dn_mm_per_cycle,flags,stress_ratio\nS1,500.0000000,9.1"
        ),
        "{expected}"
    );
    // 0.2 mm steps are too short by E647, the last one of 0.3 mm is not.
    assert_eq!(expected.matches("step_under_0.25_mm").count(), 3, "{expected}");
    for (name, text) in [("crlf.csv", crlf), ("comma.csv", decimal_comma), ("bom.csv", bom), ("together.csv", together)] {
        assert_eq!(rates(name, &text), expected, "{name}");
    }
}

#[test]
fn json_is_one_object_and_the_same_specimen_twice_is_refused() {
    let folder = tempdir().unwrap();
    let text = format!("{HEADER}{ROWS}S1,4000,9.9\nS1,5000,10.3\nS1,6000,10.9\n");
    ["a.csv", "b.csv"].iter().for_each(|name| fs::write(folder.path().join(name), &text).unwrap());
    let output = perilife(folder.path(), &["rates", "a.csv", "--json"]);
    let object: serde_json::Value = serde_json::from_str(&texts(&output).0).unwrap();
    assert_eq!(object["method"], "polynomial7");
    assert_eq!(object["specimens"][0]["points"].as_array().unwrap().len(), 1);
    assert!(object["specimens"][0]["points"][0]["delta_k_mpa_sqrt_m"].is_null(), "no specimen, no ΔK");
    assert_refused(&perilife(folder.path(), &["rates", "a.csv", "b.csv"]), 2, &["b.csv:2", "specimen = S1", "a.csv", "own name"]);
}
