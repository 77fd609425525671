//! What a run gives and how it reports while it goes on.

use serde::{Deserialize, Serialize};

use super::checkpoint::Checkpoint;
use crate::net::PointGrid;
use crate::specimen::Point;

crate::kinds! {
    /// Why a run ended.
    pub enum StopReason for "stop_reason" {
        CrackLengthReached = "crack_length_reached": "the crack reached stop.crack_length_mm",
        Toughness = "toughness": "the stress intensity at maximum load reached the toughness",
        NetSectionYield = "net_section_yield": "the remaining section yields throughout: its limit load at the yield strength is reached",
        Severed = "severed": "the plate is in two pieces, or what is left of it cannot carry the load",
        LeftPlate = "left_plate": "every crack tip has left the plate",
        EnteredHole = "entered_hole": "the last crack tip ran into a hole",
        LeftRefinement = "left_refinement": "a crack tip came to the rim of the finest level of points: the refined region is too small",
        NothingAges = "nothing_ages": "nothing is left that grows under these loads: the life is unlimited",
        RunOut = "run_out": "cycles_max was reached",
        NoConvergence = "no_convergence": "the equilibrium solver did not converge",
    }
}

/// State of one tip at a recorded step.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct TipRecord {
    /// Position, m.
    pub position: Point,
    /// Growth since N = 0, m.
    pub growth: f64,
    /// K_I and K_II at maximum load, Pa√m; `None` where nobody reads them.
    pub factors: Option<[f64; 2]>,
}

/// One cycle block of a finished run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CurvePoint {
    /// Cycles since N = 0.
    pub cycles: f64,
    /// Crack length in the specimen's convention, m.
    pub crack_length: f64,
    /// Range of the stress intensity factor, Pa√m (handbook where there is one, else from the energy release rate); NaN where unknown.
    pub delta_k: f64,
    /// Growth rate da/dN, m/cycle.
    pub growth_rate: f64,
    /// Work of the loads over the displacement at maximum load, f·u, J: twice the strain energy, the load squared times the
    /// compliance; NaN where the plate is severed and in hand calculation.
    pub work: f64,
    /// Bonds broken since the start, initial cracks not counted.
    pub broken_bonds: usize,
    /// Tips, in the order of `Specimen::tips`.
    pub tips: Vec<TipRecord>,
}

/// Picture of the damaged plate at one moment.
#[derive(Debug, Clone, PartialEq)]
pub struct Snapshot {
    /// Cycles since N = 0.
    pub cycles: f64,
    /// Crack length, m.
    pub crack_length: f64,
    /// Displacement (x, y) of every point at maximum load, m.
    pub displacement: Vec<[f64; 2]>,
    /// Damage φ of every point: share of its bonds that are broken, 0 to 1.
    pub damage: Vec<f64>,
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
    /// Actual lattice spacing, m.
    pub spacing: f64,
    /// Horizon, m.
    pub horizon: f64,
    /// Wall time, s.
    pub wall_s: f64,
    /// Peak memory of the process, MB.
    pub memory_mb: f64,
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
    /// What the user should know: warnings in plain words.
    pub warnings: Vec<String>,
}

impl Prediction {
    /// The life, cycles; `None` where the cracks stand still under these loads, so that it has no end.
    #[must_use]
    pub fn life(&self) -> Option<f64> {
        (self.stop != StopReason::NothingAges).then(|| self.life_cycles())
    }

    /// Cycles from N = 0 to the end of the run.
    #[must_use]
    pub fn life_cycles(&self) -> f64 {
        self.curve.last().map_or(0.0, |point| point.cycles)
    }

    /// Crack length at the end, m.
    #[must_use]
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

/// Receives progress; the engine itself never prints. Returning `false` asks the run to stop.
pub trait Observer: Sync {
    /// Called after every cycle block.
    fn block_done(&self, progress: &Progress) -> bool;
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
