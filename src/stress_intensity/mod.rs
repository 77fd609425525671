//! Stress intensity factors K_I and K_II and the stress T of a crack tip in a plate of points and bonds in equilibrium, by an interaction
//! integral over a ring around it ([`ring`]).

mod crack_faces;
mod cut_cells;
mod gradient;
pub mod ring;

pub use gradient::{Derivatives, derivatives_at};

use crate::specimen::Point;

/// The frame of a crack tip: origin at the tip, x₁ ahead of it, x₂ a quarter turn counter-clockwise from x₁.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TipFrame {
    /// The tip, m.
    pub origin: Point,
    /// Unit vector x₁.
    pub ahead: Point,
}

impl TipFrame {
    /// A vector of the plate in the frame.
    pub fn vector(&self, v: Point) -> Point {
        let [c, s] = self.ahead;
        [v[0] * c + v[1] * s, v[1] * c - v[0] * s]
    }

    /// A vector of the frame in the plate.
    pub fn in_plate(&self, v: Point) -> Point {
        let [c, s] = self.ahead;
        [v[0] * c - v[1] * s, v[0] * s + v[1] * c]
    }

    /// A place of the plate in the frame.
    pub fn local(&self, point: Point) -> Point {
        self.vector([point[0] - self.origin[0], point[1] - self.origin[1]])
    }
}
