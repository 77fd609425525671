//! A plate under tension with a row of equal holes across it, cracked at their sides, such as a riveted joint: cracks of neighbours link up.

use super::shapes::{FROM_RIM, LENGTHS, SLACK, below};
use super::{Layout, SpecimenSpec};
use crate::specimen::keys::{HOLE_DIAMETER, LENGTH, THICKNESS, WIDTH};
use crate::specimen::plate::{Drawing, rectangle};
use crate::specimen::{Hole, Point, SpecimenKind};
use perilife_base::error::{Result, input};
use perilife_base::keys::{Given, OrNone, Section, length, number};
use perilife_base::units::round_mm;

pub(super) const KIND: SpecimenSpec = SpecimenSpec { kind: SpecimenKind::RowOfHoles, keys: Keys::KEYS, layout };

perilife_base::keys! {
    struct Keys {
        width: f64 = WIDTH;
        length: f64 = LENGTH;
        thickness: f64 = THICKNESS;
        count: usize = number("holes", "Holes: in one row across the load", "a number of holes", 2.0, 100.0)
            .missing("give 2 to 100, or use kind = \"crack_at_hole\"");
        pitch: f64 = length("pitch_mm", "Pitch: between hole centers");
        diameter: f64 = HOLE_DIAMETER;
        shared: Option<f64> = FROM_RIM;
        lengths: Option<Vec<[OrNone; 2]>> = length("crack_lengths_mm", "Crack lengths: [left, right] of every hole, 0 for no crack").group(LENGTHS);
    }
}

fn layout(given: &Given<'_>) -> Result<Layout> {
    let own = Keys::read(given)?;
    let Keys { width, length, thickness, count, pitch, diameter, shared, .. } = own;
    below("hole_diameter_mm", diameter, pitch, "the pitch of the row")?;
    below("pitch_mm", pitch, (width - diameter) / (count - 1) as f64, "what fits in the width")?;
    let lengths = lengths(given, &own)?;
    let xs: Vec<f64> = (0..count).map(|i| (i as f64 - (count - 1) as f64 / 2.0) * pitch).collect();
    let edge = (width - diameter) / 2.0 - xs[count - 1];
    let key = if shared.is_some() { "crack_length_mm" } else { "crack_lengths_mm" };
    below(key, lengths[0][0].max(lengths[count - 1][1]), edge, "the distance from the row to the edge")?;
    let radius = diameter / 2.0;
    check_ligaments(&lengths, pitch - diameter)?;
    let drawing = Drawing {
        outline: rectangle(width, length),
        holes: xs.iter().map(|&x| Hole { centre: [x, 0.0], radius }).collect(),
        cracks: paths(&xs, radius, &lengths),
        thickness,
        ..Drawing::default()
    };
    Ok(Layout { drawing, crack_length: shared, ..Layout::default() })
}

fn lengths(given: &Given<'_>, own: &Keys) -> Result<Vec<[f64; 2]>> {
    const KEY: &str = "crack_lengths_mm";
    const REMEDY: &str = "give crack_length_mm of all cracks, or crack_lengths_mm = [[left, right], ...], 0 without a crack";
    match (own.shared, &own.lengths) {
        (Some(length), _) => {
            below("crack_length_mm", length, (own.pitch - own.diameter) / 2.0, "half the ligament")?;
            Ok(vec![[length; 2]; own.count])
        }
        (None, Some(list)) if list.iter().flatten().all(|length| length.0 == 0.0) => {
            Err(given.refuse(KEY, "has no crack", REMEDY))
        }
        (None, Some(list)) if list.len() == own.count => Ok(list.iter().map(|pair| pair.map(|length| length.0)).collect()),
        (None, Some(_)) => Err(given.refuse(KEY, format!("do not match the number of holes, {}", own.count), REMEDY)),
        (None, None) => Err(given.refuse("crack_length_mm", "is missing", REMEDY)),
    }
}

/// Refuses a crack that would end beyond the next hole: one that fills the ligament has linked both.
fn check_ligaments(lengths: &[[f64; 2]], ligament: f64) -> Result<()> {
    let last = lengths.len() - 1;
    let inner = lengths.iter().enumerate().flat_map(|(hole, pair)| [(hole, 0, pair[0]), (hole, 1, pair[1])]);
    let mut inner = inner.filter(|&(hole, side, _)| (hole, side) != (0, 0) && (hole, side) != (last, 1));
    let Some((hole, side, length)) = inner.find(|(_, _, length)| *length > ligament * (1.0 + SLACK)) else { return Ok(()) };
    let problem = format!("is longer than the ligament to the next hole, {} mm", round_mm(ligament));
    let remedy = "give at most the ligament; two cracks that fill it are linked up";
    Err(input(&format!("specimen.crack_lengths_mm[{hole}][{side}]"), round_mm(length), problem, remedy))
}

/// Cracks from left to right; those that fill the ligament between two holes have cut it, as after link-up.
fn paths(xs: &[f64], radius: f64, lengths: &[[f64; 2]]) -> Vec<Vec<Point>> {
    let mut paths = Vec::new();
    let mut line = |from: f64, to: f64| {
        if from != to {
            paths.push(vec![[from, 0.0], [to, 0.0]]);
        }
    };
    line(xs[0] - radius, xs[0] - radius - lengths[0][0]);
    for (i, pair) in xs.windows(2).enumerate() {
        let (left, right) = (pair[0] + radius, pair[1] - radius);
        let (out, back) = (lengths[i][1], lengths[i + 1][0]);
        if out + back >= (right - left) * (1.0 - SLACK) {
            line(left, right);
        } else {
            line(left, left + out);
            line(right, right - back);
        }
    }
    let last = xs.len() - 1;
    line(xs[last] + radius, xs[last] + radius + lengths[last][1]);
    paths
}
