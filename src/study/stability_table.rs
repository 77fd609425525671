//! Records of the stability sweeps as text, CSV and JSON.

use serde_json::{Value, json};

use crate::stability::StabilityRecord;
use perilife_base::cells::field;
use perilife_base::columns::number_text as number;
use perilife_base::limits;
use perilife_results::time;

pub fn line(record: &StabilityRecord) -> String {
    let sweep = record.sweep;
    format!("{}: {}: {} ({:.0} s)", sweep.name, record.method, range(record), record.wall_s)
}

/// The safe range in words.
pub fn range(record: &StabilityRecord) -> String {
    let sweep = record.sweep;
    let unit = if sweep.unit.is_empty() { String::new() } else { format!(" {}", sweep.unit) };
    let [first, last] = sweep.range().map(short);
    let (usual, bound) = (short(sweep.usual), sweep.bound_percent);
    match (record.is_safe, record.ends) {
        (None, _) => format!("not evaluated: {usual}{unit} (default) exceeded the time limit"),
        (Some(false), _) => format!("not within {bound} % at the default {usual}{unit}"),
        (Some(true), [None, None]) => format!("within {bound} % from {first} to {last}{unit}, the whole sweep"),
        (Some(true), _) => format!("{}{unit}", ends(record)),
    }
}

/// The safe range of the map: its unit stands beside the parameter.
pub fn ends(record: &StabilityRecord) -> String {
    let (sweep, [first, last]) = (record.sweep, record.sweep.range());
    match (record.is_safe, record.ends) {
        (None, _) => "not judged".to_owned(),
        (Some(false), _) => format!("never within {} %", sweep.bound_percent),
        (Some(true), [None, None]) => format!("within {} % everywhere", sweep.bound_percent),
        (Some(true), [low, high]) => {
            let [low, high] = [low.unwrap_or(first), high.unwrap_or(last)].map(short);
            format!("within {} % from {low} to {high}", sweep.bound_percent)
        }
    }
}

/// Four significant digits.
pub fn short(value: f64) -> String {
    let rounded = format!("{value:.3e}").parse::<f64>().unwrap_or(value);
    if (1e-4..1e6).contains(&rounded.abs()) || rounded == 0.0 { rounded.to_string() } else { format!("{rounded:e}") }
}

/// `stability.csv`: a row a run; `boundary` is the end of the safe range on the side of the value, empty where it has none there.
pub fn csv(records: &[StabilityRecord]) -> String {
    let mut text = "sweep,method,parameter,value,status,error_percent,boundary,reason,version\n".to_owned();
    for record in records {
        let sweep = record.sweep;
        for (value, outcome) in &record.points {
            let (error, reason) =
                (outcome.done().map_or_else(String::new, |error| number(*error)), outcome.reason().unwrap_or_default());
            text += &format!(
                "{},{},{},{},{},{error},{},{},{}\n",
                sweep.name,
                field(record.method),
                field(&sweep.parameter),
                number(*value),
                sweep.status(outcome).name(),
                record.ends[usize::from(*value >= record.sweep.usual)].map_or_else(String::new, number),
                field(reason),
                env!("CARGO_PKG_VERSION"),
            );
        }
    }
    text
}

/// `boundaries.csv`: a row a method, as [`perilife_base::limits`] reads it; an end is empty where the sweep does not find one.
pub fn boundaries(records: &[StabilityRecord]) -> String {
    let now = time::now();
    let date = now.split('T').next().unwrap_or_default();
    let mut text = format!("{}\n", limits::COLUMNS);
    for record in records {
        let [low, high] = record.ends.map(|end| end.map_or_else(String::new, short));
        let sweep = record.sweep;
        text += &format!(
            "{},{},{},{},{low},{high},{},{},{date}\n",
            sweep.name,
            field(record.method),
            field(&sweep.parameter),
            record.is_safe.map_or_else(String::new, |is_safe| is_safe.to_string()),
            sweep.bound_percent,
            env!("CARGO_PKG_VERSION"),
        );
    }
    text
}

pub fn object(records: &[StabilityRecord]) -> Value {
    let record = |record: &StabilityRecord| {
        let sweep = record.sweep;
        let points = record.points.iter().map(|(value, outcome)| {
            json!({
                "value": value, "status": sweep.status(outcome).name(), "error_percent": outcome.done(),
                "reason": outcome.reason(),
            })
        });
        json!({
            "sweep": sweep.name, "about": sweep.about, "method": record.method, "parameter": sweep.parameter, "unit": sweep.unit,
            "bound_percent": sweep.bound_percent, "usual": sweep.usual, "is_safe": record.is_safe, "low": record.ends[0],
            "high": record.ends[1], "wall_s": record.wall_s, "points": points.collect::<Vec<_>>(),
        })
    };
    json!({ "version": env!("CARGO_PKG_VERSION"), "records": records.iter().map(record).collect::<Vec<_>>() })
}
