//! Charts as SVG: crack length against cycles, growth rate against ΔK.

use std::path::Path;

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::axis::Axis;
use super::output::write_file;
use crate::error::{Error, Result};

/// How a series is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mark {
    /// Computed: a line through the points.
    Line,
    /// Straight relation or bound: a dashed line.
    Dashes,
    /// Measured: open circles.
    Circles,
    /// Many computed values that scatter: small dots.
    Dots,
}

/// Named points of a chart, in the units of its axes.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Name in the legend.
    pub name: String,
    /// (x, y); points that are not finite (or not positive on a logarithmic axis) are left out.
    pub points: Vec<(f64, f64)>,
    /// How it is drawn.
    pub mark: Mark,
}

/// Crack length in mm against cycles, both linear.
pub fn crack_length(path: &Path, title: &str, series: &[Series]) -> Result<()> {
    linear(path, title, ["Cycles N", "Crack length a, mm"], series)
}

/// Loads against crack length in mm, both linear; `y_name` says which load in which unit.
pub fn over_crack_length(path: &Path, title: &str, y_name: &str, series: &[Series]) -> Result<()> {
    linear(path, title, ["Crack length a, mm", y_name], series)
}

/// Any quantities, both linear; `names` says what stands along x and y in which units.
pub fn linear(path: &Path, title: &str, names: [&str; 2], series: &[Series]) -> Result<()> {
    let axes = [Axis::linear(values(series, |p| p.0)), Axis::linear(values(series, |p| p.1))];
    draw(path, title, axes, names, series)
}

/// Growth rate in mm/cycle against ΔK in MPa√m, both logarithmic.
pub fn growth_rate(path: &Path, title: &str, series: &[Series]) -> Result<()> {
    let positive: Vec<Series> = series
        .iter()
        .map(|s| {
            let points = s.points.iter().copied().filter(|(x, y)| *x > 0.0 && *y > 0.0).collect();
            Series { points, ..s.clone() }
        })
        .collect();
    let axes = [Axis::logarithmic(values(&positive, |p| p.0)), Axis::logarithmic(values(&positive, |p| p.1))];
    let names = ["Range of the stress intensity factor ΔK, MPa√m", "Growth rate da/dN, mm/cycle"];
    draw(path, title, axes, names, &positive)
}

fn values(series: &[Series], pick: impl Fn(&(f64, f64)) -> f64) -> impl Iterator<Item = f64> {
    series
        .iter()
        .flat_map(|s| &s.points)
        .filter(|(x, y)| x.is_finite() && y.is_finite())
        .map(pick)
        .collect::<Vec<_>>()
        .into_iter()
}

/// Size of a chart, px.
const SIZE: (u32, u32) = (900, 600);
/// The chart library places everything on whole pixels. Drawing four times as large and shrinking by the view box keeps
/// flat curves smooth.
pub(super) const FINE: u32 = 4;
/// Colours that differ in lightness too (Okabe and Ito 2008, safe for colour-blind readers); black is for measured points.
pub(super) const COLOURS: [RGBColor; 6] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
];
pub(super) const INK: RGBColor = RGBColor(40, 40, 40);

pub(super) fn px(length: u32) -> i32 {
    (length * FINE) as i32
}

pub(super) fn font(size: u32) -> TextStyle<'static> {
    // The library divides sizes by 1.24 when it writes SVG.
    ("sans-serif", f64::from(size * FINE) * 1.24).into_font().color(&INK)
}

fn draw(path: &Path, title: &str, [x, y]: [Axis; 2], names: [&str; 2], series: &[Series]) -> Result<()> {
    save(path, SIZE, |svg| draw_into(svg, title, [x, y], names, series))
}

/// Writes what `draw` draws [`FINE`] times as large into a picture of this size.
pub(super) fn save(
    path: &Path,
    (width, height): (u32, u32),
    draw: impl FnOnce(&mut String) -> std::result::Result<(), Box<dyn std::error::Error>>,
) -> Result<()> {
    let mut svg = String::new();
    // Drawing into a string has no failure of its own; the library's error type still has to be passed on.
    draw(&mut svg).map_err(|error| Error::file(path, "cannot draw", std::io::Error::other(error.to_string())))?;
    let large = format!("width=\"{}\" height=\"{}\"", width * FINE, height * FINE);
    write_file(path, svg.replacen(&large, &format!("width=\"{width}\" height=\"{height}\""), 1).as_bytes())
}

fn draw_into(
    svg: &mut String,
    title: &str,
    [x, y]: [Axis; 2],
    [x_name, y_name]: [&str; 2],
    series: &[Series],
) -> std::result::Result<(), Box<dyn std::error::Error>> {
    let root = SVGBackend::with_string(svg, (SIZE.0 * FINE, SIZE.1 * FINE)).into_drawing_area();
    root.fill(&WHITE)?;
    let middle = Pos::new(HPos::Center, VPos::Center);
    root.draw(&Text::new(title.to_owned(), (px(SIZE.0 / 2), px(22)), font(17).pos(middle)))?;
    let (x_labels, y_labels) = (x.labels(), y.labels());
    let mut chart = ChartBuilder::on(&root)
        .margin_top(px(42))
        .margin_right(px(36))
        .margin_bottom(px(8))
        .margin_left(px(8))
        .x_label_area_size(px(58))
        .y_label_area_size(px(92))
        .build_cartesian_2d(x, y)?;
    let thin = |grey: u8| ShapeStyle::from(&RGBColor(grey, grey, grey)).stroke_width(FINE);
    chart
        .configure_mesh()
        .x_labels(x_labels)
        .y_labels(y_labels)
        .bold_line_style(thin(205))
        .light_line_style(thin(235))
        .axis_style(ShapeStyle::from(&INK).stroke_width(FINE))
        .set_all_tick_mark_size(px(5))
        .label_style(font(14))
        .axis_desc_style(font(16))
        .x_desc(x_name)
        .y_desc(y_name)
        .draw()?;
    let mut colours = COLOURS.iter().cycle();
    for (row, series) in series.iter().enumerate() {
        let colour = if series.mark == Mark::Circles { INK } else { colours.next().copied().unwrap_or(INK) };
        let line = ShapeStyle::from(&colour).stroke_width(2 * FINE + FINE / 2);
        let points = series.points.iter().copied().filter(|(x, y)| x.is_finite() && y.is_finite());
        // The sample in the legend stands on the plotting area, whose left edge is margin + label area.
        let height = px(62 + 24 * row as u32);
        let (left, right) = (px(118), px(150));
        match series.mark {
            Mark::Line => {
                chart.draw_series(LineSeries::new(points, line))?;
                root.draw(&PathElement::new(vec![(left, height), (right, height)], line))?;
            }
            Mark::Dashes => {
                chart.draw_series(DashedLineSeries::new(points, 9 * FINE, 6 * FINE, line))?;
                for start in [left, left + px(12), left + px(24)] {
                    root.draw(&PathElement::new(vec![(start, height), (start + px(8), height)], line))?;
                }
            }
            Mark::Circles => {
                let style = ShapeStyle::from(&colour).stroke_width(FINE + FINE / 2);
                chart.draw_series(points.map(|point| Circle::new(point, px(4), style)))?;
                root.draw(&Circle::new(((left + right) / 2, height), px(4), style))?;
            }
            Mark::Dots => {
                let style = colour.mix(0.55).filled();
                chart.draw_series(points.map(|point| Circle::new(point, px(2), style)))?;
                root.draw(&Circle::new(((left + right) / 2, height), px(3), colour.filled()))?;
            }
        }
        let text = Text::new(series.name.clone(), (right + px(10), height), font(15).pos(Pos::new(HPos::Left, VPos::Center)));
        root.draw(&text)?;
    }
    root.present()?;
    Ok(())
}
