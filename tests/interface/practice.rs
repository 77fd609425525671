//! Tables and cases as users brought them, through the command line: the right figure, or the cause by name (shared data).

use std::fs;
use std::path::Path;

use serde_json::Value;
use tempfile::tempdir;

use crate::interface::cli::{perilife, texts};
use crate::support::desk::{done, json};
use crate::support::shared::shared;

/// A command in a folder of its own, and what is right.
struct Row {
    folder: &'static str,
    /// Arguments; `--out` follows where there is none.
    arguments: &'static [&'static str],
    exit: i32,
    /// Words of what is said.
    words: &'static [&'static str],
    /// Files below the folder, places in them, and values with the relative difference that is allowed.
    figures: &'static [(&'static str, &'static str, f64, f64)],
}

const M: &str = "/paris_m";
const C: &str = "/paris_c_mm_per_cycle";
const FIT: &str = "out/fit.json";
const LIFE: &str = "/life_cycles";
const RESULT: &str = "out/result.json";
const GAMMA: &str = "/constants/walker_gamma";

const ROWS: &[Row] = &[
    // Which law.
    row("best_law", &["calibrate", "knee.toml"], 0, &["walker", "misses the shape of the data"], &[(FIT, GAMMA, 0.591, 0.05)]),
    row("best_law", &["calibrate", "knee_walker.toml"], 0, &["given; paris is 53.7 higher"], &[(FIT, GAMMA, 0.591, 0.05)]),
    row("best_law", &["calibrate", "smooth.toml"], 0, &["forman law at R = 0.1"], &[]),
    row("best_law", &["calibrate", "sigmoid.toml"], 0, &["misses the shape of the data"], &[]),
    // One model of all readings.
    row("sparse_readings", &["calibrate", "ct.toml"], 0, &[], &[(FIT, M, 3.0, 1e-3), (FIT, C, 1e-8, 2e-3)]),
    row("sparse_readings", &["calibrate", "two.toml"], 0, &[], &[(FIT, M, 3.4, 1e-3), (FIT, C, 2e-8, 2e-3)]),
    row("own_loads", &["calibrate", "range.toml"], 0, &["7.93 to 27.48"], &[(FIT, M, 3.0, 1e-3)]),
    row("own_loads", &["calibrate", "factor_two.toml"], 0, &["7.93 to 26.40"], &[(FIT, M, 3.0, 1e-3)]),
    row("own_loads", &["calibrate", "partly.toml"], 0, &[], &[(FIT, M, 3.0, 1e-3)]),
    row("same_cycles", &["calibrate", "twelve.toml"], 0, &["10.82 to 28.28"], &[(FIT, M, 3.2, 1e-3)]),
    row("same_name", &["calibrate", "case.toml"], 0, &["2 specimens)"], &[(FIT, M, 3.0, 1e-3)]),
    // Understood, and held against the case.
    row(
        "ratio_column",
        &["calibrate", "r05.toml"],
        0,
        &["R = 0.5, the R of the readings"],
        &[(FIT, C, 3e-8, 2e-3), (FIT, "/test/stress_ratio", 0.5, 1e-9)],
    ),
    row("ratio_column", &["calibrate", "pmin.toml"], 2, &["Pmin (kN) = 18", "3.6"], &[]),
    row("ratio_column", &["calibrate", "delta_k.toml"], 2, &["Delta K", "by the case"], &[]),
    // Units.
    row("law_units", &["predict", "table_in_m.toml"], 0, &["the rate at ΔK = 10 MPa√m is 4.7"], &[]),
    row("law_units", &["predict", "forman_in_m.toml"], 0, &["the rate at ΔK = 10 MPa√m is 7.8"], &[]),
    row("law_units", &["calibrate", "rates_in_m.toml"], 2, &["implausible growth law"], &[]),
    row("law_units", &["calibrate", "paris_in_m.toml"], 2, &["implausible growth law"], &[]),
    row("rate_tables", &["calibrate", "labs.toml"], 0, &["MPa sqrt(m)"], &[(FIT, "/constants/paris_m", 3.2, 1e-3)]),
    row("rate_tables", &["calibrate", "us.toml"], 0, &["ksi sqrt(in)"], &[(FIT, "/constants/paris_c_mm_per_cycle", 3e-8, 1e-3)]),
    row("rate_tables", &["calibrate", "semi.toml"], 0, &[], &[(FIT, "/constants/paris_c_mm_per_cycle", 3e-8, 1e-3)]),
    // Another stress ratio.
    row("table_other_ratio", &["predict", "r0_at_05.toml"], 2, &["walker_gamma"], &[]),
    row(
        "table_other_ratio",
        &["predict", "r0_at_05.toml", "--set", "fatigue.walker_gamma=0.6"],
        0,
        &[],
        &[(RESULT, LIFE, 226_610.0, 1e-4)],
    ),
    row("table_other_ratio", &["predict", "unnamed_at_05.toml"], 0, &["has no stress ratio"], &[]),
    row("negative_ratio", &["calibrate", "three.toml"], 2, &["delta_k = \"full\""], &[]),
    row("negative_ratio", &["calibrate", "three.toml", "--set", "measured.delta_k=full"], 0, &[], &[(FIT, GAMMA, 0.6, 0.05)]),
    // Beyond the end.
    row("fracture_reading", &["calibrate", "ct.toml"], 0, &["line 26", "at fracture"], &[(FIT, M, 3.0, 1e-3)]),
    row("fracture_reading", &["calibrate", "mt.toml"], 0, &["49.95 mm", "at fracture"], &[(FIT, M, 3.0, 1e-3)]),
    row("run_out", &["predict", "run_out.toml"], 0, &["life ≥ 40 000"], &[]),
    row("unlimited_lives", &["sweep", "eifs.toml"], 0, &["95 % unlimited", "138 (46 %)"], &[]),
    // What is wrong.
    row("typing_error", &["calibrate", "tens.toml"], 0, &["line 12", "27.5 mm"], &[(FIT, M, 3.0, 1e-3)]),
    row("noise", &["calibrate", "n05.toml"], 0, &[], &[(FIT, M, 3.05, 0.02)]),
    row("digitised", &["rates", "beside.csv"], 0, &["\n2,"], &[]),
    row(
        "digitised",
        &["rates", "comma_blank.csv", "--column", "cycles=1", "--column", "length=2", "--length-unit", "mm"],
        0,
        &["comma_blank,61013"],
        &[],
    ),
];

const fn row(
    folder: &'static str,
    arguments: &'static [&'static str],
    exit: i32,
    words: &'static [&'static str],
    figures: &'static [(&'static str, &'static str, f64, f64)],
) -> Row {
    Row { folder, arguments, exit, words, figures }
}

/// A folder with all that is in it.
pub fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap().map(Result::unwrap) {
        let target = to.join(entry.file_name());
        if entry.path().is_dir() { copy(&entry.path(), &target) } else { fs::copy(entry.path(), target).map(drop).unwrap() }
    }
}

#[test]
fn tables_of_practice_give_the_right_figure_or_the_cause() {
    let Some(readme) = shared("field/practice4/README.md") else { return };
    for Row { folder, arguments, exit, words, figures } in ROWS {
        let own = tempdir().unwrap();
        copy(&readme.parent().unwrap().join(folder), own.path());
        let writes: &[&str] = if arguments[0] == "rates" { &[] } else { &["--out", "out", "-v"] };
        let output = perilife(own.path(), &[*arguments, writes].concat());
        let (stdout, stderr) = texts(&output);
        let said = format!("{stdout}{stderr}");
        assert_eq!(output.status.code(), Some(*exit), "{folder} {arguments:?}: {said}");
        for words in *words {
            assert!(said.contains(words), "{folder} {arguments:?}: {words} in {said}");
        }
        for (file, place, right, slack) in *figures {
            let object = json(own.path().join(file));
            let value = object.pointer(place).and_then(Value::as_f64).unwrap_or(f64::NAN);
            assert!((value / right - 1.0).abs() <= *slack, "{folder} {arguments:?}: {place} {value}, {right} is right");
        }
    }
}

#[test]
fn constants_of_all_lie_within_those_of_the_specimens() {
    let Some(readme) = shared("field/practice4/README.md") else { return };
    for (folder, file) in [("sparse_readings", "ct.toml"), ("sparse_readings", "two.toml"), ("same_cycles", "twelve.toml")] {
        let own = tempdir().unwrap();
        let from = readme.parent().unwrap().join(folder);
        done(&from, &["calibrate", file, "--out", own.path().join("out").to_str().unwrap()]);
        let fit = json(own.path().join(FIT));
        let of = |specimen: &Value| specimen["p"].as_f64().unwrap();
        let all: Vec<f64> = fit["specimens"].as_array().unwrap().iter().map(of).collect();
        let (low, high) = (all.iter().copied().fold(f64::INFINITY, f64::min), all.iter().copied().fold(0.0, f64::max));
        assert!(all.len() > 1 && (low - 1e-3..=high + 1e-3).contains(&of(&fit)), "{folder}/{file}: {all:?}, all {}", of(&fit));
    }
}
