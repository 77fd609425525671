//! M(T), SE(T) and DE(T): a plate under tension along y with a central crack, one edge crack or two equal ones on y = 0, ASTM E647.
//!
//! ```text
//!   ↑ ↑ ↑ ↑ ↑      width W, length L
//!  ┌─────────┐     M(T): crack from -a to a, crack length a = half of the length tip to tip
//!  │  ─────  │     SE(T), DE(T): crack length a from the edge x = -W/2 (and x = W/2)
//!  └─────────┘
//!   ↓ ↓ ↓ ↓ ↓
//! ```
//!
//! A single edge crack bends the plate, so its K depends on how the ends are held, and `ends` has to be given: at a/W = 0.5 clamped ends
//! give F = 2.2, 1.7, 1.3 at length/width 10, 4, 2, against 2.83 under uniform stress.

use serde::Deserialize;
use toml::Value;

use super::net_section::check_crack;
use super::{Crack, Ends, Specimen, SpecimenKind, Support, TipSeed};
use crate::error::{Result, input_missing};
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

/// Keys of `[specimen]` for a single edge crack.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SingleEdgeInput {
    #[serde(rename = "kind")]
    _kind: SpecimenKind,
    width_mm: f64,
    length_mm: f64,
    thickness_mm: f64,
    crack_length_mm: f64,
    ends: Option<Ends>,
}

/// A central crack, or two edge cracks.
pub(super) fn from_value(kind: SpecimenKind, value: &Value) -> Result<Specimen> {
    let Input { width_mm, length_mm, thickness_mm, crack_length_mm, .. } = slice(value, "specimen")?;
    let (strip, a) = sizes(kind, [width_mm, length_mm, thickness_mm, crack_length_mm])?;
    check_crack(crack_length_mm, width_mm / 2.0, "the half width")?;
    if kind == SpecimenKind::DoubleEdgeTension {
        let ((left, left_tip), (right, right_tip)) = (edge_crack(strip.width, a, -1.0), edge_crack(strip.width, a, 1.0));
        return Ok(Specimen { cracks: vec![left, right], tips: vec![left_tip, right_tip], crack_length: a, ..strip });
    }
    let tip = |sign: f64| TipSeed { position: [sign * a, 0.0], direction: [sign, 0.0], from_slot: false };
    let cracks = vec![Crack::straight([-a, 0.0], [a, 0.0])];
    Ok(Specimen { cracks, tips: vec![tip(-1.0), tip(1.0)], crack_length: a, ..strip })
}

/// One edge crack.
pub(super) fn single_edge_from_value(value: &Value) -> Result<Specimen> {
    let SingleEdgeInput { width_mm, length_mm, thickness_mm, crack_length_mm, ends, .. } = slice(value, "specimen")?;
    let (strip, a) = sizes(SpecimenKind::SingleEdgeTension, [width_mm, length_mm, thickness_mm, crack_length_mm])?;
    check_crack(crack_length_mm, width_mm, "the width")?;
    let supports = match ends {
        Some(Ends::UniformStress) => vec![],
        Some(Ends::Pinned) => vec![Support::RigidEnds],
        Some(Ends::Clamped) => vec![Support::ClampedEnds],
        None => {
            let known: Vec<&str> = Ends::ALL.iter().map(|ends| ends.name()).collect();
            let problem = "is missing: K of a single edge crack depends on how the ends are held";
            return Err(input_missing("specimen.ends", problem, format!("use one of {}", known.join(", "))));
        }
    };
    let (crack, tip) = edge_crack(strip.width, a, -1.0);
    Ok(Specimen { cracks: vec![crack], tips: vec![tip], crack_length: a, supports, ..strip })
}

/// Plate without cracks, and the crack length, m, from width, length, thickness and crack length in mm.
fn sizes(kind: SpecimenKind, [width, length, thickness, crack]: [f64; 4]) -> Result<(Specimen, f64)> {
    let width = LENGTH.read("specimen.width_mm", width)?;
    let length = LENGTH.read("specimen.length_mm", length)?;
    let thickness = LENGTH.read("specimen.thickness_mm", thickness)?;
    let crack = LENGTH.read("specimen.crack_length_mm", crack)?;
    Ok((Specimen::strip(kind, width, length, thickness), crack))
}

/// Crack of length `a` from the edge x = side W/2 inwards.
fn edge_crack(width: f64, a: f64, side: f64) -> (Crack, TipSeed) {
    let (mouth, end) = ([side * width / 2.0, 0.0], [side * (width / 2.0 - a), 0.0]);
    (Crack::straight(mouth, end), TipSeed { position: end, direction: [-side, 0.0], from_slot: false })
}
