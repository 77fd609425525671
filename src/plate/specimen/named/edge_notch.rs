//! A plate under tension with a U-shaped notch in its left edge and, where `crack_length_mm` is given, a crack from its root.

use std::f64::consts::PI;

use super::shapes::{arc, below};
use super::{Layout, SpecimenSpec};
use crate::specimen::keys::{CRACK_LENGTH, LENGTH, THICKNESS, WIDTH};
use crate::specimen::plate::Drawing;
use crate::specimen::{Point, SpecimenKind};
use perilife_base::error::Result;
use perilife_base::keys::{Given, Section, length};

pub(super) const KIND: SpecimenSpec = SpecimenSpec { kind: SpecimenKind::EdgeNotch, keys: Keys::KEYS, layout };

perilife_base::keys! {
    struct Keys {
        width: f64 = WIDTH;
        length: f64 = LENGTH;
        thickness: f64 = THICKNESS;
        depth: f64 = length("notch_depth_mm", "Depth of the notch: from the edge to the root");
        radius: f64 = length("notch_radius_mm", "Radius of the root: half circle that ends the notch");
        crack_length: Option<f64> = CRACK_LENGTH.said("Initial crack length a: from the notch root; default no crack");
    }
}

fn layout(given: &Given<'_>) -> Result<Layout> {
    let Keys { width, length, thickness, depth, radius, crack_length } = Keys::read(given)?;
    below("notch_radius_mm", radius, (depth * (1.0 + 1e-9)).min(length / 2.0), "depth of the notch and half the length")?;
    below("notch_depth_mm", depth, width, "the width")?;
    below("crack_length_mm", crack_length.unwrap_or(0.0), width - depth, "the width minus the notch depth")?;
    let (x, y) = (width / 2.0, length / 2.0);
    let centre: Point = [-x + depth - radius, 0.0];
    let mut outline: Vec<Point> = vec![[-x, -y], [x, -y], [x, y], [-x, y]];
    if depth > radius * (1.0 + 1e-6) {
        outline.push([-x, radius]);
    }
    // Round the root from above, the plate on the left.
    outline.extend(arc(centre, radius, [0.5 * PI, -0.5 * PI]));
    if depth > radius * (1.0 + 1e-6) {
        outline.push([-x, -radius]);
    }
    let root = -x + depth;
    let cracks = crack_length.map(|a| vec![[root, 0.0], [root + a, 0.0]]).into_iter().collect();
    let drawing = Drawing { outline, cracks, thickness, ..Drawing::default() };
    Ok(Layout { drawing, crack_length, ..Layout::default() })
}
