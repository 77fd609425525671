//! The map of all stability sweeps as SVG: a bar for the safe range of every method, along the range of its parameter.

use std::path::Path;

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::chart::{FINE, INK, font, px, save};
use super::stability::{range, short};
use super::stability_picture::is_logarithmic;
use crate::error::Result;
use crate::stability::{Record, Status, Sweep};

/// Height of a row, of the head and of the foot, px.
const ROW: u32 = 24;
const HEAD: u32 = 76;
const FOOT: u32 = 40;
/// Left and right end of the bars, and width of the picture, px.
const BARS: [u32; 2] = [560, 1010];
const WIDTH: u32 = 1400;

const SAFE: RGBColor = RGBColor(0, 158, 115);
const BEYOND: RGBColor = RGBColor(240, 200, 120);
const FAILED: RGBColor = RGBColor(150, 150, 150);

type Drawn = std::result::Result<(), Box<dyn std::error::Error>>;
type Area<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;

/// Writes the map.
pub fn overview(path: &Path, records: &[Record]) -> Result<()> {
    let size = (WIDTH, HEAD + ROW * records.len() as u32 + FOOT);
    save(path, size, |svg| draw(svg, size, records))
}

fn draw(svg: &mut String, size: (u32, u32), records: &[Record]) -> Drawn {
    let root = SVGBackend::with_string(svg, (size.0 * FINE, size.1 * FINE)).into_drawing_area();
    root.fill(&WHITE)?;
    let middle = Pos::new(HPos::Center, VPos::Center);
    let left = Pos::new(HPos::Left, VPos::Center);
    let right = Pos::new(HPos::Right, VPos::Center);
    root.draw(&Text::new("Where methods are safe, degrade and fail", (px(WIDTH / 2), px(20)), font(18).pos(middle)))?;
    let mut x = 330;
    for (style, words) in
        [(SAFE, "error within the bound"), (BEYOND, "beyond the bound"), (FAILED, "no result, or refused"), (INK, "usual value")]
    {
        root.draw(&Rectangle::new([(px(x), px(40)), (px(x + 18), px(54))], style.filled()))?;
        root.draw(&Text::new(words, (px(x + 26), px(47)), font(13).pos(left)))?;
        x += 200;
    }
    for (row, record) in records.iter().enumerate() {
        let top = HEAD + ROW * row as u32;
        let height = px(top + ROW / 2);
        let is_first = row == 0 || records[row - 1].sweep.name != record.sweep.name;
        if is_first {
            let line = ShapeStyle::from(&RGBColor(225, 225, 225)).stroke_width(FINE);
            root.draw(&PathElement::new(vec![(px(10), px(top)), (px(WIDTH - 10), px(top))], line))?;
            root.draw(&Text::new(record.sweep.name, (px(14), height), font(13).pos(left)))?;
        }
        root.draw(&Text::new(record.method, (px(BARS[0] - 62), height), font(13).pos(right)))?;
        bar(&root, record, top)?;
        let [first, last] = [record.sweep.values[0], record.sweep.values[record.sweep.values.len() - 1]];
        root.draw(&Text::new(short(first), (px(BARS[0] - 6), height), font(11).pos(right)))?;
        root.draw(&Text::new(short(last), (px(BARS[1] + 6), height), font(11).pos(left)))?;
        root.draw(&Text::new(range(record), (px(BARS[1] + 64), height), font(12).pos(left)))?;
    }
    let words = format!(
        "perilife {}: perilife stability --out DIR; stability.csv has every run with its reason",
        env!("CARGO_PKG_VERSION")
    );
    root.draw(&Text::new(words, (px(WIDTH / 2), px(size.1 - 18)), font(12).pos(middle)))?;
    root.present()?;
    Ok(())
}

/// Place of a value along the bars, px.
fn place(sweep: &Sweep, value: f64) -> i32 {
    let [first, last] = [sweep.values[0], sweep.values[sweep.values.len() - 1]];
    let share = if is_logarithmic(sweep) { (value / first).ln() / (last / first).ln() } else { (value - first) / (last - first) };
    px(BARS[0]) + (share * f64::from(px(BARS[1] - BARS[0]))) as i32
}

/// Every run colours the way half to its neighbours.
fn bar(root: &Area<'_>, record: &Record, top: u32) -> Drawn {
    let sweep = record.sweep;
    let [from, to] = [px(top + 5), px(top + ROW - 5)];
    let places: Vec<i32> = record.points.iter().map(|(value, _)| place(sweep, *value)).collect();
    for (at, (_, outcome)) in record.points.iter().enumerate() {
        let mut low = if at == 0 { places[at] } else { (places[at - 1] + places[at]) / 2 };
        let mut high = if at + 1 == places.len() { places[at] } else { (places[at] + places[at + 1]) / 2 };
        // A single run at an end of the range still has a mark.
        (low, high) = if high - low < px(2) { (low - px(1), high + px(1)) } else { (low, high) };
        let status = outcome.status(sweep.bound_percent);
        let colour = match status {
            Status::Stable => SAFE,
            Status::Degraded => BEYOND,
            Status::Failed => FAILED,
        };
        root.draw(&Rectangle::new([(low, from), (high, to)], colour.filled()))?;
        if status == Status::Failed {
            hatch(root, [low, high], [from, to])?;
        }
    }
    let usual = place(sweep, sweep.usual);
    let line = ShapeStyle::from(&INK).stroke_width(2 * FINE);
    root.draw(&PathElement::new(vec![(usual, from - px(2)), (usual, to + px(2))], line))?;
    Ok(())
}

/// Slanted lines, so that failure shows in grey print.
fn hatch(root: &Area<'_>, [low, high]: [i32; 2], [from, to]: [i32; 2]) -> Drawn {
    let line = ShapeStyle::from(&WHITE).stroke_width(FINE);
    let mut x = low;
    while x + (to - from) < high {
        root.draw(&PathElement::new(vec![(x, to), (x + (to - from), from)], line))?;
        x += px(6);
    }
    Ok(())
}
