//! A plate under tension with a U-shaped notch in its left edge and, where `crack_length_mm` is given, a crack from its root.

use std::f64::consts::PI;

use serde::Deserialize;
use toml::Value;

use super::shapes::{arc, below};
use super::{Description, Layout};
use crate::specimen::plate::Drawing;
use crate::specimen::{Point, SpecimenKind};
use perilife_base::error::Result;
use perilife_base::input::{LENGTH, slice};
use perilife_base::lengths;

pub(super) const KIND: Description = Description { kind: SpecimenKind::EdgeNotch, layout };

/// Keys of `[specimen]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Input {
    #[serde(rename = "kind")]
    _kind: SpecimenKind,
    width_mm: f64,
    length_mm: f64,
    thickness_mm: f64,
    /// From the edge to the root.
    notch_depth_mm: f64,
    /// Of the half circle that ends it.
    notch_radius_mm: f64,
    crack_length_mm: Option<f64>,
}

fn layout(value: &Value) -> Result<Layout> {
    let input: Input = slice(value, "specimen")?;
    let [width, length, thickness, depth, radius] =
        lengths!(input: width_mm, length_mm, thickness_mm, notch_depth_mm, notch_radius_mm);
    let crack_length = LENGTH.read_optional("specimen.crack_length_mm", input.crack_length_mm)?;
    below("notch_radius_mm", radius, (depth * (1.0 + 1e-9)).min(length / 2.0), "depth of the notch and half the length")?;
    below("notch_depth_mm", depth, width, "the width")?;
    below("crack_length_mm", crack_length.unwrap_or(0.0), width - depth, "what the notch leaves of the width")?;
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
