//! Loads and supports at full load, unknown by unknown. All of them grow in proportion.

use super::super::boundary::{Boundary, Motion};
use super::super::net::Net;
use super::relaxation::Loads;
use super::rigid::minimal_constraints;
use crate::error::{Error, Result, input};

/// What holds and pushes the points at full load; layout of [`super::super::interaction::Interaction`].
#[derive(Debug, Clone, PartialEq)]
pub struct FullLoad {
    /// Whether an unknown is held.
    pub held: Vec<bool>,
    /// Where held unknowns go, m; 0 elsewhere.
    pub motion: Vec<f64>,
    /// Forces on the other unknowns, N; 0 on held ones but pins, which carry nothing beside.
    pub external: Vec<f64>,
    /// Unknowns held only because the plate would float; they must carry no load.
    pub pins: Vec<usize>,
}

/// Force at a pin over the load from which loads count as out of balance.
const IMBALANCE: f64 = 1e-6;

impl FullLoad {
    /// Loads and supports of a boundary.
    ///
    /// # Errors
    /// A prescribed velocity: there is no time.
    pub fn of(net: &Net, boundary: &Boundary) -> Result<Self> {
        let size = net.len() * net.unknowns;
        let mut full = FullLoad { held: vec![false; size], motion: vec![0.0; size], external: vec![0.0; size], pins: Vec::new() };
        for held in &boundary.held {
            let Motion::Displacement(value) = held.motion else {
                return Err(input(
                    "loading.kind",
                    "\"velocity\"",
                    "needs time, and the scene has none",
                    "give loading.duration_s, or kind = \"displacement\" with displacement_mm",
                ));
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
        full.pins = minimal_constraints(net, &full.held);
        full.pins.iter().for_each(|&at| full.held[at] = true);
        Ok(full)
    }

    /// Lets the plate float after all: something that is not among these loads holds it.
    pub fn release(&mut self) {
        std::mem::take(&mut self.pins).into_iter().for_each(|at| self.held[at] = false);
    }

    /// The loads as dynamic relaxation takes them.
    #[must_use]
    pub fn loads(&self) -> Loads<'_> {
        Loads { held: &self.held, external: &self.external }
    }

    /// Square root of the sum of squares of the forces on the plate, N, when its bonds pull with `force`.
    #[must_use]
    pub fn size(&self, force: &[f64]) -> f64 {
        let squares = self.held.iter().zip(force).zip(&self.external);
        squares.map(|((&held, force), external)| if held { force * force } else { external * external }).sum::<f64>().sqrt()
    }

    /// Work that the held unknowns would do on the way to full load against these forces of the bonds, and work of the given
    /// forces over this displacement, J.
    #[must_use]
    pub fn works(&self, u: &[f64], force: &[f64]) -> [f64; 2] {
        let driven: f64 = self.motion.iter().zip(force).map(|(motion, force)| -motion * force).sum();
        let pushed: f64 = self.external.iter().zip(u).map(|(force, u)| force * u).sum();
        [driven, pushed]
    }

    /// Refuses loads that a floating plate cannot balance.
    ///
    /// # Errors
    /// A force at a pin.
    pub fn check_balance(&self, net: &Net, force: &[f64]) -> Result<()> {
        let load = self.size(force);
        let Some(&at) = self.pins.iter().find(|&&at| (force[at] + self.external[at]).abs() > IMBALANCE * load) else {
            return Ok(());
        };
        Err(Error::Mechanics(format!(
            "nothing holds the plate, and its loads do not balance: {:.3e} N are left along {} at ({:.3}, {:.3}) mm; give \
             [supports] or balanced loads",
            (force[at] + self.external[at]).abs(),
            ["x", "y"][at % net.unknowns],
            net.positions[at / net.unknowns][0] * 1e3,
            net.positions[at / net.unknowns][1] * 1e3,
        )))
    }
}
