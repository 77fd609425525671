//! A lug: the pin pulls along y at the hole about the origin, the other end is held.
//!
//! A straight head ends `edge_distance_mm` beyond the centre of the hole (half the width where it is left out), a round one is half a circle of
//! the width about it. `length_mm` reaches from the centre to the held end. Where the pin touches is said by `pin_diameter_mm` (elastic contact) or
//! `pin_half_angle_deg`, as of a compact specimen.

use std::f64::consts::PI;

use super::shapes::{AtHole, AtHoleKeys, arc, below, pin};
use super::{Layout, SpecimenSpec};
use crate::specimen::keys::{HOLE_DIAMETER, LENGTH, THICKNESS, WIDTH};
use crate::specimen::pin::PinKeys;
use crate::specimen::plate::Drawing;
use crate::specimen::{Bearing, Head, Hole, Point, SpecimenKind, Support};
use perilife_base::error::Result;
use perilife_base::keys::{Given, Section, key, length, part};

pub(super) const KIND: SpecimenSpec = SpecimenSpec { kind: SpecimenKind::Lug, keys: Keys::KEYS, layout };

perilife_base::keys! {
    struct Keys {
        width: f64 = WIDTH;
        length: f64 = LENGTH.said("Length L: from the hole center to the clamped end");
        thickness: f64 = THICKNESS;
        diameter: f64 = HOLE_DIAMETER;
        head: Head = key("head", "Head: end beyond the hole");
        distance: Option<f64> = length("edge_distance_mm", "Edge distance: of a straight head, from the hole center; default W/2");
        cracks: AtHoleKeys = part();
        pin: PinKeys = part();
    }
}

fn layout(given: &Given<'_>) -> Result<Layout> {
    let Keys { width, length, thickness, diameter, head, distance, cracks, pin: pin_keys } = Keys::read(given)?;
    let (half_width, radius) = (width / 2.0, diameter / 2.0);
    let cracks = AtHole::read(given, &cracks)?;
    below("hole_diameter_mm", 2.0 * radius, (2.0 * half_width).min(2.0 * length), "width and twice the length")?;
    let key = if cracks.shared.is_some() { "crack_length_mm" } else { "crack_lengths_mm" };
    below(key, cracks.lengths[0].max(cracks.lengths[1]), half_width - radius, "the distance from the hole edge to the side")?;
    let contact = Bearing::read(given, ["pin_half_angle_deg", "pin_friction"], &pin_keys, radius)?;
    let mut outline: Vec<Point> = vec![[-half_width, -length], [half_width, -length]];
    match (head, distance) {
        (Head::Straight, distance) => {
            let top = distance.unwrap_or(half_width);
            below("hole_diameter_mm", 2.0 * radius, 2.0 * top, "twice the edge distance")?;
            outline.extend([[half_width, top], [-half_width, top]]);
        }
        (Head::Round, None) => outline.extend(arc([0.0, 0.0], half_width, [0.0, PI])),
        (Head::Round, Some(_)) => {
            let problem = "conflicts with head = \"round\", whose edge distance is W/2";
            return Err(given.refuse("edge_distance_mm", problem, "remove it, or use head = \"straight\""));
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
