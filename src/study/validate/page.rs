//! Rows of a validation as text, CSV, JSON and as a document.

use std::collections::BTreeMap;

use serde::Serialize;
use serde_json::{Value, json};

use super::{Kind, Row, Set, mean};
use crate::verification::{cell, four_digits};
use perilife_base::cells::field;
use perilife_results::axis::Axis;
use perilife_results::chart::{COLOURS, Frame, INK, LARGE, Mark, NOTE, Size};

/// What the page ends with: kinds that no built-in set tests.
const UNTESTED: &str = include_str!("../../../data/validation/untested.md");

const HEADS: [&str; 12] = [
    "set", "test", "measured", "predicted", "ratio", "band", "in the band", "CRPS, %", "path: mean, largest distance, mm",
    "error stated, %", "model", "others",
];

/// Tests of a kind that have a life, of several predictions those of one variant.
#[derive(Serialize)]
struct Group {
    group: String,
    tests: usize,
    ratio_geometric_mean: f64,
    /// exp(s), s the standard deviation of ln ratio.
    scatter_factor: Option<f64>,
    lives_inside: usize,
    lives_with_band: usize,
}

fn groups(rows: &[Row]) -> Vec<Group> {
    let mut groups: BTreeMap<String, Vec<(f64, &Row)>> = BTreeMap::new();
    for (ratio, row) in rows.iter().filter_map(|row| Some((row.ratio?, row))) {
        let variant = row.variant.as_ref().map(|of| format!(": {of}")).unwrap_or_default();
        groups.entry(row.kind.replace('_', " ") + &variant).or_default().push((ratio, row));
    }
    let group = |(group, own): (String, Vec<(f64, &Row)>)| {
        let (mean, tests) = (mean(&own.iter().map(|(ratio, _)| *ratio).collect::<Vec<_>>()), own.len());
        let square: f64 = own.iter().map(|(ratio, _)| (ratio / mean).ln().powi(2)).sum();
        let scatter_factor = (tests > 1).then(|| (square / (tests as f64 - 1.0)).sqrt().exp());
        let with_band = || own.iter().filter_map(|(_, row)| Some([row.lives_inside?, row.lives_measured]));
        let [lives_inside, lives_with_band] = [0, 1].map(|place| with_band().map(|lives| lives[place]).sum());
        Group { group, tests, ratio_geometric_mean: mean, scatter_factor, lives_inside, lives_with_band }
    };
    groups.into_iter().map(group).collect()
}

/// A set with its rows on the console, without what is not known.
pub fn lines(set: &Set, rows: &[Row]) -> String {
    let line = |row: &Row| {
        let cells = cells(row);
        let figures = HEADS.iter().zip(&cells).skip(2).take(7).filter(|(_, figure)| *figure != "-");
        let figures: Vec<String> = figures.map(|(head, figure)| format!("{head} {figure}")).collect();
        format!("\n  {:<20} {:<32} {}", cells[0], cells[1], figures.join("; "))
    };
    set.about.title.clone() + &rows.iter().map(line).collect::<String>()
}

pub fn object(rows: &[Row]) -> Value {
    json!({ "rows": rows, "groups": groups(rows) })
}

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
    let mut page = "# Validation\n\nWritten by `perilife validate --markdown`: predicted lives and paths against published \
                    tests. \
         The ratio is\npredicted over measured life (below 1: conservative); the scatter factor is exp(s), s the standard deviation of ln ratio; \
         the band is\n5 % to 95 % of specimens; the CRPS (continuous ranked probability score) is in percent of the life. Sources, assumptions and uncertainties are below; inputs are in\n`data/validation`.\n\n\
         | kind of test | tests | geometric mean of the ratio | scatter factor | lives in the band |\n|---|---|---|---|---|\n"
        .to_owned();
    for Group { group, tests, ratio_geometric_mean, scatter_factor, lives_inside, lives_with_band } in groups(rows) {
        let scatter = shown(scatter_factor, |factor| format!("{factor:.2}"));
        let inside = if lives_with_band > 0 { format!("{lives_inside} of {lives_with_band}") } else { "-".to_owned() };
        page += &format!("| {} | {tests} | {ratio_geometric_mean:.3} | {scatter} | {inside} |\n", cell(&group));
    }
    page += &format!("\n## Tests\n\n| {} |\n{}|\n", HEADS.join(" | "), "|---".repeat(HEADS.len()));
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
fn cells(row: &Row) -> [String; HEADS.len()] {
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
        shown(row.path_mean_mm, |mean| format!("{mean:.3}, {}", shown(row.path_largest_mm, |most| format!("{most:.3}")))),
        shown(row.error_estimate_percent, |error| format!("{error:.1}")),
        shown(row.model.clone(), |model| model),
        shown(row.others.clone(), |others| others + &ratio),
    ]
}

fn shown<T>(value: Option<T>, words: impl FnOnce(T) -> String) -> String {
    value.map_or_else(|| "-".to_owned(), words)
}

pub fn svg(rows: &[Row]) -> String {
    let of = |kind: Kind| rows.iter().filter(move |row| row.kind == kind.name() && row.ratio.is_some());
    let kinds: Vec<(Kind, &str)> =
        Kind::all().filter(|kind| of(*kind).next().is_some()).zip(COLOURS.iter().copied().cycle()).collect();
    let names: Vec<String> = kinds.iter().map(|(kind, _)| kind.name().replace('_', " ")).collect();
    let mut legend: Vec<(Mark, &str, &str)> =
        kinds.iter().zip(&names).map(|((_, colour), name)| (Mark::Dots, *colour, &**name)).collect();
    legend.push((Mark::Dashes, NOTE, "factor 2"));
    let lives = || rows.iter().flat_map(|row| [row.measured, row.predicted]).flatten();
    let axes = [Axis::logarithmic_wide(lives()), Axis::logarithmic_wide(lives())];
    let [from, to] = axes[0].ends();
    let names = ["Measured life, cycles or passes", "Predicted life, cycles or passes"];
    let size = Size { height: 700.0, ..LARGE };
    let mut frame = Frame::new(size, "Published tests: predicted and measured lives", axes, names, &legend);
    frame.line(&[[from, from], [to, to]], INK, 1.2, "");
    frame.line(&[[from, 2.0 * from], [0.5 * to, to]], NOTE, 1.0, "8 5");
    frame.line(&[[2.0 * from, from], [to, 0.5 * to]], NOTE, 1.0, "8 5");
    for (row, colour) in kinds.into_iter().flat_map(|(kind, colour)| of(kind).map(move |row| (row, colour))) {
        let at = |life: Option<f64>| Some([row.measured?, life?.clamp(from, to)]);
        let band: Vec<[f64; 2]> = [row.predicted_p05, row.predicted_p95].into_iter().filter_map(at).collect();
        frame.line(&band, colour, 1.0, "");
        at(row.predicted).into_iter().for_each(|place| frame.ring(place, colour));
    }
    frame.finish("Predicted over measured lives of published tests, with lines of equality and of a factor of 2")
}
