//! Equilibrium of springs at full load with the shares they have: conjugate gradients on the secant stiffness, preconditioned by
//! a Cholesky factor of an earlier one, warm start.
//!
//! A factor that is some bonds old costs few iterations more; it is renewed when those cost more than a new one. On a plate of
//! 11 000 points a factorisation costs as much as about `RENEW` iterations beyond those of a fresh factor.

use rayon::prelude::*;

use super::super::bonds::BondState;
use super::super::failure::Failure;
use super::super::interaction::{Damaging, Interaction};
use super::super::net::Net;
use super::super::springs::Springs;
use super::full_load::FullLoad;
use super::stiffness::Stiffness;
use crate::error::{Error, Result};

/// Residual over load at which a solve ends: damage of mirror twins shall agree to 1e-9.
const TOLERANCE: f64 = 1e-10;
/// Iterations from which the factor is renewed for the next solve.
const RENEW: usize = 12;
/// Iterations after which a solve has failed.
const ITERATIONS_MAX: usize = 300;

/// Solver with its factor.
pub struct Equilibrium<'n> {
    full: &'n FullLoad,
    springs: Springs<'n>,
    stiffness: Stiffness<'n>,
    stale: bool,
    /// Solves, iterations and factorisations so far.
    pub spent: Spent,
    vectors: [Vec<f64>; 4],
}

/// What solving has cost.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Spent {
    /// Solves.
    pub solves: usize,
    /// Iterations.
    pub iterations: usize,
    /// Factorisations.
    pub factorisations: usize,
}

/// Equilibrium at full load.
#[derive(Debug, Clone, PartialEq)]
pub struct Shape {
    /// Displacement, m.
    pub u: Vec<f64>,
    /// Forces of the bonds, N.
    pub force: Vec<f64>,
    /// Strain energy, J.
    pub strain: f64,
}

impl<'n> Equilibrium<'n> {
    /// A solver for a net with its loads.
    ///
    /// # Errors
    /// Out of memory.
    pub fn new(net: &'n Net, full: &'n FullLoad) -> Result<Self> {
        let size = full.held.len();
        Ok(Equilibrium {
            full,
            springs: Springs::new(net, Failure::Never, false),
            stiffness: Stiffness::new(net, &full.held)?,
            stale: true,
            spent: Spent::default(),
            vectors: [(); 4].map(|()| vec![0.0; size]),
        })
    }

    /// Moves `shape` to the equilibrium with these bonds.
    ///
    /// # Errors
    /// No convergence: nothing holds what the loads pull at.
    pub fn solve(&mut self, bonds: &mut BondState, shape: &mut Shape) -> Result<()> {
        for (i, u) in shape.u.iter_mut().enumerate().filter(|(i, _)| self.full.held[*i]) {
            *u = self.full.motion[i];
        }
        self.spent.solves += 1;
        let mut fresh = false;
        loop {
            if self.stale {
                self.stiffness.factorise(&bonds.share)?;
                self.spent.factorisations += 1;
                (self.stale, fresh) = (false, true);
            }
            if let Some(iterations) = self.iterate(bonds, shape) {
                self.stale = iterations > RENEW && !fresh;
                return Ok(());
            }
            if fresh {
                return Err(Error::Mechanics(format!(
                    "equilibrium was not found within {ITERATIONS_MAX} iterations: nothing holds what the loads pull at"
                )));
            }
            self.stale = true;
        }
    }

    /// Iterations to the tolerance, or `None` without it.
    fn iterate(&mut self, bonds: &mut BondState, shape: &mut Shape) -> Option<usize> {
        let [mut r, mut z, mut p, mut q] = std::mem::take(&mut self.vectors);
        p.fill(0.0);
        shape.strain = self.springs.react(&shape.u, bonds, Damaging::Frozen, &mut shape.force).strain;
        let residual = |force: &[f64], r: &mut [f64]| {
            for (i, r) in r.iter_mut().enumerate() {
                *r = if self.full.held[i] { 0.0 } else { force[i] + self.full.external[i] };
            }
        };
        residual(&shape.force, &mut r);
        let mut target = TOLERANCE * self.full.size(&shape.force);
        let (mut found, mut last) = (None, None);
        for iteration in 0..=ITERATIONS_MAX {
            let size = dot(&r, &r).sqrt();
            if size.is_nan() || size <= target {
                found = size.is_finite().then_some(iteration);
                break;
            }
            self.stiffness.solve(&r, &mut z);
            let rz = dot(&r, &z);
            let beta = last.map_or(0.0, |last: f64| rz / last);
            last = Some(rz);
            p.iter_mut().zip(&z).for_each(|(p, z)| *p = z + beta * *p);
            self.springs.react(&p, bonds, Damaging::Frozen, &mut q);
            // The force is -K p; held rows play no part.
            let curvature = -dot(&p, &q);
            if curvature.is_nan() || curvature <= 0.0 {
                break;
            }
            let step = rz / curvature;
            shape.u.iter_mut().zip(&p).for_each(|(u, p)| *u += step * p);
            shape.force.iter_mut().zip(&q).for_each(|(force, q)| *force += step * q);
            residual(&shape.force, &mut r);
            target = TOLERANCE * self.full.size(&shape.force);
            self.spent.iterations += 1;
        }
        if found.is_some_and(|iterations| iterations > 0) {
            shape.strain = self.springs.react(&shape.u, bonds, Damaging::Frozen, &mut shape.force).strain;
        }
        self.vectors = [r, z, p, q];
        found
    }
}

/// Scalar product, summed in parts so that it does not depend on the number of threads.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    const PART: usize = 1 << 14;
    let parts = a.par_chunks(PART).zip(b.par_chunks(PART));
    parts.map(|(a, b)| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>()).collect::<Vec<_>>().iter().sum()
}
