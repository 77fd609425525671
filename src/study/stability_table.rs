//! Records of the stability sweeps as text, CSV, JSON and pictures.

use std::path::Path;

use serde_json::{Value, json};

use super::stability::{StabilityRecord, Status, Sweep};
use super::tasks::Outcome;
use perilife_base::cells::field;
use perilife_base::columns::number_text as number;
use perilife_base::error::Result;
use perilife_base::limits;
use perilife_results::axis::Axis;
use perilife_results::chart::{COLOURS, Frame, INK, Size};
use perilife_results::format;
use perilife_results::output::write_file;
use perilife_results::specimen_picture::sketch::Sketch;

pub fn line(record: &StabilityRecord) -> String {
    let sweep = record.sweep;
    format!("{}: {}: {} ({:.0} s)", sweep.name, record.method, range(record), record.wall_s)
}

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
    let now = format::now();
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

/// Size of the picture of a sweep without its legend, px.
const SIZE: Size = Size { width: 900.0, height: 560.0, text: 13.0 };
const LINE: f64 = 22.0;
/// Errors, percent, between which they are drawn where they are.
const DRAWN: [f64; 2] = [1e-3, 1e4];
const REASON: usize = 110;

/// Whether a parameter is drawn over a logarithmic axis: above zero over more than a decade.
fn is_logarithmic(sweep: &Sweep) -> bool {
    let [first, last] = sweep.range();
    first > 0.0 && last > 10.0 * first
}

/// Different reasons of failure, shortened, each with the first value and the method that has it.
fn reasons(records: &[&StabilityRecord]) -> Vec<String> {
    let mut found: Vec<(String, String)> = Vec::new();
    for record in records {
        for (value, outcome) in &record.points {
            let Some(reason) = outcome.reason() else { continue };
            let without_digits: String = reason.chars().filter(|c| !c.is_ascii_digit()).collect();
            if found.iter().all(|(known, _)| *known != without_digits) {
                let cut: String = reason.chars().take(REASON).collect();
                let more = if reason.chars().count() > REASON { " ..." } else { "" };
                found.push((without_digits, format!("× {}, {}: {cut}{more}", record.method, short(*value))));
            }
        }
    }
    found.into_iter().map(|(_, text)| text).take(6).collect()
}

fn parameter(sweep: &Sweep) -> String {
    let mut letters = sweep.parameter.chars();
    let first = letters.next().map_or_else(String::new, |first| first.to_uppercase().to_string());
    let unit = if sweep.unit.is_empty() { String::new() } else { format!(", {}", sweep.unit) };
    format!("{first}{}{unit}", letters.as_str())
}

fn method(name: &str) -> String {
    let plain = [
        ("element_free_galerkin", "nodes"),
        ("tip_field", "points, K of the tips"),
        ("bond_strain", "points, bonds"),
        ("law chosen by the program", "points, law chosen by the program"),
    ];
    let known = plain.iter().find(|(known, _)| name.starts_with(known));
    known.map_or_else(|| name.to_owned(), |(known, words)| format!("{words}{}", &name[known.len()..])).replace('_', " ")
}

pub fn sweep(path: &Path, sweep: &Sweep, records: &[&StabilityRecord]) -> Result<()> {
    let reasons = reasons(records);
    let height = SIZE.height + LINE * (records.len() + reasons.len()) as f64 + 16.0;
    let mut sketch = draw(sweep, records).into_sketch();
    let line = |row: usize| SIZE.height + 10.0 + LINE * row as f64;
    for ((row, record), colour) in records.iter().enumerate().zip(COLOURS.iter().cycle()) {
        sketch.path(&[[30.0, line(row)], [60.0, line(row)]], colour, 3.0, "");
        let text = format!("{}: {}", method(record.method), range(record));
        sketch.name([68.0, line(row) + 5.0], &text, "start", 14.0, INK);
    }
    for (row, reason) in reasons.iter().enumerate() {
        sketch.name([30.0, line(records.len() + row) + 4.0], reason, "start", 12.0, INK);
    }
    let sentence = format!("{}: size of the error over {}", sweep.name, sweep.parameter);
    write_file(path, sketch.picture([SIZE.width, height], &sentence).as_bytes())
}

fn draw(sweep: &Sweep, records: &[&StabilityRecord]) -> Frame {
    let values = sweep.values.iter().copied();
    let x = if is_logarithmic(sweep) { Axis::logarithmic(values) } else { Axis::linear(values) };
    let drawn = |outcome: &Outcome<f64>| outcome.done().map(|error| error.abs().clamp(DRAWN[0], DRAWN[1]));
    let sizes = records.iter().flat_map(|record| &record.points).filter_map(|(_, outcome)| drawn(outcome));
    let y = Axis::logarithmic_wide(sizes.chain([sweep.bound_percent]));
    let [from, to] = x.ends();
    let mut frame = Frame::new(SIZE, &sweep.about, [x, y], [&parameter(sweep), "Size of the error, %"], &[]);
    let [first, last] = sweep.range();
    for (record, colour) in records.iter().zip(COLOURS.iter().cycle()) {
        // Safe ranges lie over each other: each is shaded faintly.
        if record.is_safe == Some(true) {
            let ends = [record.ends[0].unwrap_or(first), record.ends[1].unwrap_or(last)];
            frame.below(sweep.bound_percent, ends, colour, 0.25 / records.len() as f64);
        }
    }
    frame.line(&[[from, sweep.bound_percent], [to, sweep.bound_percent]], INK, 1.5, "8 5");
    let top = frame.room()[1] + 8.0;
    for (record, colour) in records.iter().zip(COLOURS.iter().cycle()) {
        // A failure interrupts the line.
        let points: Vec<[f64; 2]> =
            record.points.iter().map(|(value, outcome)| [*value, drawn(outcome).unwrap_or(f64::NAN)]).collect();
        frame.pieces(&points, colour, 2.0, "");
        for [value, error] in points {
            let [x, y] = frame.at([value, error]);
            if y.is_finite() {
                frame.sketch().dot([x, y], 3.0, colour);
            } else {
                let [x, _] = frame.at([value, sweep.bound_percent]);
                frame.sketch().cross([x, top], 5.0, colour, 2.0);
            }
        }
    }
    frame
}

/// Height of a row of the map, of its head and of its foot, px.
const ROW: f64 = 24.0;
const HEAD: f64 = 76.0;
const FOOT: f64 = 40.0;
/// Left and right end of the bars, and width of the map, px.
const BARS: [f64; 2] = [800.0, 1140.0];
const WIDTH: f64 = 1440.0;

const SAFE: &str = "#1b8a6b";
const BEYOND: &str = "#f0c878";
const NO_RESULT: &str = "#969696";
const RULE: &str = "#e1e1e1";

pub fn overview(path: &Path, records: &[StabilityRecord]) -> Result<()> {
    let mut sketch = Sketch::new(1.0, [0.0; 2]);
    let height = HEAD + ROW * records.len() as f64 + FOOT;
    sketch.name([14.0, 28.0], "Accuracy limits of each method", "start", 18.0, INK);
    let legend =
        [(SAFE, "error within the bound"), (BEYOND, "beyond the bound"), (NO_RESULT, "no result, or refused"), (INK, "default")];
    for (place, (colour, meaning)) in legend.into_iter().enumerate() {
        let x = 14.0 + 200.0 * place as f64;
        rectangle(&mut sketch, [x, 44.0], [x + 18.0, 58.0], colour);
        sketch.name([x + 26.0, 56.0], meaning, "start", 13.0, INK);
    }
    for (row, record) in records.iter().enumerate() {
        let top = HEAD + ROW * row as f64;
        let line = top + 0.5 * ROW + 4.5;
        if row == 0 || records[row - 1].sweep.name != record.sweep.name {
            sketch.path(&[[10.0, top], [WIDTH - 10.0, top]], RULE, 1.0, "");
            sketch.name([14.0, line], &parameter(record.sweep), "start", 13.0, INK);
        }
        sketch.name([BARS[0] - 62.0, line], &method(record.method), "end", 13.0, INK);
        bar(&mut sketch, record, top);
        let [first, last] = record.sweep.range();
        sketch.name([BARS[0] - 6.0, line], &short(first), "end", 11.0, INK);
        sketch.name([BARS[1] + 6.0, line], &short(last), "start", 11.0, INK);
        sketch.name([BARS[1] + 64.0, line], &ends(record), "start", 12.0, INK);
    }
    let version = env!("CARGO_PKG_VERSION");
    let foot = format!("perilife {version}: perilife stability --out DIR; stability.csv has every run with its reason");
    sketch.name([14.0, height - 14.0], &foot, "start", 12.0, INK);
    write_file(path, sketch.picture([WIDTH, height], "Range of each method within its error bound").as_bytes())
}

fn rectangle(sketch: &mut Sketch, [x0, y0]: [f64; 2], [x1, y1]: [f64; 2], colour: &str) {
    sketch.area(&[[x0, y0], [x1, y0], [x1, y1], [x0, y1]], colour, 1.0);
}

/// Every run colours the way half to its neighbours.
fn bar(sketch: &mut Sketch, record: &StabilityRecord, top: f64) {
    let sweep = record.sweep;
    let [first, last] = sweep.range();
    let place = |value: f64| {
        let share =
            if is_logarithmic(sweep) { (value / first).ln() / (last / first).ln() } else { (value - first) / (last - first) };
        BARS[0] + share * (BARS[1] - BARS[0])
    };
    let [from, to] = [top + 5.0, top + ROW - 5.0];
    let places: Vec<f64> = record.points.iter().map(|(value, _)| place(*value)).collect();
    for (at, (_, outcome)) in record.points.iter().enumerate() {
        let beside =
            |other: Option<usize>| other.and_then(|other| places.get(other)).map_or(places[at], |x| 0.5 * (x + places[at]));
        let (mut low, mut high) = (beside(at.checked_sub(1)), beside(Some(at + 1)));
        // A single run at an end of the range still has a mark.
        (low, high) = if high - low < 2.0 { (low - 1.0, high + 1.0) } else { (low, high) };
        let status = sweep.status(outcome);
        let colour = match status {
            Status::Stable => SAFE,
            Status::Degraded => BEYOND,
            Status::Failed => NO_RESULT,
        };
        rectangle(sketch, [low, from], [high, to], colour);
        // Slanted lines, so that failure shows in grey print.
        let mut x = low;
        while status == Status::Failed && x + to - from < high {
            sketch.path(&[[x, to], [x + to - from, from]], "white", 1.0, "");
            x += 6.0;
        }
    }
    sketch.path(&[[place(sweep.usual), from - 2.0], [place(sweep.usual), to + 2.0]], INK, 2.0, "");
}
