//! K u = f of a plate as solvers take it, and what is asked of them.

use super::product::Product;
use crate::body::{Body, Bond};
use crate::state::Bonds;
use perilife_plate::specimen::Point;

perilife_base::kinds! {
    /// Equilibrium solvers.
    pub enum SolverKind for "model.solver" {
        Window = "window": "exact updates of the plate condensed onto the points around the crack tips; multigrid for whole solves",
        Multigrid = "multigrid": "conjugate gradients on a matrix-free stencil, preconditioned by crack-aware lattice multigrid",
    }
}

perilife_base::kinds! {
    /// What solved a run, whatever `model.solver` asked for.
    pub enum SolverUsed for "solver of a run" {
        Window = "window": "updates of the plate condensed onto the points around the crack tips, multigrid for whole solves",
        Multigrid = "multigrid": "multigrid solves of the whole plate: no window was condensed",
        Direct = "direct": "sparse Cholesky factorisations of the whole plate",
    }
}

/// A crack tip around which bonds may break next.
#[derive(Debug, Clone, PartialEq)]
pub struct Focus {
    /// Position, m.
    pub position: Point,
    /// Unit vector of growth.
    pub direction: Point,
    /// Way behind it on which bonds may still break, oldest place first.
    pub wake: Vec<Point>,
    /// Distance from that way and its continuation within which the ends of fatigue bonds lie, m.
    pub reach: f64,
}

impl Focus {
    /// The way of the tip and its continuation straight ahead, as segments.
    pub(super) fn way(&self, ahead: f64) -> impl Iterator<Item = (Point, Point)> + '_ {
        let end = [0, 1].map(|i| self.position[i] + ahead * self.direction[i]);
        self.wake.windows(2).map(|step| (step[0], step[1])).chain(std::iter::once((self.position, end)))
    }
}

/// What a displacement is to be right for.
#[derive(Clone, Copy)]
pub(super) enum Sought<'a> {
    /// The bonds as they stand, at least on the window's points.
    Equilibrium,
    /// Further breaks: right at the ends of watched bonds, a window ready around tips.
    Ahead(&'a [Bond], &'a [Focus]),
    Everywhere,
}

/// What a solve took and gave.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Solved {
    /// Iterations; 0 of a factorisation.
    pub iterations: usize,
    /// Work of the load f·u, J.
    pub work: f64,
}

/// A body with its present bonds, and the residual over load at which an iteration ends.
#[derive(Clone, Copy)]
pub(super) struct Standing<'a> {
    pub body: &'a Body,
    pub bonds: &'a Bonds,
    pub tolerance: f64,
}

/// System of a linear solve: the plate and the load on free components (zero on held ones).
#[derive(Clone, Copy)]
pub(super) struct System<'a, const N: usize> {
    pub body: &'a Body,
    pub bonds: &'a Bonds,
    pub tolerance: f64,
    pub product: &'a Product<N>,
    pub f: &'a [f64],
}
