//! A plate from a drawing, `specimen.outline_file`: DXF with the layers `outline`, `holes` and `cracks`.
//!
//! ```text
//! outline   lines and arcs that close to one line; a full circle within it is a hole
//! holes     full circles
//! cracks    open lines, which may branch; arcs become polylines
//! ```
//! Pieces are chained where their ends lie within 1e-4 of the size of the drawing, cracks within 1e-3 of the shortest of their lines. Fillets
//! and other arcs of an outline are polylines with corners on the arc ([`curve::TURN`]) and where a crack meets it. With `outline_symmetry` the half is drawn on one side of x = 0 or y = 0; what lies on that line is
//! no rim, and all else is there twice.

pub mod curve;
mod dxf;

use curve::{Curve, branched, chained};

use super::geometry::{bounding_box, distance, distance_to_segment, polygon_area, turn};
use super::{Hole, Point};
use perilife_base::error::{Error, Result, fail_if, input, input_missing};
use perilife_base::input::Folder;
use perilife_base::units::{INCH, MM, place_mm};

pub const KEY: &str = "specimen.outline_file";
const LAYERS: [&str; 3] = ["outline", "holes", "cracks"];
/// Distance of ends that are one, over the size of the drawing.
const TOLERANCE: f64 = 1e-4;
/// Distance of a corner of the outline from the straight line between its neighbours that is round-off, over the size of the drawing.
const FLAT: f64 = 1e-6;
/// Distance of ends of cracks that are one, over the shortest line of a crack.
const OF_CRACK: f64 = 1e-3;
/// Least radius of a hole, m: that of `holes`.
const RADIUS_LEAST: f64 = 5e-7;
/// Lines at the most: ends are compared with each other.
const LINES_MAX: usize = 5000;

perilife_base::kinds! {
    /// Units of a drawing that does not say its own.
    pub enum DrawingUnit for "specimen.outline_unit" {
        Millimetre = "mm": "drawing unit: millimeter",
        Inch = "inch": "drawing unit: inch",
    }

    /// Planes of symmetry of a plate of which a half is drawn.
    pub enum SymmetryPlane for "specimen.outline_symmetry" {
        X = "x=0": "the half on one side of x = 0 is drawn",
        Y = "y=0": "the half on one side of y = 0 is drawn",
    }
}

/// What a drawing says of a plate, m.
#[derive(Debug, Clone, PartialEq)]
pub struct Shape {
    pub outline: Vec<Point>,
    pub holes: Vec<Hole>,
    pub cracks: Vec<Vec<Point>>,
}

/// The lines of a file, in its own unit.
pub(super) struct Drawing {
    lines: Vec<Drawn>,
    /// Millimetres in its unit, where the file says so.
    millimetres: Option<f64>,
}

pub(super) struct Drawn {
    layer: String,
    what: String,
    curve: Curve,
}

pub(super) struct Fault {
    problem: String,
    remedy: String,
}

impl Fault {
    fn of(problem: impl Into<String>, remedy: impl Into<String>) -> Self {
        Fault { problem: problem.into(), remedy: remedy.into() }
    }

    fn at(layer: &str, what: &str, problem: impl std::fmt::Display, remedy: impl Into<String>) -> Self {
        Fault::of(format!("layer {layer}: {what} {problem}"), remedy)
    }

    fn error(self, file: &str) -> Error {
        input(KEY, format!("\"{file}\""), self.problem, self.remedy)
    }
}

/// The layer that a name in a file stands for: some programs write capitals.
fn known_layer(name: &str) -> Option<&'static str> {
    LAYERS.into_iter().find(|layer| layer.eq_ignore_ascii_case(name))
}

fn place([x, y]: Point) -> String {
    let round = |value: f64| (value * 1e4).round() / 1e4 + 0.0;
    format!("({}, {})", round(x), round(y))
}

/// Reads a drawing, the unit being asked for where the file has none.
/// Errors: [`Error::Input`] by layer and place.
pub fn read(file: &str, folder: &Folder, unit: Option<DrawingUnit>, symmetry: Option<SymmetryPlane>) -> Result<Shape> {
    let bytes = folder.read(file)?;
    let text = String::from_utf8_lossy(&bytes);
    let remedy = "save it as DXF: round holes as circles on layer holes, rounded corners as arcs";
    fail_if!(!file.to_lowercase().ends_with(".dxf"), Fault::of("is not a DXF drawing", remedy).error(file));
    let drawing = dxf::read(&text).map_err(|fault| fault.error(file))?;
    let scale = scale(drawing.millimetres, unit, file)?;
    shape(drawing.lines, scale, symmetry).map_err(|fault| fault.error(file))
}

fn scale(millimetres: Option<f64>, unit: Option<DrawingUnit>, file: &str) -> Result<f64> {
    const UNIT: &str = "specimen.outline_unit";
    let given = unit.map(|unit| (unit, if unit == DrawingUnit::Inch { INCH } else { MM }));
    match (millimetres, given) {
        (None, None) => {
            let problem = format!("is missing: {file} has no unit");
            Err(input_missing(UNIT, problem, "give \"mm\" or \"inch\""))
        }
        (Some(of_file), Some((unit, metres))) if (of_file * MM / metres - 1.0).abs() > 1e-9 => {
            let problem = format!("conflicts with the unit of {file}, {of_file} mm");
            Err(input(UNIT, format!("\"{unit}\""), problem, "remove it"))
        }
        (Some(of_file), _) => Ok(of_file * MM),
        (None, Some((_, metres))) => Ok(metres),
    }
}

fn shape(lines: Vec<Drawn>, scale: f64, symmetry: Option<SymmetryPlane>) -> std::result::Result<Shape, Fault> {
    if let Some(line) = lines.iter().find(|line| !LAYERS.contains(&line.layer.as_str())) {
        let known = format!("move it to one of {} if it is part of the plate, else delete it", LAYERS.join(", "));
        return Err(Fault::at(&format!("\"{}\"", line.layer), &line.what, "is on an unknown layer", known));
    }
    fail_if!(lines.len() > LINES_MAX, Fault::of(format!("has {} lines", lines.len()), format!("draw at most {LINES_MAX}")));
    let lines: Vec<Drawn> =
        lines.into_iter().map(|line| Drawn { curve: line.curve.mapped(|at| at.map(|x| scale * x), false), ..line }).collect();
    let corners: Vec<Point> = lines.iter().flat_map(|line| line.curve.points()).collect();
    let remedy = "draw the outline of the plate on a layer of that name";
    fail_if!(!lines.iter().any(|line| line.layer == "outline"), Fault::of("has nothing on the layer outline", remedy));
    let [low, high] = bounding_box(&corners);
    let size = (high[0] - low[0]).max(high[1] - low[1]);
    let tolerance = TOLERANCE * size;
    refuse_twice(&lines, FLAT * size)?;
    let lines = match symmetry {
        Some(plane) => mirrored(lines, usize::from(plane == SymmetryPlane::Y), tolerance)?,
        None => lines,
    };
    let of_cracks: Vec<&Curve> = lines.iter().filter(|line| line.layer == "cracks").map(|line| &line.curve).collect();
    let length = |curve: &&Curve| curve.points().windows(2).map(|pair| distance(pair[0], pair[1])).sum::<f64>();
    let shortest = of_cracks.iter().map(length).filter(|length| *length > 1e-9 * size).fold(f64::INFINITY, f64::min);
    // Cracks may be as short as a flaw, and end close to each other.
    let tolerance_of_cracks = (OF_CRACK * shortest).clamp(FLAT * size, tolerance);
    let chains = |layer: &str, holes: &[Hole]| {
        let (tolerance, least) = if layer == "cracks" { (tolerance_of_cracks, 1e-9 * size) } else { (tolerance, tolerance) };
        let is_long =
            |curve: &Curve| curve.pieces.len() > 1 || curve.pieces[0].arc.is_some() || distance(curve.from, curve.end()) > least;
        let cornered = |curve: &Curve| if layer == "outline" { curve.cornered(&of_cracks, FLAT * size) } else { curve.clone() };
        let mut curves: Vec<Curve> =
            lines.iter().filter(|line| line.layer == layer).map(|line| cornered(&line.curve)).filter(is_long).collect();
        let is_in_hole = |at: Point| holes.iter().any(|hole| distance(at, hole.centre) < hole.radius);
        // A crack may branch, a rim may not.
        let branches = if layer == "cracks" { branched(&mut curves, tolerance) } else { Vec::new() };
        let is_branch = |at: Point| branches.iter().any(|branch| distance(at, *branch) <= tolerance);
        chained(curves, tolerance, |at| !is_in_hole(at) && !is_branch(at))
            .map_err(|at| Fault::at(layer, "at", format!("{} more than two ends meet", place_mm(at)), "draw lines end to end"))
    };
    let (outline, inner) = outline(&chains("outline", &[])?, tolerance, FLAT * size)?;
    let mut holes = inner;
    for curve in chains("holes", &[])? {
        let (centre, radius) = curve.as_circle(tolerance).ok_or_else(|| {
            let problem = format!("the line from {} is not a full circle", place_mm(curve.from));
            Fault::at("holes", "", problem, "draw round holes as circles; other openings are not supported")
        })?;
        holes.push(Hole { centre, radius });
    }
    if let Some(hole) = holes.iter().find(|hole| hole.radius < RADIUS_LEAST) {
        let what = format!("the circle at {}", place_mm(hole.centre));
        return Err(Fault::at("holes", &what, "has no radius", "draw it with the radius of the hole"));
    }
    let crack = |curve: &Curve| match curve.is_closed(tolerance_of_cracks) {
        true => Err(Fault::at(
            "cracks",
            "the line from",
            format!("{} is closed", place_mm(curve.from)),
            "draw a crack as an open line",
        )),
        false => Ok(plain(curve.points(), [tolerance_of_cracks, 0.0], false)),
    };
    let cracks = chains("cracks", &holes)?.iter().map(crack).collect::<std::result::Result<_, _>>()?;
    Ok(Shape { outline, holes, cracks })
}

/// Refuses a line that is drawn twice, ends within `tolerance` of each other, m.
fn refuse_twice(lines: &[Drawn], tolerance: f64) -> std::result::Result<(), Fault> {
    let points: Vec<Vec<Point>> = lines.iter().map(|line| line.curve.points()).collect();
    let is_near = |(a, b): (&Point, &Point)| distance(*a, *b) <= tolerance;
    let is_same = |i: usize, j: usize| {
        let (a, b) = (&points[i], &points[j]);
        lines[i].layer == lines[j].layer
            && a.len() == b.len()
            && (a.iter().zip(b).all(is_near) || a.iter().zip(b.iter().rev()).all(is_near))
    };
    let twice = (0..lines.len()).find(|&i| (0..i).any(|j| is_same(i, j)));
    twice.map_or(Ok(()), |i| Err(Fault::at(&lines[i].layer, &lines[i].what, "is drawn twice", "remove one of the two")))
}

/// The rim of the plate, and full circles within it.
fn outline(chains: &[Curve], tolerance: f64, flat: f64) -> std::result::Result<(Vec<Point>, Vec<Hole>), Fault> {
    if let Some(open) = chains.iter().find(|chain| !chain.is_closed(tolerance)) {
        let problem = format!("the line from {} to {} is open", place_mm(open.from), place_mm(open.end()));
        return Err(Fault::at("outline", "", problem, "close the outline of the plate, and draw cracks on the layer cracks"));
    }
    let area = |chain: &&Curve| polygon_area(&chain.points()).abs();
    let Some(largest) = chains.iter().max_by(|a, b| area(a).total_cmp(&area(b))) else {
        return Err(Fault::of("layer outline has no closed line", "draw the outline of the plate"));
    };
    let hole = |chain: &Curve| {
        let (centre, radius) = chain.as_circle(tolerance).ok_or_else(|| {
            let problem = format!("has a second closed line, from {}", place_mm(chain.from));
            Fault::at("outline", "", problem, "draw one outline, and round holes as circles on the layer holes")
        })?;
        Ok(Hole { centre, radius })
    };
    let holes =
        chains.iter().filter(|chain| !std::ptr::eq(*chain, largest)).map(hole).collect::<std::result::Result<_, Fault>>()?;
    Ok((plain(largest.points(), [tolerance, flat], true), holes))
}

/// Corners without those that are one and those that lie straight between their neighbours, or as near to that as `flat`, m.
fn plain(mut points: Vec<Point>, [tolerance, flat]: [f64; 2], is_closed: bool) -> Vec<Point> {
    if is_closed && points.len() > 1 && distance(points[0], points[points.len() - 1]) <= tolerance {
        points.pop();
    }
    let mut left: Vec<Point> = Vec::with_capacity(points.len());
    let count = points.len();
    for (i, &at) in points.iter().enumerate() {
        let is_end = !is_closed && (i == 0 || i + 1 == count);
        let before = left.last().copied().unwrap_or(points[count - 1]);
        let after = points[(i + 1) % count];
        let beside = distance_to_segment(at, before, after);
        let turns = turn(before, at, after).abs() > 1e-9 * distance(before, at) * distance(at, after);
        let is_straight = beside <= flat || !turns && beside < tolerance;
        if is_end || !is_straight {
            left.push(at);
        }
    }
    left
}

/// The lines of a half, and the same beyond its plane of symmetry, x = 0 (axis 0) or y = 0.
fn mirrored(lines: Vec<Drawn>, axis: usize, tolerance: f64) -> std::result::Result<Vec<Drawn>, Fault> {
    let plane = ["x = 0", "y = 0"][axis];
    let is_on = |at: Point| at[axis].abs() <= tolerance;
    let beyond = |at: Point| [0, 1].map(|i| if i == axis { -at[i] } else { at[i] });
    // Ends on the plane meet their mirror images there.
    let snapped = |at: Point| [0, 1].map(|i| if i == axis && is_on(at) { 0.0 } else { at[i] });
    let mut whole: Vec<Drawn> = Vec::with_capacity(2 * lines.len());
    let mut side = 0.0_f64;
    for line in lines {
        let is_centred = line.curve.as_circle(tolerance).is_some_and(|(centre, _)| is_on(centre));
        let on_plane = |from: Point, to: Point| is_on(from) && is_on(to);
        if is_centred {
            whole.push(line);
            continue;
        }
        for at in line.curve.points().into_iter().filter(|at| !is_on(*at)) {
            let problem = || format!("is beyond {plane}; the half is drawn on the other side");
            let remedy = "draw one half, or remove outline_symmetry";
            fail_if!(side * at[axis] < 0.0, Fault::at(&line.layer, &line.what, problem(), remedy));
            side = at[axis];
        }
        let drawn = |curve: Curve| Drawn { layer: line.layer.clone(), what: line.what.clone(), curve };
        let [beside, in_plane] = line.curve.parted(on_plane);
        for curve in beside {
            let half = curve.mapped(snapped, false);
            let other = half.mapped(beyond, true);
            whole.extend([half, other].map(drawn));
        }
        // What lies in the plane is no rim, but may be a crack.
        let is_crack = line.layer == "cracks";
        whole.extend(in_plane.into_iter().filter(|_| is_crack).map(|curve| drawn(curve.mapped(snapped, false))));
    }
    Ok(whole)
}
