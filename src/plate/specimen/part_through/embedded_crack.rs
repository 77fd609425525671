//! A whole ellipse in the middle of the thickness and width of a plate; t is half of the thickness.

use super::front::CrackFront;
use super::{CENTRAL, PartThroughSpec, PlateLetters};
use crate::specimen::SpecimenKind;

/// Newman and Raju 1984, embedded crack. They give no bending: the middle of the thickness has none.
pub(super) const KIND: PartThroughSpec = PartThroughSpec {
    kind: SpecimenKind::EmbeddedCrack,
    letters: PlateLetters { of_thickness: 0.5, of_width: 0.5 },
    share_of_ellipse: 1.0,
    has_hole: false,
    tension,
    bending: None,
    limits: CENTRAL,
};

/// `F = [M1 + M2 (a/t)² + M3 (a/t)⁴] g f_φ f_w`, M2 and M3 over a/c on both sides of 1.
fn tension(front: &CrackFront, angle: f64) -> f64 {
    let (x, s) = (front.aspect(), front.depth());
    let first = if x <= 1.0 { 1.0 } else { (1.0 / x).sqrt() };
    let power = x.powf(1.5);
    let m = [first, 0.05 / (0.11 + power), 0.29 / (0.23 + power)];
    let g = 1.0 - s.powi(4) * (2.6 - 2.0 * s).max(0.0).sqrt() / (1.0 + 4.0 * x) * angle.cos().abs();
    front.series(m) * g * front.around(angle) * front.width_of_central()
}
