//! Stability sweeps as SVG: a picture a sweep (error over the parameter, the bound, the safe ranges, failures with their reasons), and the
//! map of all (a bar for the safe range of every method, along the range of its parameter).

use std::path::Path;

use plotters::coord::ranged1d::Ranged;
use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use super::axis::Axis;
use super::plot::{Area, COLOURS, Drawn, INK, Layout, dashes, frame, line, px, rectangle, save, stroke, words};
use super::stability::{range, short};
use crate::error::Result;
use crate::verify::stability::{Record, Status, Sweep};
use crate::verify::tasks::Outcome;

/// Size of the picture of a sweep without its legend, px, and how its frame is laid out.
const SIZE: (u32, u32) = (900, 560);
const LAYOUT: Layout = Layout { margins: [40, 30, 6, 8], labels: [54, 84], fonts: [13, 14] };
/// Height of a line of the legend, px.
const LINE: u32 = 22;
/// Errors, percent, between which they are drawn where they are.
const DRAWN: [f64; 2] = [1e-3, 1e4];
/// Letters of a reason of failure.
const REASON: usize = 110;

/// Whether a parameter is drawn over a logarithmic axis: above zero over more than a decade.
fn is_logarithmic(sweep: &Sweep) -> bool {
    let [first, last] = sweep.range();
    first > 0.0 && last > 10.0 * first
}

/// Different reasons of failure, shortened, each with the first value and the method that has it.
fn reasons(records: &[&Record]) -> Vec<String> {
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

/// Writes the picture of a sweep with the records of its methods.
pub fn sweep(path: &Path, sweep: &Sweep, records: &[&Record]) -> Result<()> {
    let reasons = reasons(records);
    let lines = (records.len() + reasons.len()) as u32;
    save(path, (SIZE.0, SIZE.1 + LINE * lines + 16), |root| {
        let (area, foot) = root.split_vertically(px(SIZE.1));
        draw(&area, sweep, records)?;
        let height = |row: usize| 10.0 + f64::from(LINE) * row as f64;
        for ((row, record), colour) in records.iter().enumerate().zip(COLOURS.iter().cycle()) {
            line(&foot, &[[30.0, height(row)], [60.0, height(row)]], 3.0, colour)?;
            let text = format!("{}: {}", record.method, range(record));
            words(&foot, &text, [68.0, height(row)], 14, (HPos::Left, INK))?;
        }
        for (row, reason) in reasons.iter().enumerate() {
            words(&foot, reason, [30.0, height(records.len() + row)], 12, (HPos::Left, INK))?;
        }
        Ok(())
    })
}

fn draw(area: &Area<'_>, sweep: &Sweep, records: &[&Record]) -> Drawn {
    let title = format!("{}: error over {}", sweep.name, sweep.parameter);
    words(area, &title, [0.5 * f64::from(SIZE.0), 20.0], 17, (HPos::Center, INK))?;
    let values = sweep.values.iter().copied();
    let x = if is_logarithmic(sweep) { Axis::logarithmic(values) } else { Axis::linear(values) };
    let drawn = |outcome: &Outcome<f64>| outcome.done().map(|error| error.abs().clamp(DRAWN[0], DRAWN[1]));
    let sizes = records.iter().flat_map(|record| &record.points).filter_map(|(_, outcome)| drawn(outcome));
    let y = Axis::logarithmic_wide(sizes.chain([sweep.bound_percent]));
    let (over, (low, high)) = (x.range(), (y.range().start, y.range().end));
    let unit = if sweep.unit.is_empty() { String::new() } else { format!(", {}", sweep.unit) };
    let mut chart = frame(area, &LAYOUT, [x, y], [&format!("{}{unit}", sweep.parameter), "Size of the error, %"])?;
    let [first, last] = sweep.range();
    for (record, colour) in records.iter().zip(COLOURS.iter().cycle()) {
        // Safe ranges lie over each other: each is shaded faintly.
        if record.is_safe == Some(true) {
            let [from, to] = [record.ends[0].unwrap_or(first), record.ends[1].unwrap_or(last)];
            let shade = colour.mix(0.25 / records.len() as f64).filled();
            chart.draw_series([Rectangle::new([(from, low), (to, sweep.bound_percent)], shade)])?;
        }
    }
    dashes(&mut chart, [over.start, over.end].map(|x| (x, sweep.bound_percent)).to_vec(), stroke(&INK, 1.5))?;
    for (record, colour) in records.iter().zip(COLOURS.iter().cycle()) {
        // A failure interrupts the line.
        for piece in record.points.split(|(_, outcome)| outcome.done().is_none()) {
            let points: Vec<(f64, f64)> = piece.iter().filter_map(|(value, outcome)| Some((*value, drawn(outcome)?))).collect();
            chart.draw_series(LineSeries::new(points.iter().copied(), stroke(colour, 2.0)))?;
            chart.draw_series(points.iter().map(|&point| Circle::new(point, px(3), colour.filled())))?;
        }
        let failed = record.points.iter().filter(|(_, outcome)| outcome.done().is_none());
        let top = high / (high / low).powf(0.03);
        chart.draw_series(failed.map(|(value, _)| Cross::new((*value, top), px(5), stroke(colour, 2.0))))?;
    }
    Ok(())
}

/// Height of a row of the map, of its head and of its foot, px.
const ROW: u32 = 24;
const HEAD: u32 = 76;
const FOOT: u32 = 40;
/// Left and right end of the bars, and width of the map, px.
const BARS: [f64; 2] = [560.0, 1010.0];
const WIDTH: u32 = 1400;

const SAFE: RGBColor = RGBColor(0, 158, 115);
const BEYOND: RGBColor = RGBColor(240, 200, 120);
const NO_RESULT: RGBColor = RGBColor(150, 150, 150);

/// Writes the map.
pub fn overview(path: &Path, records: &[Record]) -> Result<()> {
    let (width, height) = (f64::from(WIDTH), HEAD + ROW * records.len() as u32 + FOOT);
    save(path, (WIDTH, height), |root| {
        let [left, middle, right] = [HPos::Left, HPos::Center, HPos::Right].map(|from| (from, INK));
        words(root, "Where methods are safe, degrade and fail", [0.5 * width, 20.0], 18, middle)?;
        let legend = [
            (SAFE, "error within the bound"),
            (BEYOND, "beyond the bound"),
            (NO_RESULT, "no result, or refused"),
            (INK, "usual value"),
        ];
        for (place, (colour, meaning)) in legend.into_iter().enumerate() {
            let x = 330.0 + 200.0 * place as f64;
            rectangle(root, [[x, 40.0], [x + 18.0, 54.0]], &colour)?;
            words(root, meaning, [x + 26.0, 47.0], 13, left)?;
        }
        for (row, record) in records.iter().enumerate() {
            let top = f64::from(HEAD + ROW * row as u32);
            let height = top + 0.5 * f64::from(ROW);
            if row == 0 || records[row - 1].sweep.name != record.sweep.name {
                line(root, &[[10.0, top], [width - 10.0, top]], 1.0, &RGBColor(225, 225, 225))?;
                words(root, record.sweep.name, [14.0, height], 13, left)?;
            }
            words(root, record.method, [BARS[0] - 62.0, height], 13, right)?;
            bar(root, record, top)?;
            let [first, last] = record.sweep.range();
            words(root, &short(first), [BARS[0] - 6.0, height], 11, right)?;
            words(root, &short(last), [BARS[1] + 6.0, height], 11, left)?;
            words(root, &range(record), [BARS[1] + 64.0, height], 12, left)?;
        }
        let version = env!("CARGO_PKG_VERSION");
        let foot = format!("perilife {version}: perilife stability --out DIR; stability.csv has every run with its reason");
        words(root, &foot, [0.5 * width, f64::from(height) - 18.0], 12, middle)
    })
}

/// Every run colours the way half to its neighbours.
fn bar(root: &Area<'_>, record: &Record, top: f64) -> Drawn {
    let sweep = record.sweep;
    let [first, last] = sweep.range();
    let place = |value: f64| {
        let share =
            if is_logarithmic(sweep) { (value / first).ln() / (last / first).ln() } else { (value - first) / (last - first) };
        BARS[0] + share * (BARS[1] - BARS[0])
    };
    let [from, to] = [top + 5.0, top + f64::from(ROW) - 5.0];
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
        rectangle(root, [[low, from], [high, to]], &colour)?;
        // Slanted lines, so that failure shows in grey print.
        let mut x = low;
        while status == Status::Failed && x + to - from < high {
            line(root, &[[x, to], [x + to - from, from]], 1.0, &WHITE)?;
            x += 6.0;
        }
    }
    line(root, &[[place(sweep.usual), from - 2.0], [place(sweep.usual), to + 2.0]], 2.0, &INK)
}
