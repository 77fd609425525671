//! What is committed against what the program predicts now: the page of published tests, boundaries, time beside finite elements.

use std::collections::BTreeMap;
use std::fs;
use std::process::Command;
use std::time::Instant;

use perilife_base::limits;
use perilife_growth::predict::Silent;
use perilife_study::chart::scenes;
use perilife_study::stability::{Effort, run, sweeps};
use perilife_study::validate::{page, rows, sets};
use serde_json::Value;

// The page of published tests against what the program predicts now.

/// Share by which a ratio may move before the page is written again.
const MOVED: f64 = 0.01;
/// Coverage of the 90 % band over random halves of the 34 panels.
const COVERAGE: [f64; 2] = [0.86, 0.94];

/// Figures of a page that may not move: set and test to the ratio and the distances of a path, mm.
fn figures(page: &str) -> BTreeMap<String, Vec<f64>> {
    let rows = page.lines().map(|line| line.split('|').map(str::trim).collect::<Vec<&str>>());
    let rows = rows.filter(|cells| cells.len() == 14 && cells[1] != "set" && !cells[1].starts_with('-'));
    let figures = |cells: Vec<&str>| {
        let figures = [cells[5], cells[9]].join(", ");
        (cells[1..3].join(", "), figures.split(", ").filter_map(|figure| figure.parse().ok()).collect())
    };
    rows.map(figures).collect()
}

#[test]
fn the_page_of_published_tests_has_the_ratios_of_today() {
    let sets = sets(&[]).unwrap();
    let rows = rows(&sets, &|set, rows| println!("{}", page::lines(set, rows)));
    let failed: Vec<&String> = rows.iter().filter_map(|row| row.failure.as_ref()).collect();
    assert!(failed.is_empty(), "{failed:?}");
    let [written, now] =
        [fs::read_to_string("tests/VALIDATION.md").unwrap(), page::markdown(&sets, &rows)].map(|page| figures(&page));
    assert!(now.len() >= sets.len() && now.keys().eq(written.keys()), "{now:?} for {written:?}");
    for (test, was) in &written {
        assert!(!was.is_empty() && was.len() == now[test].len(), "{test}: {was:?}");
        // Figures of the page are rounded: to 0.001.
        let moved = |(was, now): (&f64, &f64)| (now - was).abs() > MOVED * was + 5e-4;
        let is_old = was.iter().zip(&now[test]).any(moved);
        assert!(
            !is_old,
            "{test}: {:?}, on the page {was:?}; `perilife validate --markdown tests/VALIDATION.md` writes it",
            now[test]
        );
    }
    let object = page::object(&rows);
    let halves: &Value = object["rows"].as_array().unwrap().iter().find(|row| row["set"] == "virkler_panels").unwrap();
    assert_eq!(halves["lives_measured"], 30 * 17);
    let coverage = halves["lives_inside"].as_f64().unwrap() / 510.0;
    assert!((COVERAGE[0]..=COVERAGE[1]).contains(&coverage), "coverage {coverage}");
}

// The committed boundaries are those of this program: a fresh quick run finds them again.

/// Sweeps that take seconds, of several methods each: of which ends, all of them together at least.
const QUICK: ([&str; 1], usize) = (["crack_length"], 1);
const LONG: ([&str; 4], usize) = (["ligament", "density_factor", "influence_radius", "time_step"], 3);
/// The quick run narrows an end to 20 %, from between fewer values.
const APART: f64 = 0.25;

fn check<const N: usize>((names, ends_least): ([&str; N], usize)) {
    let chosen = sweeps(&names.map(str::to_owned)).unwrap();
    let records = run(&chosen, Effort::QUICK, &|_| ());
    let mut ends = 0;
    for record in &records {
        let limit = limits::of(&record.sweep.name, record.method).expect("a row of every method");
        let name = format!("{} by {}", record.sweep.name, record.method);
        assert_eq!(record.is_safe, limit.is_safe, "{name}");
        for (fresh, committed) in record.ends.into_iter().zip(limit.ends) {
            assert_eq!(fresh.is_some(), committed.is_some(), "{name}: {fresh:?} and {committed:?}");
            if let (Some(fresh), Some(committed)) = (fresh, committed) {
                assert!((fresh / committed - 1.0).abs() < APART, "{name}: {fresh} and {committed}");
                ends += 1;
            }
        }
    }
    assert!(ends >= ends_least, "{ends}");
}

#[test]
fn a_fresh_run_finds_the_committed_boundaries() {
    check(QUICK);
}

#[test]
#[ignore = "long: a minute"]
fn a_fresh_run_finds_more_committed_boundaries() {
    check(LONG);
}

// Time and error of the remeshing finite elements of `tests/reference` beside this program, on the same machine in the same call.

/// Plates of the reference, and their scenes in the chart.
const PLATES: [(&str, &str); 2] = [("slant_severance", "slant_severance"), ("hole_attracts", "hole_entered")];

#[test]
#[ignore = "long: five minutes, needs Python with tests/reference/requirements.txt: PERILIFE_PYTHON=python cargo test rivals -- --ignored --nocapture"]
fn finite_elements_take_longer_for_the_same_error() {
    let python = std::env::var("PERILIFE_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/reference/rival.py");
    println!("{:<18} {:<28} {:>10} {:>12} {:>9} {:>9}", "plate", "method", "increments", "ms each", "wall s", "error %");
    for (plate, name) in PLATES {
        let output = Command::new(&python).args([script, plate]).output().expect("Python starts");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let runs: Vec<Value> =
            String::from_utf8_lossy(&output.stdout).lines().map(|line| serde_json::from_str(line).unwrap()).collect();
        assert_eq!(runs.len(), 3, "a run a coarseness");
        let line = |method: &str, increments: f64, wall: f64, error: f64| {
            println!("{plate:<18} {method:<28} {increments:>10} {:>12.1} {wall:>9.2} {error:>9.2}", 1e3 * wall / increments);
        };
        for run in &runs {
            let [coarse, increments, wall, error] =
                ["coarseness", "increments", "wall_s", "error_percent"].map(|key| run[key].as_f64().unwrap());
            line(&format!("finite elements, × {coarse}"), increments, wall, error);
        }
        // The finest repeats the table of the reference.
        assert!(runs[0]["error_percent"].as_f64().unwrap().abs() < 0.01, "{}", runs[0]);
        let scene = scenes(&[name.to_owned()]).unwrap()[0];
        for (method, set) in [("points", vec![]), ("nodes", vec!["model.method=element_free_galerkin".to_owned()])] {
            let started = Instant::now();
            let found = scene.found(&set, &Silent).unwrap();
            let error = found.error_percent.abs();
            line(method, found.solves as f64, started.elapsed().as_secs_f64(), error);
            // The coarsest mesh errs by some percent.
            assert!(error < runs[2]["error_percent"].as_f64().unwrap().abs(), "{plate}, {method}");
        }
    }
}
