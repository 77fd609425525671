//! A benchmark as text, CSV, JSON and as tables for documents.

use serde_json::{Value, json};

use super::csv::exact;
use crate::bench::{Figure, GROUPS, Outcome, Row};

/// Columns of `bench.csv`.
pub const COLUMNS: &str = "group,scene,varied,choice,points,wall_s,cpu_s,ratio,repeats,extrapolated_from_blocks,estimated_s,error_of,\
                           error_percent,error_at_end_percent,error_against,broken_bonds,ms_per_broken_bond,bytes_per_point,\
                           on_front,note";
/// Columns of `figures.csv`.
pub const FIGURE_COLUMNS: &str = "group,quantity,value,unit,asked,met";

/// One row as a line on the console.
#[must_use]
pub fn line(row: &Row) -> String {
    let error = row.error.as_ref().map_or_else(String::new, |error| format!("  error {:.3} %", error.percent));
    let timing = &row.timing;
    let how = match timing.extrapolated_from {
        Some(blocks) => format!("extrapolated from {blocks} blocks"),
        None => format!("median of {}", timing.repeats),
    };
    let what = format!("{} {}", row.group, row.choice);
    format!("  {what:<52} {:>12}  ratio {:>9}  ({how}){error}", seconds(timing.wall_s), number(timing.ratio))
}

/// One figure as a line on the console.
#[must_use]
pub fn figure_line(figure: &Figure) -> String {
    format!("  {}: {} = {}  {}", figure.group, figure.quantity, with_unit(figure), asked(figure)).trim_end().to_owned()
}

/// Everything as one JSON object.
#[must_use]
pub fn object(outcome: &Outcome) -> Value {
    let row = |row: &Row| {
        let (timing, error) = (&row.timing, row.error.as_ref());
        json!({
            "group": row.group, "scene": row.scene, "varied": row.varied, "choice": row.choice, "points": row.points,
            "wall_s": timing.wall_s, "cpu_s": timing.cpu_s, "ratio": timing.ratio, "repeats": timing.repeats,
            "extrapolated_from_blocks": timing.extrapolated_from, "estimated_s": timing.estimated_s,
            "error_of": error.map(|error| error.of), "error_percent": error.map(|error| error.percent),
            "error_at_end_percent": error.and_then(|error| error.at_end_percent),
            "error_against": error.map(|error| error.against), "broken_bonds": row.broken_bonds,
            "ms_per_broken_bond": row.ms_per_broken_bond(), "bytes_per_point": row.bytes_per_point,
            "on_front": row.on_front, "note": row.note,
        })
    };
    let figure = |figure: &Figure| {
        json!({
            "group": figure.group, "quantity": figure.quantity, "value": figure.value, "unit": figure.unit,
            "asked": figure.asked.map(|asked| asked.to_string()), "met": figure.asked.map(|asked| asked.is_met(figure.value)),
        })
    };
    let machine = &outcome.machine;
    json!({
        "version": machine.version, "threads": machine.threads, "simd_bits": machine.simd_bits,
        "instruction_set": machine.instruction_set, "reference": outcome.reference, "reference_s": outcome.reference_s,
        "rows": outcome.rows.iter().map(row).collect::<Vec<_>>(),
        "figures": outcome.figures.iter().map(figure).collect::<Vec<_>>(),
    })
}

/// The rows as CSV, one header line.
#[must_use]
pub fn csv(rows: &[Row]) -> String {
    let mut text = format!("{COLUMNS}\n");
    for row in rows {
        let (timing, error) = (&row.timing, row.error.as_ref());
        let count = |value: Option<usize>| value.map_or_else(String::new, |value| value.to_string());
        let known = |value: Option<f64>| value.map_or_else(String::new, exact);
        let fields = [
            row.group.to_owned(),
            quoted(&row.scene),
            row.varied.to_owned(),
            quoted(&row.choice),
            row.points.to_string(),
            exact(timing.wall_s),
            exact(timing.cpu_s),
            exact(timing.ratio),
            timing.repeats.to_string(),
            count(timing.extrapolated_from),
            known(timing.estimated_s),
            quoted(error.map_or("", |error| error.of)),
            known(error.map(|error| error.percent)),
            known(error.and_then(|error| error.at_end_percent)),
            quoted(error.map_or("", |error| error.against)),
            count(row.broken_bonds),
            known(row.ms_per_broken_bond()),
            known(row.bytes_per_point),
            row.on_front.to_string(),
            quoted(&row.note),
        ];
        text += &(fields.join(",") + "\n");
    }
    text
}

/// The figures as CSV, one header line.
#[must_use]
pub fn figures_csv(figures: &[Figure]) -> String {
    figures.iter().fold(format!("{FIGURE_COLUMNS}\n"), |text, figure| {
        let asked = figure.asked.map_or_else(String::new, |asked| asked.to_string());
        let met = figure.asked.map_or_else(String::new, |asked| asked.is_met(figure.value).to_string());
        text + &format!("{},{},{},{},{asked},{met}\n", figure.group, quoted(&figure.quantity), exact(figure.value), figure.unit)
    })
}

/// Tables for a document: the figures, then the rows group by group.
#[must_use]
pub fn markdown(outcome: &Outcome) -> String {
    let mut text = format!(
        "{}\n\nRatios are over the reference run beside each measurement: {}, {}. Times are medians of the repeats.\n\n",
        outcome.machine,
        outcome.reference,
        seconds(outcome.reference_s)
    );
    if !outcome.figures.is_empty() {
        text += "| group | figure | value | asked |\n|---|---|---|---|\n";
        for figure in &outcome.figures {
            text += &format!("| {} | {} | {} | {} |\n", figure.group, figure.quantity, with_unit(figure), asked(figure));
        }
    }
    for group in GROUPS {
        let rows: Vec<&Row> = outcome.rows.iter().filter(|row| row.group == group.name).collect();
        let Some(first) = rows.first() else { continue };
        let of =
            first.error.as_ref().map_or_else(String::new, |error| format!(" Error of {} against {}.", error.of, error.against));
        text += &format!("\n`{}`: {}.{of}\n\n", group.name, first.scene);
        text += "| varied | choice | points | time | ratio | repeats | error % | ms per broken bond | note |\n\
                 |---|---|---|---|---|---|---|---|---|\n";
        rows.into_iter().for_each(|row| text += &markdown_row(row));
    }
    text
}

fn markdown_row(row: &Row) -> String {
    let timing = &row.timing;
    let repeats = timing.extrapolated_from.map_or_else(|| timing.repeats.to_string(), |_| "extrapolated".to_owned());
    let error = row.error.as_ref().map_or_else(String::new, |error| number(error.percent));
    let front = if row.on_front { " (front)" } else { "" };
    let bytes = row.bytes_per_point.map_or_else(String::new, |bytes| format!("{bytes:.0} bytes a point; "));
    format!(
        "| {} | {}{front} | {} | {} | {} | {repeats} | {error} | {} | {bytes}{} |\n",
        row.varied,
        row.choice,
        row.points,
        seconds(timing.wall_s),
        number(timing.ratio),
        row.ms_per_broken_bond().map_or_else(String::new, number),
        row.note.replace('|', "\\|")
    )
}

fn with_unit(figure: &Figure) -> String {
    format!("{} {}", number(figure.value), figure.unit).trim_end().to_owned()
}

fn asked(figure: &Figure) -> String {
    figure
        .asked
        .map_or_else(String::new, |asked| format!("asked {asked}: {}", if asked.is_met(figure.value) { "met" } else { "missed" }))
}

fn quoted(field: &str) -> String {
    format!("\"{}\"", field.replace('"', "\"\""))
}

/// A time in the unit that suits it.
#[must_use]
pub fn seconds(value: f64) -> String {
    match value {
        v if v.is_nan() => "-".to_owned(),
        v if v < 1e-3 => format!("{} µs", number(1e6 * v)),
        v if v < 1.0 => format!("{} ms", number(1e3 * v)),
        v => format!("{} s", number(v)),
    }
}

/// Three digits.
fn number(value: f64) -> String {
    let size = value.abs();
    match size {
        s if s.is_nan() => "-".to_owned(),
        0.0 => "0".to_owned(),
        s if !(1e-3..1e6).contains(&s) => format!("{value:.2e}"),
        s => {
            let decimals = (2 - s.log10().floor() as i32).clamp(0, 5) as usize;
            format!("{value:.decimals$}")
        }
    }
}
