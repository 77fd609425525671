//! The page of published tests against what the program predicts now.

use std::collections::BTreeMap;
use std::fs;

use perilife_study::validate::{Row, page, rows, sets};
use serde_json::Value;

/// Share by which a ratio may move before the page is written again.
const MOVED: f64 = 0.01;
/// Coverage of the 90 % band over random halves of the 34 panels.
const COVERAGE: [f64; 2] = [0.86, 0.94];

/// Figures of a page that may not move: set and test to the ratio, or to the distances of a path, mm.
fn figures(page: &str) -> BTreeMap<String, Vec<f64>> {
    let lines = page.lines().filter(|line| line.starts_with("| "));
    let figure = |line: &str| {
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        let (key, figure) = if cells.len() == 12 { (1..3, cells[5]) } else { (1..2, cells[2]) };
        let numbers: Vec<f64> = figure.split(", ").map_while(|number| number.parse().ok()).collect();
        let is_figure = cells.len() == 12 || cells.len() == 6 && numbers.len() == 2;
        (is_figure && !numbers.is_empty()).then(|| (cells[key].join(", "), numbers))
    };
    lines.filter_map(figure).collect()
}

#[test]
fn the_page_of_published_tests_has_the_ratios_of_today() {
    let sets = sets(&[]).unwrap();
    let rows = rows(&sets, &|set, rows| println!("{}", page::lines(set, rows)));
    let failed: Vec<String> = rows.iter().filter_map(Row::failure).collect();
    assert!(failed.is_empty(), "{failed:?}");
    let [written, now] =
        [fs::read_to_string("tests/VALIDATION.md").unwrap(), page::markdown(&sets, &rows)].map(|page| figures(&page));
    assert!(now.len() >= sets.len() && now.keys().eq(written.keys()), "{now:?} for {written:?}");
    for (test, was) in &written {
        // Figures of the page are rounded.
        let moved = |(was, now): (&f64, &f64)| (now - was).abs() > MOVED * was + 5e-4;
        let is_old = was.iter().zip(&now[test]).any(moved);
        assert!(
            !is_old,
            "{test}: {:?}, on the page {was:?}; `perilife validate --markdown tests/VALIDATION.md` writes it",
            now[test]
        );
    }
    let object = page::object(&rows);
    let halves: Vec<&Value> = object["rows"].as_array().unwrap().iter().filter(|row| !row["crps_percent"].is_null()).collect();
    assert_eq!(halves.len(), 1);
    let coverage = halves[0]["lives_inside"].as_f64().unwrap() / halves[0]["lives_measured"].as_f64().unwrap();
    assert!((COVERAGE[0]..=COVERAGE[1]).contains(&coverage), "coverage {coverage}");
}
