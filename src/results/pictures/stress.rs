//! `stress.svg`: von Mises stress and σ_y over the deformed plate in named bands, flanks of cracks open, the yield strength as a line.

use crate::axis::nice_step;
use crate::chart::{INK, Size};
use crate::format::PLAIN;
use crate::specimen_picture::sketch::Sketch;
use perilife_base::units::shown::per;
use perilife_base::units::{MM, MPA};
use perilife_growth::predict::moment::StressField;
use perilife_nodes::solve::Stress;
use perilife_nodes::stress_field::Corner;
use perilife_plate::material::Material;
use perilife_plate::specimen::geometry::{along, bounding_box, distance, polygon_area};
use perilife_plate::specimen::{CrackLine, Hole, Point};

/// Size of the picture, px; it is as high as the plate asks for between two bounds.
const SIZE: Size = Size { width: 1120.0, height: 0.0, text: 13.0 };
const HEIGHTS: [f64; 2] = [260.0, 760.0];
/// Room above the plates for words, beside one for its bar, below for the scale, and between, px.
const HEAD: f64 = 66.0;
const BAR: f64 = 92.0;
const FOOT: f64 = 40.0;
const GAP: f64 = 16.0;
const QUIET: &str = "#55606d";
const YIELD: &str = "#d9001b";
/// Both ramps rise or fall in lightness all the way (viridis; blue over grey to red), so that they read in grey too.
const ONE_SIGN: [&str; 9] = ["#440154", "#482878", "#3e4a89", "#31688e", "#26828e", "#1f9e89", "#35b779", "#6ece58", "#fde725"];
const BELOW_ZERO: [&str; 4] = ["#b9d3e8", "#7fb0d6", "#4a8bc2", "#2166ac"];
const ABOVE_ZERO: [&str; 8] = ["#e4e7ea", "#f6cdb0", "#ef9f78", "#dd6a4f", "#c03a3a", "#971b31", "#6a0a27", "#3f0216"];
/// Parts of the area that is seen below and above which stress is in the bands at the ends, which have no other bound.
const ENDS: [f64; 2] = [0.01, 0.98];
/// Displacement over the size of what is seen to which it is enlarged, about.
const SHOWN: f64 = 0.04;
/// Size of cracks over that of the plate below which their surroundings alone are seen, and how many times as large these are.
const SMALL: f64 = 0.2;
const AROUND: f64 = 2.5;

/// What a panel shows of a stress.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Of {
    VonMises,
    AlongY,
}

impl Of {
    fn value(self, stress: &Stress) -> f64 {
        in_shown(match self {
            Of::VonMises => stress.von_mises(),
            Of::AlongY => stress.y,
        })
    }

    fn title(self) -> &'static str {
        match self {
            Of::VonMises => "Von Mises stress, MPa",
            Of::AlongY => "σ_y, MPa (thin line: 0)",
        }
    }
}

fn in_shown(stress: f64) -> f64 {
    per("MPa") * stress / MPA
}

pub fn stress_svg(field: &StressField, material: &Material, holes: &[Hole]) -> String {
    let seen = seen(field, holes);
    let factor = factor(field, &seen);
    let moved = deformed(field, factor);
    let size = |i: usize| seen[1][i] - seen[0][i];
    let width = 0.5 * (SIZE.width - GAP) - BAR - 8.0;
    let scale = (width / size(0)).min((HEIGHTS[1] - HEAD - FOOT) / size(1));
    let height = (size(1) * scale + HEAD + FOOT).max(HEIGHTS[0]);
    let mut sketch = Sketch::new(1.0, [0.0; 2]);
    let when = if field.cycles > 0.0 { format!(", {} cycles", PLAIN.whole(field.cycles)) } else { String::new() };
    let lengthened = format!("Stress at maximum load{when}: displacements × {factor}");
    sketch.name([8.0, 1.5 * SIZE.text], &lengthened, "start", 1.15 * SIZE.text, INK);
    for (place, of) in [Of::VonMises, Of::AlongY].into_iter().enumerate() {
        let left = place as f64 * 0.5 * (SIZE.width + GAP) + 8.0;
        sketch.name([left, HEAD - 12.0], of.title(), "start", SIZE.text, INK);
        let mut inner = Sketch::new(scale, [-seen[0][0] * scale, seen[1][1] * scale]);
        let bands = Bands { seen: [size(0) * scale, size(1) * scale], ..Bands::of(field, &seen, of) };
        draw(&mut inner, field, &moved, &bands, material.yield_strength.filter(|_| of == Of::VonMises));
        sketch.within([left, HEAD], [size(0) * scale, size(1) * scale], inner);
        bands.bar(&mut sketch, [left + size(0) * scale + 16.0, HEAD], (size(1) * scale).clamp(120.0, 320.0));
    }
    super::plate::scale_bar(&mut sketch, [14.0, height - 12.0], [scale * MM, size(0) / MM], SIZE.text);
    if let Some(strength) = material.yield_strength {
        let words = format!("red line: yield strength {:.0} MPa (elastic analysis)", strength / MPA);
        sketch.name([SIZE.width - 12.0, height - 12.0], &words, "end", SIZE.text, QUIET);
    }
    sketch.picture([SIZE.width, height], &format!("{lengthened}; bands of von Mises stress and σ_y"))
}

/// Visible part of the plate, m: all of it, or the surroundings of small cracks with their holes; with room for displacements.
fn seen(field: &StressField, holes: &[Hole]) -> [Point; 2] {
    let [low, high] = bounding_box(&field.pieces.iter().flatten().map(|corner| corner.at).collect::<Vec<Point>>());
    let mut cracks: Vec<Point> = field.cracks.iter().flat_map(CrackLine::pieces).flatten().collect();
    let largest = |[low, high]: [Point; 2]| (high[0] - low[0]).max(high[1] - low[1]);
    let reach = largest(bounding_box(&cracks));
    let is_beside = |hole: &&Hole| cracks.iter().any(|end| distance(*end, hole.centre) < hole.radius + reach);
    let rims =
        holes.iter().filter(is_beside).flat_map(|hole| [-1.0, 1.0].map(|side| hole.centre.map(|x| x + side * hole.radius)));
    cracks.extend(rims.collect::<Vec<Point>>());
    let of_cracks = bounding_box(&cracks);
    let plate = largest([low, high]);
    let room = 1.5 * SHOWN * plate;
    let whole = [low.map(|x| x - room), high.map(|x| x + room)];
    if cracks.is_empty() || largest(of_cracks) > SMALL * plate {
        return whole;
    }
    let (middle, reach) = (along(of_cracks[0], of_cracks[1], 0.5), 0.5 * AROUND * largest(of_cracks));
    [[0, 1].map(|i| (middle[i] - reach).max(whole[0][i])), [0, 1].map(|i| (middle[i] + reach).min(whole[1][i]))]
}

/// Mean displacement and rotation of the plate, by area, so that what is left is its deformation: `[u, v, θ, x, y]`.
fn motion(field: &StressField) -> [f64; 5] {
    let mut sums = [0.0; 5];
    let mut whole = 0.0;
    let middles: Vec<(f64, Point, Point)> = field
        .pieces
        .iter()
        .map(|piece| {
            let corners: Vec<Point> = piece.iter().map(|corner| corner.at).collect();
            let mean = |of: &dyn Fn(&Corner) -> f64| piece.iter().map(of).sum::<f64>() / piece.len() as f64;
            let [at, u] =
                [[mean(&|c| c.at[0]), mean(&|c| c.at[1])], [mean(&|c| c.displacement[0]), mean(&|c| c.displacement[1])]];
            (polygon_area(&corners), at, u)
        })
        .collect();
    for (area, at, u) in &middles {
        whole += area;
        for (sum, value) in sums.iter_mut().zip([u[0], u[1], 0.0, at[0], at[1]]) {
            *sum += area * value;
        }
    }
    let mut mean = sums.map(|sum| sum / whole);
    let (mut turned, mut moment) = (0.0, 0.0);
    for (area, at, u) in &middles {
        let [x, y] = [at[0] - mean[3], at[1] - mean[4]];
        turned += area * (x * (u[1] - mean[1]) - y * (u[0] - mean[0]));
        moment += area * (x * x + y * y);
    }
    mean[2] = turned / moment;
    mean
}

/// Displacement of a corner without the motion of the plate.
fn strained(corner: &Corner, [u, v, turn, x, y]: [f64; 5]) -> Point {
    [corner.displacement[0] - u + turn * (corner.at[1] - y), corner.displacement[1] - v - turn * (corner.at[0] - x)]
}

/// How many times displacements are enlarged: 1, 2 or 5 times a power of ten.
fn factor(field: &StressField, [low, high]: &[Point; 2]) -> f64 {
    let motion = motion(field);
    let is_seen = |corner: &&Corner| (0..2).all(|i| (low[i]..=high[i]).contains(&corner.at[i]));
    let sizes = field.pieces.iter().flatten().filter(is_seen).map(|corner| strained(corner, motion)).map(|[u, v]| u.hypot(v));
    let most = SHOWN * (high[0] - low[0]).max(high[1] - low[1]) / sizes.fold(f64::MIN_POSITIVE, f64::max);
    let power = 10f64.powf(most.log10().floor());
    [5.0, 2.0, 1.0].into_iter().map(|part| part * power).find(|factor| *factor <= most).unwrap_or(power).max(1.0)
}

/// Where the corners of every piece stand, displacements enlarged.
fn deformed(field: &StressField, factor: f64) -> Vec<Vec<Point>> {
    let motion = motion(field);
    let place = |corner: &Corner| {
        let u = strained(corner, motion);
        [0, 1].map(|i| corner.at[i] + factor * u[i])
    };
    field.pieces.iter().map(|piece| piece.iter().map(place).collect()).collect()
}

/// Bands of a stress: what bounds them, in the unit that is shown, and their colours, one more.
struct Bands {
    of: Of,
    levels: Vec<f64>,
    colours: Vec<&'static str>,
    /// Width and height of what is seen, px.
    seen: Point,
}

impl Bands {
    fn of(field: &StressField, [low, high]: &[Point; 2], of: Of) -> Self {
        let is_seen =
            |piece: &&Vec<Corner>| piece.iter().any(|corner| (0..2).all(|i| (low[i]..=high[i]).contains(&corner.at[i])));
        let mut values: Vec<(f64, f64)> = field
            .pieces
            .iter()
            .filter(is_seen)
            .map(|piece| {
                let corners: Vec<Point> = piece.iter().map(|corner| corner.at).collect();
                (piece.iter().map(|corner| of.value(&corner.stress)).sum::<f64>() / piece.len() as f64, polygon_area(&corners))
            })
            .collect();
        values.sort_by(|a, b| a.0.total_cmp(&b.0));
        let whole: f64 = values.iter().map(|(_, area)| area).sum();
        let at = |share: f64| {
            let mut below = 0.0;
            let found = values.iter().find(|(_, area)| {
                below += area;
                below >= share * whole
            });
            found.map_or(1.0, |(value, _)| *value)
        };
        let [low, high] = ENDS.map(at);
        let low = if of == Of::VonMises { 0.0 } else { low.min(0.0) };
        let step = nice_step((high - low).max(1e-6) / 8.0);
        let first = if of == Of::VonMises { 1 } else { ((low / step).round() as i64).clamp(-4, 0) };
        let last = ((high / step).round() as i64).clamp(first + 1, first + 8);
        let levels: Vec<f64> = (first..=last).map(|k| k as f64 * step).collect();
        let colour = |band: usize| {
            // Of the band below the level with this number; the last one has no upper bound.
            let lower = band as i64 + first - 1;
            match of {
                Of::VonMises => ONE_SIGN[band * (ONE_SIGN.len() - 1) / levels.len()],
                Of::AlongY if lower < 0 => BELOW_ZERO[(-1 - lower).clamp(0, 3) as usize],
                Of::AlongY => ABOVE_ZERO[lower.min(7) as usize],
            }
        };
        Bands { of, colours: (0..=levels.len()).map(colour).collect(), levels, seen: [0.0; 2] }
    }

    /// The colours, each boundary named.
    fn bar(&self, sketch: &mut Sketch, [x, top]: Point, height: f64) {
        let step = height / self.colours.len() as f64;
        for (band, colour) in self.colours.iter().enumerate() {
            let y = top + height - (band as f64 + 1.0) * step;
            sketch.area(&[[x, y], [x + 16.0, y], [x + 16.0, y + step + 0.4], [x, y + step + 0.4]], colour, 1.0);
            if let Some(level) = self.levels.get(band) {
                sketch.path(&[[x + 16.0, y], [x + 21.0, y]], INK, 1.0, "");
                let words = |level: f64| format!("{}", (1e6 * level).round() / 1e6).replace('-', "−");
                sketch.name([x + 25.0, y + 0.35 * SIZE.text], &words(*level), "start", SIZE.text, INK);
                // Nothing bounds the last band from above.
                if band + 1 == self.levels.len() {
                    let middle = y - 0.5 * step + 0.35 * SIZE.text;
                    sketch.name([x + 25.0, middle], &format!("≥ {}", words(*level)), "start", SIZE.text, INK);
                }
            }
        }
    }
}

/// The plate with its bands, rims, flanks and lines.
fn draw(sketch: &mut Sketch, field: &StressField, moved: &[Vec<Point>], bands: &Bands, strength: Option<f64>) {
    let mut of_band: Vec<Vec<Vec<Point>>> = vec![Vec::new(); bands.colours.len()];
    let [mut zero, mut yielding, mut rims] = [const { Vec::new() }; 3];
    let [width, height] = bands.seen;
    for (piece, places) in field.pieces.iter().zip(moved) {
        let is_seen = |place: &Point| {
            let [x, y] = sketch.place(*place);
            (0.0..=width).contains(&x) && (0.0..=height).contains(&y)
        };
        if !places.iter().any(is_seen) {
            continue;
        }
        let corners: Vec<(Point, f64)> =
            piece.iter().zip(places).map(|(corner, place)| (sketch.place(*place), bands.of.value(&corner.stress))).collect();
        let [least, largest] =
            corners.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], (_, v)| [low.min(*v), high.max(*v)]);
        for (band, polygons) in of_band.iter_mut().enumerate() {
            let bound = |level: Option<usize>, beyond: f64| level.and_then(|at| bands.levels.get(at)).copied().unwrap_or(beyond);
            let [low, high] = [bound(band.checked_sub(1), f64::NEG_INFINITY), bound(Some(band), f64::INFINITY)];
            if largest < low || least >= high {
                continue;
            }
            let polygon = beyond(&beyond(&corners, low, 1.0), high, -1.0);
            if polygon.len() > 2 {
                polygons.push(polygon.into_iter().map(|(place, _)| place).collect());
            }
        }
        if bands.of == Of::AlongY {
            zero.extend(crossing(&corners, 0.0));
        }
        if let Some(strength) = strength {
            yielding.extend(crossing(&corners, in_shown(strength)));
        }
        let free = (0..piece.len()).filter(|k| piece[*k].is_free);
        rims.extend(free.map(|k| vec![corners[k].0, corners[(k + 1) % corners.len()].0]));
    }
    for (polygons, colour) in of_band.iter().zip(&bands.colours) {
        sketch.areas(polygons, colour);
    }
    sketch.lines(&zero, INK, 0.7);
    sketch.lines(&rims, INK, 1.3);
    sketch.lines(&yielding, YIELD, 1.8);
}

/// What of a convex polygon has values beyond a level, above it (`side` 1) or below (-1); values are linear along its sides.
fn beyond(polygon: &[(Point, f64)], level: f64, side: f64) -> Vec<(Point, f64)> {
    if !level.is_finite() {
        return polygon.to_vec();
    }
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (k, (at, value)) in polygon.iter().enumerate() {
        let (next, then) = polygon[(k + 1) % polygon.len()];
        let [here, there] = [side * (value - level), side * (then - level)];
        if here >= 0.0 {
            kept.push((*at, *value));
        }
        if (here > 0.0 && there < 0.0) || (here < 0.0 && there > 0.0) {
            kept.push((along(*at, next, here / (here - there)), level));
        }
    }
    kept
}

/// The stretch of a level through a polygon, if it crosses it.
fn crossing(polygon: &[(Point, f64)], level: f64) -> Option<Vec<Point>> {
    let sides = (0..polygon.len()).map(|k| (polygon[k], polygon[(k + 1) % polygon.len()]));
    let crossed = sides.filter(|((_, a), (_, b))| (*a < level) != (*b < level));
    let places: Vec<Point> = crossed.map(|((p, a), (q, b))| along(p, q, (level - a) / (b - a))).collect();
    (places.len() == 2).then_some(places)
}
