//! The voids that a bond must not bridge: slots, holes, and notches of the outline.
//!
//! The lattice knows a curved or tilted rim no better than about a quarter of its spacing, so a bond that only grazes a
//! hole or a slot by less than that stays. Cracks have no width and are cut apart from these ([`super::pre_crack`]).

use super::lattice::ON_RIM;
use perilife_plate::specimen::geometry::{
    along, direction, distance, distance_to_polygon, distance_to_segment, edges, point_in_polygon, segments_touch, turn,
};
use perilife_plate::specimen::{Hole, Point, Slot, Specimen};

/// Depth in spacings to which a bond may graze a hole or a slot.
const GRAZE: f64 = 0.25;
/// The voids of a specimen as a lattice of one spacing and horizon sees them.
#[derive(Debug, Clone)]
pub struct Obstacles<'a> {
    holes: &'a [Hole],
    /// Slots with their walls drawn in by the depth a bond may graze.
    slots: Vec<(Slot, [Point; 4])>,
    /// The outline where it is not convex; a bond cannot leave a convex one.
    outline: &'a [Point],
    spacing: f64,
    horizon: f64,
}

impl<'a> Obstacles<'a> {
    pub fn of(specimen: &'a Specimen, spacing: f64, horizon: f64) -> Self {
        let (corners, count) = (&specimen.outline, specimen.outline.len());
        let is_convex = (0..count).all(|i| turn(corners[i], corners[(i + 1) % count], corners[(i + 2) % count]) >= 0.0);
        let outline: &[Point] = if is_convex { &[] } else { corners };
        let slots = specimen.slots.iter().map(|slot| (*slot, drawn_in(slot, GRAZE * spacing).corners())).collect();
        Obstacles { holes: &specimen.holes, slots, outline, spacing, horizon }
    }

    /// Whether a bond that starts at a point can meet an obstacle at all; most cannot, and need no further test.
    pub fn near(&self, point: Point) -> bool {
        self.holes.iter().any(|hole| distance(point, hole.centre) < hole.radius + self.horizon)
            || self.slots.iter().any(|(slot, _)| distance_to_segment(point, slot.from, slot.to) < slot.width + self.horizon)
            || edges(self.outline).any(|(a, b)| distance_to_segment(point, a, b) < self.horizon)
    }

    /// Whether the bond between two points of the material would bridge an obstacle.
    pub fn block(&self, a: Point, b: Point) -> bool {
        self.holes.iter().any(|hole| distance_to_segment(hole.centre, a, b) < hole.radius - GRAZE * self.spacing)
            || self.slots.iter().any(|(_, corners)| edges(corners).any(|(c, d)| segments_touch(a, b, c, d)))
            || (!self.outline.is_empty() && self.leaves_outline(a, b))
    }

    /// Whether a bond crosses the outline. An edge on which one of its points lies does not count, or a row of points along
    /// the outline would lose its bonds by round-off; a bond between two such points is judged by its middle.
    fn leaves_outline(&self, a: Point, b: Point) -> bool {
        let slack = ON_RIM * self.spacing;
        let crossed = edges(self.outline).any(|(c, d)| {
            let beside = slack * distance(c, d);
            let (from_a, from_b) = (turn(c, d, a), turn(c, d, b));
            from_a.abs() > beside && from_b.abs() > beside && segments_touch(a, b, c, d)
        });
        let middle = along(a, b, 0.5);
        crossed || (!point_in_polygon(middle, self.outline) && distance_to_polygon(middle, self.outline) > slack)
    }
}

/// The slot with all its walls moved inwards, at the most to its middle line: a thin slot stays an obstacle.
fn drawn_in(slot: &Slot, depth: f64) -> Slot {
    let depth = depth.min(slot.width / 2.0).min(distance(slot.from, slot.to) / 2.0);
    let [x, y] = direction(slot.from, slot.to).map(|d| d * depth);
    Slot { from: [slot.from[0] + x, slot.from[1] + y], to: [slot.to[0] - x, slot.to[1] - y], width: slot.width - 2.0 * depth }
}
