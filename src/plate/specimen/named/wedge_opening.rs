//! Modified wedge-opening-loaded specimen (WOL) of Novak and Rolfe: a compact specimen with half height 0.486 W, whose crack has more room.
//!
//! x from the load line, W from there to the back face, 0.255 W from there to the front face. Pins in holes of 0.2 W, 0.25 W off the crack, stand
//! for bolt and clevis; a wedge that holds the opening is `loading.kind = "displacement"`.

use serde::Deserialize;
use toml::Value;

use super::shapes::{below, pin};
use super::{Description, Layout};
use crate::specimen::handbook::HandbookFormula;
use crate::specimen::pin::LOOSE_PIN;
use crate::specimen::plate::Drawing;
use crate::specimen::{Bearing, Hole, SpecimenKind};
use perilife_base::error::Result;
use perilife_base::input::{LENGTH, slice};

pub(super) const KIND: Description = Description { kind: SpecimenKind::WedgeOpening, layout };

/// Half height, over W as all that follows.
const HALF_HEIGHT: f64 = 0.486;
/// Front face from the load line.
const FRONT: f64 = 0.255;
/// Pins from the crack.
const FROM_CRACK: f64 = 0.25;
/// Diameter of their holes.
const DIAMETER: f64 = 0.2;

/// Keys of `[specimen]`; width is W.
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
    let input: Input = slice(value, "specimen")?;
    let w = LENGTH.read("specimen.width_mm", input.width_mm)?;
    let thickness = LENGTH.read("specimen.thickness_mm", input.thickness_mm)?;
    let a = LENGTH.read("specimen.crack_length_mm", input.crack_length_mm)?;
    below("crack_length_mm", a, w, "the width W from the load line")?;
    let (front, y) = (-FRONT * w, HALF_HEIGHT * w);
    let hole = |side: f64| Hole { centre: [0.0, side * FROM_CRACK * w], radius: 0.5 * DIAMETER * w };
    let drawing = Drawing {
        outline: vec![[front, -y], [w, -y], [w, y], [front, y]],
        holes: vec![hole(1.0), hole(-1.0)],
        cracks: vec![vec![[front, 0.0], [a, 0.0]]],
        thickness,
        ..Drawing::default()
    };
    let formula = HandbookFormula {
        name: "Novak and Rolfe WOL",
        source: "Novak and Rolfe 1969, J. Materials 4:701, K = P C3/(B √a)",
        range: "2 % for a/W from 0.25 to 0.75",
        bounds: [0.25, 0.75],
        of: |x, _| x.sqrt() * (30.96 + x * (-195.8 + x * (730.6 + x * (-1186.3 + 754.6 * x)))),
        error: |_| 0.02,
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
