//! Tables and cases as users brought them, through the command line: the right figure, or the cause by name (shared data).

use serde_json::Value;
use tempfile::tempdir;

use crate::support::desk::{done, json};
use crate::support::field;
use crate::support::shared::shared;

#[test]
fn tables_of_practice_give_the_right_figure_or_the_cause() {
    field::hold_rows("practice4", "practice4");
}

#[test]
fn constants_of_all_lie_within_those_of_the_specimens() {
    for case in ["sparse_readings/ct.toml", "sparse_readings/two.toml", "same_cycles/twelve.toml"] {
        let Some(case) = shared(&format!("field/practice4/{case}")) else { return };
        let own = tempdir().unwrap();
        done(own.path(), &["calibrate", case.canonicalize().unwrap().to_str().unwrap(), "--out", "out"]);
        let fit = json(own.path().join("out/fit.json"));
        let of = |specimen: &Value| specimen["p"].as_f64().unwrap();
        let all: Vec<f64> = fit["specimens"].as_array().unwrap().iter().map(of).collect();
        let (low, high) = (all.iter().copied().fold(f64::INFINITY, f64::min), all.iter().copied().fold(0.0, f64::max));
        assert!(all.len() > 1 && (low - 1e-3..=high + 1e-3).contains(&of(&fit)), "{case:?}: {all:?}, all {}", of(&fit));
    }
}
