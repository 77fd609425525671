//! Equilibrium of springs on a net with the shares of their stiffness that they have: conjugate gradients on the secant
//! stiffness, preconditioned by a Cholesky factor of an earlier one, warm start.
//!
//! A factor that is some bonds old costs few iterations more; it is renewed when those cost more than a new one. On a plate of
//! 11 000 points a factorisation costs as much as about `RENEW` iterations beyond those of a fresh factor.
//! The springs keep the damage they have; flanks that are pressed together are held by the columns of [`NetContact`].

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::super::bonds::BondState;
use super::super::boundary::{Boundary, Motion};
use super::super::contact::{NetContact, Touching};
use super::super::failure::Failure;
use super::super::interaction::{Damaging, Interaction};
use super::super::springs::Springs;
use super::stiffness::Stiffness;
use perilife_base::error::{Error, Result, fail_if, input};
use perilife_plate::specimen::Crack;
use perilife_points::net::Net;
use perilife_points::net::rigid::minimal_constraints;

/// Residual over load at which a solve ends: damage of mirror twins shall agree to 1e-9.
const TOLERANCE: f64 = 1e-10;
/// Times that contact is looked at after which the last set of pressed columns stays: what flickers then carries next to nothing.
const LOOKS: usize = 20;
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
    /// Loads and supports of a boundary.
    /// Errors: a prescribed velocity: there is no time.
    pub fn of(net: &Net, boundary: &Boundary) -> Result<Self> {
        let mut full = FullLoad::none(net);
        for held in &boundary.held {
            let Motion::Displacement(value) = held.motion else {
                let remedy = "give loading.duration_s, or kind = \"displacement\" with displacement_mm";
                return Err(input("loading.kind", "\"velocity\"", "requires time", remedy));
            };
            let at = held.point as usize * net.unknowns + held.component;
            (full.held[at], full.motion[at]) = (true, value);
        }
        for &(point, force) in &boundary.forces {
            for (component, force) in force.into_iter().enumerate() {
                let at = point as usize * net.unknowns + component;
                full.external[at] += if full.held[at] { 0.0 } else { force };
            }
        }
        full.pin(net);
        Ok(full)
    }

    /// Lets the plate float after all: something that is not among these loads holds it.
    pub fn release(&mut self) {
        std::mem::take(&mut self.pins).into_iter().for_each(|at| self.held[at] = false);
    }

    /// Work that the held unknowns would do on the way to full load against these forces of the bonds, and work of the given
    /// forces over this displacement, J.
    pub fn works(&self, u: &[f64], force: &[f64]) -> [f64; 2] {
        let driven: f64 = self.motion.iter().zip(force).map(|(motion, force)| -motion * force).sum();
        let pushed: f64 = self.external.iter().zip(u).map(|(force, u)| force * u).sum();
        [driven, pushed]
    }

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

/// What solving has cost.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Spent {
    pub solves: usize,
    pub iterations: usize,
    pub factorisations: usize,
}

/// Equilibrium at full load.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
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

/// Solver for a net with its loads, and its factor.
pub struct Equilibrium<'n> {
    net: &'n Net,
    full: &'n FullLoad,
    springs: Springs<'n>,
    contact: NetContact<'n>,
    stiffness: Stiffness,
    is_stale: bool,
    /// Solves, iterations and factorisations so far.
    spent: Spent,
    vectors: [Vec<f64>; 4],
}

/// What a solver keeps where it is renewed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Kept {
    pressed: Option<Vec<u32>>,
    spent: Spent,
}

impl<'n> Equilibrium<'n> {
    /// A solver for a net with its loads, whose flanks touch across these cracks and those that grow from them.
    pub fn new(net: &'n Net, cracks: &[Crack], full: &'n FullLoad) -> Result<Self> {
        Ok(Equilibrium {
            net,
            full,
            springs: Springs::new(net, Failure::Never, false),
            contact: NetContact::new(net, cracks),
            stiffness: Stiffness::new(net, &full.held)?,
            is_stale: true,
            spent: Spent::default(),
            vectors: [(); 4].map(|()| vec![0.0; full.held.len()]),
        })
    }

    /// What solving has cost so far.
    pub fn spent(&self) -> Spent {
        self.spent
    }

    /// What it keeps where it is renewed.
    pub fn kept(&self) -> Kept {
        Kept { pressed: self.contact.pressed(), spent: self.spent }
    }

    /// Begins anew from these bonds and what a solver kept: what follows depends on both alone.
    pub fn renew(&mut self, kept: &Kept, bonds: &BondState) {
        self.contact.renew(kept.pressed.as_deref(), bonds);
        (self.spent, self.is_stale) = (kept.spent, true);
    }

    /// How its flanks stand at the last equilibrium.
    pub fn touching(&self) -> Touching {
        self.contact.touching()
    }

    /// Moves `shape` to the equilibrium with these bonds.
    /// Errors: no convergence: nothing holds what the loads pull at, nor does contact.
    pub fn solve(&mut self, bonds: &mut BondState, shape: &mut Shape) -> Result<()> {
        let mut has_pressed_all = false;
        for _ in 0..LOOKS {
            let before = shape.clone();
            if let Err(error) = self.solve_pressed(bonds, shape) {
                *shape = before;
                // What the load drives against another piece is held by contact alone. Where that does not hold either without columns
                // that pull, the shape found with them is none: they glue the pieces together.
                fail_if!(has_pressed_all || !self.contact.press_all(bonds), error);
                (has_pressed_all, self.is_stale) = (true, true);
            } else if !self.contact.settle(bonds, &shape.u) {
                break;
            }
        }
        Ok(())
    }

    /// The same with the columns that are pressed now.
    fn solve_pressed(&mut self, bonds: &mut BondState, shape: &mut Shape) -> Result<()> {
        for (i, u) in shape.u.iter_mut().enumerate().filter(|(i, _)| self.full.held[*i]) {
            *u = self.full.motion[i];
        }
        self.spent.solves += 1;
        let mut is_fresh = false;
        loop {
            if self.is_stale {
                self.stiffness.factorise(self.net, &bonds.share, self.contact.struts())?;
                self.spent.factorisations += 1;
                (self.is_stale, is_fresh) = (false, true);
            }
            if let Some(iterations) = self.iterate(bonds, shape) {
                self.is_stale = iterations > RENEW && !is_fresh;
                return Ok(());
            }
            fail_if!(
                is_fresh,
                Error::Mechanics(format!("no equilibrium within {ITERATIONS_MAX} iterations: the loaded part has no support"))
            );
            self.is_stale = true;
        }
    }

    /// Forces of bonds and columns on the points at a displacement, N, and their energy, J.
    fn internal_force(&mut self, bonds: &mut BondState, u: &[f64], force: &mut [f64]) -> f64 {
        self.springs.internal_force(u, bonds, Damaging::Frozen, force).strain + self.contact.push(u, force)
    }

    /// Iterations to the tolerance, or `None` without it.
    fn iterate(&mut self, bonds: &mut BondState, shape: &mut Shape) -> Option<usize> {
        let full = self.full;
        let [mut r, mut z, mut p, mut q] = std::mem::take(&mut self.vectors);
        p.fill(0.0);
        shape.strain = self.internal_force(bonds, &shape.u, &mut shape.force);
        let residual = |force: &[f64], r: &mut [f64]| {
            for (i, r) in r.iter_mut().enumerate() {
                *r = if full.held[i] { 0.0 } else { force[i] + full.external[i] };
            }
        };
        residual(&shape.force, &mut r);
        let mut target = TOLERANCE * full.size(&shape.force);
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
            self.internal_force(bonds, &p, &mut q);
            // The force is -K p; held rows play no part.
            let curvature = -dot(&p, &q);
            if curvature.is_nan() || curvature <= 0.0 {
                break;
            }
            let step = rz / curvature;
            shape.u.iter_mut().zip(&p).for_each(|(u, p)| *u += step * p);
            shape.force.iter_mut().zip(&q).for_each(|(force, q)| *force += step * q);
            residual(&shape.force, &mut r);
            target = TOLERANCE * full.size(&shape.force);
            self.spent.iterations += 1;
        }
        if found.is_some_and(|iterations| iterations > 0) {
            shape.strain = self.internal_force(bonds, &shape.u, &mut shape.force);
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
