//! `--units us`: every file and every printed line against the same run in metric units.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use perilife_base::units::us::{System, renamed};
use perilife_results::curve::read_a_n;
use serde_json::Value;
use tempfile::tempdir;

use crate::support::desk::done;

/// Names without a unit: counts, cycles, shares, ratios and exponents. A number under any other name without one would be a length, a stress or the
/// like that nobody converts.
const WITHOUT_UNIT: &str = "aspect_ratio_final back_face_strain beta blocks bonds broken_bonds compared correlation covariance crack cycles \
    cycles_at_break_through cycles_fitted cycles_high cycles_low cycles_measured depth_over_thickness direction \
    effect_percent error_estimate_percent error_percent evaluations flags freedom horizon_ratio k_error_percent \
    largest_difference_percent lattice_angle_deg left_out life_cycles life_cycles_if_k_is_larger life_cycles_if_k_is_smaller \
    life_fitted life_measured life_share life_share_extrapolated life_share_too_large marks method misfit over_crack \
    over_horizon over_ligament over_thickness own p p_error paris_m paris_m_error passes points points_solved range \
    rate_at_pivot_relative_error rate_over_law_percent reading readings rms_life_error robust_paris_m shape shares slope \
    slope_of_readings solver_iterations solves specimen specimens stress_ratio tip";
/// Those of a population and of its law, SI as in `fitted.toml`, which has the same.
const OF_THE_RECORD: &str =
    "a gain increment_scatter intervals length level level_of_lives pivot restricted_likelihood scatter white";
/// Kept as they are, or of this moment.
const SKIPPED: &str = "case constants_si finished inputs memory_mb sources tables wall_s";

fn is_of(names: &str, name: &str) -> bool {
    names.split_whitespace().any(|own| own == name)
}

fn is_without_unit(name: &str) -> bool {
    is_of(WITHOUT_UNIT, name) || is_of(OF_THE_RECORD, name)
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-9 * a.abs().max(b.abs()) || a.abs().max(b.abs()) < 1e-12
}

/// A run of the program in `dir` by words; it ended well. All that it printed.
fn run(dir: &Path, call: &str) -> String {
    let (stdout, stderr) = done(dir, &call.split_whitespace().collect::<Vec<_>>());
    stdout + &stderr
}

fn no_metric_unit_in(text: &str, what: &str) {
    for word in text.split(|c: char| c.is_whitespace() || "(),;:".contains(c)) {
        assert!(!["mm", "MPa", "MPa√m", "GPa", "kN", "mm/cycle"].contains(&word), "{what}: {word} in {text}");
    }
}

/// Columns of a table by name.
fn columns(path: &Path) -> BTreeMap<String, Vec<String>> {
    let mut reader = csv::ReaderBuilder::new().has_headers(false).from_path(path).unwrap();
    let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    let column = |place: usize| (rows[0][place].to_owned(), rows[1..].iter().map(|row| row[place].to_owned()).collect());
    (0..rows[0].len()).map(column).collect()
}

/// The columns of a table in US units hold what those in metric units hold.
fn same_table(si: &Path, us: &Path) {
    let (si, us, name) = (columns(si), columns(us), us.display());
    assert_eq!(si.len(), us.len(), "{name}");
    for (column, values) in &si {
        let there = renamed(column, System::Us);
        assert!(
            there.is_some() || is_without_unit(column) || values.iter().all(|cell| cell.parse::<f64>().is_err()),
            "{name}: {column} has no unit"
        );
        let own = us.get(there.as_ref().map_or(column, |there| &there.name)).unwrap_or_else(|| panic!("{name}: {column}"));
        for (row, (a, b)) in values.iter().zip(own).enumerate() {
            let sibling = |other: &str| si.get(other)?[row].parse().ok();
            let factor = there.as_ref().map_or(1.0, |there| there.factor(sibling).unwrap());
            match (a.parse::<f64>(), b.parse::<f64>()) {
                (Ok(a), Ok(b)) => assert!(near(a * factor, b), "{name}: {column}: {a} and {b}"),
                _ => assert!(a.is_empty() == b.is_empty(), "{name}: {column}: {a} and {b}"),
            }
        }
    }
}

fn same_result(si: &Value, us: &Value, key: &str, name: &str) {
    match (si, us) {
        (Value::Object(si), Value::Object(us)) => {
            assert_eq!(si.len(), us.len(), "{name}: {key}");
            for (key, value) in si.iter().filter(|(key, _)| !is_of(SKIPPED, key)) {
                let Some(there) = renamed(key, System::Us) else {
                    same_result(value, &us[key], key, name);
                    continue;
                };
                let own = us.get(&there.name).unwrap_or_else(|| panic!("{name}: {key} in {us:?}"));
                if let Ok(factor) = there.factor(|other| si.get(other).and_then(Value::as_f64)) {
                    times(value, own, factor, &format!("{name}: {key}"));
                }
            }
        }
        (Value::Array(si), Value::Array(us)) => si.iter().zip(us).for_each(|(si, us)| same_result(si, us, key, name)),
        (Value::Number(a), Value::Number(b)) => {
            assert!(is_without_unit(key), "{name}: {key} = {a} has no unit");
            assert!(near(a.as_f64().unwrap(), b.as_f64().unwrap()), "{name}: {key}: {a} and {b}");
        }
        // Words are metric, and converted where they are shown.
        (Value::String(si), Value::String(words)) => assert_eq!(si, words, "{name}: {key}"),
        (si, us) => assert_eq!(si, us, "{name}: {key}"),
    }
}

fn times(si: &Value, us: &Value, factor: f64, name: &str) {
    match (si, us) {
        (Value::Array(si), Value::Array(us)) => si.iter().zip(us).for_each(|(si, us)| times(si, us, factor, name)),
        (Value::Number(a), Value::Number(b)) => {
            let (a, b) = (a.as_f64().unwrap() * factor, b.as_f64().unwrap());
            assert!(near(a, b), "{name}: {a} and {b}");
        }
        (si, us) => assert_eq!(si, us, "{name}"),
    }
}

/// Every file of a folder in US units against that in metric units; how many were compared.
fn same_folders(si: &Path, us: &Path) -> usize {
    let names = |folder: &Path| {
        let mut names: Vec<_> =
            fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    };
    assert_eq!(names(si), names(us));
    let read = |path: &Path| fs::read_to_string(path).unwrap();
    let mut compared = 0;
    for name in names(si) {
        let [of_si, of_us] = [si.join(&name), us.join(&name)];
        match name.rsplit_once('.').map(|(_, ending)| ending) {
            Some("csv") => same_table(&of_si, &of_us),
            Some("json") => {
                let [si, us] = [of_si, of_us].map(|path| serde_json::from_str::<Value>(&read(&path)).unwrap());
                same_result(&si, &us, "", &name);
            }
            Some("svg") => {
                let words = read(&of_us)
                    .replace('<', " <")
                    .split('>')
                    .map(|part| part.split(" <").next().unwrap().to_owned() + "\n")
                    .collect::<String>();
                no_metric_unit_in(&words, &name);
            }
            Some("txt") => {
                let first = |path: &Path| read(path).split_whitespace().next().unwrap().parse::<f64>().unwrap();
                assert!(near(first(&of_si) / 25.4, first(&of_us)), "{name}");
            }
            _ => continue,
        }
        compared += 1;
    }
    compared
}

#[test]
fn a_run_in_us_units_is_the_same_run() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/cases");
    let dir = tempdir().unwrap();
    let here = dir.path();
    for (case, flags) in [
        ("hand_calculation.toml", "--residual-strength --set material.toughness_mpa_sqrt_m=90"),
        ("corner_crack_at_hole.toml", "--set stop.at_break_through=true"),
    ] {
        let case = root.join(case).display().to_string();
        for units in ["si", "us"] {
            let printed = run(here, &format!("predict {case} --out {units} --units {units} --force {flags}"));
            if units == "us" {
                no_metric_unit_in(&printed, "predict");
            }
        }
        let compared = same_folders(&here.join("si"), &here.join("us"));
        assert!(compared >= 8, "{compared} files");
        // The input stays what it was, and each folder is read in both units.
        assert_eq!(fs::read(here.join("si/case.toml")).unwrap(), fs::read(here.join("us/case.toml")).unwrap());
        for (folder, units) in [("si", "si"), ("si", "us"), ("us", "si"), ("us", "us")] {
            let [table, page] = ["csv", "html"].map(|ending| format!("{folder}_{units}.{ending}"));
            run(here, &format!("export {folder} --points 20 --out {table} --units {units}"));
            run(here, &format!("report {folder} --out {page} --units {units}"));
        }
        same_table(&here.join("si_si.csv"), &here.join("si_us.csv"));
        // Where no units are asked for, an export has those of its run.
        for units in ["si", "us"] {
            run(here, &format!("export {units} --points 20 --out own.csv"));
            let asked = here.join(format!("{units}_{units}.csv"));
            assert_eq!(fs::read(here.join("own.csv")).unwrap(), fs::read(asked).unwrap(), "{units}");
        }
        for (own, other) in [("si_si", "us_si"), ("si_us", "us_us")] {
            let [a, b] = [own, other].map(|name| read_a_n(&here.join(format!("{name}.csv"))).unwrap());
            let same = a.iter().zip(&b).all(|(a, b)| near(a.crack_length_mm, b.crack_length_mm) && near(a.cycles, b.cycles));
            assert!(a.len() == 20 && b.len() == 20 && same, "{own} and {other}");
            // What was written in US units is rounded once: both reports say the same.
            let [of_own, page] = [own, other].map(|name| fs::read_to_string(here.join(format!("{name}.html"))).unwrap());
            let terms = |page: &str| page.split("<h2>Input</h2>").nth(1).unwrap().split("</dl>").next().unwrap().to_owned();
            assert_eq!(terms(&of_own), terms(&page), "{own} and {other}");
            let [metric, us] = ["mm/cycle", "in/cycle"].map(|unit| page.contains(unit));
            assert_eq!([metric, us], [other == "us_si", other == "us_us"], "{other}.html");
        }
    }
}

#[test]
fn other_commands_print_in_the_units_asked_for() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let dir = tempdir().unwrap();
    let here = dir.path();
    let [fit, panel] =
        ["calibration/al2024-t3/case.toml", "data/cases/hand_calculation.toml"].map(|file| root.join(file).display().to_string());
    let readings = root.join("calibration/al2024-t3/measured/virkler_median.csv").display().to_string();
    let text = fs::read_to_string(&fit).unwrap().replace("[model]\nspacing_mm = 1.0", "[model]\nmethod = \"handbook\"");
    fs::write(here.join("fit.toml"), text.replace("measured/virkler_median.csv", &readings)).unwrap();
    for (units, lengths) in [("si", "30:34:2"), ("us", "30mm:1.3385826771653544:2mm")] {
        let points = "--method ring --set model.method=\"peridynamics\" --set specimen.crack_length_mm=30";
        let all = [
            format!("calibrate fit.toml --out {units}"),
            format!("sif {panel} {points}"),
            format!("check {panel} --set model.method=\"handbook\""),
            format!("rates {readings} --specimen {panel} --out rates_{units}.csv"),
            format!("sif {panel} --sweep {lengths} --out sweep_{units}.csv --beta beta_{units}.csv"),
        ];
        let mut all = all.map(|call| run(here, &format!("{call} --units {units}"))).to_vec();
        let listed = run(here, &format!("list material --units {units}"));
        all.push(listed.lines().filter(|line| line.contains("; E ")).collect());
        if units == "us" {
            all.iter().for_each(|printed| no_metric_unit_in(printed, "printed"));
        }
    }
    assert!(same_folders(&here.join("si"), &here.join("us")) >= 7);
    for table in ["rates", "sweep", "beta"] {
        same_table(&here.join(format!("{table}_si.csv")), &here.join(format!("{table}_us.csv")));
    }
    // A fit whose figures are written in US units drives a case like any other.
    assert_eq!(fs::read(here.join("si/fitted.toml")).unwrap(), fs::read(here.join("us/fitted.toml")).unwrap());
    let inline = "paris_c_mm_per_cycle = 8.95422e-8\nparis_m = 2.874";
    fs::write(here.join("panel.toml"), fs::read_to_string(&panel).unwrap().replace(inline, "fitted = \"us/fitted.toml\""))
        .unwrap();
    let printed = run(here, "check panel.toml");
    assert!(printed.starts_with("panel.toml: valid input\n"), "{printed}");
}
