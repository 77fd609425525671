//! Places for the names of points in a chart, so that no name covers another one, a point or the frame.

/// An upright rectangle.
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
/// Room that a point needs, px.
const POINT: f64 = 6.0;
/// Distance of the points that stand for a line, px: less than a name is high.
const LINE_STEP: f64 = 6.0;

impl Box2 {
    /// Middle.
    pub fn centre(self) -> [f64; 2] {
        [0, 1].map(|i| 0.5 * (self.low[i] + self.high[i]))
    }

    /// Point of the rectangle nearest to another point.
    pub fn nearest(self, to: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|i| to[i].clamp(self.low[i], self.high[i]))
    }

    /// Whether they share room.
    pub fn overlaps(self, other: Box2) -> bool {
        (0..2).all(|i| self.low[i] < other.high[i] && other.low[i] < self.high[i])
    }

    /// Whether the other lies within.
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

/// A rectangle at a distance from a point.
fn beside(point: [f64; 2], size: [f64; 2], gap: f64, way: [f64; 2]) -> Box2 {
    let centre = [0, 1].map(|i| point[i] + way[i] * (gap + 0.5 * size[i]));
    Box2 { low: [0, 1].map(|i| centre[i] - 0.5 * size[i]), high: [0, 1].map(|i| centre[i] + 0.5 * size[i]) }
}
