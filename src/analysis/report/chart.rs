//! Charts as SVG: crack length against cycles, growth rate against ΔK.

use std::path::Path;

use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use super::axis::Axis;
use super::plot::{Area, COLOURS, Drawn, Frame, INK, Layout, dashes, frame, line, px, save, stroke, words};
use crate::error::Result;

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

/// Size of a chart, px, and how its frame is laid out.
const SIZE: (u32, u32) = (900, 600);
const LAYOUT: Layout = Layout { margins: [42, 36, 8, 8], labels: [58, 92], fonts: [14, 16] };

fn draw(path: &Path, title: &str, axes: [Axis; 2], names: [&str; 2], series: &[Series]) -> Result<()> {
    save(path, SIZE, |root| {
        words(root, title, [0.5 * f64::from(SIZE.0), 22.0], 17, (HPos::Center, INK))?;
        let mut chart = frame(root, &LAYOUT, axes, names)?;
        let mut colours = COLOURS.iter().cycle();
        for (row, series) in series.iter().enumerate() {
            let colour = if series.mark == Mark::Circles { INK } else { colours.next().copied().unwrap_or(INK) };
            // The sample in the legend stands on the plotting area, whose left edge is margin + label area.
            sample(root, &mut chart, series, colour, [118.0, 62.0 + 24.0 * row as f64])?;
        }
        Ok(())
    })
}

/// Draws a series, and a sample of it with its name at a place.
fn sample(root: &Area<'_>, chart: &mut Frame<'_>, series: &Series, colour: RGBColor, [left, height]: [f64; 2]) -> Drawn {
    let points = series.points.iter().copied().filter(|(x, y)| x.is_finite() && y.is_finite());
    let right = left + 32.0;
    let middle = (px((left + 16.0) as u32), px(height as u32));
    match series.mark {
        Mark::Line => {
            chart.draw_series(LineSeries::new(points, stroke(&colour, 2.5)))?;
            line(root, &[[left, height], [right, height]], 2.5, &colour)?;
        }
        Mark::Dashes => {
            dashes(chart, points.collect(), stroke(&colour, 2.5))?;
            for start in [left, left + 12.0, left + 24.0] {
                line(root, &[[start, height], [start + 8.0, height]], 2.5, &colour)?;
            }
        }
        Mark::Circles => {
            let style = stroke(&colour, 1.5);
            chart.draw_series(points.map(|point| Circle::new(point, px(4), style)))?;
            root.draw(&Circle::new(middle, px(4), style))?;
        }
        Mark::Dots => {
            let style = colour.mix(0.55).filled();
            chart.draw_series(points.map(|point| Circle::new(point, px(2), style)))?;
            root.draw(&Circle::new(middle, px(3), colour.filled()))?;
        }
    }
    words(root, &series.name, [right + 10.0, height], 15, (HPos::Left, INK))
}
