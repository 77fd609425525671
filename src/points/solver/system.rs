//! K u = f of a plate as solvers take it: the kinds of solvers, what each has to supply, and what stands between them and the plate.

use super::product::Product;
use super::spring::GapSpring;
use crate::body::{Body, Bond};
use crate::state::Bonds;
use perilife_base::error::Result;
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

/// What a solve took and gave.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solved {
    /// Iterations; 0 for a direct solver.
    pub iterations: usize,
    /// Work of the load f·u, J.
    pub work: f64,
}

/// System of a linear solve: the plate with its bonds and the load on free components (zero on held ones).
#[derive(Clone, Copy)]
pub(super) struct System<'a, const N: usize> {
    pub body: &'a Body,
    pub bonds: &'a Bonds,
    pub product: &'a Product<N>,
    pub f: &'a [f64],
}

/// Solves `K u = f` on the free components of a body; what a new solver has to supply. A solver may leave u right on some
/// points only, if it says so.
pub(super) trait LinearSolver<const N: usize>: Send {
    /// Improves `u` until K u = f, at least on the window's points.
    fn solve(&mut self, system: System<'_, N>, u: &mut [f64]) -> Result<Solved>;
    /// Told which bonds broke since the last solve.
    fn broke(&mut self, body: &Body, bonds: &Bonds, product: &Product<N>, broken: &[Bond]);
    /// What has solved since it was built.
    fn used(&self) -> SolverUsed;
    /// Told to what residual over load to solve; the direct solver has one of its own.
    fn set_tolerance(&mut self, _: f64) {}
    /// Makes `u` right at the ends of `watched` bonds, and gets ready for breaks around the tips; what a solve of the whole plate
    /// took and gave if that needed one.
    fn reach(&mut self, _: System<'_, N>, _u: &mut [f64], _watched: &[Bond], _tips: &[Focus]) -> Result<Option<Solved>> {
        Ok(None)
    }
    /// Makes `u` right everywhere; what a solve took and gave if that needed one.
    fn complete(&mut self, _: System<'_, N>, _u: &mut [f64]) -> Result<Option<Solved>> {
        Ok(None)
    }
    /// `u` everywhere, as right as pictures need it, and the iterations; `None` where `u` itself is. Nothing else changes.
    fn picture(&mut self, _: System<'_, N>, _u: &[f64]) -> Result<Option<(Vec<f64>, usize)>> {
        Ok(None)
    }
    /// Whether to begin anew costs little now, `solves` solves after the last beginning.
    fn is_due(&self, _body: &Body, _watched: &[Bond], solves: usize) -> bool {
        solves >= SOLVES_MOST
    }
    /// Whether `u` is right everywhere.
    fn is_whole(&self) -> bool {
        true
    }
    /// Points, ascending, on which `u` is always right; `None` if that is all of them.
    fn window(&self) -> Option<&[u32]> {
        None
    }
}

/// Solves of the whole plate after which a solver begins anew. That takes three to four of them: a solve from rest, and where
/// there is one a new hierarchy.
pub(super) const SOLVES_MOST: usize = 128;

/// Both sides of the system, with the number of unknowns and mirror images hidden.
pub(super) trait EquilibriumBackend: Send {
    fn set_tolerance(&mut self, tolerance: f64);
    fn solve(&mut self, body: &Body, bonds: &Bonds, displacement: &mut Vec<f64>) -> Result<usize>;
    fn broke(&mut self, body: &Body, bonds: &Bonds, broken: &[Bond]);
    fn work(&self) -> f64;
    fn set_contact(&mut self, body: &Body, share: f64, contact: &[GapSpring]);
    fn reach(&mut self, body: &Body, bonds: &Bonds, ahead: (&[Bond], &[Focus]), displacement: &mut Vec<f64>) -> Result<usize>;
    fn is_due(&self, body: &Body, watched: &[Bond], solves: usize) -> bool;
    fn complete(&mut self, body: &Body, bonds: &Bonds, displacement: &mut Vec<f64>) -> Result<usize>;
    fn picture(&mut self, body: &Body, bonds: &Bonds) -> Result<(Vec<f64>, usize)>;
    fn is_whole(&self) -> bool;
    fn window(&self) -> Option<&[u32]>;
    fn points(&self, body: &Body) -> usize;
    fn used(&self) -> SolverUsed;
}
