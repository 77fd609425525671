//! M(T): a plate with a central through crack under uniform stress, ASTM E647.
//!
//! ```text
//!   ↑ ↑ ↑ ↑ ↑      width W, length L, crack from -a to a on y = 0
//!  ┌─────────┐     crack length a = half of the length tip to tip
//!  │  ─────  │
//!  └─────────┘
//!   ↓ ↓ ↓ ↓ ↓
//! ```

use serde::Deserialize;
use toml::Value;

use super::read::check_crack;
use super::{Crack, Specimen, SpecimenKind, TipSeed};
use crate::error::Result;
use crate::input::{LENGTH, slice};

/// Keys of `[specimen]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Input {
    #[serde(rename = "kind")]
    _kind: SpecimenKind,
    width_mm: f64,
    length_mm: f64,
    thickness_mm: f64,
    crack_length_mm: f64,
}

pub(super) fn from_value(value: &Value) -> Result<Specimen> {
    let input: Input = slice(value, "specimen")?;
    let width = LENGTH.read("specimen.width_mm", input.width_mm)?;
    let length = LENGTH.read("specimen.length_mm", input.length_mm)?;
    let thickness = LENGTH.read("specimen.thickness_mm", input.thickness_mm)?;
    let a = LENGTH.read("specimen.crack_length_mm", input.crack_length_mm)?;
    check_crack(input.crack_length_mm, input.width_mm / 2.0, "the half width")?;
    let tip = |sign: f64| TipSeed { position: [sign * a, 0.0], direction: [sign, 0.0], from_slot: false };
    Ok(Specimen {
        cracks: vec![Crack::straight([-a, 0.0], [a, 0.0])],
        tips: vec![tip(-1.0), tip(1.0)],
        crack_length: a,
        ..Specimen::strip(SpecimenKind::MiddleTension, width, length, thickness)
    })
}
