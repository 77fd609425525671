//! A quarter of an ellipse on an edge of a plate.
//!
//! Its `f_w` is the correction of an edge crack for the width of its plate, `1 - 0.2 λ + ...` with λ = c/b at a/t = 1 (Gross and Srawley's
//! polynomial 1.12 - 0.231 λ + 10.55 λ² - ... over 1.12): b is the whole width.

use super::front::CrackFront;
use super::{Limit, PartThroughSpec, PlateLetters, SHAPE};
use crate::specimen::SpecimenKind;

/// Newman and Raju 1984, corner crack.
pub(super) const KIND: PartThroughSpec = PartThroughSpec {
    kind: SpecimenKind::CornerCrack,
    letters: PlateLetters { of_thickness: 1.0, of_width: 1.0 },
    share_of_ellipse: 0.25,
    has_hole: false,
    tension,
    bending: Some(bending),
    limits: &[SHAPE[0], SHAPE[1], Limit { name: "c/width", of: |front| front.c / front.b, low: 0.0, high: 0.5 }],
};

/// `F = [M1 + M2 (a/t)² + M3 (a/t)⁴] g1 g2 f_φ f_w`.
fn tension(front: &CrackFront, angle: f64) -> f64 {
    let (x, s) = (front.flatness(), front.depth());
    let (m, depth) = if front.aspect() <= 1.0 {
        ([1.08 - 0.03 * x, -0.44 + 1.06 / (0.3 + x), -0.5 + 0.25 * x + 14.8 * (1.0 - x).powi(15)], s)
    } else {
        ([x.sqrt() * (1.08 - 0.03 * x), 0.375 * x * x, -0.25 * x * x], front.c / front.t)
    };
    let g1 = 1.0 + (0.08 + 0.4 * depth * depth) * (1.0 - angle.sin()).powi(3);
    let g2 = 1.0 + (0.08 + 0.15 * depth * depth) * (1.0 - angle.cos()).powi(3);
    let l = front.c / front.b * s.sqrt();
    let width = 1.0 + l * (-0.2 + l * (9.4 + l * (-19.4 + l * 27.1)));
    front.series(m) * g1 * g2 * front.around(angle) * width
}

/// `H F`.
fn bending(front: &CrackFront, angle: f64) -> f64 {
    front.bending_of_faces(0.64, angle) * tension(front, angle)
}
