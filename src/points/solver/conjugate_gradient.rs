//! Conjugate gradients preconditioned by lattice multigrid.

use rayon::prelude::*;

use super::field::{Layout, dot, dots, lane_sum};
use super::multigrid::{Depth, Multigrid};
use super::product::{Into, Product};
use super::rigid_motion::RigidMotion;
use super::system::{LinearSolver, Solved, SolverUsed, System};
use crate::body::{Body, Bond};
use crate::state::Bonds;
use perilife_base::error::{Error, Result};
use perilife_base::watch::{self, Stage};

/// Residual over load at which a solve ends. Neither the preconditioner in single precision nor a window's starting values are
/// symmetric to the last digit, and mirror twins have to agree better than the tolerance within which bonds break together.
const TOLERANCE: f64 = 1e-11;
/// Iterations after which a solve has failed.
const ITERATIONS_MAX: usize = 400;
/// Work of the loads over that of the displacement a solve starts from at which the plate is a mechanism, and every how many
/// iterations that is asked.
const LOST_STIFFNESS: f64 = 1e3;
const ITERATIONS_PER_LOOK: usize = 20;
/// Iterations above those of a fresh hierarchy at which it is rebuilt.
const ITERATIONS_SLACK: usize = 3;
/// The same where solves are few: to build it takes as long as a dozen iterations.
const ITERATIONS_SLACK_FEW: usize = 12;
/// Broken bonds, in stencils, after which the hierarchy is rebuilt in any case, where solves are many.
const STENCILS_PER_REBUILD: usize = 12;

/// Multigrid-preconditioned conjugate gradients with the hierarchy kept between solves.
pub struct MultigridSolver<const N: usize> {
    multigrid: Multigrid<N>,
    fresh_iterations: Option<usize>,
    broken_since: usize,
    /// Ends of bonds that broke since the last solve.
    changed: Vec<usize>,
    stale: bool,
    /// Iterations above those of a fresh hierarchy at which it is rebuilt.
    slack: usize,
    /// Residual over load at which a solve ends.
    tolerance: f64,
    r: Vec<f64>,
    p: Vec<f64>,
    q: Vec<f64>,
}

impl<const N: usize> MultigridSolver<N> {
    /// Builds the hierarchy.
    pub fn new(body: &Body, bonds: &Bonds, product: &Product<N>) -> Self {
        let layout = product.layout();
        MultigridSolver {
            multigrid: Multigrid::new(body, bonds, product),
            fresh_iterations: None,
            broken_since: 0,
            changed: Vec::new(),
            stale: false,
            slack: ITERATIONS_SLACK,
            tolerance: TOLERANCE,
            r: layout.zeros(),
            p: layout.zeros(),
            q: layout.zeros(),
        }
    }

    /// The same for solves between which many bonds break.
    pub fn for_few_solves(body: &Body, bonds: &Bonds, product: &Product<N>) -> Self {
        MultigridSolver { slack: ITERATIONS_SLACK_FEW, ..MultigridSolver::new(body, bonds, product) }
    }

    /// Solves to a residual over load. A rough solve makes do with the hierarchy that is there.
    /// Errors: [`Error::LossOfStiffness`]; the iteration does not converge.
    pub(super) fn solve_to(&mut self, tolerance: f64, system: System<'_, N>, u: &mut [f64]) -> Result<Solved> {
        let System { body, bonds, product, f } = system;
        let is_rough = tolerance > self.tolerance;
        if self.stale && !is_rough {
            self.multigrid = Multigrid::new(body, bonds, product);
            self.changed.clear();
            self.stale = false;
            self.broken_since = 0;
            self.fresh_iterations = None;
        }
        if !self.changed.is_empty() {
            let mut changed = std::mem::take(&mut self.changed);
            changed.sort_unstable();
            changed.dedup();
            if self.slack == ITERATIONS_SLACK_FEW {
                self.multigrid.refresh_levels(body, bonds, product, &changed);
            } else {
                self.multigrid.refresh_points(body, bonds, product, &changed);
            }
        }
        let work_before = dot(product.layout(), f, u);
        let mut spent = self.iterate(tolerance, system, u, work_before)?;
        if spent.is_none() {
            // The hierarchy belongs to an older crack, or to a plate that is nearly a mechanism: once more with a new one, from rest.
            self.multigrid = Multigrid::new(body, bonds, product);
            self.multigrid.depth = Depth::Cautious;
            self.broken_since = 0;
            u.fill(0.0);
            spent = self.iterate(tolerance, system, u, work_before)?;
        }
        let spent = spent.ok_or_else(|| {
            Error::Mechanics(format!(
                "the equilibrium solver did not converge to {tolerance:e} within {ITERATIONS_MAX} iterations"
            ))
        })?;
        tracing::debug!(iterations = spent, broken_since_setup = self.broken_since, "equilibrium");
        let is_slow = !is_rough && {
            let fresh = *self.fresh_iterations.get_or_insert(spent);
            self.broken_since > 0 && spent > fresh + self.slack
        };
        let is_old = self.slack == ITERATIONS_SLACK && self.broken_since > STENCILS_PER_REBUILD * body.steps.len();
        self.stale = is_slow || is_old;
        Ok(Solved { iterations: spent, work: dot(product.layout(), f, u) })
    }

    /// Iterations to a residual over load; `None` where it is not reached. `work_before` is the work of the loads before bonds broke.
    fn iterate(&mut self, tolerance: f64, system: System<'_, N>, u: &mut [f64], work_before: f64) -> Result<Option<usize>> {
        let System { body, bonds, product, f } = system;
        let layout = *product.layout();
        let target = tolerance * dot(&layout, f, f).sqrt();
        self.r.copy_from_slice(f);
        product.apply(bonds, u, &mut self.r, Into::Subtract);
        if dot(&layout, &self.r, &self.r).sqrt() <= target {
            return Ok(Some(0));
        }
        let rigid = RigidMotion::of(body, bonds, layout);
        // r·z and the step of the last iteration.
        let mut last: Option<(f64, f64)> = None;
        for iteration in 1..=ITERATIONS_MAX {
            watch::at(Stage::Equilibrium, iteration as f64 / ITERATIONS_MAX as f64)?;
            let z = self.multigrid.precondition(bonds, product, &self.r);
            if let Some(rigid) = &rigid {
                rigid.take_off(z);
            }
            let [rz, qz] = dots(&layout, [&self.r, &self.q], z);
            // z·(r - r_last) / (r·z)_last, with r - r_last = -α q: a preconditioner in single precision is not the same linear
            // operator every time (Notay 2000, SIAM J. Sci. Comput. 22:1444).
            if !(rz > 0.0 && rz.is_finite()) {
                tracing::debug!(iteration, rz, "the preconditioner is not positive");
                return Ok(None);
            }
            let beta = last.map_or(0.0, |(rz_last, alpha)| -alpha * qz / rz_last);
            next_direction(&layout, &mut self.p, z, beta);
            product.apply(bonds, &mut self.p, &mut self.q, Into::Set);
            let curvature = dot(&layout, &self.p, &self.q);
            if !(curvature > 0.0 && curvature.is_finite()) {
                tracing::debug!(iteration, curvature, rz, "conjugate gradients broke down");
                return Ok(None);
            }
            let alpha = rz / curvature;
            last = Some((rz, alpha));
            if advance(&layout, alpha, [u, &mut self.r], [&self.p, &self.q]).sqrt() <= target {
                return Ok(Some(iteration));
            }
            if iteration % ITERATIONS_PER_LOOK == 0 && work_before > 0.0 {
                let work = dot(&layout, f, u);
                if work > LOST_STIFFNESS * work_before {
                    tracing::debug!(iteration, work, work_before, "the plate loses its stiffness");
                    return Err(Error::LossOfStiffness);
                }
            }
        }
        tracing::debug!(residual = dot(&layout, &self.r, &self.r).sqrt(), target, "conjugate gradients did not converge");
        Ok(None)
    }
}

/// p = z + β p.
fn next_direction(layout: &Layout, p: &mut [f64], z: &[f32], beta: f64) {
    let part = layout.part();
    p.par_chunks_mut(part).zip(z.par_chunks(part)).for_each(|(p, z)| {
        p.iter_mut().zip(z).for_each(|(p, &z)| *p = beta.mul_add(*p, z.into()));
    });
}

/// u += α p, r -= α q in one pass; r·r of the new r.
fn advance(layout: &Layout, alpha: f64, [u, r]: [&mut [f64]; 2], [p, q]: [&[f64]; 2]) -> f64 {
    let part = layout.part();
    let state = u.par_chunks_mut(part).zip(r.par_chunks_mut(part));
    let rows = state.zip(p.par_chunks(part).zip(q.par_chunks(part)));
    let squares: Vec<f64> = rows
        .map(|((u, r), (p, q))| {
            u.iter_mut().zip(p).for_each(|(u, p)| *u = alpha.mul_add(*p, *u));
            r.iter_mut().zip(q).for_each(|(r, q)| *r = (-alpha).mul_add(*q, *r));
            lane_sum(r, r)
        })
        .collect();
    squares.iter().sum()
}

impl<const N: usize> LinearSolver<N> for MultigridSolver<N> {
    fn used(&self) -> SolverUsed {
        SolverUsed::Multigrid
    }

    fn solve(&mut self, system: System<'_, N>, u: &mut [f64]) -> Result<Solved> {
        self.solve_to(self.tolerance, system, u)
    }

    fn set_tolerance(&mut self, tolerance: f64) {
        self.tolerance = tolerance;
    }

    fn broke(&mut self, body: &Body, _: &Bonds, _: &Product<N>, broken: &[Bond]) {
        let ends = |bond: Bond| [body.ends(bond).1, body.ends(bond).2].map(|place| body.behind(place).0);
        self.changed.extend(broken.iter().flat_map(|&bond| ends(bond)));
        self.broken_since += broken.len();
    }
}
