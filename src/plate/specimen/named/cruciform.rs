//! A cross of four equal arms with rounded inner corners and a central crack: pulled at the ends of the upright arms, and of the others by
//! `loading.stress_parallel_ratio` times the stress.

use std::f64::consts::PI;

use serde::Deserialize;
use toml::Value;

use super::shapes::{arc, below};
use super::{Description, Layout};
use crate::specimen::plate::{Drawing, turned};
use crate::specimen::{Point, SpecimenKind};
use perilife_base::error::Result;
use perilife_base::input::{number, slice};
use perilife_base::lengths;

pub(super) const KIND: Description = Description { kind: SpecimenKind::Cruciform, layout };

/// Keys of `[specimen]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Input {
    #[serde(rename = "kind")]
    _kind: SpecimenKind,
    /// From end to end.
    length_mm: f64,
    arm_width_mm: f64,
    fillet_radius_mm: f64,
    thickness_mm: f64,
    /// Half of it.
    crack_length_mm: f64,
    /// Against x.
    #[serde(default)]
    crack_angle_deg: f64,
}

fn layout(value: &Value) -> Result<Layout> {
    let input: Input = slice(value, "specimen")?;
    let [length, arm_width, radius, thickness, a] =
        lengths!(input: length_mm, arm_width_mm, fillet_radius_mm, thickness_mm, crack_length_mm);
    let (end, arm) = (length / 2.0, arm_width / 2.0);
    let angle = number("an angle in degrees", -180.0, 180.0).read("specimen.crack_angle_deg", input.crack_angle_deg)?;
    below("fillet_radius_mm", radius, end - arm, "what an arm is long")?;
    below("crack_length_mm", a, arm, "half the width of an arm")?;
    // One inner corner, turned into all four; built so that the cross is its own mirror image but for round-off.
    let quarter: Vec<Point> =
        [[end, -arm], [end, arm]].into_iter().chain(arc([arm + radius, arm + radius], radius, [1.5 * PI, PI])).collect();
    let outline = (0..4).flat_map(|quarters| quarter.iter().map(move |&corner| turned(corner, quarters))).collect();
    let (sin, cos) = match angle {
        // Exactly along the axes, where sin and cos would leave a rounding.
        0.0 => (0.0, 1.0),
        90.0 => (1.0, 0.0),
        other => other.to_radians().sin_cos(),
    };
    let cracks = vec![vec![[-a * cos, -a * sin], [a * cos, a * sin]]];
    let drawing = Drawing { outline, cracks, thickness, ..Drawing::default() };
    Ok(Layout { drawing, crack_length: Some(a), ..Layout::default() })
}
