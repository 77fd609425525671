//! What a run gives and how it reports while it goes on.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::checkpoint::Checkpoint;
use super::memory;
use crate::case::Case;
pub use crate::growth::cross_check::CrossCheck;
use crate::growth::plate::Plate;
pub use crate::growth::record::{CurvePoint, StopReason, TipRecord};
use crate::growth::{CrackGrowth, GrowthStatus};
use crate::levels::PointGrid;
use crate::solver::SolverUsed;
use crate::units::MM;
use crate::watch::Watch;

/// Picture of the damaged plate at one moment.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Snapshot {
    /// Cycles since N = 0.
    pub cycles: f64,
    /// Crack length, m.
    pub crack_length: f64,
    /// Displacement (x, y) of every point at maximum load, m.
    pub displacement: Vec<[f64; 2]>,
    /// Damage φ of every point: fraction of its bonds that are broken, 0 to 1.
    pub damage: Vec<f64>,
    /// Least remaining life λ of the intact bonds of every point, 0 to 1; empty where no bonds have one.
    pub remaining_life: Vec<f64>,
    /// Von Mises stress of every point at maximum load, Pa; empty where it is not known.
    pub stress: Vec<f64>,
}

/// Figures of a run that users ask for.
#[derive(Debug, Clone, PartialEq)]
pub struct RunFigures {
    /// Points of the whole body.
    pub points: usize,
    /// Points that were solved for.
    pub points_solved: usize,
    /// Bonds of the uncracked body.
    pub bonds: usize,
    /// Cycle blocks.
    pub blocks: usize,
    /// Equilibrium solves.
    pub solves: usize,
    /// Solver iterations in all (0 for a direct solver).
    pub iterations: usize,
    /// What solved; `None` of a hand calculation.
    pub solver: Option<SolverUsed>,
    /// Actual lattice spacing, m.
    pub spacing: f64,
    /// Horizon, m.
    pub horizon: f64,
    /// Wall time, s.
    pub wall_s: f64,
    /// Peak memory of the process, MB.
    pub memory_mb: f64,
}

impl RunFigures {
    /// Of a run that is over, after so many blocks and seconds.
    pub(super) fn of(growth: &dyn CrackGrowth, blocks: usize, wall_s: f64) -> Self {
        let (plate, statistics) = (growth.plate(), growth.statistics());
        let plate = plate.as_deref();
        RunFigures {
            points: plate.map_or(statistics.points_solved, Plate::points),
            points_solved: statistics.points_solved,
            bonds: plate.map_or(0, Plate::bonds),
            blocks,
            solves: statistics.solves,
            iterations: statistics.iterations,
            solver: statistics.solver,
            spacing: plate.map_or(f64::NAN, |plate| plate.body.lattice.spacing),
            horizon: plate.map_or(f64::NAN, |plate| plate.body.horizon()),
            wall_s,
            memory_mb: memory::peak_mb(),
        }
    }
}

/// What a run gives.
#[derive(Debug, Clone, PartialEq)]
pub struct Prediction {
    /// The a-N curve: first row N = 0 at the initial crack length; cycles and length never fall.
    pub curve: Vec<CurvePoint>,
    /// Why it ended.
    pub stop: StopReason,
    /// Snapshots: first, some between, last.
    pub snapshots: Vec<Snapshot>,
    /// Lattice of the snapshots.
    pub grid: PointGrid,
    /// Figures.
    pub figures: RunFigures,
    /// K against an independent one, where there is one.
    pub cross_check: Option<CrossCheck>,
    /// What the user should know: warnings in plain words.
    pub warnings: Vec<String>,
}

impl Prediction {
    /// The life, cycles; `None` where the cracks stand still under these loads, so that it has no end.
    pub fn life(&self) -> Option<f64> {
        (self.stop != StopReason::NothingAges).then(|| self.life_cycles())
    }

    /// Cycles from N = 0 to the end of the run.
    pub fn life_cycles(&self) -> f64 {
        self.curve.last().map_or(0.0, |point| point.cycles)
    }

    /// Crack length at the end, mm.
    pub fn crack_length_final_mm(&self) -> f64 {
        self.crack_length_final() / MM
    }

    /// Crack length at the end, m.
    pub fn crack_length_final(&self) -> f64 {
        self.curve.last().map_or(f64::NAN, |point| point.crack_length)
    }
}

/// What a run reports while it goes on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// Cycles since N = 0.
    pub cycles: f64,
    /// Crack length, m.
    pub crack_length: f64,
    /// Share of the way from the initial to the final crack length (or of `cycles_max`), 0 to 1.
    pub share: f64,
}

impl Progress {
    /// That of a run of a case which has come so far.
    pub(super) fn of(case: &Case, now: &GrowthStatus<'_>) -> Self {
        let start = case.specimen.crack_length;
        // Without a length to stop at, growth across the plate is the way.
        let end = if case.stop.crack_length.is_finite() { case.stop.crack_length } else { start + case.specimen.gross_width };
        let (by_length, by_cycles) = ((now.crack_length - start) / (end - start), now.cycles / case.stop.cycles_max);
        Progress { cycles: now.cycles, crack_length: now.crack_length, share: by_length.max(by_cycles).clamp(0.0, 1.0) }
    }
}

/// Receives progress; the engine itself never prints. Returning `false` asks the run to stop.
pub trait Observer: Sync {
    /// Called after every cycle block.
    fn block_done(&self, progress: &Progress) -> bool;
    /// Where the run marks what it does before it has a first row to show, and where it looks whether it may go on; by default nowhere.
    fn watch(&self) -> Option<Arc<Watch>> {
        None
    }
    /// Called where the run could be taken up again ([`super::resume`]); `checkpoint` builds what that takes, so that nothing is
    /// built where nobody wants it. By default nobody does.
    ///
    /// These places depend on the case alone, not on time and not on what the observer does.
    fn may_keep(&self, _checkpoint: &dyn Fn() -> Checkpoint) {}
    /// Called after every cycle block since N = 0, before [`Observer::block_done`], with where the tips are now.
    fn grown(&self, _tips: &[TipRecord]) {}
    /// Called with every picture that is taken while the run goes on. Its cycles count from the start of the run, which is before
    /// N = 0 where the crack is first grown to its initial length.
    fn looked(&self, _snapshot: &Snapshot, _grid: &PointGrid) {}
}

/// An observer that watches nothing.
#[derive(Debug, Clone, Copy, Default)]
pub struct Silent;

impl Observer for Silent {
    fn block_done(&self, _progress: &Progress) -> bool {
        true
    }
}
