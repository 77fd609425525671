//! A plate of any outline with round holes, slots and through cracks.
//!
//! ```toml
//! [specimen]
//! kind = "plate"
//! width_mm = 100.0              # with length_mm: a rectangle centred on 0; or outline_mm = [[x, y], ...]; or diameter_mm: a disc about 0;
//!                               # or outline_file = "part.dxf", with its holes and cracks before those of the keys
//! length_mm = 300.0
//! thickness_mm = 2.0
//! holes = [{ x_mm = 20.0, y_mm = 0.0, diameter_mm = 8.0 }]
//! cracks = [{ from_mm = [-5.0, 0.0], to_mm = [5.0, 0.0] }]   # or { path_mm = [[x, y], [x, y], ...] }: a crack with bends
//! notches = [{ from_mm = [-50.0, 20.0], to_mm = [-40.0, 20.0], width_mm = 2.0 }]
//! ```
//! Cracks that share a point or cross are joined; an end that lies on another crack is no tip. A crack may start on an edge, in a hole or in a slot: what lies outside the material is cut off and only the inner end
//! is a tip; an end nearer to one of them than a hundredth of the crack starts there, too. The tip seed of a slot is the middle of each end face that lies in the material. Crack length is the sum of
//! all cracks and slots inside the plate plus all growth. The load is chosen in `[loading]`.

use toml::Value;

use super::drawing::{self, DrawingUnit, Shape, SymmetryPlane};
use super::geometry::{bounding_box, distance, polygon_area, segments_touch, self_intersection, turn};
use super::keys::{LENGTH, THICKNESS, WIDTH};
use super::placement::{check_holes, place_cracks, place_slots};
use super::{Hole, LengthConvention, Point, Slot, Specimen, SpecimenKind};
use perilife_base::error::{Result, fail_if, input, input_missing};
use perilife_base::input::Folder;
use perilife_base::keys::{Given, Section, coordinate, key, length};
use perilife_base::units::place_mm;

/// More than this is a slip, and the checks compare every item with every other.
const ITEMS_MAX: usize = 500;
/// Corners of a drawing, whose arcs have many.
const CORNERS_MAX: usize = 4000;
const OUTLINE: &str = "the outline";

perilife_base::keys! {
    pub(super) struct Keys {
        outline: Option<Vec<Point>> = coordinate("outline_mm", "Outline: corners in order").group(OUTLINE);
        file: Option<String> = key("outline_file", "Drawing of the plate: DXF with layers outline, holes (full circles), cracks").group(OUTLINE);
        unit: Option<DrawingUnit> = key("outline_unit", "Unit of the drawing: where the file has none");
        symmetry: Option<SymmetryPlane> = key("outline_symmetry", "Symmetry of the drawing: half of the plate drawn");
        width: Option<f64> = WIDTH.said("Width W: of a rectangle about 0, with its length").group(OUTLINE);
        length: Option<f64> = LENGTH.said("Length L: of a rectangle about 0, along y");
        diameter: Option<f64> = length("diameter_mm", "Diameter: of a disc about 0").group(OUTLINE);
        thickness: f64 = THICKNESS;
        holes: Vec<HoleKeys> = key("holes", "Circular holes"), or "none" Vec::new();
        cracks: Vec<CrackKeys> = key("cracks", "Cracks: straight or kinked"), or "none" Vec::new();
        notches: Vec<NotchKeys> = key("notches", "Notches: straight slots with square ends"), or "none" Vec::new();
    }
    pub(super) struct HoleKeys {
        x: f64 = coordinate("x_mm", "Hole center, x");
        y: f64 = coordinate("y_mm", "Hole center, y");
        diameter: f64 = length("diameter_mm", "Hole diameter");
    }
    struct CrackKeys {
        from: Option<Point> = coordinate("from_mm", "One end: [x, y]");
        to: Option<Point> = coordinate("to_mm", "Other end: [x, y]");
        path: Option<Vec<Point>> = coordinate("path_mm", "Corners of a kinked crack: both ends included");
    }
    struct NotchKeys {
        from: Point = coordinate("from_mm", "One end: [x, y]");
        to: Point = coordinate("to_mm", "Other end: [x, y]");
        width: f64 = length("width_mm", "Width across");
    }
}

/// What a plate is drawn from, m.
#[derive(Debug, Default)]
pub(super) struct Drawing {
    /// Outline, counter-clockwise and simple.
    pub outline: Vec<Point>,
    pub holes: Vec<Hole>,
    pub slots: Vec<Slot>,
    pub cracks: Vec<Vec<Point>>,
    pub thickness: f64,
}

pub(super) fn from_value(value: &Value, folder: &Folder, notes: &mut Vec<String>) -> Result<Specimen> {
    let given = Given::of(value, "specimen")?;
    let own = Keys::read(&given)?;
    let drawn = drawn(&given, &own, folder)?;
    let outline = match &drawn {
        Some(shape) => simple(shape.outline.clone(), drawing::KEY)?,
        None => outline(&given, &own)?,
    };
    let (mut holes, mut cracks) = drawn.map(|shape| (shape.holes, shape.cracks)).unwrap_or_default();
    holes.extend(read_holes(&own.holes)?);
    let slots = items("specimen.notches", &own.notches, |item, path| {
        ends(path, item.from, item.to).map(|(from, to)| Slot { from, to, width: item.width })
    })?;
    cracks.extend(items("specimen.cracks", &own.cracks, crack_path)?);
    let thickness = own.thickness;
    Drawing { outline, holes, slots, cracks, thickness }.specimen(SpecimenKind::Plate, notes)
}

impl Drawing {
    /// The plate, not yet loaded. What was done to ends of cracks goes into `notes`.
    /// Errors: holes, slots or cracks that do not fit into it or beside each other.
    pub(super) fn specimen(self, kind: SpecimenKind, notes: &mut Vec<String>) -> Result<Specimen> {
        let [low, high] = bounding_box(&self.outline);
        let (width, length) = (high[0] - low[0], high[1] - low[1]);
        let mut specimen = Specimen {
            outline: self.outline,
            holes: self.holes,
            loads: vec![],
            crack_plane_y: None,
            convention: LengthConvention::SumOfTips,
            ..Specimen::strip(kind, width, length, self.thickness)
        };
        check_holes(&specimen)?;
        let slot_tips = place_slots(&mut specimen, self.slots)?;
        place_cracks(&mut specimen, self.cracks, slot_tips, notes)?;
        // Where all cracks lie on one line along an axis it must fall between two columns or rows of points.
        [specimen.crack_plane_x, specimen.crack_plane_y] = [0, 1].map(|axis| {
            let first = specimen.cracks.first()?.from[axis];
            specimen.cracks.iter().all(|crack| crack.from[axis] == first && crack.to[axis] == first).then_some(first)
        });
        Ok(specimen)
    }
}

/// The rectangle centred on 0, m.
pub(super) fn rectangle(width: f64, length: f64) -> Vec<Point> {
    let (x, y) = (width / 2.0, length / 2.0);
    vec![[-x, -y], [x, -y], [x, y], [-x, y]]
}

pub(super) fn read_holes(list: &[HoleKeys]) -> Result<Vec<Hole>> {
    items("specimen.holes", list, |item, _| Ok(Hole { centre: [item.x, item.y], radius: item.diameter / 2.0 }))
}

fn drawn(given: &Given<'_>, own: &Keys, folder: &Folder) -> Result<Option<Shape>> {
    let Some(file) = &own.file else {
        let problem = "applies only to outline_file, which is missing";
        given.refuse_any(&["outline_unit", "outline_symmetry"], problem, "give outline_file, or remove it")?;
        return Ok(None);
    };
    given.refuse_any(&["length_mm"], "conflicts with outline_file", "remove one of them")?;
    drawing::read(file, folder, own.unit, own.symmetry).map(Some)
}

/// Outline, counter-clockwise and simple.
fn outline(given: &Given<'_>, own: &Keys) -> Result<Vec<Point>> {
    const REMEDY: &str = "give width_mm and length_mm, or outline_mm, or diameter_mm, or outline_file";
    match (own.width, own.length, own.diameter, &own.outline) {
        (Some(width), Some(length), ..) => Ok(rectangle(width, length)),
        (None, None, Some(diameter), _) => Ok(disc(diameter / 2.0)),
        (None, None, None, Some(corners)) => polygon(corners),
        (_, Some(_), Some(_), _) | (_, Some(_), _, Some(_)) => Err(given.refuse(
            "length_mm",
            "conflicts with the outline given",
            "give outline_mm, or width_mm and length_mm, or diameter_mm",
        )),
        (None, ..) => Err(given.refuse("width_mm", "is missing", REMEDY)),
        (Some(_), None, ..) => Err(given.refuse("length_mm", "is missing", REMEDY)),
    }
}

/// Sides of the polygon that stands for a circle: its area is 5e-5 too small.
const DISC_SIDES: usize = 360;

/// A disc about the origin as a polygon with its corners on the circle, counter-clockwise, with a flat side at top, bottom, left
/// and right. Built from one eighth, so that it is its own mirror image to the last bit.
fn disc(radius: f64) -> Vec<Point> {
    let quarter = DISC_SIDES / 4;
    let corner = |k: usize| {
        let (first, swapped) = if 2 * k < quarter { (k, false) } else { (quarter - 1 - k, true) };
        let (sin, cos) = (std::f64::consts::TAU * (first as f64 + 0.5) / DISC_SIDES as f64).sin_cos();
        if swapped { [radius * sin, radius * cos] } else { [radius * cos, radius * sin] }
    };
    (0..4).flat_map(|quarters| (0..quarter).map(move |k| turned(corner(k), quarters))).collect()
}

/// A point turned about the origin by quarters of a turn, to the last bit.
pub(super) fn turned([x, y]: Point, quarters: usize) -> Point {
    match quarters {
        0 => [x, y],
        1 => [-y, x],
        2 => [-x, -y],
        _ => [y, -x],
    }
}

fn polygon(corners: &[Point]) -> Result<Vec<Point>> {
    const KEY: &str = "specimen.outline_mm";
    let mut outline = corners.to_vec();
    if outline.len() > 1 && outline.first() == outline.last() {
        outline.pop();
    }
    let remedy = || format!("give 3 to {ITEMS_MAX} corners in order");
    fail_if!(outline.len() > ITEMS_MAX, input(KEY, format!("{} points", corners.len()), "is not an outline", remedy()));
    simple(outline, KEY)
}

/// The outline of a key counter-clockwise, if it is one.
/// Errors: corners that enclose no area, or whose sides meet.
fn simple(mut outline: Vec<Point>, key: &str) -> Result<Vec<Point>> {
    let count = format!("{} points", outline.len());
    if outline.len() < 3 || outline.len() > CORNERS_MAX {
        return Err(input(key, count, "is not an outline", format!("give 3 to {CORNERS_MAX} corners in order")));
    }
    if let Some(i) = (0..outline.len()).find(|&i| distance(outline[i], outline[(i + 1) % outline.len()]) < 1e-9) {
        return Err(input(key, format!("corner {i}"), "is repeated", "remove one of them"));
    }
    if let Some((i, j)) = self_intersection(&outline) {
        let [from, to] = [i, j].map(|corner| place_mm(outline[corner]));
        let problem =
            format!("crosses or touches itself: the edge after corner {i}, {from}, meets the edge after corner {j}, {to}");
        return Err(input(key, count, problem, "give the corners in order around the plate"));
    }
    let area = polygon_area(&outline);
    let [low, high] = bounding_box(&outline);
    let remedy = "give the corners in order around the plate";
    fail_if!(area.abs() < 1e-6 * (high[0] - low[0]).max(high[1] - low[1]).powi(2), input(key, count, "encloses no area", remedy));
    if area < 0.0 {
        outline.reverse();
    }
    Ok(outline)
}

/// Reads a list of tables, each at its own path, so that messages name `specimen.holes[2]`.
fn items<I, T>(key: &str, list: &[I], read: impl Fn(&I, &str) -> Result<T>) -> Result<Vec<T>> {
    if list.len() > ITEMS_MAX {
        return Err(input(key, format!("{} entries", list.len()), "is too long", format!("give at most {ITEMS_MAX}")));
    }
    list.iter().enumerate().map(|(i, item)| read(item, &format!("{key}[{i}]"))).collect()
}

fn crack_path(item: &CrackKeys, path: &str) -> Result<Vec<Point>> {
    const REMEDY: &str = "give from_mm and to_mm, or path_mm = [[x, y], [x, y], ...]";
    let line = match (item.from, item.to, &item.path) {
        (Some(from), Some(to), None) => return ends(path, from, to).map(|(from, to)| vec![from, to]),
        (None, None, Some(corners)) => corners,
        (None, None, None) => return Err(input_missing(path, "has no ends", REMEDY)),
        (from, _, None) => {
            let key = format!("{path}.{}", if from.is_none() { "from_mm" } else { "to_mm" });
            return Err(input_missing(&key, "is missing", REMEDY));
        }
        (_, _, Some(_)) => return Err(input_missing(&format!("{path}.path_mm"), "conflicts with from_mm or to_mm", REMEDY)),
    };
    let key = format!("{path}.path_mm");
    if line.len() < 2 || line.len() > ITEMS_MAX {
        return Err(input(&key, format!("{} points", line.len()), "is not a path", format!("give 2 to {ITEMS_MAX} points")));
    }
    if let Some(i) = (1..line.len()).find(|&i| distance(line[i - 1], line[i]) < 1e-6) {
        return Err(input_missing(&format!("{key}[{i}]"), "coincides with the point before it", "remove one of them"));
    }
    let pieces: Vec<[Point; 2]> = line.windows(2).map(|piece| [piece[0], piece[1]]).collect();
    for (j, [c, d]) in pieces.iter().enumerate() {
        let folds =
            j > 0 && turn(pieces[j - 1][0], *c, *d) == 0.0 && distance(pieces[j - 1][0], *d) < distance(pieces[j - 1][0], *c);
        if folds || pieces[..j.saturating_sub(1)].iter().any(|[a, b]| segments_touch(*a, *b, *c, *d)) {
            let problem = format!("crosses, touches or folds back on itself after point {j}");
            return Err(input_missing(&key, problem, "give branches as separate cracks that share a point with this one"));
        }
    }
    Ok(line.clone())
}

fn ends(path: &str, from: Point, to: Point) -> Result<(Point, Point)> {
    let remedy = "give two different points";
    fail_if!(distance(from, to) < 1e-6, input_missing(path, "has zero length: from_mm and to_mm coincide", remedy));
    Ok((from, to))
}
