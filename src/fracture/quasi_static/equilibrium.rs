//! Equilibrium of the springs of a scene at full load with the damage they have.

use super::super::bonds::BondState;
use super::super::failure::Failure;
use super::super::interaction::{Damaging, Interaction};
use super::super::springs::Springs;
use crate::error::Result;
use crate::levels::Net;
pub use crate::levels::equilibrium::Shape;
use crate::levels::equilibrium::{self, FullLoad, InternalForce, Spent};

/// Residual over load at which a solve ends: damage of mirror twins shall agree to 1e-9.
const TOLERANCE: f64 = 1e-10;

/// Solver for a net with its loads.
pub struct Equilibrium<'n> {
    net: &'n Net,
    full: &'n FullLoad,
    springs: Springs<'n>,
    inner: equilibrium::Equilibrium,
}

/// Springs whose damage stays as it is.
struct Frozen<'a, 'n> {
    springs: &'a mut Springs<'n>,
    bonds: &'a mut BondState,
}

impl InternalForce for Frozen<'_, '_> {
    fn share(&self) -> &[f64] {
        &self.bonds.share
    }

    fn internal_force(&mut self, u: &[f64], force: &mut [f64]) -> f64 {
        self.springs.internal_force(u, self.bonds, Damaging::Frozen, force).strain
    }
}

impl<'n> Equilibrium<'n> {
    /// A solver for a net with its loads.
    ///
    /// # Errors
    /// Out of memory.
    pub fn new(net: &'n Net, full: &'n FullLoad) -> Result<Self> {
        let springs = Springs::new(net, Failure::Never, false);
        Ok(Equilibrium { net, full, springs, inner: equilibrium::Equilibrium::new(net, full)? })
    }

    /// What solving has cost so far.
    #[must_use]
    pub fn spent(&self) -> Spent {
        self.inner.spent
    }

    /// Moves `shape` to the equilibrium with these bonds.
    ///
    /// # Errors
    /// No convergence: nothing holds what the loads pull at.
    pub fn solve(&mut self, bonds: &mut BondState, shape: &mut Shape) -> Result<()> {
        let mut frozen = Frozen { springs: &mut self.springs, bonds };
        self.inner.solve(self.net, self.full, &mut frozen, shape, TOLERANCE).map(|_| ())
    }
}
