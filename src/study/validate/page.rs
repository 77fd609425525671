//! Rows of a validation as text, CSV, JSON and as a document.

use serde_json::{Value, json};

use super::{Kind, Row, Set, mean};
use crate::verification::{cell, four_digits};
use perilife_base::cells::field;
use perilife_results::digits::number;
use serde::Serialize;

/// What no set tests yet.
const UNTESTED: &str = "
## No measured test yet

- surface, corner and embedded cracks; breakthrough
- cracks at holes, rows of holes, link-up of several cracks; lugs and pins in contact
- single overloads and underloads; flight spectra with compression
- residual stress (welds, cold-worked holes, peening)
- cycles of displacement; out-of-plane bending; eccentric load; plane strain
- initiation from S-N data; rates near the threshold; fracture and net-section yield as the end of a test
- slant and mixed-mode cracks with a measured life
- fleets, probability of detection, inspection intervals
- steels and titanium of a named alloy
";

/// Tests of a kind, of several predictions those of one variant.
#[derive(Default, Serialize)]
struct Group {
    group: String,
    tests: usize,
    ratio_geometric_mean: f64,
    /// exp(s), s the standard deviation of ln ratio.
    scatter_factor: Option<f64>,
    /// Measured lives within their bands. Those of halves of one lot count by themselves.
    lives_inside: usize,
    lives_with_band: usize,
}

/// The groups of tests with a life, in the order of the kinds.
fn groups(rows: &[Row]) -> Vec<Group> {
    let name =
        |row: &Row| row.kind.replace('_', " ") + &row.variant.as_ref().map(|variant| format!(": {variant}")).unwrap_or_default();
    let of_kind = |kind: Kind| rows.iter().filter(move |row| row.kind == kind.name() && row.ratio.is_some());
    let group = |group: String| {
        let own = || rows.iter().filter(|row| row.ratio.is_some() && name(row) == group);
        let ratios: Vec<f64> = own().filter_map(|row| row.ratio).collect();
        let (mean, tests) = (mean(&ratios), ratios.len());
        let square = ratios.iter().map(|ratio| (ratio / mean).ln().powi(2)).sum::<f64>();
        let inside =
            || own().filter(|row| row.crps_percent.is_none()).filter_map(|row| Some([row.lives_inside?, row.lives_measured]));
        let [lives_inside, lives_with_band] = [0, 1].map(|place| inside().map(|lives| lives[place]).sum());
        let scatter_factor = (tests > 1).then(|| (square / (tests as f64 - 1.0)).sqrt().exp());
        Group { tests, ratio_geometric_mean: mean, scatter_factor, lives_inside, lives_with_band, group }
    };
    distinct(Kind::all().flat_map(of_kind).map(name)).into_iter().map(group).collect()
}

/// Each item once, in the order of the first ones.
fn distinct<T: PartialEq>(items: impl Iterator<Item = T>) -> Vec<T> {
    items.fold(Vec::new(), |mut kept, item| {
        kept.extend((!kept.contains(&item)).then_some(item));
        kept
    })
}

/// A set with its rows on the console.
pub fn lines(set: &Set, rows: &[Row]) -> String {
    let line = |row: &Row| {
        let life = row.ratio.map(|ratio| format!(" {ratio:.3} of measured {} {}", digits(row.measured), row.unit));
        let inside = row.lives_inside.map(|inside| format!(", {inside} of {} in the band", row.lives_measured));
        let path = distances(row).map(|distances| format!(" distance of the path, mean and largest: {distances} mm"));
        let failure = row.failure.as_ref().map(|why| format!(" failed: {why}"));
        format!(
            "\n  {:<20} {:<28}{}",
            row.set,
            label(row),
            [life, inside, path, failure].into_iter().flatten().collect::<String>()
        )
    };
    set.about.title.clone() + &rows.iter().map(line).collect::<String>()
}

/// All rows and groups as one object.
pub fn object(rows: &[Row]) -> Value {
    json!({ "rows": rows, "groups": groups(rows) })
}

/// All rows as CSV; columns are the keys of the object.
pub fn csv(rows: &[Row]) -> String {
    let object = object(rows);
    let fields = |row: &Value, cell: fn(&str, &Value) -> String| {
        let cells = row.as_object().into_iter().flatten().map(|(key, value)| cell(key, value)).collect::<Vec<_>>();
        cells.join(",") + "\n"
    };
    let cell = |_: &str, value: &Value| match value {
        Value::Null => String::new(),
        Value::String(text) => field(text),
        Value::Number(count) if count.is_u64() => count.to_string(),
        other => other.as_f64().map_or_else(String::new, number),
    };
    let rows = object["rows"].as_array().into_iter().flatten();
    let head = rows.clone().next().map(|row| fields(row, |key, _| key.to_owned()));
    head.into_iter().chain(rows.map(|row| fields(row, cell))).collect()
}

/// The validation as a document, without wall times, with few digits.
pub fn markdown(sets: &[Set], rows: &[Row]) -> String {
    let mut text = "# Validation\n\nWritten by `perilife validate --markdown`: lives and paths of published tests beside those that the program predicts. \
         The ratio is\npredicted over measured life (below 1: conservative); the scatter factor is exp(s), s the standard deviation of ln ratio; \
         the band is\n5 % to 95 % of specimens. Sources, assumptions and uncertainties are below; inputs are in `data/validation`.\n\n\
         | kind of test | tests | geometric mean of the ratio | scatter factor | lives in the band |\n|---|---|---|---|---|\n"
        .to_owned();
    for group in groups(rows) {
        let scatter = dash(group.scatter_factor.map(|factor| format!("{factor:.2}")));
        let (inside, all) = (group.lives_inside, group.lives_with_band);
        let inside = dash((all > 0).then(|| format!("{inside} of {all}")));
        let mean = group.ratio_geometric_mean;
        text += &format!("| {} | {} | {mean:.3} | {scatter} | {inside} |\n", cell(&group.group), group.tests);
    }
    let lives = "| set | test | measured | predicted | ratio | band | in the band | error stated, % | model | others |";
    text += &(table("Lives", lives, rows, life_row) + &variants(rows));
    let halves = "| set | lives | in the band, % | rms of the ratio less 1, % | CRPS, % of life |";
    text += &table("Replicates: random halves", halves, rows, |row| {
        let share = 100.0 * row.lives_inside? as f64 / row.lives_measured as f64;
        let (rms, crps) = (row.ratio_rms_percent?, row.crps_percent?);
        Some(format!("| {} | {} | {share:.1} | {rms:.2} | {crps:.2} |", cell(&row.set), row.lives_measured))
    });
    let paths = "| set | mean, largest, mm | model | others |";
    text += &table("Paths: distance of the measured points from the predicted path", paths, rows, |row| {
        Some(format!("| {} | {} | {} | {} |", cell(&row.set), distances(row)?, row.model.as_deref()?, cell(&row.others)))
    });
    text += "\n## Sources\n";
    for set in sets {
        let about = &set.about;
        text += &format!("\n### {}\n\n{}. {}.\n", set.name, about.title, about.reference);
        let [numbers, assumed] = [("Numbers", &about.obtained), ("Assumed", &about.assumed)];
        let said = [numbers, assumed, ("Uncertainty", &about.uncertainty), ("Licence", &about.licence)];
        let said = said.into_iter().chain(about.remark.as_ref().map(|remark| ("Remark", remark)));
        text += &(said.map(|(what, words)| format!("\n- {what}: {words}")).collect::<String>() + "\n");
    }
    text + UNTESTED
}

/// A table under a heading; nothing without rows.
fn table(heading: &str, head: &str, rows: &[Row], line: impl Fn(&Row) -> Option<String>) -> String {
    let lines: String = rows.iter().filter_map(line).map(|line| line + "\n").collect();
    let rule = "|---".repeat(head.matches('|').count() - 1);
    if lines.is_empty() { lines } else { format!("\n## {heading}\n\n{head}\n{rule}|\n{lines}") }
}

fn life_row(row: &Row) -> Option<String> {
    let name = format!("| {} | {} |", cell(&row.set), cell(&label(row)));
    if let Some(why) = &row.failure {
        return Some(format!("{name} failed: {} | | | | | | | |", cell(why)));
    }
    let value = row.ratio?;
    let inside = dash(row.lives_inside.map(|inside| format!("{inside} of {}", row.lives_measured)));
    let band = dash(row.predicted_p05.map(|low| format!("{} to {}", four_digits(low), digits(row.predicted_p95))));
    let error = dash(row.error_estimate_percent.map(|error| format!("{error:.1}")));
    let ratio = row.others_ratio.map(|ratio| format!(" ({ratio:.2})")).unwrap_or_default();
    let figures = format!("{} {} | {} | {value:.3}", digits(row.measured), row.unit, digits(row.predicted));
    let model = row.model.as_deref().unwrap_or_default();
    Some(format!("{name} {figures} | {band} | {inside} | {error} | {model} | {}{ratio} |", cell(&row.others)))
}

/// Ratios of the variants of each set side by side.
fn variants(rows: &[Row]) -> String {
    let names = distinct(rows.iter().filter_map(|row| row.variant.as_ref()));
    let words = names.iter().map(|name| cell(name)).collect::<Vec<_>>().join(" | ");
    let line = |row: &Row| {
        let own = || rows.iter().filter(|other| other.set == row.set && other.variant.is_some());
        let is_first = own().next().is_some_and(|first| first.case == row.case && first.variant == row.variant);
        let find = |name: &&String| own().find(|other| other.variant.as_ref() == Some(name)).and_then(|other| other.ratio);
        let ratios = names.iter().map(find).chain([row.others_ratio]).map(|ratio| dash(ratio.map(|ratio| format!("{ratio:.3}"))));
        is_first.then(|| format!("| {} | {} |", cell(&row.set), ratios.collect::<Vec<_>>().join(" | ")))
    };
    table("Ratio by model", &format!("| set | {words} | others |"), rows, line)
}

/// The variant, or the kind where there is one prediction.
fn label(row: &Row) -> String {
    row.variant.clone().unwrap_or_else(|| row.kind.replace('_', " "))
}

fn digits(life: Option<f64>) -> String {
    dash(life.map(four_digits))
}

fn dash(words: Option<String>) -> String {
    words.unwrap_or_else(|| "-".to_owned())
}

fn distances(row: &Row) -> Option<String> {
    Some(format!("{:.2}, {:.2}", row.path_mean_mm?, row.path_largest_mm?))
}
