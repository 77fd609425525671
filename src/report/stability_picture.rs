//! A stability sweep as SVG: error over the parameter, the bound, the safe ranges, failures with their reasons.

use std::path::Path;

use plotters::coord::ranged1d::Ranged;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::axis::Axis;
use super::chart::{COLOURS, FINE, INK, font, px, save};
use crate::error::Result;
use crate::stability::{Outcome, Record, Sweep};

/// Size of a picture without its legend, px.
const SIZE: (u32, u32) = (900, 560);
/// Height of a line of the legend, px.
const LINE: u32 = 22;
/// Smallest error that is told from zero, percent.
const FLOOR: f64 = 1e-3;
/// Largest error that is drawn where it is, percent.
const CEILING: f64 = 1e4;
/// Letters of a reason of failure.
const REASON: usize = 110;

type Drawn = std::result::Result<(), Box<dyn std::error::Error>>;

/// Writes the picture of a sweep with the records of its methods.
pub fn sweep(path: &Path, sweep: &Sweep, records: &[&Record]) -> Result<()> {
    let reasons = reasons(records);
    let size = (SIZE.0, SIZE.1 + LINE * (records.len() + reasons.len()) as u32 + 16);
    save(path, size, |svg| draw(svg, size, sweep, records, &reasons))
}

/// Whether a parameter is drawn over a logarithmic axis: above zero over more than a decade.
pub(super) fn is_logarithmic(sweep: &Sweep) -> bool {
    let (first, last) = (sweep.values[0], sweep.values[sweep.values.len() - 1]);
    first > 0.0 && last > 10.0 * first
}

/// Different reasons of failure, shortened, each with the first value and the method that has it.
fn reasons(records: &[&Record]) -> Vec<String> {
    let mut found: Vec<(String, String)> = Vec::new();
    for record in records {
        for (value, outcome) in &record.points {
            let Some(reason) = outcome.reason() else { continue };
            let words: String = reason.chars().filter(|c| !c.is_ascii_digit()).collect();
            if found.iter().all(|(known, _)| *known != words) {
                let cut: String = reason.chars().take(REASON).collect();
                let more = if reason.chars().count() > REASON { " ..." } else { "" };
                found.push((words, format!("× {}, {}: {cut}{more}", record.method, super::stability::short(*value))));
            }
        }
    }
    found.into_iter().map(|(_, text)| text).take(6).collect()
}

fn draw(svg: &mut String, size: (u32, u32), sweep: &Sweep, records: &[&Record], reasons: &[String]) -> Drawn {
    let root = SVGBackend::with_string(svg, (size.0 * FINE, size.1 * FINE)).into_drawing_area();
    root.fill(&WHITE)?;
    let (area, foot) = root.split_vertically(px(SIZE.1));
    let middle = Pos::new(HPos::Center, VPos::Center);
    let title = format!("{}: error over {}", sweep.name, sweep.parameter);
    area.draw(&Text::new(title, (px(SIZE.0 / 2), px(20)), font(17).pos(middle)))?;
    let values = || sweep.values.iter().copied();
    let x = if is_logarithmic(sweep) { Axis::logarithmic(values()) } else { Axis::linear(values()) };
    let drawn = |error: f64| error.abs().clamp(FLOOR, CEILING);
    let sizes = records.iter().flat_map(|record| &record.points).filter_map(|(_, outcome)| outcome.error()).map(drawn);
    let y = Axis::logarithmic_wide(sizes.chain([sweep.bound_percent]));
    let (low, high) = (y.range().start, y.range().end);
    let (x_labels, y_labels) = (x.labels(), y.labels());
    let [left, right] = [x.range().start, x.range().end];
    let mut chart = ChartBuilder::on(&area)
        .margin_top(px(40))
        .margin_right(px(30))
        .margin_left(px(8))
        .margin_bottom(px(6))
        .x_label_area_size(px(54))
        .y_label_area_size(px(84))
        .build_cartesian_2d(x, y)?;
    let thin = |grey: u8| ShapeStyle::from(&RGBColor(grey, grey, grey)).stroke_width(FINE);
    let unit = if sweep.unit.is_empty() { String::new() } else { format!(", {}", sweep.unit) };
    chart
        .configure_mesh()
        .x_labels(x_labels)
        .y_labels(y_labels)
        .bold_line_style(thin(210))
        .light_line_style(thin(240))
        .axis_style(ShapeStyle::from(&INK).stroke_width(FINE))
        .label_style(font(13))
        .axis_desc_style(font(14))
        .x_desc(format!("{}{unit}", sweep.parameter))
        .y_desc("Size of the error, %")
        .draw()?;
    let [first, last] = [sweep.values[0], sweep.values[sweep.values.len() - 1]];
    for (record, colour) in records.iter().zip(COLOURS.iter().cycle()) {
        // Safe ranges lie over each other: each is shaded faintly.
        if record.is_safe == Some(true) {
            let [from, to] = [record.ends[0].unwrap_or(first), record.ends[1].unwrap_or(last)];
            let shade = colour.mix(0.25 / records.len() as f64).filled();
            chart.draw_series([Rectangle::new([(from, low), (to, sweep.bound_percent)], shade)])?;
        }
    }
    let dashes = ShapeStyle::from(&INK).stroke_width(FINE + FINE / 2);
    chart.draw_series(DashedLineSeries::new(
        [(left, sweep.bound_percent), (right, sweep.bound_percent)],
        9 * FINE,
        6 * FINE,
        dashes,
    ))?;
    for (record, colour) in records.iter().zip(COLOURS.iter().cycle()) {
        let line = ShapeStyle::from(colour).stroke_width(2 * FINE);
        // A failure interrupts the line.
        let pieces = record.points.split(|(_, outcome)| outcome.error().is_none());
        for piece in pieces {
            let point = |(value, outcome): &(f64, Outcome)| Some((*value, drawn(outcome.error()?)));
            let points: Vec<(f64, f64)> = piece.iter().filter_map(point).collect();
            chart.draw_series(LineSeries::new(points.iter().copied(), line))?;
            chart.draw_series(points.iter().map(|&point| Circle::new(point, px(3), colour.filled())))?;
        }
        let failed = record.points.iter().filter(|(_, outcome)| outcome.error().is_none());
        let top = high / (high / low).powf(0.03);
        chart.draw_series(failed.map(|(value, _)| Cross::new((*value, top), px(5), line)))?;
    }
    legend(&foot, records, reasons)?;
    root.present()?;
    Ok(())
}

/// Methods with their safe ranges, and reasons of failure.
fn legend(foot: &DrawingArea<SVGBackend<'_>, plotters::coord::Shift>, records: &[&Record], reasons: &[String]) -> Drawn {
    let left = Pos::new(HPos::Left, VPos::Center);
    for ((row, record), colour) in records.iter().enumerate().zip(COLOURS.iter().cycle()) {
        let height = px(10 + LINE * row as u32);
        let line = ShapeStyle::from(colour).stroke_width(3 * FINE);
        foot.draw(&PathElement::new(vec![(px(30), height), (px(60), height)], line))?;
        let text = format!("{}: {}", record.method, super::stability::range(record));
        foot.draw(&Text::new(text, (px(68), height), font(14).pos(left)))?;
    }
    for (row, reason) in reasons.iter().enumerate() {
        let height = px(10 + LINE * (records.len() + row) as u32);
        foot.draw(&Text::new(reason.clone(), (px(30), height), font(12).pos(left)))?;
    }
    Ok(())
}
