//! The page of published tests against what the program predicts now.

use std::collections::BTreeMap;
use std::fs;

use perilife_study::validate::{page, rows, sets};
use serde_json::Value;

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
