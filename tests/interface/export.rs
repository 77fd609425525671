//! `perilife export` on a fabricated run.

use std::fs;
use std::path::Path;

use tempfile::{TempDir, tempdir};

use crate::interface::cli::{assert_refused, perilife};
use crate::support::desk::done;
use crate::support::{made_up_case, made_up_run};
use perilife_results::curve::{self, Row, cycles_over_length};

/// A folder with the made-up run in `run/`.
fn fabricated() -> TempDir {
    let dir = tempdir().unwrap();
    fs::create_dir(dir.path().join("run")).unwrap();
    fs::write(dir.path().join("run/a_n.csv"), curve::a_n(&made_up_case::case(), &made_up_run::prediction(0.0), None).csv())
        .unwrap();
    dir
}

fn rows(folder: &Path, file: &str) -> Vec<Row> {
    curve::read_a_n(&folder.join(file)).unwrap()
}

#[test]
fn an_export_keeps_both_ends_and_lies_on_the_curve() {
    let dir = fabricated();
    let run = rows(dir.path(), "run/a_n.csv");
    for count in [2, 3, 200, 5000] {
        done(dir.path(), &["export", "run", "--points", &count.to_string(), "--out", "e.csv"]);
        let text = fs::read_to_string(dir.path().join("e.csv")).unwrap();
        assert_eq!(text.lines().next(), Some("cycles,crack_length_mm,delta_k_mpa_sqrt_m,da_dn_mm_per_cycle"));
        let export = rows(dir.path(), "e.csv");
        assert_eq!((export.len(), export[0], export[count - 1]), (count, run[0], run[run.len() - 1]));
        let step = (run[run.len() - 1].cycles - run[0].cycles) / (count - 1) as f64;
        for (i, row) in export.iter().enumerate() {
            assert!((row.cycles - step * i as f64).abs() <= 1e-6 * step);
            // On the cubic between the neighbouring rows of the run.
            let on_curve = cycles_over_length(&run).at(row.crack_length_mm);
            assert!((on_curve - row.cycles).abs() < 1e-9 * run[run.len() - 1].cycles, "row {i}: {on_curve} and {}", row.cycles);
        }
        assert!(export.windows(2).all(|pair| pair[0].crack_length_mm <= pair[1].crack_length_mm));
    }
}

#[test]
fn an_export_can_step_in_cycles() {
    let dir = fabricated();
    let last = rows(dir.path(), "run/a_n.csv").pop().unwrap();
    done(dir.path(), "export run --every-cycles 100000 --out e.csv");
    let export = rows(dir.path(), "e.csv");
    assert_eq!(export.len(), 2 + (last.cycles / 1e5).floor() as usize);
    let (stdout, _) = done(dir.path(), "export run --points 7 --out e3.csv --json");
    let object: serde_json::Value = serde_json::from_str(&stdout).unwrap();
    assert_eq!((&object["rows"], &object["file"]), (&7.into(), &"e3.csv".into()));
    assert_eq!(export[3].cycles, 3e5);
    assert_eq!(export.last(), Some(&last));
    for step in ["0", "-5", "nan", "inf", "1e-9"] {
        let argument = format!("--every-cycles={step}");
        assert_refused(&perilife(dir.path(), &format!("export run {argument} --out e2.csv")), 2, &["--every-cycles"]);
    }
    assert!(!dir.path().join("e2.csv").exists());
}

#[test]
fn rows_at_the_same_cycles_and_unknown_values_are_taken_as_they_are() {
    let dir = tempdir().unwrap();
    let table = "cycles,crack_length_mm,delta_k_mpa_sqrt_m,da_dn_mm_per_cycle\n0,9,,\n0,10,8,1e-5\n50,11,9,2e-5\n50,12,,\n100,14,10,3e-5\n";
    fs::write(dir.path().join("a_n.csv"), table).unwrap();
    done(dir.path(), "export . --points 5 --out e.csv");
    let export = rows(dir.path(), "e.csv");
    let lengths: Vec<f64> = export.iter().map(|row| row.crack_length_mm).collect();
    assert_eq!(lengths, [9.0, 10.5, 12.0, 13.0, 14.0]);
    let unknown: Vec<bool> = export.iter().map(|row| row.delta_k_mpa_sqrt_m.is_nan()).collect();
    assert_eq!(unknown, [true, false, true, true, false]);
    // A run whose life is zero has one moment only.
    fs::write(dir.path().join("a_n.csv"), table.lines().take(2).collect::<Vec<_>>().join("\n")).unwrap();
    done(dir.path(), "export . --out e.csv");
    assert_eq!(rows(dir.path(), "e.csv").len(), 1);
}

#[test]
fn what_cannot_be_exported_is_refused_with_words() {
    let dir = fabricated();
    fs::create_dir(dir.path().join("empty")).unwrap();
    fs::create_dir(dir.path().join("fit")).unwrap();
    fs::write(dir.path().join("fit/fitted.toml"), "").unwrap();
    let refused: [(&str, &str, i32, &[&str]); 3] = [
        ("empty", "e.csv", 2, &["empty", "a_n.csv is missing", "perilife predict"]),
        ("fit", "e.csv", 2, &["fit", "inside this calibration"]),
        ("run", "missing/e.csv", 4, &["missing/e.csv", "cannot write"]),
    ];
    for (run, out, code, words) in refused {
        assert_refused(&perilife(dir.path(), &format!("export {run} --out {out}")), code, words);
    }
    assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 3, "nothing new stands there");
}

/// A device is written to as it is, so a curve can go down a pipe without a summary in between.
#[test]
fn a_device_is_written_to_as_it_is() {
    let dir = fabricated();
    let (stdout, _) = done(dir.path(), "export run --points 2 --out /dev/stdout");
    assert_eq!(stdout.lines().count(), 3, "{stdout}");
}
