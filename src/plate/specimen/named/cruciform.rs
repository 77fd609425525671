//! A cross of four equal arms with rounded inner corners and a central crack: pulled at the ends of the upright arms, and of the others by
//! `loading.stress_parallel_ratio` times the stress.

use std::f64::consts::PI;

use super::shapes::{arc, below};
use super::{Layout, SpecimenSpec};
use crate::specimen::keys::{CRACK_LENGTH, LENGTH, THICKNESS};
use crate::specimen::plate::{Drawing, turned};
use crate::specimen::{Point, SpecimenKind};
use perilife_base::error::Result;
use perilife_base::keys::{Given, Section, length, number};

pub(super) const KIND: SpecimenSpec = SpecimenSpec { kind: SpecimenKind::Cruciform, keys: Keys::KEYS, layout };

perilife_base::keys! {
    struct Keys {
        length: f64 = LENGTH.said("Length L: end to end of two arms");
        arm_width: f64 = length("arm_width_mm", "Width of an arm");
        radius: f64 = length("fillet_radius_mm", "Radius of the inner corners");
        thickness: f64 = THICKNESS;
        a: f64 = CRACK_LENGTH.said("Initial crack length a: half length");
        angle: f64 = number("crack_angle_deg", "Angle of the crack, °: against x", "an angle in degrees", -180.0, 180.0), or "0" 0.0;
    }
}

fn layout(given: &Given<'_>) -> Result<Layout> {
    let Keys { length, arm_width, radius, thickness, a, angle } = Keys::read(given)?;
    let (end, arm) = (length / 2.0, arm_width / 2.0);
    below("fillet_radius_mm", radius, end - arm, "the length of an arm")?;
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
