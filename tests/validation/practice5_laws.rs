//! Laws, tables of rates and readings as users brought them: the right value within what its page states, or the cause by name (shared data).

use std::fs;

use serde::Deserialize;
use serde_json::Value;

use crate::support::desk::json;
use crate::support::field;
use crate::support::rows::{assert_says, rows};

/// Arguments of a command, its exit code, words of what it says, and places in files of results with the value that is right and the relative
/// difference that its page allows.
type Row = (String, i32, Vec<String>, Vec<(String, String, f64, f64)>);

/// Commands of a kind in its folder, one after the other.
#[derive(Deserialize)]
struct Kind {
    kind: String,
    rows: Vec<Row>,
}

#[test]
fn laws_and_tables_of_practice_give_the_right_value_or_the_cause() {
    for Kind { kind, rows } in rows::<Vec<Kind>>("practice5_laws", "kinds") {
        let Some(own) = field::kind(&kind) else { return };
        for (command, exit, words, figures) in &rows {
            for folder in ["out", "out_fit"] {
                // Fits are kept for the predictions behind them.
                if command.ends_with(folder) && own.path().join(folder).is_dir() {
                    fs::remove_dir_all(own.path().join(folder)).unwrap();
                }
            }
            let (code, said) = field::command(own.path(), command);
            assert_eq!(code, *exit, "{kind}: {command}: {said}");
            assert_says(&format!("{kind}: {command}: {said}"), words);
            for (file, place, right, slack) in figures {
                let object = json(own.path().join(file));
                let value = object.pointer(place).and_then(Value::as_f64).unwrap_or(f64::NAN);
                println!("{kind}: {command}: {place} {value}, {right} is right within {slack}");
                assert!((value / right - 1.0).abs() <= *slack, "{kind}: {command}: {place} {value}, {right} is right");
            }
        }
    }
}

/// One reading says where the crack is and nothing of its rate.
#[test]
fn every_quantile_of_one_reading_is_that_of_the_lot() {
    let Some(dir) = field::kind("few_readings_of_a_plate") else { return };
    assert_eq!(field::command(dir.path(), "calibrate lot.toml --out out_fit").0, 0);
    let (_, result) = field::predicted(dir.path(), "plate.toml --measured read1.csv");
    let [own, lot] = ["/measured", "/measured/of_lot"].map(|place| result.pointer(place).unwrap());
    for quantile in ["remaining_cycles_p05", "remaining_cycles_p50", "remaining_cycles_p95"] {
        assert!(own[quantile].is_f64() && own[quantile] == lot[quantile], "{quantile}: {own}");
    }
}
