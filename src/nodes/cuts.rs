//! What parts a node from a point: cracks, slots, holes, re-entrant corners, and the way around them.
//!
//! A crack parts a node from a point where the segment between them crosses it an odd number of times. The way round its tip counts in
//! place of the distance, `s = |x_i - x_tip| + |x_tip - x|` (diffraction: Organ, Fleming, Terry and Belytschko 1996, Comput. Mech.
//! 18:225, with exponent 1), which leaves shape functions continuous ahead of the tip. An even number leaves both on one side of a
//! crack that bends. A crack that starts at a hole is cut on to the middle of it, one at an edge on beyond it: supports would reach
//! round its mouth through what is no material. The walls of slots part like those of an outline, and the way
//! leads round their corners.

use perilife_plate::specimen::geometry::{
    along, bounding_box, direction, distance, distance_to_segment, edges, point_in_polygon, segments_touch, turn,
};
use perilife_plate::specimen::{Hole, Point, Specimen};

/// Distance of a segment from the middle of a hole, in radii, within which the hole parts its ends.
const HOLE_SHARE: f64 = 0.6;
/// Share of a segment left out at its ends, which may lie on a rim.
const ENDS: f64 = 1e-6;

/// Sides of an outline in a box.
const TOGETHER: usize = 8;

/// A line along which the plate is cut.
#[derive(Debug, Clone, PartialEq)]
pub struct Cut {
    /// Corners, m.
    pub points: Vec<Point>,
    /// Ends round which the way leads.
    pub free: Vec<Point>,
}

/// Everything that parts nodes from points.
#[derive(Debug, Clone, Default)]
pub struct Obstacles {
    pub cuts: Vec<Cut>,
    holes: Vec<Hole>,
    /// Sides of slots, and of an outline that is not convex.
    edges: Vec<[Point; 2]>,
    /// Their re-entrant corners.
    corners: Vec<Point>,
}

/// Those near a cell.
#[derive(Debug, Clone, Default)]
pub struct Near {
    cuts: Vec<Pieces>,
    holes: Vec<Hole>,
    edges: Vec<Pieces>,
    corners: Vec<Point>,
}

/// Pieces of a cut, or some sides, near a cell, the box around them, and the ends round which the way leads.
#[derive(Debug, Clone, Default)]
struct Pieces {
    pieces: Vec<[Point; 2]>,
    bounds: [Point; 2],
    free: Vec<Point>,
}

impl Pieces {
    /// Whether a segment crosses the pieces an odd number of times.
    fn parts(&self, a: Point, b: Point) -> bool {
        let [low, high] = self.bounds;
        if (0..2).any(|i| a[i].max(b[i]) < low[i] || a[i].min(b[i]) > high[i]) {
            return false;
        }
        self.pieces.iter().filter(|[c, d]| crosses(a, b, *c, *d)).count() % 2 == 1
    }
}

/// Length of the way from a node to a point, m, and its gradient at the point.
pub type Way = (f64, Point);

impl Obstacles {
    pub fn new(specimen: &Specimen, cuts: Vec<Cut>) -> Self {
        let outline = &specimen.outline;
        let n = outline.len();
        let before = |i: usize| outline[(i + n - 1) % n];
        let is_reentrant = |i: &usize| turn(before(*i), outline[*i], outline[(i + 1) % n]) < 0.0;
        let mut corners: Vec<Point> = (0..n).filter(is_reentrant).map(|i| outline[i]).collect();
        let mut walls = if corners.is_empty() { Vec::new() } else { edges(outline).map(|(a, b)| [a, b]).collect() };
        for slot in &specimen.slots {
            corners.extend(slot.corners().into_iter().filter(|corner| point_in_polygon(*corner, outline)));
            walls.extend(edges(&slot.corners()).map(|(a, b)| [a, b]));
        }
        Obstacles { cuts, holes: specimen.holes.clone(), edges: walls, corners }
    }

    /// Those within `reach`, m, of a point.
    pub fn near(&self, at: Point, reach: f64) -> Near {
        let of_cut = |cut: &Cut| {
            let pieces: Vec<[Point; 2]> = cut.points.windows(2).map(|piece| [piece[0], piece[1]]).collect();
            let is_near = |piece: &[Point; 2]| distance_to_segment(at, piece[0], piece[1]) <= reach;
            let near: Vec<[Point; 2]> = pieces.into_iter().filter(is_near).collect();
            (!near.is_empty()).then(|| {
                let bounds = bounding_box(near.as_flattened());
                Pieces { pieces: near, bounds, free: cut.free.clone() }
            })
        };
        let sides: Vec<[Point; 2]> =
            self.edges.iter().filter(|[a, b]| distance_to_segment(at, *a, *b) <= reach).copied().collect();
        let stretch = |sides: &[[Point; 2]]| Pieces {
            pieces: sides.to_vec(),
            bounds: bounding_box(sides.as_flattened()),
            free: Vec::new(),
        };
        Near {
            cuts: self.cuts.iter().filter_map(of_cut).collect(),
            holes: self.holes.iter().filter(|hole| distance(at, hole.centre) - hole.radius <= reach).copied().collect(),
            edges: sides.chunks(TOGETHER).map(stretch).collect(),
            corners: self.corners.iter().filter(|corner| distance(at, **corner) <= reach).copied().collect(),
        }
    }
}

/// Length and gradient of the straight way.
fn straight(node: Point, at: Point) -> Way {
    let [x, y] = [at[0] - node[0], at[1] - node[1]];
    // Not `hypot`, which guards against an overflow that there cannot be: this is asked for every node and point.
    let length = (x * x + y * y).sqrt();
    if length > 0.0 { (length, [x / length, y / length]) } else { (0.0, [0.0; 2]) }
}

/// Length and gradient of the way round a place.
fn round(node: Point, place: Point, at: Point) -> Way {
    let (last, gradient) = straight(place, at);
    (straight(node, place).0 + last, gradient)
}

impl Near {
    /// Whether the straight way from a node to any point of a box is free for sure.
    pub fn is_clear(&self, node: Point, [low, high]: [Point; 2]) -> bool {
        let (from, to) = ([0, 1].map(|i| node[i].min(low[i])), [0, 1].map(|i| node[i].max(high[i])));
        let corners = [low, [high[0], low[1]], high, [low[0], high[1]], node];
        let is_beside = |[a, b]: &[Point; 2]| {
            if (0..2).any(|i| a[i].max(b[i]) < from[i] || a[i].min(b[i]) > to[i]) {
                return true;
            }
            let sides = corners.map(|corner| turn(*a, *b, corner));
            let slack = 1e-9 * distance(*a, *b) * (to[0] - from[0] + to[1] - from[1]);
            sides.iter().all(|side| *side > slack) || sides.iter().all(|side| *side < -slack)
        };
        let misses = |hole: &Hole| {
            let outside = [0, 1].map(|i| (from[i] - hole.centre[i]).max(hole.centre[i] - to[i]).max(0.0));
            outside[0].hypot(outside[1]) >= HOLE_SHARE * hole.radius
        };
        self.cuts.iter().all(|cut| cut.pieces.iter().all(is_beside))
            && self.edges.iter().all(|stretch| stretch.pieces.iter().all(is_beside))
            && self.holes.iter().all(misses)
    }

    pub fn is_empty(&self) -> bool {
        self.cuts.is_empty() && self.holes.is_empty() && self.edges.is_empty()
    }

    /// The way from a node to a point; `None` where both do not see each other, or round a corner by `most`, m, and more.
    pub fn way(&self, node: Point, at: Point, most: f64) -> Option<Way> {
        let mut way = straight(node, at);
        let in_hole = |hole: &Hole| distance_to_segment(hole.centre, node, at) < HOLE_SHARE * hole.radius;
        if self.holes.iter().any(in_hole) {
            return None;
        }
        if self.leaves_outline(node, at) {
            // The shortest first: few are looked along before one is clear.
            let ways = self.corners.iter().map(|corner| (round(node, *corner, at), *corner));
            let mut ways: Vec<(Way, Point)> = ways.filter(|((length, _), _)| *length < most).collect();
            ways.sort_unstable_by(|a, b| a.0.0.total_cmp(&b.0.0));
            let is_clear = |corner| !self.leaves_outline(node, corner) && !self.leaves_outline(corner, at);
            way = ways.into_iter().find(|(_, corner)| is_clear(*corner))?.0;
        }
        for cut in &self.cuts {
            if cut.parts(node, at) {
                let ways = cut.free.iter().map(|end| round(node, *end, at));
                let detour = ways.min_by(|a, b| a.0.total_cmp(&b.0))?;
                if detour.0 > way.0 {
                    way = detour;
                }
            }
        }
        Some(way)
    }

    fn leaves_outline(&self, a: Point, b: Point) -> bool {
        if self.edges.is_empty() {
            return false;
        }
        let (from, to) = (along(a, b, ENDS), along(a, b, 1.0 - ENDS));
        let is_crossed = |[c, d]: &[Point; 2]| segments_touch(from, to, *c, *d) && crosses(from, to, *c, *d);
        let (least, most) = ([0, 1].map(|i| from[i].min(to[i])), [0, 1].map(|i| from[i].max(to[i])));
        let is_near = |[low, high]: [Point; 2]| (0..2).all(|i| least[i] <= high[i] && low[i] <= most[i]);
        self.edges.iter().any(|stretch| is_near(stretch.bounds) && stretch.pieces.iter().any(is_crossed))
    }
}

/// Whether two segments cross. A corner between two pieces of a line is on one side for both, so that it is counted once.
fn crosses(a: Point, b: Point, c: Point, d: Point) -> bool {
    (turn(a, b, c) > 0.0) != (turn(a, b, d) > 0.0) && (turn(c, d, a) > 0.0) != (turn(c, d, b) > 0.0)
}

/// Share of the farthest corner's distance within which others are as far: a line that is its own image stays one.
const AS_FAR: f64 = 1e-6;

/// A line without the corners that lie within `tolerance`, m, of the straight line between those that stay (Douglas and Peucker 1973).
pub fn simplified(points: &[Point], tolerance: f64) -> Vec<Point> {
    let [first, .., last] = points else { return points.to_vec() };
    let away = |k: &usize| distance_to_segment(points[*k], *first, *last);
    let farthest = (1..points.len() - 1).map(|k| away(&k)).fold(0.0, f64::max);
    if farthest <= tolerance {
        return vec![*first, *last];
    }
    let (mut line, mut from) = (vec![*first], 0);
    let stay = (1..points.len() - 1).filter(|k| away(k) >= (1.0 - AS_FAR) * farthest);
    for to in stay.chain([points.len() - 1]) {
        line.extend_from_slice(&simplified(&points[from..=to], tolerance)[1..]);
        from = to;
    }
    line
}

/// A line with one more corner beyond its last one, `by` m on.
pub fn lengthened(mut points: Vec<Point>, by: f64) -> Vec<Point> {
    if let [.., before, last] = points[..] {
        let [x, y] = direction(before, last);
        points.push([last[0] + by * x, last[1] + by * y]);
    }
    points
}
