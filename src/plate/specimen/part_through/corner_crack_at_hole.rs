//! A quarter of an ellipse on the edge of a round hole in the middle of a plate, on one side of it or on both.

use std::f64::consts::PI;

use super::front::{CrackFront, secant};
use super::plain::series;
use super::{Limit, PartThroughSpec, PlateLetters, SHAPE};
use crate::specimen::SpecimenKind;

/// Newman and Raju 1984, corner crack at a hole.
pub(super) const KIND: PartThroughSpec = PartThroughSpec {
    kind: SpecimenKind::CornerCrackAtHole,
    letters: PlateLetters { of_thickness: 1.0, of_width: 0.5 },
    share_of_ellipse: 0.25,
    has_hole: true,
    tension,
    bending: Some(bending),
    limits: &[
        SHAPE[0],
        SHAPE[1],
        Limit { name: "(radius + c)/half width", of: |front| (front.r + front.c) / front.b, low: 0.0, high: 0.5 },
        Limit { name: "radius/thickness", of: |front| front.r / front.t, low: 0.5, high: 2.0 },
    ],
};

/// Share μ of φ that the stress beside the hole is taken at.
const TURN: f64 = 0.85;

fn tension(front: &CrackFront, angle: f64) -> f64 {
    shared(front, angle, TURN)
}

/// `F = [M1 + M2 (a/t)² + M3 (a/t)⁴] g1 g2 g3 g4 f_φ f_w`, with the stress of the hole at c cos(μ φ) from its edge in g2; of a single crack
/// times the factor of Shah (1976, ASTM STP 590), `√[(4/π + a c/(2 t R))/(4/π + a c/(t R))]`.
fn shared(front: &CrackFront, angle: f64, turn: f64) -> f64 {
    let [m, g1] = series(front, angle);
    let (x, s) = (front.flatness(), front.depth());
    let l = 1.0 / (1.0 + front.c / front.r * (turn * angle).cos());
    let g2 = (1.0 + l * (0.358 + l * (1.425 + l * (-1.578 + l * 2.156)))) / (1.0 + 0.13 * l * l);
    let (of_shape, g4) = if front.aspect() <= 1.0 {
        (1.0 + 0.04 * x, 1.0 - 0.7 * (1.0 - s) * (x - 0.2) * (1.0 - x))
    } else {
        (1.13 - 0.09 * x, 1.0)
    };
    let g3 = of_shape * (1.0 + 0.1 * (1.0 - angle.cos()).powi(2)) * (0.85 + 0.15 * s.sqrt().sqrt());
    m * g1 * g2 * g3 * g4 * front.around(angle) * width(front) * single(front)
}

/// `f_w = √[sec(π R/(2b)) sec(π (2R + n c)/(4 (b - c) + 2 n c) √(a/t))]`.
fn width(&CrackFront { a, c, t, b, r, n }: &CrackFront) -> f64 {
    let crack = PI * (2.0 * r + n * c) / (4.0 * (b - c) + 2.0 * n * c) * (a / t).sqrt();
    (secant(PI * r / (2.0 * b)) * secant(crack)).sqrt()
}

fn single(&CrackFront { a, c, t, r, n, .. }: &CrackFront) -> f64 {
    let area = a * c / (t * r);
    if n > 1.0 { 1.0 } else { ((4.0 / PI + 0.5 * area) / (4.0 / PI + area)).sqrt() }
}

/// `H F`, g2 of F at another angle than under tension: μ = 0.85 - 0.25 (a/t)^¼.
fn bending(front: &CrackFront, angle: f64) -> f64 {
    let (x, s) = (front.flatness(), front.depth());
    let (h, p) = if front.aspect() <= 1.0 {
        let first = [-0.43 - x * (0.74 + 0.84 * x), 1.25 + x * (-1.19 + 4.39 * x), -1.94 + x * (4.22 - 5.51 * x)];
        let second = [-1.5 - x * (0.04 + 1.73 * x), 1.71 + x * (-3.17 + 6.84 * x), -1.28 + x * (2.71 - 5.22 * x)];
        ([first, second], 0.1 + 1.3 * s + 1.1 * x - 0.7 * x * s)
    } else {
        let first = [-2.07 + 0.06 * x, 4.35 + 0.16 * x, -2.93 - 0.3 * x];
        let second = [-3.64 + 0.37 * x, 5.87 - 0.49 * x, -4.32 + 0.53 * x];
        ([first, second], 0.2 + x + 0.6 * s)
    };
    let h = h.map(|[linear, square, cube]| 1.0 + s * (linear + s * (square + s * cube)));
    CrackFront::bent(h, p, angle) * shared(front, angle, TURN - 0.25 * s.sqrt().sqrt())
}
