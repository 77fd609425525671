//! ESE(T) of ASTM E647: a long plate with an edge crack, pulled by two pins on a line 0.3 W towards the crack from its middle.
//!
//! x from the cracked edge. The line of the pins follows from the formula: K of a short crack is that of an edge crack under the stress of
//! the edge, `1.4 × 3.97 = 1.1215 √π (1 + 6 e/W)` for e = 0.3 W.

use serde::Deserialize;
use toml::Value;

use super::shapes::{below, pin};
use super::{Description, Layout};
use crate::specimen::handbook::HandbookFormula;
use crate::specimen::pin::LOOSE_PIN;
use crate::specimen::plate::Drawing;
use crate::specimen::{Bearing, Hole, SpecimenKind};
use perilife_base::error::Result;
use perilife_base::input::{self, slice};

pub(super) const KIND: Description = Description { kind: SpecimenKind::EccentricSingleEdgeTension, layout };

/// Length of the plate, over W as all that follows.
const LENGTH: f64 = 3.7;
/// Place of the pins from its ends and from the cracked edge.
const PINS: [f64; 2] = [0.35, 0.2];
/// Diameter of their holes.
const DIAMETER: f64 = 0.2;

/// Keys of `[specimen]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Input {
    #[serde(rename = "kind")]
    _kind: SpecimenKind,
    width_mm: f64,
    thickness_mm: f64,
    crack_length_mm: f64,
}

fn layout(value: &Value) -> Result<Layout> {
    let given: Input = slice(value, "specimen")?;
    let w = input::LENGTH.read("specimen.width_mm", given.width_mm)?;
    let thickness = input::LENGTH.read("specimen.thickness_mm", given.thickness_mm)?;
    let a = input::LENGTH.read("specimen.crack_length_mm", given.crack_length_mm)?;
    below("crack_length_mm", a, w, "the width")?;
    let y = 0.5 * LENGTH * w;
    let hole = |side: f64| Hole { centre: [PINS[1] * w, side * (y - PINS[0] * w)], radius: 0.5 * DIAMETER * w };
    let drawing = Drawing {
        outline: vec![[0.0, -y], [w, -y], [w, y], [0.0, y]],
        holes: vec![hole(1.0), hole(-1.0)],
        cracks: vec![vec![[0.0, 0.0], [a, 0.0]]],
        thickness,
        ..Drawing::default()
    };
    let formula = HandbookFormula {
        name: "ASTM E647 ESE(T)",
        source: "ASTM E647 annex A3 (Piascik, Newman and Underwood 1997)",
        range: "0.5 % for any a/W",
        bounds: [0.0, 1.0],
        of: |x, _| {
            let polynomial = 3.97 + x * (-10.88 + x * (26.25 + x * (-38.9 + x * (30.15 - 9.27 * x))));
            x.sqrt() * (1.4 + x) * (1.0 - x).powf(-1.5) * polynomial
        },
        error: |_| 0.005,
        cracks: 1.0,
        is_of_pins: true,
        width: w,
        thickness,
        shape: 0.0,
        limit: 1.0,
        table: None,
    };
    let loads = vec![pin(0, [0.0, 1.0], Bearing::Unknown(LOOSE_PIN)), pin(1, [0.0, -1.0], Bearing::Unknown(LOOSE_PIN))];
    Ok(Layout { drawing, loads, crack_length: Some(a), formula: Some(formula), supports: Vec::new() })
}
