//! Parts of an ellipse in a plate without a hole: half of one on a face, a quarter on an edge, a whole one in the middle of thickness and
//! width (t is half of the thickness there).

use super::front::CrackFront;
use super::{CENTRAL, Limit, PartThroughSpec, PlateLetters, SHAPE};
use crate::specimen::SpecimenKind;

/// Newman and Raju 1984, surface crack.
pub(super) const SURFACE: PartThroughSpec = PartThroughSpec {
    kind: SpecimenKind::SurfaceCrack,
    letters: PlateLetters { of_thickness: 1.0, of_width: 0.5 },
    share_of_ellipse: 0.5,
    has_hole: false,
    tension: of_surface,
    bending: Some(|front, angle| front.bending_of_faces(0.55, angle) * of_surface(front, angle)),
    limits: CENTRAL,
};

/// Newman and Raju 1984, corner crack.
pub(super) const CORNER: PartThroughSpec = PartThroughSpec {
    kind: SpecimenKind::CornerCrack,
    letters: PlateLetters { of_thickness: 1.0, of_width: 1.0 },
    share_of_ellipse: 0.25,
    tension: of_corner,
    bending: Some(|front, angle| front.bending_of_faces(0.64, angle) * of_corner(front, angle)),
    limits: &[SHAPE[0], SHAPE[1], Limit { name: "c/width", of: |front| front.c / front.b, low: 0.0, high: 0.5 }],
    ..SURFACE
};

/// Newman and Raju 1984, embedded crack. They give no bending: the middle of the thickness has none.
pub(super) const EMBEDDED: PartThroughSpec = PartThroughSpec {
    kind: SpecimenKind::EmbeddedCrack,
    letters: PlateLetters { of_thickness: 0.5, of_width: 0.5 },
    share_of_ellipse: 1.0,
    tension: of_embedded,
    bending: None,
    ..SURFACE
};

/// `F = [M1 + M2 (a/t)² + M3 (a/t)⁴] g f_φ f_w`.
fn of_surface(front: &CrackFront, angle: f64) -> f64 {
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

/// `F = [M1 + M2 (a/t)² + M3 (a/t)⁴] g1 g2 f_φ f_w` with the correction of an edge crack for the width of its plate,
/// `f_w = 1 - 0.2 λ + ...` with λ = c/b at a/t = 1 (Gross and Srawley's polynomial 1.12 - 0.231 λ + 10.55 λ² - ... over 1.12): b is the
/// whole width.
fn of_corner(front: &CrackFront, angle: f64) -> f64 {
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

/// `F = [M1 + M2 (a/t)² + M3 (a/t)⁴] g f_φ f_w`, M2 and M3 over a/c on both sides of 1.
fn of_embedded(front: &CrackFront, angle: f64) -> f64 {
    let (x, s) = (front.aspect(), front.depth());
    let first = if x <= 1.0 { 1.0 } else { (1.0 / x).sqrt() };
    let power = x.powf(1.5);
    let m = [first, 0.05 / (0.11 + power), 0.29 / (0.23 + power)];
    let g = 1.0 - s.powi(4) * (2.6 - 2.0 * s).max(0.0).sqrt() / (1.0 + 4.0 * x) * angle.cos().abs();
    front.series(m) * g * front.around(angle) * front.width_of_central()
}
