//! Equilibrium of springs on a net with the shares of their stiffness that they have: conjugate gradients on the secant
//! stiffness, preconditioned by a Cholesky factor of an earlier one, warm start.
//!
//! A factor that is some bonds old costs few iterations more; it is renewed when those cost more than a new one. On a plate of
//! 11 000 points a factorisation costs as much as about `RENEW` iterations beyond those of a fresh factor.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::stiffness::{LinearSpring, Stiffness};
use perilife_base::error::{Error, Result};
use perilife_points::net::Net;
use perilife_points::net::rigid::minimal_constraints;

/// Iterations from which the factor is renewed for the next solve.
const RENEW: usize = 12;
/// Iterations after which a solve has failed.
const ITERATIONS_MAX: usize = 300;
/// Force at a pin over the load from which loads count as out of balance.
const IMBALANCE: f64 = 1e-6;

/// What holds and pushes the points at full load, unknown by unknown ([`Net::unknowns`] a point).
#[derive(Debug, Clone, PartialEq)]
pub struct FullLoad {
    pub held: Vec<bool>,
    /// Where held unknowns go, m; 0 elsewhere.
    pub motion: Vec<f64>,
    /// Forces on the other unknowns, N; 0 on held ones but pins, which carry nothing beside.
    pub external: Vec<f64>,
    /// Unknowns held only because the plate would float; they must carry no load.
    pub pins: Vec<usize>,
}

impl FullLoad {
    /// Nothing holds, nothing pushes.
    pub fn none(net: &Net) -> Self {
        let size = net.len() * net.unknowns;
        FullLoad { held: vec![false; size], motion: vec![0.0; size], external: vec![0.0; size], pins: Vec::new() }
    }

    /// Holds what floats, at pins.
    pub fn pin(&mut self, net: &Net) {
        self.pins = minimal_constraints(net, &self.held);
        self.pins.iter().for_each(|&at| self.held[at] = true);
    }

    /// Square root of the sum of squares of the forces on the plate, N, when its bonds pull with `force`.
    pub fn size(&self, force: &[f64]) -> f64 {
        let squares = self.held.iter().zip(force).zip(&self.external);
        squares.map(|((&held, force), external)| if held { force * force } else { external * external }).sum::<f64>().sqrt()
    }

    /// Refuses loads that a floating plate cannot balance.
    /// Errors: a force at a pin.
    pub fn check_balance(&self, net: &Net, force: &[f64]) -> Result<()> {
        let load = self.size(force);
        let Some(&at) = self.pins.iter().find(|&&at| (force[at] + self.external[at]).abs() > IMBALANCE * load) else {
            return Ok(());
        };
        Err(Error::Mechanics(format!(
            "no supports, and the loads do not balance: {:.3e} N along {} at ({:.3}, {:.3}) mm; add [supports] or balance the \
             loads",
            (force[at] + self.external[at]).abs(),
            ["x", "y"][at % net.unknowns],
            net.positions[at / net.unknowns][0] * 1e3,
            net.positions[at / net.unknowns][1] * 1e3,
        )))
    }
}

/// Springs that the iteration works on.
pub trait InternalForce {
    /// Share of its stiffness that every bond has.
    fn share(&self) -> &[f64];
    /// What the factor has to stand for beside the bonds.
    fn struts(&self) -> &[LinearSpring] {
        &[]
    }
    /// Forces of the bonds on the points at a displacement, N, and the strain energy, J.
    fn internal_force(&mut self, u: &[f64], force: &mut [f64]) -> f64;
}

/// Solver with its factor.
pub struct Equilibrium {
    stiffness: Stiffness,
    stale: bool,
    /// Solves, iterations and factorisations so far.
    pub spent: Spent,
    vectors: [Vec<f64>; 4],
}

/// What solving has cost.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Spent {
    pub solves: usize,
    pub iterations: usize,
    pub factorisations: usize,
}

/// Equilibrium at full load.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Shape {
    /// Displacement, m.
    pub u: Vec<f64>,
    /// Forces of the bonds, N.
    pub force: Vec<f64>,
    /// Strain energy, J.
    pub strain: f64,
}

impl Shape {
    pub fn at_rest(size: usize) -> Self {
        Shape { u: vec![0.0; size], force: vec![0.0; size], strain: 0.0 }
    }
}

impl Equilibrium {
    pub fn new(net: &Net, full: &FullLoad) -> Result<Self> {
        let size = full.held.len();
        Ok(Equilibrium {
            stiffness: Stiffness::new(net, &full.held)?,
            stale: true,
            spent: Spent::default(),
            vectors: [(); 4].map(|()| vec![0.0; size]),
        })
    }

    /// Has the next solve find a factor of its own.
    pub fn renew(&mut self) {
        self.stale = true;
    }

    /// Moves `shape` to the equilibrium of these springs, to a residual of `tolerance` times the load; returns the iterations.
    /// Errors: no convergence: nothing holds what the loads pull at.
    pub fn solve(
        &mut self,
        net: &Net,
        full: &FullLoad,
        springs: &mut dyn InternalForce,
        shape: &mut Shape,
        tolerance: f64,
    ) -> Result<usize> {
        for (i, u) in shape.u.iter_mut().enumerate().filter(|(i, _)| full.held[*i]) {
            *u = full.motion[i];
        }
        self.spent.solves += 1;
        let mut fresh = false;
        loop {
            if self.stale {
                self.stiffness.factorise(net, springs.share(), springs.struts())?;
                self.spent.factorisations += 1;
                (self.stale, fresh) = (false, true);
            }
            if let Some(iterations) = self.iterate(full, springs, shape, tolerance) {
                self.stale = iterations > RENEW && !fresh;
                return Ok(iterations);
            }
            if fresh {
                return Err(Error::Mechanics(format!(
                    "no equilibrium within {ITERATIONS_MAX} iterations: the loaded part has no support"
                )));
            }
            self.stale = true;
        }
    }

    /// Iterations to the tolerance, or `None` without it.
    fn iterate(&mut self, full: &FullLoad, springs: &mut dyn InternalForce, shape: &mut Shape, tolerance: f64) -> Option<usize> {
        let [mut r, mut z, mut p, mut q] = std::mem::take(&mut self.vectors);
        p.fill(0.0);
        shape.strain = springs.internal_force(&shape.u, &mut shape.force);
        let residual = |force: &[f64], r: &mut [f64]| {
            for (i, r) in r.iter_mut().enumerate() {
                *r = if full.held[i] { 0.0 } else { force[i] + full.external[i] };
            }
        };
        residual(&shape.force, &mut r);
        let mut target = tolerance * full.size(&shape.force);
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
            springs.internal_force(&p, &mut q);
            // The force is -K p; held rows play no part.
            let curvature = -dot(&p, &q);
            if curvature.is_nan() || curvature <= 0.0 {
                break;
            }
            let step = rz / curvature;
            shape.u.iter_mut().zip(&p).for_each(|(u, p)| *u += step * p);
            shape.force.iter_mut().zip(&q).for_each(|(force, q)| *force += step * q);
            residual(&shape.force, &mut r);
            target = tolerance * full.size(&shape.force);
            self.spent.iterations += 1;
        }
        if found.is_some_and(|iterations| iterations > 0) {
            shape.strain = springs.internal_force(&shape.u, &mut shape.force);
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
