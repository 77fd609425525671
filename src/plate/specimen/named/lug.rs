//! A lug: the pin pulls along y at the hole about the origin, the other end is held.
//!
//! A straight head ends `edge_distance_mm` beyond the centre of the hole (half the width where it is left out), a round one is half a circle of
//! the width about it. `length_mm` reaches from the centre to the held end. Where the pin touches is said by `pin_diameter_mm` (elastic contact) or
//! `pin_half_angle_deg`, as of a compact specimen.

use std::f64::consts::PI;

use serde::Deserialize;
use toml::Value;

use super::shapes::{AtHole, arc, below, pin};
use super::{Description, Layout};
use crate::specimen::pin::PinKeys;
use crate::specimen::plate::Drawing;
use crate::specimen::{Bearing, Head, Hole, Point, SpecimenKind, Support};
use perilife_base::error::{Result, input};
use perilife_base::input::{LENGTH, slice};
use perilife_base::lengths;

pub(super) const KIND: Description = Description { kind: SpecimenKind::Lug, layout };

/// Keys of `[specimen]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Input {
    #[serde(rename = "kind")]
    _kind: SpecimenKind,
    width_mm: f64,
    length_mm: f64,
    thickness_mm: f64,
    hole_diameter_mm: f64,
    head: Head,
    edge_distance_mm: Option<f64>,
    crack_length_mm: Option<f64>,
    cracks: Option<usize>,
    crack_lengths_mm: Option<[f64; 2]>,
    pin_half_angle_deg: Option<f64>,
    pin_diameter_mm: Option<f64>,
    pin_friction: Option<f64>,
    pin_youngs_modulus_gpa: Option<f64>,
    pin_poisson_ratio: Option<f64>,
}

fn layout(value: &Value) -> Result<Layout> {
    let input_: Input = slice(value, "specimen")?;
    let [width, length, thickness, diameter] = lengths!(input_: width_mm, length_mm, thickness_mm, hole_diameter_mm);
    let (half_width, radius) = (width / 2.0, diameter / 2.0);
    let distance = LENGTH.read_optional("specimen.edge_distance_mm", input_.edge_distance_mm)?;
    let cracks = AtHole::read(input_.crack_length_mm, input_.cracks, input_.crack_lengths_mm)?;
    below("hole_diameter_mm", 2.0 * radius, (2.0 * half_width).min(2.0 * length), "width and twice the length")?;
    let key = if cracks.shared.is_some() { "crack_length_mm" } else { "crack_lengths_mm" };
    below(key, cracks.lengths[0].max(cracks.lengths[1]), half_width - radius, "the way from the rim to the side")?;
    let keys: PinKeys<'_> = perilife_base::keyed!(
        input_: pin_half_angle_deg, pin_diameter_mm, pin_friction, pin_youngs_modulus_gpa, pin_poisson_ratio);
    let contact = Bearing::read("specimen", &keys, radius)?;
    let mut outline: Vec<Point> = vec![[-half_width, -length], [half_width, -length]];
    match (input_.head, distance) {
        (Head::Straight, distance) => {
            let top = distance.unwrap_or(half_width);
            below("hole_diameter_mm", 2.0 * radius, 2.0 * top, "twice the edge distance")?;
            outline.extend([[half_width, top], [-half_width, top]]);
        }
        (Head::Round, None) => outline.extend(arc([0.0, 0.0], half_width, [0.0, PI])),
        (Head::Round, Some(_)) => {
            let given = input_.edge_distance_mm.unwrap_or_default();
            let problem = "stands beside head = \"round\", whose edge is half the width away";
            return Err(input("specimen.edge_distance_mm", given, problem, "leave it out, or use head = \"straight\""));
        }
    }
    let drawing = Drawing {
        outline,
        holes: vec![Hole { centre: [0.0, 0.0], radius }],
        cracks: cracks.paths([0.0, 0.0], radius),
        thickness,
        ..Drawing::default()
    };
    let (from, to) = ([-half_width, -length], [half_width, -length]);
    Ok(Layout {
        drawing,
        loads: vec![pin(0, [0.0, 1.0], contact)],
        supports: vec![Support::Fixed { from, to, depth: 0.0, x: true, y: true }],
        crack_length: cracks.shared,
        formula: None,
    })
}
