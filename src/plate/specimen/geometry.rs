//! Plane geometry: polygons, segments, the four sides of a plate, and the questions the body asks of a specimen.

use std::collections::HashMap;

use super::{Point, Slot, Specimen};

/// Distance between two points, m.
#[inline]
pub fn distance(a: Point, b: Point) -> f64 {
    let [x, y] = [b[0] - a[0], b[1] - a[1]];
    // Not `hypot`, which guards against an overflow that there cannot be.
    (x * x + y * y).sqrt()
}

/// Point at share `t` of the way from `a` to `b`.
#[inline]
pub fn along(a: Point, b: Point, t: f64) -> Point {
    [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]
}

/// Unit vector from `a` to `b`; zero where they coincide.
#[inline]
pub fn direction(a: Point, b: Point) -> Point {
    let length = distance(a, b);
    if length > 0.0 { [(b[0] - a[0]) / length, (b[1] - a[1]) / length] } else { [0.0, 0.0] }
}

/// The direction of a vector that was given, of length 1; `None` for one that shows none.
pub fn unit([x, y]: Point) -> Option<Point> {
    let size = x.hypot(y);
    (1e-9..1e9).contains(&size).then(|| [x / size, y / size])
}

/// Twice the signed area of the triangle abc: positive where a, b, c turn counter-clockwise.
#[inline]
pub fn turn(a: Point, b: Point, c: Point) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Turn of the way from `before` over `at` to `after`, rad, negative where a counter-clockwise outline is concave.
pub fn turn_at(before: Point, at: Point, after: Point) -> f64 {
    let ([ax, ay], [bx, by]) = (direction(before, at), direction(at, after));
    (ax * by - ay * bx).atan2(ax * bx + ay * by)
}

/// Whether the closed segments ab and cd share a point; touching counts.
#[inline]
pub fn segments_touch(a: Point, b: Point, c: Point, d: Point) -> bool {
    // Most pairs are far apart: compare the boxes first.
    if a[0].max(b[0]) < c[0].min(d[0])
        || c[0].max(d[0]) < a[0].min(b[0])
        || a[1].max(b[1]) < c[1].min(d[1])
        || c[1].max(d[1]) < a[1].min(b[1])
    {
        return false;
    }
    // With overlapping boxes, collinear segments (all turns zero) do touch.
    turn(a, b, c) * turn(a, b, d) <= 0.0 && turn(c, d, a) * turn(c, d, b) <= 0.0
}

/// Share of the way from `a` to `b` at which the line through them meets the line through c and d; `None` if parallel.
#[inline]
pub fn meeting_share(a: Point, b: Point, c: Point, d: Point) -> Option<f64> {
    let (from_a, from_b) = (turn(c, d, a), turn(c, d, b));
    let share = from_a / (from_a - from_b);
    share.is_finite().then_some(share)
}

/// Shares of the way from `a` to `b` at which the line through them comes into a circle and leaves it; `None` if it passes the circle.
#[inline]
pub fn circle_shares(a: Point, b: Point, centre: Point, radius: f64) -> Option<[f64; 2]> {
    // |f + t d| = radius
    let (d, f) = ([b[0] - a[0], b[1] - a[1]], [a[0] - centre[0], a[1] - centre[1]]);
    let (dd, df, ff) = (d[0] * d[0] + d[1] * d[1], d[0] * f[0] + d[1] * f[1], f[0] * f[0] + f[1] * f[1]);
    let square = df * df - dd * (ff - radius * radius);
    (square >= 0.0).then(|| [-1.0, 1.0].map(|sign| (sign * square.sqrt() - df) / dd))
}

/// Share of the way from `a` to `b` at which the closed segment ab is nearest to `p`.
#[inline]
pub fn nearest_share(p: Point, a: Point, b: Point) -> f64 {
    let (ab, ap) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
    let squared = ab[0] * ab[0] + ab[1] * ab[1];
    if squared > 0.0 { ((ap[0] * ab[0] + ap[1] * ab[1]) / squared).clamp(0.0, 1.0) } else { 0.0 }
}

/// The point of the closed segment ab that is nearest to `p`.
#[inline]
pub fn nearest_of_segment(p: Point, a: Point, b: Point) -> Point {
    along(a, b, nearest_share(p, a, b))
}

/// Distance of `p` from the closed segment ab, m.
#[inline]
pub fn distance_to_segment(p: Point, a: Point, b: Point) -> f64 {
    distance(p, nearest_of_segment(p, a, b))
}

/// Edges of a closed polygon, last point to first included.
#[inline]
pub fn edges(polygon: &[Point]) -> impl Iterator<Item = (Point, Point)> + '_ {
    (0..polygon.len()).map(|i| (polygon[i], polygon[(i + 1) % polygon.len()]))
}

/// Whether `p` lies inside the polygon (crossing count; a point exactly on the edge may fall either way).
#[inline]
pub fn point_in_polygon(p: Point, polygon: &[Point]) -> bool {
    let mut inside = false;
    for (a, b) in edges(polygon) {
        if (a[1] > p[1]) != (b[1] > p[1]) && p[0] < a[0] + (p[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]) {
            inside = !inside;
        }
    }
    inside
}

/// Distance of `p` from the polygon's boundary, m.
#[inline]
pub fn distance_to_polygon(p: Point, polygon: &[Point]) -> f64 {
    edges(polygon).map(|(a, b)| distance_to_segment(p, a, b)).fold(f64::INFINITY, f64::min)
}

/// Signed area, m²: positive if counter-clockwise.
pub fn polygon_area(polygon: &[Point]) -> f64 {
    edges(polygon).map(|(a, b)| a[0] * b[1] - b[0] * a[1]).sum::<f64>() / 2.0
}

/// Lower left and upper right corner of the box around the points.
pub fn bounding_box(points: &[Point]) -> [Point; 2] {
    points.iter().fold([[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]], |[low, high], p| {
        [[low[0].min(p[0]), low[1].min(p[1])], [high[0].max(p[0]), high[1].max(p[1])]]
    })
}

/// The first pair of edges of the polygon that touch without being neighbours, by index.
pub fn self_intersection(polygon: &[Point]) -> Option<(usize, usize)> {
    let n = polygon.len();
    let edge = |i: usize| (polygon[i], polygon[(i + 1) % n]);
    for i in 0..n {
        let (a, b) = edge(i);
        // Neighbours share a corner; they overlap only if the outline turns straight back.
        let (_, c) = edge((i + 1) % n);
        if turn(a, b, c) == 0.0 && (b[0] - a[0]) * (c[0] - b[0]) + (b[1] - a[1]) * (c[1] - b[1]) < 0.0 {
            return Some((i, (i + 1) % n));
        }
        for j in i + 2..n {
            if i == 0 && j == n - 1 {
                continue;
            }
            let (c, d) = edge(j);
            if segments_touch(a, b, c, d) {
                return Some((i, j));
            }
        }
    }
    None
}

/// Places by square cells, so that those near one are found at once.
#[derive(Debug, Default)]
pub struct Places {
    width: f64,
    places: Vec<Point>,
    cells: HashMap<[i64; 2], Vec<u32>>,
}

impl Places {
    /// Places by cells of a width, m.
    pub fn of(width: f64, places: impl Iterator<Item = Point>) -> Self {
        let mut cells = Places { width, places: places.collect(), cells: HashMap::new() };
        for (i, &place) in cells.places.iter().enumerate() {
            let cell = place.map(|x| (x / width).floor() as i64);
            cells.cells.entry(cell).or_default().push(i as u32);
        }
        cells
    }

    pub fn is_empty(&self) -> bool {
        self.places.is_empty()
    }

    /// Numbers of the places in cells within `reach` of one, m, in an order that depends on the places alone.
    #[inline]
    pub fn near(&self, at: Point, reach: f64) -> impl Iterator<Item = u32> + '_ {
        let range = |x: f64| ((x - reach) / self.width).floor() as i64..=((x + reach) / self.width).floor() as i64;
        let columns = range(at[0]);
        let cells = range(at[1]).flat_map(move |row| columns.clone().map(move |column| [column, row]));
        cells.flat_map(|cell| self.cells.get(&cell).into_iter().flatten().copied())
    }

    /// Way from a position to a place, m.
    #[inline]
    pub fn away(&self, place: u32, from: Point) -> Point {
        let [x, y] = self.places[place as usize];
        [x - from[0], y - from[1]]
    }
}

impl Slot {
    /// Corners of the slot, counter-clockwise: right of `from`, right of `to`, left of `to`, left of `from`.
    #[inline]
    pub fn corners(&self) -> [Point; 4] {
        let [dx, dy] = direction(self.from, self.to);
        let half = self.width / 2.0;
        let (nx, ny) = (-dy * half, dx * half);
        let shift = |p: Point, sign: f64| [p[0] + sign * nx, p[1] + sign * ny];
        [shift(self.from, -1.0), shift(self.to, -1.0), shift(self.to, 1.0), shift(self.from, 1.0)]
    }

    /// Whether `p` lies in the slot.
    #[inline]
    pub fn contains(&self, p: Point) -> bool {
        let [dx, dy] = direction(self.from, self.to);
        let (x, y) = (p[0] - self.from[0], p[1] - self.from[1]);
        let (ahead, across) = (x * dx + y * dy, y * dx - x * dy);
        ahead >= 0.0 && ahead <= distance(self.from, self.to) && across.abs() <= self.width / 2.0
    }
}

impl Specimen {
    /// Whether `point` lies in the material: inside the outline, outside holes and slots. Cracks have no width.
    #[inline]
    pub fn contains(&self, point: Point) -> bool {
        point_in_polygon(point, &self.outline)
            && self.holes.iter().all(|hole| distance(point, hole.centre) > hole.radius)
            && !self.slots.iter().any(|slot| slot.contains(point))
    }

    /// The same of a point of a lattice: on the outline, within `slack`, m, a point is one on every side of the plate, and none on the
    /// rim of a hole or a slot, so that a plate that is its own mirror image has points that are.
    pub fn has_point_at(&self, point: Point, slack: f64) -> bool {
        let is_inside = || point_in_polygon(point, &self.outline) || distance_to_polygon(point, &self.outline) <= slack;
        let is_void = |slot: &Slot| slot.contains(point) || distance_to_polygon(point, &slot.corners()) <= slack;
        is_inside()
            && self.holes.iter().all(|hole| distance(point, hole.centre) > hole.radius + slack)
            && !self.slots.iter().any(is_void)
    }

    /// Length of the part of a segment that lies inside the outline, m, for a segment that crosses it at most once.
    #[inline]
    pub fn length_inside(&self, from: Point, to: Point) -> f64 {
        let crossing = edges(&self.outline)
            .filter(|(a, b)| segments_touch(from, to, *a, *b))
            .find_map(|(a, b)| meeting_share(from, to, a, b))
            .map(|share| share.clamp(0.0, 1.0));
        let (starts_inside, ends_inside) = (point_in_polygon(from, &self.outline), point_in_polygon(to, &self.outline));
        let share = match (crossing, starts_inside) {
            (None, _) => 1.0,
            // One end lies on the edge and round-off calls it inside.
            (Some(share), true) if ends_inside => share.max(1.0 - share),
            (Some(share), true) => share,
            (Some(share), false) => 1.0 - share,
        };
        share * distance(from, to)
    }
}

perilife_base::kinds! {
    /// Sides of a plate: the straight stretches of the outline that lie on its bounding box.
    pub enum Edge for "loading.edges" {
        Top = "top": "side at the largest y",
        Bottom = "bottom": "side at the smallest y",
        Left = "left": "side at the smallest x",
        Right = "right": "side at the largest x",
    }

    /// Components a support holds.
    pub enum Component for "supports.fix" {
        X = "x": "no displacement along x",
        Y = "y": "no displacement along y",
    }
}

impl Edge {
    /// Unit vector out of the plate.
    pub fn normal(self) -> Point {
        match self {
            Edge::Top => [0.0, 1.0],
            Edge::Bottom => [0.0, -1.0],
            Edge::Left => [-1.0, 0.0],
            Edge::Right => [1.0, 0.0],
        }
    }

    /// Stretches of the outline on this side, within 1e-6 of the size of the plate; empty where only a corner touches the bounding box.
    pub fn stretches(self, specimen: &Specimen) -> Vec<(Point, Point)> {
        self.level(specimen, [-1.0, 1e-6])
    }

    /// A stretch along this side that lies deeper than those of it by less than a drawing can tell from a slip, 1e-4 of the size of the plate.
    pub fn step(self, specimen: &Specimen) -> Option<(Point, Point)> {
        self.level(specimen, [1e-6, 1e-4]).first().copied()
    }

    /// Stretches of the outline along this side whose ends lie so deep in the bounding box, over its size.
    fn level(self, specimen: &Specimen, [above, deepest]: [f64; 2]) -> Vec<(Point, Point)> {
        let [low, high] = bounding_box(&specimen.outline);
        let (axis, place) = match self {
            Edge::Top => (1, high[1]),
            Edge::Bottom => (1, low[1]),
            Edge::Left => (0, low[0]),
            Edge::Right => (0, high[0]),
        };
        let size = (high[0] - low[0]).max(high[1] - low[1]);
        let is_level = |(a, b): &(Point, Point)| {
            let [shallow, deep] =
                [f64::min, f64::max].map(|of: fn(f64, f64) -> f64| of((a[axis] - place).abs(), (b[axis] - place).abs()));
            deep <= deepest * size && deep > above * size && deep - shallow <= 1e-3 * distance(*a, *b)
        };
        edges(&specimen.outline).filter(is_level).collect()
    }
}
