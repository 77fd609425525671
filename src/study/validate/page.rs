//! Rows of a validation as text, CSV, JSON and as a document.

use std::collections::BTreeMap;

use serde::Serialize;
use serde_json::{Value, json};

use super::{Row, Set, mean};
use crate::verification::{cell, four_digits};
use perilife_base::cells::field;

/// What the page ends with: kinds that no built-in set tests.
const UNTESTED: &str = include_str!("../../../data/validation/untested.md");

/// Tests of a kind, of several predictions those of one variant.
#[derive(Default, Serialize)]
struct Group {
    group: String,
    tests: usize,
    ratio_geometric_mean: f64,
    /// exp(s), s the standard deviation of ln ratio.
    scatter_factor: Option<f64>,
    /// Measured lives within their bands.
    lives_inside: usize,
    lives_with_band: usize,
}

/// The groups of tests with a life.
fn groups(rows: &[Row]) -> Vec<Group> {
    let mut groups: BTreeMap<String, Vec<&Row>> = BTreeMap::new();
    for row in rows.iter().filter(|row| row.ratio.is_some()) {
        let variant = row.variant.as_ref().map(|of| format!(": {of}")).unwrap_or_default();
        groups.entry(row.kind.replace('_', " ") + &variant).or_default().push(row);
    }
    let group = |(group, own): (String, Vec<&Row>)| {
        let ratios: Vec<f64> = own.iter().filter_map(|row| row.ratio).collect();
        let (mean, tests) = (mean(&ratios), own.len());
        let square: f64 = ratios.iter().map(|ratio| (ratio / mean).ln().powi(2)).sum();
        let with_band = || own.iter().filter(|row| row.lives_inside.is_some());
        Group {
            group,
            tests,
            ratio_geometric_mean: mean,
            scatter_factor: (tests > 1).then(|| (square / (tests as f64 - 1.0)).sqrt().exp()),
            lives_inside: with_band().filter_map(|row| row.lives_inside).sum(),
            lives_with_band: with_band().map(|row| row.lives_measured).sum(),
        }
    };
    groups.into_iter().map(group).collect()
}

/// A set with its rows on the console.
pub fn lines(set: &Set, rows: &[Row]) -> String {
    let line = |row: &Row| format!("\n  {}", cells(row).join("  "));
    set.about.title.clone() + &rows.iter().map(line).collect::<String>()
}

/// All rows and groups as one object.
pub fn object(rows: &[Row]) -> Value {
    json!({ "rows": rows, "groups": groups(rows) })
}

/// All rows as CSV, one header line.
pub fn csv(rows: &[Row]) -> String {
    let text = |value: &Value| match value {
        Value::Null => String::new(),
        Value::String(text) => field(text),
        number => number.to_string(),
    };
    let fields = |row: &Row| json!(row).as_object().cloned().unwrap_or_default();
    let head = fields(&Row::default()).keys().cloned().collect::<Vec<String>>().join(",");
    let line = |row: &Row| format!("\n{}", fields(row).values().map(text).collect::<Vec<_>>().join(","));
    head + &rows.iter().map(line).collect::<String>() + "\n"
}

/// The validation as a document, with few digits.
pub fn markdown(sets: &[Set], rows: &[Row]) -> String {
    let mut page = "# Validation\n\nWritten by `perilife validate --markdown`: lives and paths of published tests beside those that the program predicts. \
         The ratio is\npredicted over measured life (below 1: conservative); the scatter factor is exp(s), s the standard deviation of ln ratio; \
         the band is\n5 % to 95 % of specimens. Sources, assumptions and uncertainties are below; inputs are in `data/validation`.\n\n\
         | kind of test | tests | geometric mean of the ratio | scatter factor | lives in the band |\n|---|---|---|---|---|\n"
        .to_owned();
    for Group { group, tests, ratio_geometric_mean, scatter_factor, lives_inside, lives_with_band } in groups(rows) {
        let scatter = shown(scatter_factor, |factor| format!("{factor:.2}"));
        let inside = if lives_with_band > 0 { format!("{lives_inside} of {lives_with_band}") } else { "-".to_owned() };
        page += &format!("| {} | {tests} | {ratio_geometric_mean:.3} | {scatter} | {inside} |\n", cell(&group));
    }
    page += "\n## Tests\n\n| set | test | measured | predicted | ratio | band | in the band | CRPS, % of life | \
             path, mean and largest distance, mm | error stated, % | model | others |\n|---|---|---|---|---|---|---|---|---|---|---|---|\n";
    rows.iter().for_each(|row| page += &format!("| {} |\n", cells(row).map(|text| cell(&text)).join(" | ")));
    page += "\n## Sources\n";
    for Set { name, about, .. } in sets {
        page += &format!("\n### {name}\n\n{}. {}.\n\n", about.title, about.reference);
        let said = [("Numbers", &about.obtained), ("Assumed", &about.assumed), ("Uncertainty", &about.uncertainty)];
        let said = said.into_iter().chain([("Licence", &about.licence)]).chain(about.remark.iter().map(|text| ("Remark", text)));
        said.for_each(|(what, text)| page += &format!("- {what}: {text}\n"));
    }
    page + "\n" + UNTESTED
}

/// A row in words: of its variant, or its kind where there is one prediction.
fn cells(row: &Row) -> [String; 12] {
    let digits = |value: Option<f64>| shown(value, four_digits);
    let ratio = row.others_ratio.map(|ratio| format!(" (ratio {ratio:.3})")).unwrap_or_default();
    let predicted = row.failure.as_ref().map(|why| format!("failed: {why}")).unwrap_or_else(|| digits(row.predicted));
    [
        row.set.clone(),
        row.variant.clone().unwrap_or_else(|| row.kind.replace('_', " ")),
        shown(row.measured, |life| format!("{} {}", four_digits(life), row.unit)),
        predicted,
        shown(row.ratio, |ratio| format!("{ratio:.3}")),
        shown(row.predicted_p05, |low| format!("{} to {}", four_digits(low), digits(row.predicted_p95))),
        shown(row.lives_inside, |inside| format!("{inside} of {}", row.lives_measured)),
        shown(row.crps_percent, |score| format!("{score:.2}")),
        shown(row.path_mean_mm, |mean| format!("{mean:.2}, {}", shown(row.path_largest_mm, |most| format!("{most:.2}")))),
        shown(row.error_estimate_percent, |error| format!("{error:.1}")),
        shown(row.model.clone(), |model| model),
        shown(row.others.clone(), |others| others + &ratio),
    ]
}

fn shown<T>(value: Option<T>, words: impl FnOnce(T) -> String) -> String {
    value.map_or_else(|| "-".to_owned(), words)
}
