//! What drives a crack: from the plate as it stands to the plate an increment later.
//!
//! Knows: the case, the chain from bonds, formulas and fronts to tips, and, in [`predict`], the whole run with its error bound, checkpoints and
//! judgement. **[`predict::increment`] is the main page.**
//! Must not know: fits, files of results, terminals, networks.
//!
//! Imports `base`, `plate`, `laws`, `measured`, `points` and `nodes`.
//!
//! [`crate::predict::predict`] advances one [`CrackGrowth`] until there is a reason to stop: K of every tip ([`cracks`]), on points and bonds
//! ([`points`]) or on nodes ([`nodes`]), fatigue bonds that fail by their own strain ([`bond_strain`]), first these and then K for cracks
//! from slots ([`hand_over`]), K of a handbook without any plate ([`hand_calculation`]), or that of a crack that does not go through, and of its
//! tips once it does ([`part_through`]).

pub mod case;
pub mod rate_constant;
pub mod ageing;
pub mod bond_strain;
pub mod cracks;
pub mod cross_check;
pub mod end_of_life;
pub mod hand_calculation;
pub mod hand_over;
pub mod nodes;
pub mod part_through;
pub mod plate;
pub mod points;
pub mod record;
pub mod relay;
pub mod stress_concentration;
pub mod predict;

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use cross_check::CrossCheck;
use perilife_base::error::Result;
use perilife_base::raster::PointGrid;
use perilife_laws::growth_law::GrowthLaw;
use perilife_laws::response::Response;
use perilife_laws::retardation::Underway;
use perilife_plate::loading::Loading;
use perilife_points::body::Body;
use perilife_points::solver::SolverUsed;
use record::{CurvePoint, StopReason, TipRecord};

/// What drives the cracks of one plate. An implementor supplies the first row, where the run stands, its curve, and a state from which
/// it can be resumed; each has an increment of its own, which [`crate::predict::predict`] calls until there is a reason to stop.
pub trait CrackGrowth {
    /// Makes the first row: the plate with its initial cracks, in equilibrium.
    /// Errors: no equilibrium, or nothing can be read at a tip.
    fn open(&mut self) -> Result<()>;

    /// The last row.
    fn now(&self) -> GrowthStatus<'_>;

    /// The rows; handed over once.
    fn curve(&mut self) -> Vec<CurvePoint>;

    /// All that the next increments depend on where the solver is built anew.
    fn state(&self) -> State;

    /// Goes on from a state of an earlier run, in place of [`CrackGrowth::open`]; whether it is one of this plate and law.
    fn restore(&mut self, state: State) -> Result<bool>;

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

    /// Whether to rebuild the solver, so that what follows depends on [`CrackGrowth::state`] alone; independent of time.
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

    /// Where the loads and the zone of the last overload stand after rows whose cycles are counted in the order of their spectrum.
    fn overload(&self) -> Option<Underway> {
        None
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

/// Where a run stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GrowthStatus<'a> {
    /// Cycles since N = 0.
    pub cycles: f64,
    /// Crack length in the specimen's convention, m.
    pub crack_length: f64,
    /// Range of the stress intensity factor, Pa√m; NaN where it is known at the end only.
    pub delta_k: f64,
    /// How K of the tip that leads follows the load.
    pub response: Response,
    /// Nominal load at which the weakest section is fully plastic, Pa or N; `None` where it is not known on the way.
    pub limit_load: Option<f64>,
    /// Tips, in the order of `Specimen::tips`.
    pub tips: &'a [TipRecord],
}

impl GrowthStatus<'_> {
    /// Largest K of the tip that leads, Pa√m.
    pub fn k_max(&self, loading: &Loading) -> f64 {
        self.delta_k / self.response.range_share(loading.ratio)
    }

    /// Growth of all tips together, m.
    pub fn growth(&self) -> f64 {
        self.tips.iter().map(|tip| tip.growth).sum()
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
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct SolverStatistics {
    pub points_solved: usize,
    pub solves: usize,
    pub iterations: usize,
    /// Times that nodes were made finer than usual.
    pub refined: u32,
    /// What solved; `None` of a hand calculation.
    pub solver: Option<SolverUsed>,
}

/// State of a run at a place where its solver is built anew.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum State {
    Bonds(bond_strain::BondStrainState),
    /// Of tips driven by their K.
    Tips(cracks::CracksRun<points::PointState>),
    /// Of tips that another engine has handed over.
    HandedOver(relay::HandedOver),
    /// Of tips on a plate of nodes.
    Nodes(cracks::CracksRun<nodes::NodeState>),
    /// Of a hand calculation, also of a crack that is not through yet: its rows.
    Rows(Vec<CurvePoint>),
}
