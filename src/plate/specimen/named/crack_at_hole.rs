//! A plate under tension with a round hole in its middle, or `hole_offset_mm` beside it, and a crack at its right, or at both sides.

use std::f64::consts::PI;

use super::shapes::{AtHole, AtHoleKeys, below};
use super::{Layout, SpecimenSpec};
use crate::specimen::handbook::{HandbookFormula, half};
use crate::specimen::keys::{HOLE_DIAMETER, LENGTH, THICKNESS, WIDTH};
use crate::specimen::plate::{Drawing, rectangle};
use crate::specimen::{Hole, SpecimenKind};
use perilife_base::error::Result;
use perilife_base::keys::{Given, Section, coordinate, part};

pub(super) const KIND: SpecimenSpec = SpecimenSpec { kind: SpecimenKind::CrackAtHole, keys: Keys::KEYS, layout };

perilife_base::keys! {
    struct Keys {
        width: f64 = WIDTH;
        length: f64 = LENGTH;
        thickness: f64 = THICKNESS;
        diameter: f64 = HOLE_DIAMETER;
        x: f64 = coordinate("hole_offset_mm", "Hole center: distance from the midline, across the load"), or "0" 0.0;
        cracks: AtHoleKeys = part();
    }
}

fn layout(given: &Given<'_>) -> Result<Layout> {
    let Keys { width, length, thickness, diameter, x, cracks } = Keys::read(given)?;
    let radius = diameter / 2.0;
    let cracks = AtHole::read(given, &cracks)?;
    below("hole_diameter_mm", 2.0 * radius, width - 2.0 * x.abs(), "the width available there")?;
    let key = if cracks.shared.is_some() { "crack_length_mm" } else { "crack_lengths_mm" };
    for (length, side) in cracks.lengths.into_iter().zip([-1.0, 1.0]) {
        below(key, length, width / 2.0 - side * x - radius, "the distance from the hole edge to the plate edge")?;
    }
    let drawing = Drawing {
        outline: rectangle(width, length),
        holes: vec![Hole { centre: [x, 0.0], radius }],
        cracks: cracks.paths([x, 0.0], radius),
        thickness,
        ..Drawing::default()
    };
    let is_known = x == 0.0 && cracks.shared.is_some() && length >= width;
    let formula = is_known.then(|| formula(cracks.count(), [width, radius], thickness));
    Ok(Layout { drawing, crack_length: cracks.shared, formula, ..Layout::default() })
}

/// `K = F f_w σ √(π a)` of one or two equal cracks (errors: against nodes, whose lives are those of finite elements): F in a large plate, width by Newman, `f_w = √[sec(π R/W) sec(π (R + n a/2)/(W - (2 - n) a))]`.
fn formula(count: usize, [width, radius]: [f64; 2], thickness: f64) -> HandbookFormula {
    let shape = radius / width;
    let two = HandbookFormula {
        name: "Newman two cracks at a hole",
        source: "Newman 1971, NASA TN D-6376, table for uniaxial tension",
        range: "1 % for 2(R + a)/W ≤ 0.3; length/width ≥ 1",
        bounds: [0.01 * shape, 0.15 - shape],
        of: |x, shape| of_two(x / shape) * in_width(x, shape, 2.0),
        error: |_| 0.01,
        shape,
        limit: 0.5 - shape,
        ..HandbookFormula::unstated(width, thickness)
    };
    if count == 2 {
        return two;
    }
    HandbookFormula {
        name: "Newman and Shah, one crack at a hole",
        source: "Newman 1971, NASA TN D-6376, for two cracks, times the factor of Shah 1976, ASTM STP 590, for one",
        range: "up to 3.5 % low for 2(R + a)/W ≤ 0.5; length/width ≥ 1",
        bounds: [0.01 * shape, 0.25 - shape],
        of: |x, shape| {
            let a = x / shape;
            of_two(a) * ((2.0 + a) / (2.0 + 2.0 * a)).sqrt() * in_width(x, shape, 1.0)
        },
        error: |_| 0.035,
        ..two
    }
}

/// `f_w` over a/W and R/W for n cracks.
fn in_width(x: f64, shape: f64, n: f64) -> f64 {
    let crack = PI * (2.0 * shape + n * x) / (4.0 * (0.5 - x) + 2.0 * n * x);
    (1.0 / (half(2.0 * shape).cos() * crack.cos())).sqrt()
}

/// (R + a)/R and K/(σ √(π (R + a))) of two cracks at a hole in a large plate in tension.
const NEWMAN: [[f64; 2]; 19] = [
    [1.01, 0.3256],
    [1.02, 0.4514],
    [1.04, 0.6082],
    [1.06, 0.7104],
    [1.08, 0.7843],
    [1.10, 0.8400],
    [1.15, 0.9322],
    [1.20, 0.9851],
    [1.25, 1.0168],
    [1.30, 1.0358],
    [1.40, 1.0536],
    [1.50, 1.0582],
    [1.60, 1.0571],
    [1.80, 1.0495],
    [2.00, 1.0409],
    [2.20, 1.0336],
    [2.50, 1.0252],
    [3.00, 1.0161],
    [4.00, 1.0077],
];

/// F = K/(σ √(π a)) of two cracks of length `a` radii.
fn of_two(a: f64) -> f64 {
    // F is smooth in R/(R + a), from 3.36 of an edge crack under 3 σ to 1 of a crack as long as both and the hole.
    let place = |[l, f]: [f64; 2]| [1.0 / l, f * (l / (l - 1.0)).sqrt()];
    let at = 1.0 / (1.0 + a);
    let table: Vec<[f64; 2]> = [[1.0, 3.0 * 1.1215]].into_iter().chain(NEWMAN.map(place)).chain([[0.0, 1.0]]).collect();
    let above = table.iter().position(|[s, _]| *s < at).unwrap_or(table.len() - 1).clamp(1, table.len() - 1);
    let [[s0, f0], [s1, f1]] = [table[above - 1], table[above]];
    f0 + (f1 - f0) * (at - s0) / (s1 - s0)
}
