//! Derivatives of the displacement on the lattice by moving least squares.
//!
//! Around a point the displacement is fitted by a quadratic over the points it is bonded to: `u(ξ) = u + H ξ + ½ ξ·Q ξ`,
//! weights falling with the distance. Bonds that the crack cut take no part, so a gradient never looks across the crack;
//! the quadratic terms keep it second order on the crack faces, where the neighbours lie on one side only.

use nalgebra::{SMatrix, SVector};

use crate::body::Body;
use crate::solver::field::Layout;
use crate::state::Bonds;
use perilife_plate::specimen::Point;

/// Length, in spacings, over which weights fall to 1/e: near a tip the field bends so much that a wider quadratic reads K 0.4 % low
/// on a ring of two and a half horizons.
const REACH_SPACINGS: f64 = 0.9;
/// Unknowns of the quadratic: two of the gradient, three of the curvature.
const TERMS: usize = 5;

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

    /// A place of the plate in the frame.
    pub fn local(&self, point: Point) -> Point {
        self.vector([point[0] - self.origin[0], point[1] - self.origin[1]])
    }
}

/// Displacement of a place in a frame's axes, m.
fn displacement_at(body: &Body, layout: &Layout, displacement: &[f64], frame: &TipFrame, place: usize) -> Point {
    let at = layout.index(place);
    frame.vector(body.lattice.from_axes([displacement[at], displacement[at + layout.stride]]))
}

/// Derivatives of the displacement around a place, in a frame's axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Derivatives {
    /// `∂u_i/∂x_j` at the place.
    pub first: [[f64; 2]; 2],
    /// Of every `u_i` the derivatives over x₁ twice, over x₁ and x₂, over x₂ twice, 1/m.
    second: [[f64; 3]; 2],
}

impl Derivatives {
    /// `∂u_i/∂x_j` at a distance from the place, m.
    pub fn at(&self, [x, y]: Point) -> [[f64; 2]; 2] {
        [0, 1].map(|i| {
            let [xx, xy, yy] = self.second[i];
            [self.first[i][0] + xx * x + xy * y, self.first[i][1] + xy * x + yy * y]
        })
    }
}

/// Derivatives at a place in a frame's axes; `None` where too few bonds are left to tell.
pub fn derivatives_at(
    body: &Body,
    bonds: &Bonds,
    layout: &Layout,
    displacement: &[f64],
    frame: &TipFrame,
    place: usize,
) -> Option<Derivatives> {
    let (spacing, over_a_spacing) = (body.lattice.spacing, (-REACH_SPACINGS.powi(-2)).exp());
    let here = displacement_at(body, layout, displacement, frame, place);
    let mut normal = SMatrix::<f64, TERMS, TERMS>::zeros();
    let mut right = SMatrix::<f64, TERMS, 2>::zeros();
    for (k, sign, _, other) in bonds.at(body, place) {
        let bond = &body.stencil.bonds[k];
        // In spacings, so that the five columns are of one size.
        let [x, y] = frame.vector(body.lattice.from_axes([sign * f64::from(bond.dx), sign * f64::from(bond.dy)]));
        let weight = over_a_spacing.powi(bond.dx * bond.dx + bond.dy * bond.dy);
        let there = displacement_at(body, layout, displacement, frame, other);
        let basis = SVector::from([x, y, 0.5 * x * x, x * y, 0.5 * y * y]);
        let difference = SMatrix::<f64, 1, 2>::from([[there[0] - here[0]], [there[1] - here[1]]]);
        normal += weight * basis * basis.transpose();
        right += weight * basis * difference;
    }
    let fit = normal.cholesky()?.solve(&right) / spacing;
    let of = |row: usize| [fit[(row, 0)], fit[(row, 1)]];
    let [[ux, vx], [uy, vy], [uxx, vxx], [uxy, vxy], [uyy, vyy]] = [0, 1, 2, 3, 4].map(of);
    let second = [[uxx, uxy, uyy], [vxx, vxy, vyy]].map(|row| row.map(|value| value / spacing));
    let derivatives = Derivatives { first: [[ux, uy], [vx, vy]], second };
    derivatives.first.iter().flatten().chain(second.iter().flatten()).all(|value| value.is_finite()).then_some(derivatives)
}
