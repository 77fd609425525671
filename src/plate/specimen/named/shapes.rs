//! What several named plates share: cracks at a hole, arcs of an outline, pins and rollers, refusals.

use std::f64::consts::PI;

use crate::specimen::geometry::distance;
use crate::specimen::{Bearing, Load, Point};
use perilife_base::error::{Result, input, input_missing};
use perilife_base::input::LENGTH;
use perilife_base::units::MM;

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

/// A pin.
pub(super) fn pin(hole: usize, direction: Point, contact: Bearing) -> Load {
    Load::Pin { hole, direction, force: 1.0, contact }
}

/// A roller on the stretch `from`-`to` of the outline, pushing with a share of the force.
pub(super) fn roller([from, to]: [Point; 2], direction: Point, share: f64, thickness: f64) -> Load {
    let pressure = share / (distance(from, to) * thickness);
    Load::Edge { from, to, traction: direction.map(|d| pressure * d) }
}

/// The cracks at the sides of a hole, left first.
pub(super) struct AtHole {
    /// Their lengths from the rim, m; 0 without one.
    pub lengths: [f64; 2],
    /// The one length of all of them.
    pub shared: Option<f64>,
}

impl AtHole {
    /// From `crack_length_mm` with `cracks` (1, on the right, where it is left out), or `crack_lengths_mm` = [left, right].
    pub(super) fn read(length: Option<f64>, cracks: Option<usize>, lengths: Option<[f64; 2]>) -> Result<Self> {
        const REMEDY: &str = "give crack_length_mm with cracks = 1 or 2, or crack_lengths_mm = [left, right]";
        match (length, lengths) {
            (Some(length), None) => {
                let length = LENGTH.read("specimen.crack_length_mm", length)?;
                let left = match cracks.unwrap_or(1) {
                    1 => 0.0,
                    2 => length,
                    other => return Err(input("specimen.cracks", other, "is not 1 or 2", REMEDY)),
                };
                Ok(AtHole { lengths: [left, length], shared: Some(length) })
            }
            (None, Some(_)) if cracks.is_some() => {
                Err(input_missing("specimen.cracks", "stands beside crack_lengths_mm, which says how many there are", REMEDY))
            }
            (None, Some([left, right])) => {
                let [left, right] = [
                    length_or_none("specimen.crack_lengths_mm[0]", left)?,
                    length_or_none("specimen.crack_lengths_mm[1]", right)?,
                ];
                Ok(AtHole { lengths: [left, right], shared: None })
            }
            (None, None) => Err(input_missing("specimen.crack_length_mm", "is missing", REMEDY)),
            (Some(_), Some(_)) => Err(input_missing("specimen.crack_length_mm", "stands beside crack_lengths_mm", REMEDY)),
        }
    }

    /// Number of cracks.
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

/// A length in mm, or 0 for no crack; m.
pub(super) fn length_or_none(key: &str, given: f64) -> Result<f64> {
    if given == 0.0 { Ok(0.0) } else { LENGTH.read(key, given) }
}

/// Share of a size by which two that are equal in the file may differ.
pub(super) const SLACK: f64 = 1e-9;

/// Metres as mm, rounded for messages.
pub(super) fn in_mm(metres: f64) -> f64 {
    (metres / MM * 1e6).round() / 1e6
}

/// Refuses a size that does not lie below a limit, both in m.
pub(super) fn below(key: &str, size: f64, limit: f64, what: &str) -> Result<()> {
    if size < limit * (1.0 - SLACK) {
        return Ok(());
    }
    let problem = format!("is not below {what}, {} mm", in_mm(limit));
    Err(input(&format!("specimen.{key}"), in_mm(size), problem, "give a smaller one, or a larger plate"))
}
