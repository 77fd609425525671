//! `spectrum.svg`: how often loads are exceeded in a pass, and how many cycles have which range.

use crate::axis::Axis;
use crate::chart::{COMPUTED, Frame, Size};
use crate::specimen_picture::sketch::Sketch;
use crate::spectrum::{BARS, thinned};
use perilife_plate::loading::spectrum::Spectrum;
use perilife_plate::specimen::Point;

const BAR: f64 = 0.7;
/// Points of the curve at the most.
const POINTS: usize = 400;

/// Exceedances of the maxima, left, and histogram of the ranges, right, of a pass.
pub fn spectrum_svg(spectrum: &Spectrum, size: Size) -> String {
    let half = Size { width: 0.5 * size.width, ..size };
    let mut picture = Sketch::new(1.0, [0.0; 2]);
    exceedances(spectrum, half).beside(&mut picture, [0.0; 2]);
    ranges(spectrum, half).beside(&mut picture, [half.width, 0.0]);
    let sentence = format!("Exceedances and ranges of the {:.0} cycles of a pass", spectrum.per_pass);
    picture.picture([size.width, size.height], &sentence)
}

/// Maxima over how many of a pass are as large or larger, a stair.
fn exceedances(spectrum: &Spectrum, size: Size) -> Frame {
    let mut stair: Vec<Point> = Vec::new();
    for (level, count) in thinned(spectrum, POINTS) {
        if let Some([before, _]) = stair.last().copied() {
            stair.push([before, level]);
        }
        stair.push([count, level]);
    }
    let counts = stair.iter().map(|point| point[0]);
    let axes = [Axis::logarithmic(counts), Axis::linear(stair.iter().map(|point| point[1]).chain([0.0]))];
    let mut frame = Frame::new(size, "", axes, ["Peak exceedances per pass", "Peak / maximum load"], &[]);
    frame.line(&stair, COMPUTED, 2.0, "");
    frame
}

/// Cycles of a pass by their range, over a logarithmic axis where they differ much.
fn ranges(spectrum: &Spectrum, size: Size) -> Frame {
    let (counts, largest) = spectrum.ranges(BARS);
    let some = || counts.iter().copied().filter(|count| *count > 0.0);
    let [low, high] = some().fold([f64::INFINITY, 0.0], |[low, high], count| [low.min(count), high.max(count)]);
    let floor = if high > 50.0 * low { 0.5 * low } else { 0.0 };
    let y = if floor > 0.0 { Axis::logarithmic_between(floor, 1.5 * high) } else { Axis::linear([0.0, high].into_iter()) };
    let axes = [Axis::linear_in([0.0, largest].into_iter(), 5.0), y];
    let mut frame = Frame::new(size, "", axes, ["Range / maximum load", "Cycles per pass"], &[]);
    let width = largest / BARS as f64;
    for (place, count) in counts.iter().enumerate().filter(|(_, count)| **count > 0.0) {
        let [from, to] = [(place as f64 + 0.08) * width, (place as f64 + 0.92) * width];
        frame.band(&[[from, floor], [to, floor]], &[[from, *count], [to, *count]], BAR);
    }
    frame
}
