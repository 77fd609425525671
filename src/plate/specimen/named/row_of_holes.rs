//! A plate under tension with a row of equal holes across it, cracked at their sides, such as a riveted joint: cracks of neighbours link up.

use serde::Deserialize;
use toml::Value;

use super::shapes::{SLACK, below, in_mm, length_or_none};
use super::{Description, Layout};
use crate::specimen::plate::{Drawing, rectangle};
use crate::specimen::{Hole, Point, SpecimenKind};
use perilife_base::error::{Result, input, input_missing};
use perilife_base::input::{LENGTH, slice};
use perilife_base::lengths;
use perilife_base::units::MM;

pub(super) const KIND: Description = Description { kind: SpecimenKind::RowOfHoles, layout };

/// More holes than this are a slip.
const HOLES_MAX: usize = 100;

/// Keys of `[specimen]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Input {
    #[serde(rename = "kind")]
    _kind: SpecimenKind,
    width_mm: f64,
    length_mm: f64,
    thickness_mm: f64,
    holes: usize,
    pitch_mm: f64,
    hole_diameter_mm: f64,
    crack_length_mm: Option<f64>,
    /// Of every hole [left, right].
    crack_lengths_mm: Option<Vec<[f64; 2]>>,
}

fn layout(value: &Value) -> Result<Layout> {
    let input_: Input = slice(value, "specimen")?;
    let [width, length, thickness, pitch, diameter] =
        lengths!(input_: width_mm, length_mm, thickness_mm, pitch_mm, hole_diameter_mm);
    let count = input_.holes;
    if !(2..=HOLES_MAX).contains(&count) {
        let remedy = format!("give 2 to {HOLES_MAX}, or use kind = \"{}\"", SpecimenKind::CrackAtHole);
        return Err(input("specimen.holes", count, "is no row", remedy));
    }
    below("hole_diameter_mm", diameter, pitch, "the pitch of the row")?;
    below("pitch_mm", pitch, (width - diameter) / (count - 1) as f64, "what the width has room for")?;
    let (lengths, shared) = lengths(&input_)?;
    let xs: Vec<f64> = (0..count).map(|i| (i as f64 - (count - 1) as f64 / 2.0) * pitch).collect();
    let edge = (width - diameter) / 2.0 - xs[count - 1];
    let key = if shared.is_some() { "crack_length_mm" } else { "crack_lengths_mm" };
    below(key, lengths[0][0].max(lengths[count - 1][1]), edge, "the way from the row to the edge")?;
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

/// Lengths of the cracks of every hole, [left, right], m, and the one of all.
fn lengths(given: &Input) -> Result<(Vec<[f64; 2]>, Option<f64>)> {
    const KEY: &str = "specimen.crack_lengths_mm";
    const REMEDY: &str = "give crack_length_mm of all cracks, or crack_lengths_mm = [[left, right], ...], 0 without a crack";
    match (given.crack_length_mm, &given.crack_lengths_mm) {
        (Some(length), None) => {
            let length = LENGTH.read("specimen.crack_length_mm", length)?;
            let ligament = (given.pitch_mm - given.hole_diameter_mm) * MM;
            below("crack_length_mm", length, ligament / 2.0, "half the ligament")?;
            Ok((vec![[length; 2]; given.holes], Some(length)))
        }
        (None, Some(list)) if list.iter().flatten().all(|length| *length == 0.0) => {
            Err(input(KEY, format!("{list:?}"), "has no crack", REMEDY))
        }
        (None, Some(list)) if list.len() == given.holes => {
            let one = |(i, pair): (usize, &[f64; 2])| -> Result<[f64; 2]> {
                Ok([length_or_none(&format!("{KEY}[{i}][0]"), pair[0])?, length_or_none(&format!("{KEY}[{i}][1]"), pair[1])?])
            };
            Ok((list.iter().enumerate().map(one).collect::<Result<_>>()?, None))
        }
        (None, Some(list)) => {
            let problem = format!("are not those of {} holes", given.holes);
            Err(input(KEY, format!("{} pairs", list.len()), problem, REMEDY))
        }
        (None, None) => Err(input_missing("specimen.crack_length_mm", "is missing", REMEDY)),
        (Some(_), Some(_)) => Err(input_missing("specimen.crack_length_mm", "stands beside crack_lengths_mm", REMEDY)),
    }
}

/// Refuses a crack that would end beyond the next hole: one that fills the ligament has linked both.
fn check_ligaments(lengths: &[[f64; 2]], ligament: f64) -> Result<()> {
    let last = lengths.len() - 1;
    let inner = lengths.iter().enumerate().flat_map(|(hole, pair)| [(hole, 0, pair[0]), (hole, 1, pair[1])]);
    let mut inner = inner.filter(|&(hole, side, _)| (hole, side) != (0, 0) && (hole, side) != (last, 1));
    let Some((hole, side, length)) = inner.find(|(_, _, length)| *length > ligament * (1.0 + SLACK)) else { return Ok(()) };
    let problem = format!("is longer than the ligament to the next hole, {} mm", in_mm(ligament));
    let remedy = "give at most the ligament: two lengths that together fill it are cracks that have linked";
    Err(input(&format!("specimen.crack_lengths_mm[{hole}][{side}]"), in_mm(length), problem, remedy))
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
