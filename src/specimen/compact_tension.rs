//! C(T): compact specimen pulled open by two pins, proportions of ASTM E647.
//!
//! The origin lies on the load line in the crack plane; W reaches from there to the back face x = W. Total width 1.25 W,
//! height 1.2 W, holes of diameter 0.25 W at (0, ±0.275 W). The machined notch and the pre-crack together are one crack
//! from the front face x = -0.25 W to x = a.
//!
//! The pins have a diameter of 0.24 W and roll on flats: they touch the far side of their holes over a narrow arc and bring
//! no friction. How wide the arc is matters for short cracks, whose tips lie close to the holes (Newman 1974, ASTM STP 560,
//! p. 105): a pressure over the whole half circle spreads the hole and raises K by 4.3, 2.4, 1.3, 0.2 % at a/W = 0.2, 0.25,
//! 0.3, 0.4 (own finite elements, quadratic, K by J), while arcs of 5 to 20° agree with each other and with the formula of
//! E647 within 0.2 %, of 45° within 1 %.

use serde::Deserialize;
use toml::Value;

use super::net_section::check_crack;
use super::{Crack, Hole, Load, LoadMeasure, Specimen, SpecimenKind, TipSeed};
use crate::error::Result;
use crate::input::{LENGTH, slice};

/// Half angle of contact of the pins, rad: Hertz contact of a steel pin with the clearance of E647 in aluminium gives
/// `b = √(4 P' R / π E*)` = 1.4 mm at W = 50 mm and P' = 640 N/mm, or 13° of the hole (1/E* = (1-ν²)/E of both, R = 150 mm).
const CONTACT: f64 = 15.0 * std::f64::consts::PI / 180.0;

/// Keys of `[specimen]`; width is W, from the load line to the back face.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Input {
    #[serde(rename = "kind")]
    _kind: SpecimenKind,
    width_mm: f64,
    thickness_mm: f64,
    crack_length_mm: f64,
}

pub(super) fn from_value(value: &Value) -> Result<Specimen> {
    let input: Input = slice(value, "specimen")?;
    let w = LENGTH.read("specimen.width_mm", input.width_mm)?;
    let thickness = LENGTH.read("specimen.thickness_mm", input.thickness_mm)?;
    let a = LENGTH.read("specimen.crack_length_mm", input.crack_length_mm)?;
    check_crack(input.crack_length_mm, input.width_mm, "the width W from the load line")?;
    let hole = |sign: f64| Hole { centre: [0.0, sign * 0.275 * w], radius: 0.125 * w };
    let pin = |hole: usize, sign: f64| Load::Pin { hole, direction: [0.0, sign], force: 1.0, contact: CONTACT };
    let (front, half_height) = (-0.25 * w, 0.6 * w);
    Ok(Specimen {
        outline: vec![[front, -half_height], [w, -half_height], [w, half_height], [front, half_height]],
        holes: vec![hole(1.0), hole(-1.0)],
        cracks: vec![Crack::straight([front, 0.0], [a, 0.0])],
        tips: vec![TipSeed { position: [a, 0.0], direction: [1.0, 0.0], from_slot: false }],
        gross_width: 1.25 * w,
        crack_length: a,
        loads: vec![pin(0, 1.0), pin(1, -1.0)],
        load_measure: LoadMeasure::Force,
        crack_pressure: 0.0,
        ..Specimen::strip(SpecimenKind::CompactTension, w, 1.2 * w, thickness)
    })
}
