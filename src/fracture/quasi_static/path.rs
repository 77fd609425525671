//! The equilibrium path of springs with damage, controlled by damage itself: load and displacement rise and fall as the path
//! asks.
//!
//! Every state on the path is exact equilibrium at the load where the next bond is damaged (`Control::next`). From there
//!
//! - where bonds are damaged gradually, the largest damage grows by τ: `D(n+1)` from the law at the load of that growth, with
//!   the displacements of D(n+1), found by repeated secant solutions until no damage changes by more than a tolerance; τ is
//!   halved where that takes long and grown again where it does not;
//! - where a bond has come to the end of its curve, or its law knows no gradual damage, it breaks alone (with its mirror
//!   twins) while its stretch stays at the limit: the load dips to where its last force is gone.
//!
//! Bonds that parts sliding past each other stretch in truth but not in linear measures are torn where they stand.
//!
//! Of the usual controls (arc length, energy released, largest growth of damage) this one is explicit: the load follows from one
//! pass over the bonds, it exists for any damage and has one value, so there are no roots to choose between and a step never
//! fails to find the path.

use super::super::bonds::BondState;
use super::super::failure::Failure;
use super::account::Recorder;
use super::full_load::FullLoad;
use super::walk::{Walk, Walked};
use crate::error::Result;
use crate::levels::Net;
use crate::specimen::Crack;

/// Settings of path following.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Growth of the largest damage in a step, τ, at the most.
    pub growth: f64,
    /// Change of damage at which a step is quiet.
    pub quiet: f64,
    /// Solutions in a step after which τ is halved for the next; half of them, and it grows again.
    pub solutions: usize,
    /// Steps after which a run ends.
    pub steps: usize,
}

impl Default for Settings {
    fn default() -> Self {
        Settings { growth: 0.04, quiet: 1e-3, solutions: 12, steps: 100_000 }
    }
}

/// A path to follow.
pub struct Path<'a> {
    /// Points and bonds.
    pub net: &'a Net,
    /// Cracks of the start, whose flanks may touch.
    pub cracks: &'a [Crack],
    /// Loads.
    pub full: &'a FullLoad,
    /// Law of damage, not in its printed form.
    pub failure: &'a Failure,
    /// Nominal load steps: a row at least every so many-th of the full load.
    pub steps: usize,
    /// Settings.
    pub settings: Settings,
}

impl Path<'_> {
    /// Follows the path from rest to full load, or until the plate is in two; or from where the run is taken up.
    ///
    /// # Errors
    /// A run that was cancelled, no equilibrium at the start, a checkpoint of another run.
    pub fn follow(&self, bonds: &mut BondState, recorder: Recorder<'_, '_>) -> Result<Walked> {
        let mut walk = Walk::start(self, bonds, recorder)?;
        let end = walk.run(bonds)?;
        Ok(walk.close(end))
    }
}
