//! An axis of a chart: range, ticks and how numbers are written along it; places for names, so that none covers another, a point or the frame.

use super::format::{AXIS, clean, trimmed};
use perilife_base::units::shown::per;

/// Linear or logarithmic axis. Whole decades alone would leave ΔK from 8 to 40 MPa√m with one tick.
#[derive(Debug, Clone)]
pub struct Axis {
    low: f64,
    high: f64,
    logarithmic: bool,
    labelled: Vec<f64>,
    faint: Vec<f64>,
    /// What a linear one was asked to hold, and in how many steps.
    asked: [f64; 2],
    parts: f64,
    /// What numbers along it are multiplied by.
    written: f64,
}

impl Axis {
    /// Linear axis that holds all `values`, from zero where that wastes little.
    pub fn linear(values: impl Iterator<Item = f64>) -> Axis {
        let (mut low, high) = bounds(values.filter(|v| v.is_finite())).unwrap_or((0.0, 1.0));
        if low > 0.0 && low < 0.5 * high {
            low = 0.0;
        }
        Self::linear_in([low, high].into_iter(), 6.0)
    }

    /// Linear axis that holds all `values` and no more, in about so many steps.
    pub fn linear_in(values: impl Iterator<Item = f64>, parts: f64) -> Axis {
        let (mut low, mut high) = bounds(values.filter(|v| v.is_finite())).unwrap_or((0.0, 1.0));
        if high - low <= 1e-9 * high.abs().max(1e-300) {
            (low, high) = (low - 0.05 * low.abs().max(1.0), high + 0.05 * high.abs().max(1.0));
        }
        let asked = [low, high];
        let step = nice_step((high - low) / parts);
        (low, high) = ((low / step + 1e-9).floor() * step, (high / step - 1e-9).ceil() * step);
        let count = ((high - low) / step).round() as usize;
        let labelled: Vec<f64> = (0..=count).map(|i| low + i as f64 * step).collect();
        Axis { low, high, logarithmic: false, labelled, faint: Vec::new(), asked, parts, written: 1.0 }
    }

    pub fn logarithmic(values: impl Iterator<Item = f64>) -> Axis {
        let (low, high) = bounds(values.filter(|v| v.is_finite() && *v > 0.0)).unwrap_or((1.0, 10.0));
        Self::logarithmic_between(low / 1.12, high * 1.12) // keeps marks off the frame
    }

    /// The same with room for names around the values: a twelfth of the axis at each end.
    pub fn logarithmic_wide(values: impl Iterator<Item = f64>) -> Axis {
        let (low, high) = bounds(values.filter(|v| v.is_finite() && *v > 0.0)).unwrap_or((1.0, 10.0));
        let room = (high / low).powf(0.1).max(1.3);
        Self::logarithmic_between(low / room, high * room)
    }

    pub fn logarithmic_between(low: f64, high: f64) -> Axis {
        let decades = (high / low).log10();
        let multiples: &[f64] = match decades {
            d if d > 3.0 => &[1.0],
            d if d > 1.5 => &[1.0, 2.0, 5.0],
            d if d > 0.7 => &[1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 7.0],
            _ => &[1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0, 4.5, 5.0, 6.0, 7.0, 8.0, 9.0],
        };
        let ticks = |multiples: &[f64]| {
            let exponents = (low.log10().floor() as i32)..=(high.log10().ceil() as i32);
            let all = exponents.flat_map(|e| multiples.iter().map(move |m| m * 10f64.powi(e)).collect::<Vec<_>>());
            all.filter(|v| (low..=high).contains(v)).collect::<Vec<f64>>()
        };
        let faint = ticks(if decades > 2.0 { &[1.0] } else { multiples });
        let (asked, labelled) = ([low, high], ticks(multiples));
        Axis { low, high, logarithmic: true, labelled, faint, asked, parts: 1.0, written: 1.0 }
    }

    /// The axis of quantities of this name, with round numbers in the units that are shown; values stay metric.
    pub fn named(self, name: &str) -> Axis {
        let word = name.rsplit_once(", ").map_or("", |(_, unit)| unit);
        let factor = per(word);
        if factor == 1.0 {
            return self;
        }
        let [low, high] = self.asked.map(|end| end * factor);
        let own = if self.logarithmic {
            Self::logarithmic_between(low, high)
        } else {
            Self::linear_in([low, high].into_iter(), self.parts)
        };
        let back = |values: Vec<f64>| values.into_iter().map(|value| value / factor).collect();
        Axis {
            low: own.low / factor,
            high: own.high / factor,
            labelled: back(own.labelled),
            faint: back(own.faint),
            written: factor,
            ..own
        }
    }

    /// Where a logarithmic axis has lines across: whole decades, or every labelled tick of one that is shorter than two.
    pub fn faint(&self) -> &[f64] {
        &self.faint
    }

    pub fn ticks(&self) -> Vec<(f64, String)> {
        self.labelled.iter().map(|value| (*value, self.format(*value))).collect()
    }

    pub fn ends(&self) -> [f64; 2] {
        [self.low, self.high]
    }

    /// Part of the way from the low end at which a value stands.
    pub fn share(&self, value: f64) -> f64 {
        if self.logarithmic {
            (value.max(1e-300) / self.low).ln() / (self.high / self.low).ln()
        } else {
            (value - self.low) / (self.high - self.low)
        }
    }

    fn format(&self, value: f64) -> String {
        let value = clean(value * self.written);
        if self.logarithmic {
            return tick_text(value, 0.0, 0);
        }
        // All labels of a linear axis carry as many decimals as the one that needs most: 10.00, 10.01.
        let decimals_of = |v: &f64| trimmed(&format!("{v:.6}")).split_once('.').map_or(0, |(_, decimals)| decimals.len());
        let decimals = self.labelled.iter().map(|tick| decimals_of(&(tick * self.written))).max().unwrap_or(0);
        tick_text(value, self.written * self.high.abs().max(self.low.abs()), decimals)
    }
}

fn bounds(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    values.fold(None, |range: Option<(f64, f64)>, v| Some(range.map_or((v, v), |(low, high)| (low.min(v), high.max(v)))))
}

/// 1, 2, 2.5 or 5 times a power of ten, not below `rough`.
pub(super) fn nice_step(rough: f64) -> f64 {
    let power = 10f64.powf(rough.log10().floor());
    [1.0, 2.0, 2.5, 5.0, 10.0].into_iter().map(|m| m * power).find(|step| *step >= rough * (1.0 - 1e-9)).unwrap_or(rough)
}

/// A number as people write it beside an axis: `0.5`, `20`, `50 000`, `2·10⁷`, `10⁻⁴`. On an axis that reaches `largest`
/// all numbers keep one style, with at least so many `decimals`.
fn tick_text(value: f64, largest: f64, decimals: usize) -> String {
    let value = if value.abs() < 1e-9 * largest { 0.0 } else { value };
    let size = largest.max(value.abs());
    if value == 0.0 {
        return "0".to_owned();
    }
    if !(9e-3..0.999e7).contains(&size) {
        let text = format!("{value:.6e}");
        let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
        let mantissa = trimmed(mantissa);
        let power = format!("10{}", superscript(exponent));
        return if mantissa == "1" { power } else { format!("{mantissa}·{power}") };
    }
    let text = if decimals > 0 { format!("{value:.decimals$}") } else { trimmed(&format!("{value:.6}")).to_owned() };
    AXIS.digits(&text)
}

fn superscript(exponent: &str) -> String {
    let raised = |c: char| c.to_digit(10).and_then(|digit| "⁰¹²³⁴⁵⁶⁷⁸⁹".chars().nth(digit as usize)).unwrap_or('⁻');
    exponent.chars().map(raised).collect()
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Box2 {
    /// Corner of smallest coordinates.
    pub low: [f64; 2],
    /// Corner of largest coordinates.
    pub high: [f64; 2],
}

/// Distances of a name from its point, px, and directions in which it is tried, best first.
const DISTANCES: [f64; 8] = [10.0, 16.0, 24.0, 36.0, 52.0, 70.0, 92.0, 120.0];
const DIRECTIONS: [[f64; 2]; 8] =
    [[1.0, 0.0], [1.0, -1.0], [1.0, 1.0], [0.0, -1.0], [0.0, 1.0], [-1.0, -1.0], [-1.0, 1.0], [-1.0, 0.0]];
const POINT: f64 = 6.0;
/// Distance of the points that stand for a line, px: less than a name is high.
const LINE_STEP: f64 = 6.0;

impl Box2 {
    pub fn centre(self) -> [f64; 2] {
        [0, 1].map(|i| 0.5 * (self.low[i] + self.high[i]))
    }

    /// Point of the rectangle nearest to another point.
    pub fn nearest(self, to: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|i| to[i].clamp(self.low[i], self.high[i]))
    }

    pub fn overlaps(self, other: Box2) -> bool {
        (0..2).all(|i| self.low[i] < other.high[i] && other.low[i] < self.high[i])
    }

    pub fn contains(self, other: Box2) -> bool {
        (0..2).all(|i| self.low[i] <= other.low[i] && other.high[i] <= self.high[i])
    }
}

/// Rectangles of the given sizes next to the `named` ones of `points`, inside the frame and off the `line` (a gap where it is not finite); if no
/// place is free, the one that covers least.
pub fn place_labels(frame: Box2, points: &[[f64; 2]], line: &[[f64; 2]], named: &[usize], sizes: &[[f64; 2]]) -> Vec<Box2> {
    let around = |p: [f64; 2], room: f64| Box2 { low: p.map(|v| v - room), high: p.map(|v| v + room) };
    let mut taken: Vec<Box2> = points.iter().map(|p| around(*p, POINT)).collect();
    let is_drawn = |ends: &&[[f64; 2]]| ends.iter().flatten().all(|x| x.is_finite());
    taken.extend(line.windows(2).filter(is_drawn).flat_map(|ends| along(ends[0], ends[1])).map(|p| around(p, 1.0)));
    let mut placed = Vec::with_capacity(named.len());
    for (&i, size) in named.iter().zip(sizes) {
        let candidates = DISTANCES.iter().flat_map(|&gap| DIRECTIONS.iter().map(move |&way| (gap, way)));
        let boxes: Vec<Box2> = candidates.map(|(gap, way)| beside(points[i], *size, gap, way)).collect();
        let covered = |spot: &Box2| {
            let outside = usize::from(!frame.contains(*spot)) * 100;
            // A name nearer to another point would be read as that one's.
            let way = |p: &[f64; 2]| distance(spot.nearest(*p), *p);
            let own = way(&points[i]);
            let misread = usize::from(points.iter().enumerate().any(|(other, p)| other != i && way(p) < own));
            outside + misread + taken.iter().filter(|other| spot.overlaps(**other)).count()
        };
        // The first of the least; there are always candidates.
        let best = boxes.iter().min_by_key(|spot| covered(spot)).copied();
        if let Some(best) = best {
            taken.push(best);
            placed.push(best);
        }
    }
    placed
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// Points along a straight stretch, some pixels apart.
pub fn along(from: [f64; 2], to: [f64; 2]) -> Vec<[f64; 2]> {
    let count = (distance(from, to) / LINE_STEP).ceil().max(1.0);
    (0..=count as usize).map(|i| [0, 1].map(|axis| from[axis] + (to[axis] - from[axis]) * i as f64 / count)).collect()
}

fn beside(point: [f64; 2], size: [f64; 2], gap: f64, way: [f64; 2]) -> Box2 {
    let centre = [0, 1].map(|i| point[i] + way[i] * (gap + 0.5 * size[i]));
    Box2 { low: [0, 1].map(|i| centre[i] - 0.5 * size[i]), high: [0, 1].map(|i| centre[i] + 0.5 * size[i]) }
}
