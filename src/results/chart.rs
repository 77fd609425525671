//! Charts as SVG: crack length against cycles, da/dN against ΔK, K against crack length.

use std::path::Path;

use super::axis::{Axis, Box2, along, place_labels};
use super::output::write_file;
use super::specimen_picture::sketch::Sketch;
use perilife_base::error::Result;
use perilife_plate::specimen::Point;
use perilife_plate::specimen::geometry::distance;

pub const COMPUTED: &str = "#0b5fa5";
pub const SECOND: &str = "#a8480a";
/// Limits and what is not known.
pub const NOTE: &str = "#7a5300";
/// Measured values, ends, words that count.
pub const INK: &str = "#12171d";
const QUIET: &str = "#55606d";
const AXIS: &str = "#7b8794";
const GRID: &str = "#e3e7ec";
/// Width of a broad line, px, and its cover.
const BROAD: f64 = 7.0;
const FAINT: &str = "66";
/// Distance up to which ends of curves share a name, px.
const SHARED: f64 = 5.0;
/// Colours of several series, which differ in lightness too.
pub const COLOURS: [&str; 6] = [COMPUTED, SECOND, "#1b8a6b", "#8a4fa3", NOTE, "#4fa3d1"];
/// Size of a chart in a file of its own, px, and of its numbers.
pub const LARGE: Size = Size { width: 900.0, height: 560.0, text: 14.0 };

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Size {
    pub width: f64,
    pub height: f64,
    /// Height of numbers and words, px.
    pub text: f64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mark {
    /// Computed: a line through the points.
    Line,
    /// What counts of several lines: a broad one below them.
    Broad,
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
    pub name: String,
    /// (x, y); points that are not finite (or not positive on a logarithmic axis) leave a gap.
    pub points: Vec<(f64, f64)>,
    pub mark: Mark,
}

/// Any quantities, both linear; `names` says what stands along x and y in which units.
pub fn linear(path: &Path, title: &str, names: [&str; 2], series: &[Series]) -> Result<()> {
    let axes = [Axis::linear(values(series, |p| p.0)), Axis::linear(values(series, |p| p.1))];
    draw(path, title, axes, names, series)
}

pub const OF_RATES: [&str; 2] = ["Stress intensity range ΔK, MPa√m", "Crack growth rate da/dN, mm/cycle"];

/// Growth rate in mm/cycle against ΔK in MPa√m, both logarithmic.
pub fn growth_rate(path: &Path, title: &str, series: &[Series]) -> Result<()> {
    let positive: Vec<Series> = series
        .iter()
        .map(|s| {
            let or_gap = |(x, y): &(f64, f64)| if *x > 0.0 && *y > 0.0 { (*x, *y) } else { (f64::NAN, f64::NAN) };
            Series { points: s.points.iter().map(or_gap).collect(), ..s.clone() }
        })
        .collect();
    let axes = [Axis::logarithmic(values(&positive, |p| p.0)), Axis::logarithmic(values(&positive, |p| p.1))];
    draw(path, title, axes, OF_RATES, &positive)
}

fn values(series: &[Series], pick: fn(&(f64, f64)) -> f64) -> impl Iterator<Item = f64> {
    series.iter().flat_map(|s| &s.points).filter(|(x, y)| x.is_finite() && y.is_finite()).map(pick)
}

/// A chart with the names of its series in rows above it.
fn draw(path: &Path, title: &str, axes: [Axis; 2], names: [&str; 2], series: &[Series]) -> Result<()> {
    let mut colours = COLOURS.iter().cycle();
    let colours: Vec<&str> = series
        .iter()
        .map(|series| if series.mark == Mark::Circles { INK } else { colours.next().copied().unwrap_or(INK) })
        .collect();
    let legend: Vec<(Mark, &str, &str)> =
        series.iter().zip(&colours).map(|(series, colour)| (series.mark, *colour, &*series.name)).collect();
    let mut frame = Frame::new(LARGE, title, axes, names, &legend);
    for (series, colour) in series.iter().zip(colours) {
        let points: Vec<Point> = series.points.iter().map(|(x, y)| [*x, *y]).collect();
        match series.mark {
            Mark::Line => frame.pieces(&points, colour, 2.0, ""),
            Mark::Broad => frame.pieces(&points, &format!("{colour}{FAINT}"), BROAD, ""),
            Mark::Dashes => frame.pieces(&points, colour, 2.0, "8 5"),
            Mark::Circles => frame.circles(&points),
            Mark::Dots => frame.dots(&points, colour),
        }
    }
    write_file(path, frame.finish(&format!("{title}: {} against {}", names[1], names[0])).as_bytes())
}

/// A chart in the making: two axes with their names and numbers, to which lines, areas and marks are added.
pub struct Frame {
    sketch: Sketch,
    axes: [Axis; 2],
    /// Left, top, right and bottom of the plot, px.
    room: [f64; 4],
    size: Size,
}

/// Width of words, px, about.
pub fn width_of(words: &str, text: f64) -> f64 {
    0.56 * text * words.chars().count() as f64
}

impl Frame {
    /// An empty chart. `title` may be empty; `legend` are marks with their colours and names, in rows below the title.
    pub fn new(size: Size, title: &str, axes: [Axis; 2], names: [&str; 2], legend: &[(Mark, &str, &str)]) -> Self {
        let text = size.text;
        let [of_x, of_y] = axes;
        let [x, y] = [of_x.named(names[0]), of_y.named(names[1])];
        let widest = y.ticks().iter().map(|(_, words)| width_of(words, text)).fold(0.0, f64::max);
        let mut sketch = Sketch::new(1.0, [0.0; 2]);
        let mut top = 0.5 * text;
        if !title.is_empty() {
            top += 1.5 * text;
            sketch.name([0.5 * text, top], title, "start", 1.15 * text, INK);
            top += 0.7 * text;
        }
        top = Self::legend(&mut sketch, legend, size, top);
        let room = [widest + 1.4 * text, top + 2.5 * text, size.width - 1.2 * text, size.height - 3.8 * text];
        let mut frame = Frame { sketch, axes: [x, y], room, size };
        frame.draw_axes(names);
        frame
    }

    /// Room is left beside the plot for names of so many letters.
    pub fn with_names(mut size: Size, axes: [Axis; 2], names: [&str; 2], letters: usize) -> Self {
        let beside = width_of(&"n".repeat(letters), size.text);
        let whole = size.width;
        size.width -= beside;
        let mut frame = Frame::new(size, "", axes, names, &[]);
        frame.size.width = whole;
        frame
    }

    fn legend(sketch: &mut Sketch, legend: &[(Mark, &str, &str)], size: Size, mut top: f64) -> f64 {
        let text = size.text;
        let mut left = 0.5 * text;
        for (place, (mark, colour, name)) in legend.iter().enumerate() {
            let width = 3.2 * text + width_of(name, text) + 1.5 * text;
            if place == 0 || left + width > size.width {
                (left, top) = (0.5 * text, top + 1.5 * text);
            }
            let (from, to, middle) = (left, left + 2.4 * text, left + 1.2 * text);
            let height = top - 0.35 * text;
            match mark {
                Mark::Line => sketch.path(&[[from, height], [to, height]], colour, 2.0, ""),
                Mark::Broad => sketch.path(&[[from, height], [to, height]], &format!("{colour}{FAINT}"), BROAD, ""),
                Mark::Dashes => sketch.path(&[[from, height], [to, height]], colour, 2.0, "8 5"),
                Mark::Circles => sketch.ring([middle, height], 3.0, colour, 1.1),
                Mark::Dots => sketch.dot([middle, height], 2.5, colour),
            }
            sketch.name([left + 3.0 * text, top], name, "start", text, INK);
            left += width;
        }
        top
    }

    fn draw_axes(&mut self, [x_name, y_name]: [&str; 2]) {
        let ([left, top, right, bottom], text) = (self.room, self.size.text);
        for (value, words) in self.axes[1].ticks() {
            let y = self.at([self.axes[0].ends()[0], value])[1];
            self.sketch.path(&[[left, y], [right, y]], GRID, 1.0, "");
            self.sketch.name([left - 0.6 * text, y + 0.35 * text], &words, "end", text, QUIET);
        }
        for value in self.axes[0].faint() {
            let x = self.at([*value, self.axes[1].ends()[0]])[0];
            self.sketch.path(&[[x, top], [x, bottom]], GRID, 1.0, "");
        }
        self.sketch.path(&[[left, bottom], [right, bottom]], AXIS, 1.0, "");
        let mut free = f64::NEG_INFINITY;
        for (value, words) in self.axes[0].ticks() {
            let x = self.at([value, self.axes[1].ends()[0]])[0];
            let half = 0.5 * width_of(&words, text);
            // A number that would touch the one before is left out, and so is its tick.
            if x - half < free {
                continue;
            }
            free = x + half + 0.4 * text;
            self.sketch.path(&[[x, bottom], [x, bottom + 4.0]], AXIS, 1.0, "");
            let place = x.min(self.size.width - half - 1.0);
            self.sketch.name([place, bottom + 4.0 + 1.1 * text], &words, "middle", text, QUIET);
        }
        self.sketch.name([0.5 * text, top - 1.0 * text], y_name, "start", text, INK);
        self.sketch.name([right, bottom + 2.9 * text], x_name, "end", text, INK);
    }

    pub fn at(&self, [x, y]: Point) -> Point {
        let [left, top, right, bottom] = self.room;
        [left + self.axes[0].share(x) * (right - left), bottom - self.axes[1].share(y) * (bottom - top)]
    }

    fn pixels(&self, points: &[Point]) -> Vec<Point> {
        let known = points.iter().filter(|point| point.iter().all(|value| value.is_finite()));
        known.map(|point| self.at(*point)).filter(|place| place.iter().all(|value| value.is_finite())).collect()
    }

    /// A line through points; one that is alone is a dot. Points that are not finite are passed over.
    pub fn line(&mut self, points: &[Point], colour: &str, width: f64, dash: &str) {
        let places = self.pixels(points);
        match places.as_slice() {
            [] => {}
            [alone] => self.sketch.dot(*alone, width, colour),
            _ => self.sketch.path(&places, colour, width, dash),
        }
    }

    /// The same, broken where a point is not finite: nothing is drawn where nothing is known.
    pub fn pieces(&mut self, points: &[Point], colour: &str, width: f64, dash: &str) {
        for piece in points.split(|point| !point.iter().all(|value| value.is_finite())) {
            self.line(piece, colour, width, dash);
        }
    }

    /// Left, top, right and bottom of the plot, px.
    pub fn room(&self) -> [f64; 4] {
        self.room
    }

    /// What else is drawn over the plot, in pixels.
    pub fn sketch(&mut self) -> &mut Sketch {
        &mut self.sketch
    }

    pub fn into_sketch(self) -> Sketch {
        self.sketch
    }

    /// Fills what lies below a value along y, from one x to another.
    pub fn below(&mut self, y: f64, [from, to]: [f64; 2], colour: &str, opacity: f64) {
        let bottom = self.room[3];
        let [[left, top], [right, _]] = [from, to].map(|x| self.at([x, y]));
        self.sketch.area(&[[left, bottom], [left, top], [right, top], [right, bottom]], colour, opacity);
    }

    pub fn band(&mut self, low: &[Point], high: &[Point], opacity: f64) {
        let mut corners = self.pixels(low);
        corners.extend(self.pixels(high).into_iter().rev());
        self.sketch.area(&corners, COMPUTED, opacity);
    }

    pub fn circles(&mut self, points: &[Point]) {
        let radius = if self.size.text > 12.0 { 3.2 } else { 2.2 };
        self.pixels(points).into_iter().for_each(|place| self.sketch.ring(place, radius, INK, 1.1));
    }

    /// Small dots, darker where many lie.
    pub fn dots(&mut self, points: &[Point], colour: &str) {
        let fill = format!("{colour}8c");
        self.pixels(points).into_iter().for_each(|place| self.sketch.dot(place, 2.0, &fill));
    }

    /// A ring around a point that is spoken of.
    pub fn ring(&mut self, point: Point, colour: &str) {
        self.pixels(&[point]).into_iter().for_each(|place| self.sketch.ring(place, 4.5, colour, 1.8));
    }

    /// A cross where a curve ends, and why.
    pub fn end(&mut self, point: Point, why: &str) {
        for [x, y] in self.pixels(&[point]) {
            self.sketch.cross([x, y], 5.0, INK, 2.0);
            self.sketch.name([x - 9.0, y - 3.0], why, "end", self.size.text, INK);
        }
    }

    /// A dashed limit across the plot, named at its left: below it unless it is low, since a curve that passes it ends above.
    pub fn limit(&mut self, y: f64, name: &str) {
        let ([left, _, right, _], text) = (self.room, self.size.text);
        let height = self.at([self.axes[0].ends()[0], y])[1];
        if self.contains(y) {
            self.sketch.path(&[[left, height], [right, height]], NOTE, 1.0, "3 3");
            let away = if self.axes[1].share(y) > 0.3 { text } else { -4.0 };
            self.sketch.name([left + 6.0, height + away], name, "start", text, NOTE);
        }
    }

    fn contains(&self, y: f64) -> bool {
        (0.0..=1.0).contains(&self.axes[1].share(y))
    }

    /// Hatches what is beyond a value along y, above or below it.
    pub fn unknown(&mut self, y: f64, is_above: bool, name: &str) {
        let ([left, top, right, bottom], text) = (self.room, self.size.text);
        if !self.contains(y) {
            return;
        }
        let edge = self.at([self.axes[0].ends()[0], y])[1];
        let (from, to) = if is_above { (top, edge) } else { (edge, bottom) };
        self.sketch.hatch([left, from], [right, to], NOTE);
        if to - from > 1.6 * text {
            self.sketch.name([left + 6.0, from + 1.2 * text], name, "start", text, NOTE);
        }
    }

    pub fn remark(&mut self, words: &str) {
        let ([left, _, _, bottom], text) = (self.room, self.size.text);
        self.sketch.name([left + 6.0, bottom - 0.5 * text], words, "start", text, NOTE);
    }

    /// Names of curves beside their last points, where they cover no curve and no other name.
    pub fn names(&mut self, named: &[(String, Point, &str)], curves: &[Vec<Point>]) {
        let ([left, top, _, bottom], text) = (self.room, self.size.text);
        let room = Box2 { low: [left, top], high: [self.size.width, bottom] };
        let ends: Vec<Point> = named.iter().map(|(_, end, _)| self.at(*end)).collect();
        let line: Vec<Point> = curves.iter().flat_map(|curve| self.pixels(curve).into_iter().chain([[f64::NAN; 2]])).collect();
        let sizes: Vec<Point> = named.iter().map(|(words, ..)| [width_of(words, text), 1.1 * text]).collect();
        let all: Vec<usize> = (0..named.len()).collect();
        // A name that is nearer to another curve than to the end of its own would be read as that of the other.
        let reach = |place: &Box2, curve: &[Point]| {
            let parts = curve.windows(2).flat_map(|ends| along(ends[0], ends[1]));
            parts.map(|at| distance(place.nearest(at), at)).fold(f64::INFINITY, f64::min)
        };
        let curves: Vec<Vec<Point>> = curves.iter().map(|curve| self.pixels(curve)).collect();
        for ((place, end), (words, _, colour)) in place_labels(room, &ends, &line, &all, &sizes).into_iter().zip(&ends).zip(named)
        {
            let own = distance(place.nearest(*end), *end);
            let is_other = |curve: &&Vec<Point>| curve.last().is_none_or(|last| distance(*last, *end) > SHARED);
            if curves.iter().filter(is_other).any(|curve| reach(&place, curve) < own) {
                continue;
            }
            self.sketch.name([place.low[0], place.centre()[1] + 0.35 * text], words, "start", text, colour);
        }
    }

    /// A dashed line up at a value along x, named beside its foot.
    pub fn mark(&mut self, x: f64, name: &str) {
        let ([_, top, _, bottom], text) = (self.room, self.size.text);
        let x = self.at([x, self.axes[1].ends()[0]])[0];
        self.sketch.path(&[[x, top], [x, bottom]], NOTE, 1.0, "3 3");
        self.sketch.name([x + 5.0, bottom - 0.5 * text], name, "start", text, NOTE);
    }

    /// Puts what was drawn beside other charts into a picture, at a pixel.
    pub fn beside(self, picture: &mut Sketch, place: Point) {
        picture.within(place, [self.size.width, self.size.height], self.sketch);
    }

    pub fn finish(self, sentence: &str) -> String {
        self.sketch.picture([self.size.width, self.size.height], sentence)
    }
}
