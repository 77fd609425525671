//! Conjugate gradients preconditioned by lattice multigrid.

use rayon::prelude::*;

use super::field::{Layout, dot, dots, lane_sum};
use super::multigrid::fine::Fine;
use super::multigrid::{Depth, Multigrid};
use super::product::{Into, Product};
use super::rigid_motion::RigidMotion;
use super::system::{Solved, System};
use crate::body::{Body, Bond};
use crate::state::Bonds;
use perilife_base::error::{Error, Result};
use perilife_base::watch::{self, Stage};

/// Residual over load at which a solve ends where bonds break one by one. Neither the preconditioner in single precision nor a window's
/// starting values are symmetric to the last digit, and mirror twins have to agree better than the tolerance within which bonds break together.
pub(super) const TOLERANCE: f64 = 1e-11;
/// Iterations after which a solve has failed.
const ITERATIONS_MAX: usize = 400;
/// Work of the loads over that of the displacement a solve starts from at which the plate is a mechanism, and every how many
/// iterations that is asked.
const LOST_STIFFNESS: f64 = 1e3;
const ITERATIONS_PER_LOOK: usize = 20;

/// Multigrid-preconditioned conjugate gradients. The hierarchy is kept between solves and takes in what changes: one built anew needs as many
/// iterations.
pub struct MultigridSolver<const N: usize> {
    multigrid: Multigrid<N>,
    /// Ends of bonds that changed since the hierarchy took them in.
    changed: Vec<usize>,
    r: Vec<f64>,
    p: Vec<f64>,
    q: Vec<f64>,
}

impl<const N: usize> MultigridSolver<N> {
    /// Builds the hierarchy.
    pub fn new(body: &Body, bonds: &Bonds, product: &Product<N>) -> Self {
        let zeros = || product.layout().zeros();
        let multigrid = Multigrid::new(&Fine { body, bonds, product });
        let (r, p, q) = (zeros(), zeros(), zeros());
        MultigridSolver { multigrid, changed: Vec::new(), r, p, q }
    }

    /// Told which bonds changed since the last solve.
    pub fn broke(&mut self, body: &Body, broken: &[Bond]) {
        for &bond in broken {
            self.changed.extend([body.ends(bond).1, body.ends(bond).2].map(|place| body.behind(place).0));
        }
    }

    /// Solves to a residual over load.
    /// Errors: [`Error::LossOfStiffness`]; the iteration does not converge.
    pub(super) fn solve(&mut self, system: System<'_, N>, u: &mut [f64]) -> Result<Solved> {
        let System { body, bonds, tolerance, product, f } = system;
        if !self.changed.is_empty() {
            let mut changed = std::mem::take(&mut self.changed);
            changed.sort_unstable();
            changed.dedup();
            self.multigrid.refresh(&Fine { body, bonds, product }, &changed);
        }
        let work_before = dot(product.layout(), f, u);
        let mut spent = self.iterate(system, u, work_before)?;
        if spent.is_none() {
            // The plate is nearly a mechanism, or its spectrum is no longer that of the smoothers: once more with new ones, from rest.
            self.multigrid = Multigrid::new(&Fine { body, bonds, product });
            self.multigrid.depth = Depth::Cautious;
            u.fill(0.0);
            spent = self.iterate(system, u, work_before)?;
        }
        let iterations = spent.ok_or_else(|| {
            Error::Mechanics(format!(
                "the equilibrium solver did not converge to {tolerance:e} within {ITERATIONS_MAX} iterations"
            ))
        })?;
        tracing::debug!(iterations, "equilibrium");
        Ok(Solved { iterations, work: dot(product.layout(), f, u) })
    }

    /// Iterations to a residual over load; `None` where it is not reached. `work_before` is the work of the loads before bonds broke.
    fn iterate(&mut self, system: System<'_, N>, u: &mut [f64], work_before: f64) -> Result<Option<usize>> {
        let System { body, bonds, tolerance, product, f } = system;
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
            let z = self.multigrid.precondition(&Fine { body, bonds, product }, &self.r);
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
            if iteration % ITERATIONS_PER_LOOK == 0 {
                let work = dot(&layout, f, u);
                if is_mechanism(work, work_before) {
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
        p.iter_mut().zip(z).for_each(|(p, &z)| *p = beta * *p + f64::from(z));
    });
}

/// u += α p, r -= α q in one pass; r·r of the new r.
fn advance(layout: &Layout, alpha: f64, [u, r]: [&mut [f64]; 2], [p, q]: [&[f64]; 2]) -> f64 {
    let part = layout.part();
    let state = u.par_chunks_mut(part).zip(r.par_chunks_mut(part));
    let rows = state.zip(p.par_chunks(part).zip(q.par_chunks(part)));
    let squares: Vec<f64> = rows
        .map(|((u, r), (p, q))| {
            u.iter_mut().zip(p).for_each(|(u, p)| *u += alpha * p);
            r.iter_mut().zip(q).for_each(|(r, q)| *r -= alpha * q);
            lane_sum(r, r)
        })
        .collect();
    squares.iter().sum()
}

/// Whether a plate is a mechanism by the work of its loads, which was another before bonds broke (0: not known).
pub(super) fn is_mechanism(work: f64, before: f64) -> bool {
    before > 0.0 && work > LOST_STIFFNESS * before
}
