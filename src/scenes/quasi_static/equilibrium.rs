//! Equilibrium of the springs of a scene at full load with the damage they have, and with its flanks in contact.

use serde::{Deserialize, Serialize};

use super::super::bonds::BondState;
use super::super::contact::{NetContact, Touching};
use super::super::failure::Failure;
use super::super::interaction::{Damaging, Interaction};
use super::super::springs::Springs;
pub use crate::levels::equilibrium::Shape;
use crate::levels::equilibrium::{self, FullLoad, InternalForce, Spent};
use crate::levels::stiffness::LinearSpring;
use perilife_base::error::Result;
use perilife_plate::specimen::Crack;
use perilife_points::net::Net;

/// Residual over load at which a solve ends: damage of mirror twins shall agree to 1e-9.
const TOLERANCE: f64 = 1e-10;
/// Times that contact is looked at after which the last set of pressed columns stays: what flickers then carries next to nothing.
const LOOKS: usize = 20;

/// Solver for a net with its loads.
pub struct Equilibrium<'n> {
    net: &'n Net,
    full: &'n FullLoad,
    springs: Springs<'n>,
    contact: NetContact<'n>,
    inner: equilibrium::Equilibrium,
}

/// What a solver keeps where it is renewed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Kept {
    pressed: Option<Vec<u32>>,
    spent: Spent,
}

/// Springs whose damage stays as it is.
struct Frozen<'a, 'n> {
    springs: &'a mut Springs<'n>,
    contact: &'a NetContact<'n>,
    bonds: &'a mut BondState,
}

impl InternalForce for Frozen<'_, '_> {
    fn share(&self) -> &[f64] {
        &self.bonds.share
    }

    fn struts(&self) -> &[LinearSpring] {
        self.contact.struts()
    }

    fn internal_force(&mut self, u: &[f64], force: &mut [f64]) -> f64 {
        self.springs.internal_force(u, self.bonds, Damaging::Frozen, force).strain + self.contact.push(u, force)
    }
}

impl<'n> Equilibrium<'n> {
    /// A solver for a net with its loads, whose flanks touch across these cracks and those that grow from them.
    pub fn new(net: &'n Net, cracks: &[Crack], full: &'n FullLoad) -> Result<Self> {
        let springs = Springs::new(net, Failure::Never, false);
        Ok(Equilibrium {
            net,
            full,
            springs,
            contact: NetContact::new(net, cracks),
            inner: equilibrium::Equilibrium::new(net, full)?,
        })
    }

    /// What solving has cost so far.
    pub fn spent(&self) -> Spent {
        self.inner.spent
    }

    /// What it keeps where it is renewed.
    pub fn kept(&self) -> Kept {
        Kept { pressed: self.contact.pressed(), spent: self.spent() }
    }

    /// Begins anew from these bonds and what a solver kept: what follows depends on both alone.
    pub fn renew(&mut self, kept: &Kept, bonds: &BondState) {
        self.contact.renew(kept.pressed.as_deref(), bonds);
        self.inner.spent = kept.spent;
        self.inner.renew();
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
            let mut frozen = Frozen { springs: &mut self.springs, contact: &self.contact, bonds };
            let found = self.inner.solve(self.net, self.full, &mut frozen, shape, TOLERANCE);
            if let Err(error) = found {
                *shape = before;
                // What the load drives against another piece is held by contact alone. Where that does not hold either without columns
                // that pull, the shape found with them is none: they glue the pieces together.
                if has_pressed_all || !self.contact.press_all(bonds) {
                    return Err(error);
                }
                has_pressed_all = true;
                self.inner.renew();
                continue;
            }
            if !self.contact.settle(bonds, &shape.u) {
                break;
            }
        }
        Ok(())
    }
}
