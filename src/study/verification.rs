//! Rows of a verification, the judgement over them, as text, CSV, JSON and as tables for documents.

use std::cmp::Ordering;

use serde_json::{Value, json};

use super::Topic;
use super::values::percent;
use perilife_base::cells::defused;

pub fn line(row: &VerificationRow) -> String {
    let mark = match (row.ok(), row.fails()) {
        (true, _) => "ok",
        (false, true) => "FAIL",
        (false, false) => "miss",
    };
    let figures = format!("{:>12} against {:>12}", number(row.computed), number(row.reference));
    let known = row.known_miss.as_ref().map_or_else(String::new, |miss| format!(", known miss {} %", bound(miss.bound_percent)));
    let error = format!("{:+.3} % (bound {} %{known})", row.error_percent, bound(row.bound_percent));
    format!("  {mark:<5} {:<62} {figures}  {error}, {:.1} s", row.quantity, row.wall_s)
}

pub fn object(rows: &[VerificationRow]) -> Value {
    let row = |row: &VerificationRow| {
        json!({
            "name": row.name, "quantity": row.quantity, "computed": row.computed, "reference": row.reference,
            "error_percent": row.error_percent, "bound_percent": row.bound_percent, "ok": row.ok(),
            "known_miss": row.known_miss.as_ref().map(|miss| &miss.reason),
            "miss_bound_percent": row.known_miss.as_ref().map(|miss| miss.bound_percent),
            "source": row.source, "wall_s": row.wall_s,
        })
    };
    json!({ "rows": rows.iter().map(row).collect::<Vec<_>>() })
}

pub fn csv(rows: &[VerificationRow]) -> String {
    let mut text =
        "name,quantity,computed,reference,error_percent,bound_percent,ok,known_miss,source,wall_s,miss_bound_percent\n"
            .to_owned();
    for row in rows {
        let quoted = |field: &str| format!("\"{}\"", defused(field).replace('"', "\"\""));
        text += &format!(
            "{},{},{:.12e},{:.12e},{:.6},{},{},{},{},{:.3},{}\n",
            row.name,
            quoted(&row.quantity),
            row.computed,
            row.reference,
            row.error_percent,
            row.bound_percent,
            row.ok(),
            quoted(row.known_miss.as_ref().map_or("", |miss| &miss.reason)),
            quoted(&row.source),
            row.wall_s,
            row.known_miss.as_ref().map_or_else(String::new, |miss| format!("{:.6}", miss.bound_percent)),
        );
    }
    text
}

/// A table for a document: every topic with the row that takes the largest share of its bound, the worst topic first. Known misses
/// are counted, and left out of that where the topic has other rows.
pub fn summary(rows: &[VerificationRow]) -> String {
    let mut names: Vec<&str> = rows.iter().map(|row| row.name).collect();
    names.dedup();
    let mut topics: Vec<(f64, String)> = names
        .into_iter()
        .filter_map(|name| {
            let of_topic = || rows.iter().filter(|row| row.name == name);
            let misses = of_topic().filter(|row| !row.ok()).count();
            let worst =
                of_topic().max_by(|a, b| (a.ok(), share(a)).partial_cmp(&(b.ok(), share(b))).unwrap_or(Ordering::Less))?;
            let figures = format!("{} % | {} %", signed(worst.error_percent, 1), bound(worst.bound_percent));
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
pub(super) fn cell(text: &str) -> String {
    text.replace('|', "\\|")
}

fn share(row: &VerificationRow) -> f64 {
    (row.error_percent / row.bound_percent).abs()
}

/// The verification as a document: [`summary`], then all rows of every topic. It holds no wall times, and figures of few digits,
/// so that whoever computes it again gets the same text.
pub fn markdown(topics: &[&Topic], rows: &[VerificationRow]) -> String {
    let mut text = format!(
        "# Accuracy\n\nWritten by `perilife verify --markdown`: results of the program against references. Errors are in \
         percent of the reference;\nwhere that is 0, the result is itself an error. A known miss has a second bound that it \
         must not exceed.\n\n{}",
        summary(rows)
    );
    for topic in topics {
        text += &format!("\n## {}\n\n{}.\n\n", topic.name, topic.about);
        text += "| quantity | computed | reference | error, % | bound, % | source |\n|---|---|---|---|---|---|\n";
        rows.iter().filter(|row| row.name == topic.name).for_each(|row| text += &markdown_row(row));
    }
    text
}

fn markdown_row(row: &VerificationRow) -> String {
    let (reason, second) = row.known_miss.as_ref().map_or_else(Default::default, |miss| {
        (format!(" (known miss: {})", cell(&miss.reason)), format!("; known miss {}", bound(miss.bound_percent)))
    });
    let [computed, reference] = [row.computed, row.reference].map(four_digits);
    let (error, bound) = (signed(row.error_percent, 2), bound(row.bound_percent));
    format!(
        "| {}{reason} | {computed} | {reference} | {error} | {bound}{second} | {} |\n",
        cell(&row.quantity),
        cell(&row.source)
    )
}

/// With its sign, which zero has none of.
fn signed(value: f64, decimals: usize) -> String {
    let text = format!("{value:+.decimals$}");
    if text.contains(|digit| ('1'..='9').contains(&digit)) || !value.is_finite() { text } else { text[1..].to_owned() }
}

/// Two decimals; a power of ten where that would be none.
fn bound(percent: f64) -> String {
    if percent < 0.01 { format!("{percent:.1e}") } else { format!("{percent:.2}") }
}

/// Four significant digits; what round-off leaves is zero.
pub(super) fn four_digits(value: f64) -> String {
    let size = value.abs();
    if size < 1e-9 {
        return "0".to_owned();
    }
    if size < 1e-3 {
        return format!("{value:.3e}");
    }
    let decimals = 3 - size.log10().floor() as i32;
    let unit = 10_f64.powi(-decimals);
    format!("{:.*}", decimals.max(0) as usize, (value / unit).round() * unit)
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

#[derive(Debug, Clone, PartialEq)]
pub struct VerificationRow {
    pub name: &'static str,
    /// What is compared, with unit and conditions.
    pub quantity: String,
    pub computed: f64,
    /// What it should be; 0 where the figure is itself an error in percent.
    pub reference: f64,
    /// Error in percent of the reference, or the figure itself where the reference is 0.
    pub error_percent: f64,
    /// Largest size of the error that is accepted.
    pub bound_percent: f64,
    /// Why the bound is not met and how far the error may go all the same, where that is known.
    pub known_miss: Option<KnownMiss>,
    pub source: String,
    /// Seconds spent since the row before.
    pub wall_s: f64,
}

#[derive(Debug, Clone, PartialEq)]
pub struct KnownMiss {
    pub reason: String,
    /// Second bound on the size of the error, percent: what is known and a tenth of it, so that a miss cannot grow unseen.
    pub bound_percent: f64,
}

impl VerificationRow {
    /// A figure against its reference (not 0); without one the figure is itself an error in percent.
    pub fn new(
        name: &'static str,
        (quantity, source): (String, String),
        computed: f64,
        reference: Option<f64>,
        bound_percent: f64,
    ) -> Self {
        let error_percent = reference.map_or(computed, |reference| percent(computed, reference));
        let (reference, known_miss, wall_s) = (reference.unwrap_or(0.0), None, 0.0);
        VerificationRow { name, quantity, computed, reference, error_percent, bound_percent, known_miss, source, wall_s }
    }

    /// With the reason of a miss and the error that is known, percent; a row that keeps its bound has none.
    pub fn with_miss(self, reason: String, known_percent: f64) -> Self {
        let known_miss = (!self.ok()).then(|| KnownMiss { reason, bound_percent: 1.1 * known_percent.abs() });
        VerificationRow { known_miss, ..self }
    }

    /// Whether the error keeps its bound; an error that is not a number does not.
    pub fn ok(&self) -> bool {
        self.error_percent.abs() <= self.bound_percent
    }

    /// Whether the row fails the verification: bound missed for no known reason, or by more than is known.
    pub fn fails(&self) -> bool {
        !self.ok() && !self.known_miss.as_ref().is_some_and(|miss| self.error_percent.abs() <= miss.bound_percent)
    }
}
