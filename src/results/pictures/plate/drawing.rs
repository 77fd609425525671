//! `plate.svg`: the plate to scale with its loads, the first crack and the way of every tip, coloured by cycles.

use super::{LoadDrawn, Plate};
use crate::axis::{Box2, place_labels};
use crate::chart::{COMPUTED, INK, Size, width_of};
use crate::curve::RunTables;
use crate::pictures::curves::a_n_moving;
use crate::record::RunRecord;
use crate::specimen_picture::sketch::Sketch;
use perilife_base::monotone::Monotone;
use perilife_base::units::shown::{name_of, per};
use perilife_plate::specimen::Point;
use perilife_plate::specimen::geometry::{along, bounding_box, distance, point_in_polygon};

/// Size of the picture in a file of its own.
pub const SIZE: Size = Size { width: 760.0, height: 520.0, text: 13.0 };
/// Size of the one that moves, with its curve.
pub const MOVING: Size = Size { width: 1120.0, height: 520.0, text: 13.0 };
const PLATE: &str = "#e3e8ee";
const EDGE: &str = "#44505d";
const QUIET: &str = "#55606d";
/// From the first to the last cycle: lightness falls all the way, so that it reads in grey too.
const RAMP: [[f64; 3]; 5] =
    [[90.0, 169.0, 230.0], [79.0, 127.0, 209.0], [106.0, 82.0, 179.0], [122.0, 42.0, 130.0], [90.0, 11.0, 69.0]];
/// Shares of the life that are marked along the path, percent.
const MARKS: [f64; 4] = [25.0, 50.0, 75.0, 90.0];
/// How much larger cracks and their ways are in a picture of their own at the least.
const ENLARGED: f64 = 1.4;
/// Places of a tip between which an animation moves it evenly.
const FRAMES: usize = 40;
/// Room around the plate for loads, and below it for the scale, px.
const AROUND: f64 = 44.0;
const BELOW: f64 = 26.0;
/// Length of the arrow of the largest load, px.
const ARROW: f64 = 18.0;

/// The way of a tip from its start on.
struct Way {
    /// Places, mm.
    places: Vec<Point>,
    /// Cycles over the way, mm.
    cycles: Monotone,
    /// Way up to every place.
    lengths: Vec<f64>,
}

impl Way {
    fn of(path: &[[f64; 3]]) -> Self {
        // The initial crack is drawn by itself: its far end stands first, at N = 0 as the tip.
        let start = path.iter().rposition(|row| row[0] <= 0.0).unwrap_or(0);
        let places: Vec<Point> = path[start..].iter().map(|row| [row[1], row[2]]).collect();
        let mut lengths = vec![0.0];
        for pair in places.windows(2) {
            lengths.push(lengths[lengths.len() - 1] + distance(pair[0], pair[1]));
        }
        let table = lengths.iter().zip(&path[start..]).map(|(length, row)| [*length, row[0]]);
        Way { cycles: Monotone::new(table), places, lengths }
    }

    /// Place at a way from the start, mm.
    fn at(&self, length: f64) -> Point {
        let after = self.lengths.partition_point(|known| *known <= length).min(self.places.len() - 1);
        let before = after.saturating_sub(1);
        let width = self.lengths[after] - self.lengths[before];
        let share = if width > 0.0 { ((length - self.lengths[before]) / width).clamp(0.0, 1.0) } else { 0.0 };
        along(self.places[before], self.places[after], share)
    }

    fn whole(&self) -> f64 {
        self.lengths.last().copied().unwrap_or(0.0)
    }

    /// Way at cycles; `None` beyond the last.
    fn length_at(&self, cycles: f64) -> Option<f64> {
        let (mut low, mut high) = (0.0, self.whole());
        if self.cycles.at(high) < cycles {
            return None;
        }
        for _ in 0..50 {
            let middle = 0.5 * (low + high);
            if self.cycles.at(middle) < cycles { low = middle } else { high = middle }
        }
        Some(high)
    }
}

/// SVG text: the whole plate, and beside it the cracks where they are small in it.
pub fn plate_svg(plate: &Plate, tables: &RunTables, size: Size) -> String {
    let ways: Vec<Way> = tables.paths.iter().filter(|path| !path.is_empty()).map(|path| Way::of(path)).collect();
    let [low, high] = bounding_box(&plate.outline_mm);
    let of_cracks: Vec<Point> =
        plate.cracks_mm.iter().flatten().chain(ways.iter().flat_map(|way| &way.places)).copied().collect();
    // Beside the plate there is room for loads only where some act there.
    let beside = if plate.loads.iter().any(|load| load.direction[0].abs() > 0.5) { AROUND } else { 14.0 };
    let room = |width: f64| [width - 2.0 * beside, size.height - 2.0 * AROUND - BELOW];
    let narrow = 0.45 * size.width;
    let is_enlarged = |own: &[Point; 2]| {
        middled(around(*own), beside_plate(size), [0.0; 2]).scale > ENLARGED * middled([low, high], room(narrow), [0.0; 2]).scale
    };
    let of_cracks = (!of_cracks.is_empty()).then(|| bounding_box(&of_cracks)).filter(is_enlarged);
    let width = if of_cracks.is_some() { narrow } else { size.width };
    let room = room(width);
    let mut sketch = middled([low, high], room, [0.5 * width, AROUND + 0.5 * room[1]]);
    let drawing = Drawing { plate, ways: &ways, life: tables.life(), text: size.text, width: size.width };
    let detail = of_cracks.map(|own| drawing.detail(own, size));
    let bar = [sketch.scale, high[0] - low[0]];
    sketch.group(&view([0.0; 2], [width, size.height], sketch.scale, sketch.origin), |sketch| {
        drawing.body(sketch);
        drawing.loads(sketch);
        drawing.cracks(sketch, detail.is_none());
        scale_bar(sketch, [14.0, size.height - 8.0], bar, size.text);
        if let Some((_, size, Sketch { scale, origin, .. })) = &detail {
            let corner = |[x, y]: Point| sketch.place([(x - origin[0]) / scale, (origin[1] - y) / scale]);
            let corners = [[0.0; 2], *size].map(|place| corner(place).map(|x| x.max(1.0))).map(|[x, y]| [x.min(width - 1.0), y]);
            sketch.group(r#"class="frame""#, |sketch| sketch.frame(corners, "3 3"));
        }
    });
    if let Some((place, [width, height], inner)) = detail {
        let (origin, bar) = ([0, 1].map(|i| place[i] + inner.origin[i]), [inner.scale, width / inner.scale]);
        let (corner, whole) = (place.map(|x| x - 1.0), [width + 2.0, height + 2.0 * size.text]);
        sketch.group(&view(corner, whole, inner.scale, origin), |sketch| {
            sketch.within(place, [width, height], inner);
            scale_bar(sketch, [place[0] + 1.0, place[1] + height + 1.5 * size.text], bar, size.text);
            sketch.group(r#"class="frame""#, |sketch| sketch.frame([place, [place[0] + width, place[1] + height]], ""));
        });
    }
    if !ways.is_empty() {
        ramp(&mut sketch, size);
    }
    let of_paths = |count| format!("; paths of {count} crack tips, colored by cycles");
    let paths = Some(ways.len()).filter(|count| *count > 0).map_or_else(String::new, of_paths);
    sketch.picture([size.width, size.height], &format!("Plate, {}{paths}", plate.load))
}

/// A sketch to scale in which a box of the plate fills the room about a pixel.
fn middled([low, high]: [Point; 2], room: Point, [x, y]: Point) -> Sketch {
    let scale = (room[0] / (high[0] - low[0])).min(room[1] / (high[1] - low[1]));
    let middle = along(low, high, 0.5);
    Sketch::new(scale, [x - middle[0] * scale, y + middle[1] * scale])
}

/// Attributes of a part of the picture that a page may show by itself: its corner and size, px, and its pixels to a mm with the pixel of (0, 0).
fn view([x, y]: Point, [width, height]: Point, scale: f64, [left, top]: Point) -> String {
    format!(r#"class="view" data-box="{x:.1} {y:.1} {width:.1} {height:.1}" data-mm="{scale} {left} {top}""#)
}

/// The plate at the left with cracks that grow as cycles go by, and at the right the curve with a dot that follows; SVG that moves by itself.
pub fn growth_svg(plate: &Plate, run: &RunRecord, tables: &RunTables, size: Size) -> String {
    let ways: Vec<Way> = tables.paths.iter().filter(|path| !path.is_empty()).map(|path| Way::of(path)).collect();
    let [low, high] = bounding_box(&plate.outline_mm);
    let (width, life) = (0.5 * size.width, tables.life());
    let room = [width - 2.0 * AROUND, size.height - 2.0 * AROUND - BELOW];
    let mut sketch = middled([low, high], room, [0.5 * width, AROUND + 0.5 * room[1]]);
    let drawing = Drawing { plate, ways: &[], life, text: size.text, width: size.width };
    drawing.body(&mut sketch);
    drawing.loads(&mut sketch);
    drawing.cracks(&mut sketch, true);
    for way in &ways {
        let lengths = || (0..=FRAMES).map(|frame| way.whole() * frame as f64 / FRAMES as f64);
        let places: Vec<Point> = lengths().map(|length| sketch.place(way.at(length))).collect();
        let times: Vec<f64> = lengths().map(|length| way.cycles.at(length) / life).collect();
        sketch.growing(&places, &times, COMPUTED, 3.5);
    }
    let bar = [sketch.scale, high[0] - low[0]];
    scale_bar(&mut sketch, [14.0, size.height - 8.0], bar, size.text);
    sketch.within([width, 0.0], [width, size.height], a_n_moving(run, tables, Size { width, ..size }));
    sketch.picture([size.width, size.height], &format!("Cracks as they grow over {life:.0} cycles, {}", plate.load))
}

/// A plate in the making; coordinates in mm.
pub(crate) struct Drawing<'a> {
    plate: &'a Plate,
    ways: &'a [Way],
    life: f64,
    text: f64,
    width: f64,
}

impl<'a> Drawing<'a> {
    pub(crate) fn of(plate: &'a Plate, text: f64) -> Self {
        Drawing { plate, ways: &[], life: 0.0, text, width: f64::INFINITY }
    }

    /// Outline, holes and slots.
    pub(crate) fn body(&self, sketch: &mut Sketch) {
        sketch.group(r#"class="plate-body""#, |sketch| sketch.polygon(&self.plate.outline_mm, PLATE, EDGE));
        sketch.group(r#"class="plate-hole""#, |sketch| self.holes(sketch));
    }

    fn holes(&self, sketch: &mut Sketch) {
        for hole in &self.plate.holes {
            sketch.circle([hole.x_mm, hole.y_mm], 0.5 * hole.diameter_mm, "white", EDGE);
        }
        for slot in &self.plate.slots_mm {
            sketch.polygon(slot, "white", "none");
            for side in 0..slot.len() {
                let (from, to) = (slot[side], slot[(side + 1) % slot.len()]);
                // Walls are drawn inside the plate only: the mouth is open.
                let inside = |share: f64| point_in_polygon(along(from, to, share), &self.plate.outline_mm);
                let parts: Vec<f64> = (0..64).map(|part| (f64::from(part) + 0.5) / 64.0).filter(|share| inside(*share)).collect();
                if let [first, .., last] = parts.as_slice() {
                    sketch.path(&[sketch.place(along(from, to, *first)), sketch.place(along(from, to, *last))], EDGE, 1.4, "");
                }
            }
        }
    }

    /// First cracks in ink, ways in the colours of cycles, tips; with the marks of the life where they are asked for.
    fn cracks(&self, sketch: &mut Sketch, is_large: bool) {
        let width = if is_large { 4.0 } else { 2.4 };
        for (number, way) in self.ways.iter().enumerate() {
            let group = format!(r#"class="way" data-tip="{number}" fill="none" stroke-width="{width}""#);
            sketch.group(&group, |sketch| self.steps(sketch, way));
        }
        sketch.group(r#"class="flaw""#, |sketch| {
            for ends in &self.plate.cracks_mm {
                sketch.path(&ends.map(|end| sketch.place(end)), INK, if is_large { 5.0 } else { 3.2 }, "");
            }
        });
        let mut taken = Vec::new();
        // Shares of the life stand beside the longest way of one crack; beside those of several cracks they would cover others.
        let longest = self.ways.iter().map(Way::whole).fold(0.0, f64::max);
        let named = self.ways.iter().position(|way| way.whole() >= longest && longest > 0.0 && self.ways.len() <= 2);
        if is_large {
            let grown = self.ways.iter().enumerate().filter(|(_, way)| way.whole() > 0.0);
            grown.for_each(|(number, way)| self.marks(sketch, way, named == Some(number), &mut taken));
        }
        let ends: Vec<Point> = self.ways.iter().map(|way| sketch.place(way.at(way.whole()))).collect();
        let names = if is_large && ends.len() > 1 { self.names(sketch, &ends, &taken) } else { Vec::new() };
        for (number, end) in ends.into_iter().enumerate() {
            sketch.group(&format!(r#"class="tip" data-tip="{number}""#), |sketch| {
                sketch.ring(end, if is_large { 4.5 } else { 3.0 }, INK, 1.8);
                if let Some([x, y]) = names.get(number).map(|place| place.centre()) {
                    sketch.name([x, y + 0.35 * self.text], &number.to_string(), "middle", self.text, INK);
                }
            });
        }
    }

    /// Places of the numbers of the tips, off cracks, ways and words that stand already.
    fn names(&self, sketch: &Sketch, ends: &[Point], taken: &[Point]) -> Vec<Box2> {
        let drawn = self.ways.iter().map(|way| &way.places[..]).chain(self.plate.cracks_mm.iter().map(|ends| &ends[..]));
        let line = drawn.flat_map(|places| places.iter().map(|at| sketch.place(*at)).chain([[f64::NAN; 2]]));
        let words = taken.iter().flat_map(|[x, y]| [-1.2, 0.0, 1.2].map(|side| [x + side * self.text, *y]));
        let points: Vec<Point> = ends.iter().copied().chain(words).collect();
        let frame = Box2 { low: [f64::NEG_INFINITY; 2], high: [f64::INFINITY; 2] };
        let all: Vec<usize> = (0..ends.len()).collect();
        let sizes = vec![[width_of("0", self.text), self.text]; all.len()];
        place_labels(frame, &points, &line.collect::<Vec<_>>(), &all, &sizes)
    }

    /// Steps of three pixels, each in the color of its middle.
    fn steps(&self, sketch: &mut Sketch, way: &Way) {
        let steps = (way.whole() * sketch.scale / 3.0).ceil().clamp(1.0, 400.0);
        for step in 0..steps as usize {
            let ends = [step as f64, step as f64 + 1.08].map(|part| way.whole() * (part / steps).min(1.0));
            let color = colour(way.cycles.at(0.5 * (ends[0] + ends[1])) / self.life);
            sketch.step(ends.map(|end| sketch.place(way.at(end))), &color, way.cycles.at(ends[1]));
        }
    }

    /// Where the tip was at shares of the life; `taken` are the middles of words that stand already.
    fn marks(&self, sketch: &mut Sketch, way: &Way, is_named: bool, taken: &mut Vec<Point>) {
        for share in MARKS {
            let Some(length) = way.length_at(share / 100.0 * self.life) else { continue };
            let at = sketch.place(way.at(length));
            let step = 0.02 * way.whole();
            let (from, to) = (sketch.place(way.at((length - step).max(0.0))), sketch.place(way.at(length + step)));
            let reach = distance(from, to).max(1e-9);
            // Across the way: its upper side first, or the right of one that runs up.
            let across = [(to[1] - from[1]) / reach, -(to[0] - from[0]) / reach];
            let is_lower = across[1] > 0.2 || across[1].abs() <= 0.2 && across[0] < 0.0;
            let upper = if is_lower { across.map(|part| -part) } else { across };
            let half = [1.4 * self.text, 0.6 * self.text];
            let place = |side: f64, out: f64| [0, 1].map(|i| at[i] + side * upper[i] * (out + half[i]));
            let is_free = |middle: Point, wide: f64| {
                let room = [wide * half[0], 2.0 * half[1]];
                !taken.iter().any(|other| (0..2).all(|i| (other[i] - middle[i]).abs() < room[i]))
            };
            let places = [(1.0, 10.0), (-1.0, 10.0), (1.0, 28.0), (-1.0, 28.0)];
            // Words of the second row need room for their line beside words of the first; without room a mark has no words.
            let has_room = |&(side, out): &(f64, f64)| is_free(place(side, out), 2.0) && is_free(place(side, 10.0), 1.2);
            let words = places.into_iter().find(|at| is_named && has_room(at));
            sketch.group(&format!(r#"class="mark" data-cycles="{:.1}""#, share / 100.0 * self.life), |sketch| {
                if let Some((side, out)) = words {
                    let middle = place(side, out);
                    sketch.path(&[at, [0, 1].map(|i| at[i] + side * out * upper[i])], INK, 1.0, "");
                    sketch.name([middle[0], middle[1] + 0.35 * self.text], &format!("{share:.0} %"), "middle", self.text, INK);
                    taken.extend([middle, place(side, 10.0)]);
                }
                sketch.ring(at, 3.0, INK, 1.3);
            });
        }
    }

    /// Arrows, what is held, and the load in words once.
    fn loads(&self, sketch: &mut Sketch) {
        self.arrows(sketch);
        // Words wider than the picture are written smaller.
        let letters = self.plate.load.chars().count() as f64;
        let text = self.text.min((self.width - 8.0) / (0.54 * letters.max(1.0)));
        let top = sketch.place(bounding_box(&self.plate.outline_mm)[1])[1] - 6.0;
        // The upper of two that pull against each other, where it has room for words.
        let is_up = |load: &&LoadDrawn| load.direction[1] > 0.5 || self.plate.loads.iter().all(|load| load.direction[1] < 0.5);
        let at = |load: &LoadDrawn| {
            let middle = along(sketch.place(load.from_mm), sketch.place(load.to_mm), 0.5);
            let tip = self.start(load, sketch.scale) + ARROW + 4.0;
            let place = [middle[0] + tip * load.direction[0], middle[1] - tip * load.direction[1] - 3.0];
            // Words wider than the plate stay within the picture; those of a pin stand above the plate.
            [place[0].max(4.0 + 0.27 * text * letters), place[1].min(top).max(1.2 * text)]
        };
        match self.plate.loads.iter().find(is_up).map(at) {
            Some(place) => sketch.name(place, &self.plate.load, "middle", text, INK),
            None => sketch.name([8.0, 1.2 * self.text], &self.plate.load, "start", text, INK),
        }
    }

    /// Pixels from the place of a load to the foot of its arrow.
    fn start(&self, load: &LoadDrawn, scale: f64) -> f64 {
        let hole = self.plate.holes.iter().find(|hole| load.from_mm == load.to_mm && [hole.x_mm, hole.y_mm] == load.from_mm);
        let held = self.plate.held_mm.iter().any(|[one, other]| *one == load.from_mm || *other == load.from_mm);
        hole.map_or(if held { 11.0 } else { 3.0 }, |hole| 0.5 * hole.diameter_mm * scale + 3.0)
    }

    /// What is held, and arrows of the loads, as long as the load is large there.
    pub(crate) fn arrows(&self, sketch: &mut Sketch) {
        sketch.group(r#"class="plate-load""#, |sketch| self.held_and_pulled(sketch));
    }

    fn held_and_pulled(&self, sketch: &mut Sketch) {
        for [from, to] in &self.plate.held_mm {
            self.hold(sketch, *from, *to);
        }
        for load in &self.plate.loads {
            let way = [load.direction[0], -load.direction[1]];
            let (from, to) = (sketch.place(load.from_mm), sketch.place(load.to_mm));
            let (reach, start) = (distance(from, to), self.start(load, sketch.scale));
            let is_pin = reach < 1e-9;
            if is_pin {
                sketch.dot(from, (start - 5.0).max(2.0), "#7b8794");
            }
            let count = if is_pin { 1.0 } else { (reach / 28.0).round().clamp(1.0, 25.0) };
            for arrow in 0..count as usize {
                let at = (arrow as f64 + 0.5) / count;
                let share = load.shares[0] + at * (load.shares[1] - load.shares[0]);
                if share.abs() < 0.05 {
                    continue;
                }
                let foot = along(from, to, at);
                let ends =
                    [start, start + ARROW * share.abs().max(0.4)].map(|out| [foot[0] + out * way[0], foot[1] + out * way[1]]);
                let [near, far] = if share > 0.0 { ends } else { [ends[1], ends[0]] };
                sketch.arrow(near, far, QUIET, 1.3);
            }
        }
    }

    /// Hatching outside a stretch of the outline that is held.
    fn hold(&self, sketch: &mut Sketch, from: Point, to: Point) {
        let [low, high] = bounding_box(&self.plate.outline_mm);
        let middle = sketch.place(along(low, high, 0.5));
        let (from, to) = (sketch.place(from), sketch.place(to));
        let reach = distance(from, to).max(1e-9);
        let mut out = [(to[1] - from[1]) / reach, -(to[0] - from[0]) / reach];
        let foot = along(from, to, 0.5);
        if (foot[0] - middle[0]) * out[0] + (foot[1] - middle[1]) * out[1] < 0.0 {
            out = out.map(|part| -part);
        }
        sketch.path(&[from, to], EDGE, 2.5, "");
        let count = (reach / 8.0).ceil().clamp(1.0, 200.0);
        for line in 0..count as usize {
            let start = along(from, to, (line as f64 + 1.0) / count);
            let end = along(from, to, line as f64 / count);
            sketch.path(&[start, [end[0] + 8.0 * out[0], end[1] + 8.0 * out[1]]], EDGE, 1.0, "");
        }
    }

    /// The cracks and their ways, enlarged: the corner and size of the part in the picture, px, and the part.
    fn detail(&self, own: [Point; 2], size: Size) -> (Point, Point, Sketch) {
        let (whole, part) = (beside_plate(size), around(own));
        let mut inner = middled(part, whole, [0.0; 2]);
        let frame = [whole[0], ((part[1][1] - part[0][1]) * inner.scale).max(0.55 * whole[0]).min(whole[1])];
        inner.origin = [0, 1].map(|i| inner.origin[i] + 0.5 * frame[i]);
        self.body(&mut inner);
        self.cracks(&mut inner, true);
        ([0.47 * size.width, 24.0 + 0.5 * (whole[1] - frame[1])], frame, inner)
    }
}

/// Most of an enlarged part, px.
fn beside_plate(size: Size) -> Point {
    [0.53 * size.width - 8.0, size.height - 24.0 - 2.0 * BELOW]
}

/// What is enlarged of cracks within a box.
fn around([low, high]: [Point; 2]) -> [Point; 2] {
    let room = 0.22 * (high[0] - low[0]).max(high[1] - low[1]).max(1e-6);
    [low.map(|x| x - room), high.map(|x| x + room)]
}

pub fn colour(share: f64) -> String {
    let at = share.clamp(0.0, 1.0) * (RAMP.len() - 1) as f64;
    let first = (at as usize).min(RAMP.len() - 2);
    let [r, g, b] =
        [0, 1, 2].map(|i| (RAMP[first][i] + (at - first as f64) * (RAMP[first + 1][i] - RAMP[first][i])).round() as u8);
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// A length of 1, 2 or 5 times a power of ten, of the unit that is shown; `scale` is in pixels to a mm, `span` in mm.
pub(crate) fn scale_bar(sketch: &mut Sketch, [x, y]: Point, [scale, span]: [f64; 2], text: f64) {
    let (scale, span) = (scale / per("mm"), span * per("mm"));
    let most = 0.3 * span;
    let power = 10f64.powf(most.log10().floor());
    let length = [5.0, 2.0, 1.0].into_iter().map(|part| part * power).find(|length| *length <= most).unwrap_or(power);
    let end = x + length * scale;
    sketch.group(r#"class="plate-rule""#, |sketch| {
        sketch.path(&[[x, y - 5.0], [x, y], [end, y], [end, y - 5.0]], EDGE, 1.2, "");
        sketch.name([end + 6.0, y], &format!("{length} {}", name_of("mm")), "start", text, QUIET);
    });
}

/// What the colours stand for.
fn ramp(sketch: &mut Sketch, size: Size) {
    let (right, y) = (size.width - 10.0, size.height - 8.0);
    let (width, parts) = (90.0, 30);
    let words = 3.3 * size.text;
    for part in 0..parts {
        let share = f64::from(part) / f64::from(parts);
        let x = right - words - width + share * width;
        let step = width / f64::from(parts) + 0.5;
        sketch.area(&[[x, y - 8.0], [x + step, y - 8.0], [x + step, y], [x, y]], &colour(share), 1.0);
    }
    sketch.name([right - words - width - 6.0, y], "cycles: 0", "end", size.text, QUIET);
    sketch.name([right - words + 6.0, y], "life", "start", size.text, QUIET);
}
