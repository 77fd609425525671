//! Half of an ellipse on the face of a plate.

use super::front::CrackFront;
use super::{CENTRAL, PartThroughSpec, PlateLetters};
use crate::specimen::SpecimenKind;

/// Newman and Raju 1984, surface crack.
pub(super) const KIND: PartThroughSpec = PartThroughSpec {
    kind: SpecimenKind::SurfaceCrack,
    letters: PlateLetters { of_thickness: 1.0, of_width: 0.5 },
    share_of_ellipse: 0.5,
    has_hole: false,
    tension,
    bending: Some(bending),
    limits: CENTRAL,
};

/// `F = [M1 + M2 (a/t)² + M3 (a/t)⁴] g f_φ f_w`.
fn tension(front: &CrackFront, angle: f64) -> f64 {
    let [m, near_face] = series(front, angle);
    m * near_face * front.around(angle) * front.width_of_central()
}

/// The polynomial in a/t and `g`, which a corner crack at a hole has, too.
pub(super) fn series(front: &CrackFront, angle: f64) -> [f64; 2] {
    let (x, s) = (front.flatness(), front.depth());
    let (m, slope) = if front.aspect() <= 1.0 {
        ([1.13 - 0.09 * x, -0.54 + 0.89 / (0.2 + x), 0.5 - 1.0 / (0.65 + x) + 14.0 * (1.0 - x).powi(24)], 0.35)
    } else {
        ([x.sqrt() * (1.0 + 0.04 * x), 0.2 * x.powi(4), -0.11 * x.powi(4)], 0.35 * x)
    };
    [front.series(m), 1.0 + (0.1 + slope * s * s) * (1.0 - angle.sin()).powi(2)]
}

/// `H F`.
fn bending(front: &CrackFront, angle: f64) -> f64 {
    front.bending_of_faces(0.55, angle) * tension(front, angle)
}
