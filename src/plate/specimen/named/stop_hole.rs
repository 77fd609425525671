//! A plate under tension with a central crack that was stopped by a hole drilled about each of its tips.
//!
//! The holes stand `stopped_crack_length_mm`, half the length of the crack, from the centre. `formed_length_mm` is how long, from the rims, the cracks
//! are that form beyond the holes in phase I ([`perilife_laws::initiation`]); from there on they grow.

use serde::Deserialize;
use toml::Value;

use super::shapes::below;
use super::{Description, Layout};
use crate::specimen::plate::{Drawing, rectangle};
use crate::specimen::{Hole, SpecimenKind};
use perilife_base::error::Result;
use perilife_base::input::slice;
use perilife_base::lengths;

pub(super) const KIND: Description = Description { kind: SpecimenKind::StopHole, layout };

/// Keys of `[specimen]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Input {
    #[serde(rename = "kind")]
    _kind: SpecimenKind,
    width_mm: f64,
    length_mm: f64,
    thickness_mm: f64,
    stopped_crack_length_mm: f64,
    hole_diameter_mm: f64,
    formed_length_mm: f64,
}

fn layout(value: &Value) -> Result<Layout> {
    let input: Input = slice(value, "specimen")?;
    let [width, length, thickness, centre, diameter, formed] = lengths!(
        input: width_mm, length_mm, thickness_mm, stopped_crack_length_mm, hole_diameter_mm, formed_length_mm);
    let radius = diameter / 2.0;
    below("hole_diameter_mm", 2.0 * radius, (2.0 * centre).min(length), "the length of the crack and of the plate")?;
    below("formed_length_mm", formed, width / 2.0 - centre - radius, "the way from the rim to the edge")?;
    let line = |from: f64, to: f64| vec![[from, 0.0], [to, 0.0]];
    let rim = centre + radius;
    let drawing = Drawing {
        outline: rectangle(width, length),
        holes: [-1.0, 1.0].map(|side| Hole { centre: [side * centre, 0.0], radius }).to_vec(),
        cracks: vec![line(radius - centre, centre - radius), line(rim, rim + formed), line(-rim, -rim - formed)],
        thickness,
        ..Drawing::default()
    };
    Ok(Layout { drawing, crack_length: Some(rim + formed), ..Layout::default() })
}
