//! What drives a crack: from the plate as it stands to the plate an increment later.
//!
//! Knows: the case, the chain from bonds, formulas and fronts to tips, and, in [`predict`], the whole run with its error bound, checkpoints and
//! judgement. **[`predict::increment`] is the main page.**
//! Must not know: fits, files of results, terminals, networks.
//!
//! Imports `base`, `plate`, `laws`, `measured`, `points` and `nodes`.
//!
//! A life is a chain of stages ([`predict::chain`]), each a [`CrackGrowth`]: cracks that have to form first, K of a handbook without any plate
//! ([`hand_calculation`]), K of a front that does not go through ([`part_through`]), fatigue bonds that fail by their own strain
//! ([`bond_strain`]), and K of every tip ([`cracks`]), on points and bonds ([`points`]) or on nodes ([`nodes`]).

pub mod case;
pub mod rate_constant;
pub mod ageing;
pub mod bond_strain;
pub mod cracks;
pub mod cross_check;
pub mod end_of_life;
pub mod hand_calculation;
pub mod nodes;
pub mod part_through;
pub mod plate;
pub mod points;
pub mod record;
pub mod stress_concentration;
pub mod predict;

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use cross_check::CrossCheck;
use perilife_base::error::Result;
use perilife_base::raster::PointGrid;
use perilife_laws::growth_law::GrowthLaw;
use perilife_points::body::Body;
use perilife_points::solver::SolverUsed;
use record::{CurvePoint, StopReason};

/// What drives the cracks of one plate. An implementor supplies the first row, where the run stands and its curve; each has an increment of its
/// own, which [`predict::chain::Chain::step`] calls until there is a reason to stop.
pub trait CrackGrowth {
    /// Makes the first row: the plate with its initial cracks, in equilibrium.
    /// Errors: no equilibrium, or nothing can be read at a tip.
    fn open(&mut self) -> Result<()>;

    /// The last row.
    fn now(&self) -> &CurvePoint;

    /// The rows; handed over once.
    fn curve(&mut self) -> Vec<CurvePoint>;

    /// The plate as points and bonds, where there is one.
    fn body(&self) -> Option<Arc<Body>> {
        None
    }

    /// The points that pictures show, where there are any.
    fn grid(&self) -> Option<PointGrid> {
        self.body().map(|body| body.grid())
    }

    /// Displacement and damage of its points as they stand.
    fn fields(&mut self) -> Result<Option<Fields>> {
        Ok(None)
    }

    /// The law over K that rates come from, where there is one.
    fn law(&self) -> Option<&dyn GrowthLaw> {
        None
    }

    /// Whether to rebuild the solver, so that what follows depends on the state of its checkpoint alone; independent of time.
    fn should_rebuild_solver(&self) -> bool {
        false
    }

    /// Builds the solver anew from the bonds.
    fn rebuild_solver(&mut self) -> Result<()> {
        Ok(())
    }

    /// Ends the run for a reason, or for one that had come before it.
    /// Errors: no equilibrium of the whole plate.
    fn close(&mut self, stop: StopReason) -> Result<StopReason> {
        Ok(stop)
    }

    /// What the run took.
    fn statistics(&self) -> SolverStatistics {
        SolverStatistics::default()
    }

    /// K of a run of so many `cycles` against an independent one, where it grew far enough for that.
    fn cross_check(&self, _cycles: f64) -> Option<CrossCheck> {
        None
    }

    /// What the user should know of the driver's own.
    fn warnings(&self) -> Vec<String> {
        Vec::new()
    }
}

/// Displacement (x, y), m, and damage, 0 to 1, of every point.
#[derive(Debug, Clone, PartialEq)]
pub struct Fields {
    /// Displacement at maximum load, m.
    pub displacement: Vec<[f64; 2]>,
    /// Fraction of a point's bonds that are broken.
    pub damage: Vec<f64>,
    /// Least remaining life λ of a point's intact bonds, 0 to 1; empty where there are no bonds.
    pub remaining_life: Vec<f64>,
    /// Von Mises stress of a point at maximum load, Pa; empty where it is not known.
    pub stress: Vec<f64>,
}

/// What a run took.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct SolverStatistics {
    pub points_solved: usize,
    pub solves: usize,
    pub iterations: usize,
    /// Times that nodes were made finer than usual, near tips and rims and far from them.
    pub refined: [u32; 2],
    /// Cycles that its steps may be off by.
    pub step_error: f64,
    /// What solved; `None` of a hand calculation.
    pub solver: Option<SolverUsed>,
}
