//! What several named plates share: cracks at a hole, arcs of an outline, pins and rollers, refusals.

use std::f64::consts::PI;

use crate::specimen::geometry::distance;
use crate::specimen::{Bearing, Load, Point};
use perilife_base::error::{Result, input};
use perilife_base::keys::{Given, Key, OrNone, length, number};
use perilife_base::units::round_mm;

/// Angle of one side of a polygon that stands for an arc, rad: 2°, whose middle lies 1.5e-4 of the radius off the arc.
const ARC_SIDE: f64 = PI / 90.0;

/// Corners of an arc from one angle to another, rad, both ends included; a half circle has one in its middle, where cracks start.
pub(super) fn arc(centre: Point, radius: f64, [from, to]: [f64; 2]) -> impl Iterator<Item = Point> {
    let sides = ((to - from).abs() / ARC_SIDE - 1e-9).ceil().max(1.0);
    (0..=sides as usize).map(move |i| {
        let (sin, cos) = (from + (to - from) * i as f64 / sides).sin_cos();
        [centre[0] + radius * cos, centre[1] + radius * sin]
    })
}

pub(super) fn pin(hole: usize, direction: Point, contact: Bearing) -> Load {
    Load::Pin { hole, direction, force: 1.0, contact }
}

/// A roller on the stretch `from`-`to` of the outline, pushing with a share of the force.
pub(super) fn roller([from, to]: [Point; 2], direction: Point, share: f64, thickness: f64) -> Load {
    let pressure = share / (distance(from, to) * thickness);
    Load::Edge { from, to, traction: direction.map(|d| pressure * d) }
}

pub(super) const LENGTHS: &str = "the length of the cracks";
pub(super) const FROM_RIM: Key = length("crack_length_mm", "Initial crack length a: from the hole edge").group(LENGTHS);

perilife_base::keys! {
    pub(super) struct AtHoleKeys {
        length: Option<f64> = FROM_RIM;
        count: Option<usize> = number("cracks", "Cracks at the hole: 1 (right) or 2; default 1", "a number of cracks", 1.0, 2.0)
            .missing("give crack_length_mm with cracks = 1 or 2, or crack_lengths_mm = [left, right]");
        lengths: Option<[OrNone; 2]> = length("crack_lengths_mm", "Crack lengths: left and right from the hole edge, 0 for no crack").group(LENGTHS);
    }
}

/// The cracks at the sides of a hole, left first.
pub(super) struct AtHole {
    /// Their lengths from the rim, m; 0 without one.
    pub lengths: [f64; 2],
    pub shared: Option<f64>,
}

impl AtHole {
    /// What the keys of a section say.
    /// Errors: none of the lengths; a number of cracks beside lengths of each.
    pub(super) fn read(given: &Given<'_>, keys: &AtHoleKeys) -> Result<Self> {
        const REMEDY: &str = "give crack_length_mm with cracks = 1 or 2, or crack_lengths_mm = [left, right]";
        match (keys.length, &keys.lengths) {
            (Some(length), _) => {
                Ok(AtHole { lengths: [if keys.count == Some(2) { length } else { 0.0 }, length], shared: Some(length) })
            }
            (None, Some(_)) if keys.count.is_some() => Err(given.refuse("cracks", "conflicts with crack_lengths_mm", REMEDY)),
            (None, Some([left, right])) => Ok(AtHole { lengths: [left.0, right.0], shared: None }),
            (None, None) => Err(given.refuse("crack_length_mm", "is missing", REMEDY)),
        }
    }

    pub(super) fn count(&self) -> usize {
        self.lengths.iter().filter(|length| **length > 0.0).count()
    }

    /// Their paths, from the rim of a hole outwards along x.
    pub(super) fn paths(&self, centre: Point, radius: f64) -> Vec<Vec<Point>> {
        let path = |(side, length): (f64, f64)| {
            let at = |from_rim: f64| [centre[0] + side * (radius + from_rim), centre[1]];
            (length > 0.0).then(|| vec![at(0.0), at(length)])
        };
        // Right first: tip 0 is that of a single crack.
        [(1.0, self.lengths[1]), (-1.0, self.lengths[0])].into_iter().filter_map(path).collect()
    }
}

/// Share of a size by which two that are equal in the file may differ.
pub(super) const SLACK: f64 = 1e-9;

/// Refuses a size that does not lie below a limit, both in m.
pub(super) fn below(key: &str, size: f64, limit: f64, what: &str) -> Result<()> {
    if size < limit * (1.0 - SLACK) {
        return Ok(());
    }
    let problem = format!("must be below {what}, {} mm", round_mm(limit));
    Err(input(&format!("specimen.{key}"), round_mm(size), problem, "use a smaller one, or a larger plate"))
}
