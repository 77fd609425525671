//! The frame of a crack tip.

use std::f64::consts::TAU;

use crate::specimen::Point;

/// Origin at the tip, x₁ ahead of it, x₂ a quarter turn counter-clockwise from x₁.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TipFrame {
    /// The tip, m.
    pub origin: Point,
    /// Unit vector x₁.
    pub ahead: Point,
    /// x₂ of the line that cut the bonds, m: points beyond it belong to the face on the side of x₂ > 0.
    pub line: f64,
}

impl TipFrame {
    /// A vector of the plate in the frame.
    #[must_use]
    pub fn vector(&self, v: Point) -> Point {
        let [c, s] = self.ahead;
        [v[0] * c + v[1] * s, v[1] * c - v[0] * s]
    }

    /// A vector of the frame in the plate.
    #[must_use]
    pub fn in_plate(&self, v: Point) -> Point {
        let [c, s] = self.ahead;
        [v[0] * c - v[1] * s, v[0] * s + v[1] * c]
    }

    /// A place of the plate in the frame.
    #[must_use]
    pub fn local(&self, point: Point) -> Point {
        self.vector([point[0] - self.origin[0], point[1] - self.origin[1]])
    }

    /// Distance from the tip and angle from x₁: the crack faces are at ±π, and a point between the line that cut the bonds
    /// and the middle of the gap keeps the angle of its own side, a trifle beyond π.
    #[must_use]
    pub fn polar(&self, point: Point) -> (f64, f64) {
        let [x, y] = self.local(point);
        let theta = y.atan2(x);
        let wrong_side = x < 0.0 && (y > self.line) != (y > 0.0);
        let turn = if !wrong_side {
            0.0
        } else if y > self.line {
            TAU
        } else {
            -TAU
        };
        (x.hypot(y), theta + turn)
    }
}
