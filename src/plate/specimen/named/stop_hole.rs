//! A plate under tension with a central crack that was stopped by a hole drilled about each of its tips.
//!
//! The holes stand `stopped_crack_length_mm`, half the length of the crack, from the centre. `formed_length_mm` is how long, from the rims, the cracks
//! are that form beyond the holes in phase I ([`perilife_laws::initiation`]); from there on they grow.

use super::shapes::below;
use super::{Layout, SpecimenSpec};
use crate::specimen::keys::{HOLE_DIAMETER, LENGTH, THICKNESS, WIDTH};
use crate::specimen::plate::{Drawing, rectangle};
use crate::specimen::{Hole, SpecimenKind};
use perilife_base::error::Result;
use perilife_base::keys::{Given, Section, length};

pub(super) const KIND: SpecimenSpec = SpecimenSpec { kind: SpecimenKind::StopHole, keys: Keys::KEYS, layout };

perilife_base::keys! {
    struct Keys {
        width: f64 = WIDTH;
        length: f64 = LENGTH;
        thickness: f64 = THICKNESS;
        centre: f64 = length("stopped_crack_length_mm", "Stopped crack: half length, to the hole centers");
        diameter: f64 = HOLE_DIAMETER;
        formed: f64 = length("formed_length_mm", "Crack length after initiation: from the hole edges");
    }
}

fn layout(given: &Given<'_>) -> Result<Layout> {
    let Keys { width, length, thickness, centre, diameter, formed } = Keys::read(given)?;
    let radius = diameter / 2.0;
    below("hole_diameter_mm", 2.0 * radius, (2.0 * centre).min(length), "the length of the crack and of the plate")?;
    below("formed_length_mm", formed, width / 2.0 - centre - radius, "the distance from the hole edge to the plate edge")?;
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
