//! Verification rows as text, CSV, JSON and as tables for documents.

use std::cmp::Ordering;

use serde_json::{Value, json};

use crate::verify::Row;

/// One row as a line on the console.
#[must_use]
pub fn line(row: &Row) -> String {
    let mark = verdict(row);
    let figures = format!("{:>12} against {:>12}", number(row.computed), number(row.reference));
    let error = format!("{:+.3} % (bound {:.3} %)", row.error_percent, row.bound_percent);
    format!("  {mark:<5} {:<62} {figures}  {error}, {:.1} s", row.quantity, row.wall_s)
}

/// All rows as one JSON object, `{"rows": [...]}`.
#[must_use]
pub fn object(rows: &[Row]) -> Value {
    let row = |row: &Row| {
        json!({
            "name": row.name, "quantity": row.quantity, "computed": row.computed, "reference": row.reference,
            "error_percent": row.error_percent, "bound_percent": row.bound_percent, "ok": row.ok(),
            "known_miss": row.known_miss, "source": row.source, "wall_s": row.wall_s,
        })
    };
    json!({ "rows": rows.iter().map(row).collect::<Vec<_>>() })
}

/// All rows as CSV, one header line.
#[must_use]
pub fn csv(rows: &[Row]) -> String {
    let mut text = "name,quantity,computed,reference,error_percent,bound_percent,ok,known_miss,source,wall_s\n".to_owned();
    for row in rows {
        let quoted = |field: &str| format!("\"{}\"", field.replace('"', "\"\""));
        text += &format!(
            "{},{},{:.12e},{:.12e},{:.6},{},{},{},{},{:.3}\n",
            row.name,
            quoted(&row.quantity),
            row.computed,
            row.reference,
            row.error_percent,
            row.bound_percent,
            row.ok(),
            quoted(row.known_miss.as_deref().unwrap_or("")),
            quoted(&row.source),
            row.wall_s
        );
    }
    text
}

/// A table for a document: every topic with the row that takes the largest share of its bound, the worst topic first. Known misses
/// are counted, and left out of that where the topic has other rows.
#[must_use]
pub fn summary(rows: &[Row]) -> String {
    let mut names: Vec<&str> = rows.iter().map(|row| row.name).collect();
    names.dedup();
    let mut topics: Vec<(f64, String)> = names
        .into_iter()
        .filter_map(|name| {
            let of_topic = || rows.iter().filter(|row| row.name == name);
            let misses = of_topic().filter(|row| !row.ok()).count();
            let worst =
                of_topic().max_by(|a, b| (a.ok(), share(a)).partial_cmp(&(b.ok(), share(b))).unwrap_or(Ordering::Less))?;
            let figures = format!("{:+.1} % | {:.2} %", worst.error_percent, worst.bound_percent);
            let line = format!("| `{name}` | {} | {misses} | {} | {figures} |\n", of_topic().count(), cell(&worst.quantity));
            Some((share(worst), line))
        })
        .collect();
    topics.sort_by(|a, b| b.0.total_cmp(&a.0));
    let head =
        "| topic | rows | known misses | its worst row within bounds | error | bound |\n|---|---|---|---|---|---|\n".to_owned();
    topics.into_iter().fold(head, |text, (_, line)| text + &line)
}

/// Text for a cell of a table, in which a bar would end it.
fn cell(text: &str) -> String {
    text.replace('|', "\\|")
}

/// Share of its bound that a row takes.
fn share(row: &Row) -> f64 {
    (row.error_percent / row.bound_percent).abs()
}

/// A table for a document: the row with the largest share of its bound first.
#[must_use]
pub fn markdown(rows: &[Row]) -> String {
    let mut sorted: Vec<&Row> = rows.iter().collect();
    // An error that is not a number counts as the worst.
    sorted.sort_by(|a, b| share(b).total_cmp(&share(a)));
    let mut text = "| what | computed | reference | error % | bound % | source |\n|---|---|---|---|---|---|\n".to_owned();
    for row in sorted {
        let miss = row.known_miss.as_ref().map_or_else(String::new, |reason| format!(" (known miss: {reason})"));
        let figures = format!(
            "{} | {} | {:+.2} | {:.2}",
            number(row.computed),
            number(row.reference),
            row.error_percent,
            row.bound_percent
        );
        text += &format!("| {}: {}{miss} | {figures} | {} |\n", row.name, cell(&row.quantity), cell(&row.source));
    }
    text
}

fn verdict(row: &Row) -> &'static str {
    match (row.ok(), row.fails()) {
        (true, _) => "ok",
        (false, true) => "FAIL",
        (false, false) => "miss",
    }
}

/// Six digits, with an exponent only where it helps.
fn number(value: f64) -> String {
    let size = value.abs();
    if size != 0.0 && !(1e-3..1e7).contains(&size) {
        return format!("{value:.4e}");
    }
    let digits = if size >= 1000.0 { 0 } else { 4 };
    format!("{value:.digits$}")
}
