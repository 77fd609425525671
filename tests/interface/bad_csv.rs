//! Broken measured curves: every one ends with words that name file, line, column, value and what would be right.

use std::fs;

use tempfile::tempdir;

use super::cli::{assert_refused, perilife, texts};

use crate::support::desk::{desk, done};
use crate::support::rows::rows;

/// A panel of half width 76.2 mm.
const PANEL: &str = "[specimen]\nkind = \"middle_tension\"\nwidth_mm = 152.4\nlength_mm = 300\nthickness_mm = 2.54\ncrack_length_mm = 9\n\
                     [material]\nname = \"al2024-t3\"\n[loading]\nkind = \"constant_amplitude\"\nstress_range_mpa = 48.28\nstress_ratio = 0.2\n";

const HEADER: &str = "specimen,cycles,crack_length_mm\n";

/// Four good rows, so that a fifth decides.
const ROWS: &str = "S1,0,9.0\nS1,1000,9.2\nS1,2000,9.4\nS1,3000,9.6\n";

#[test]
fn every_broken_curve_is_refused_with_place_value_and_remedy() {
    let folder = desk(&[("panel.toml", &PANEL)]);
    let text = rows::<Vec<(String, String, [String; 4])>>("bad_csv", "broken").into_iter();
    let picture = b"cycles,crack_length_mm\n\x89PNG\xff\xd8\0,1\n".to_vec();
    let picture = ("a picture".to_owned(), picture, [":2: ", "", "is not text", "CSV in UTF-8"].map(str::to_owned));
    for (name, bytes, words) in text.map(|(name, text, words)| (name, text.into_bytes(), words)).chain([picture]) {
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
    let folder = desk(&[("panel.toml", &PANEL)]);
    let plain = format!("{HEADER}{ROWS}S1,4000,9.9\n");
    let crlf = plain.replace('\n', "\r\n");
    let decimal_comma = plain.replace(',', ";").replace('.', ",");
    let bom = format!("\u{feff}{plain}");
    let together = format!("\u{feff}{}", decimal_comma.replace('\n', "\r\n"));
    let rates = |name: &str, text: &str| {
        fs::write(folder.path().join(name), text).unwrap();
        let (stdout, _) = done(folder.path(), &["rates", name, "--specimen", "panel.toml", "--method", "secant"]);
        stdout
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
