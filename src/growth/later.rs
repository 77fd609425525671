//! A run that an engine has taken over from another: one curve, cycles and growth counted on from N = 0.

use serde::{Deserialize, Serialize};

use super::record::{CurvePoint, TipRecord};
use super::{CrackGrowth, GrowthStatus, SolverStatistics, State};
use perilife_base::error::Result;

/// The run from where it was taken over.
pub struct Later<G> {
    /// What drives the cracks now.
    pub growth: G,
    /// The rows up to there, but the last.
    before: Vec<CurvePoint>,
    /// The last of them, at which the new run begins.
    start: CurvePoint,
    /// What the run took until then.
    took: SolverStatistics,
    /// The tips of the last row, which count their growth from N = 0.
    now: Vec<TipRecord>,
}

/// State of a run that was taken over.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct HandedOver {
    /// The rows up to there.
    pub before: Vec<CurvePoint>,
    /// What the run took until then.
    pub took: SolverStatistics,
    /// State of what drives the cracks now.
    pub tips: Box<State>,
}

impl<G: CrackGrowth> Later<G> {
    /// The run of `growth`, which is not open yet, after some rows; `None` where there are none.
    pub fn new(growth: G, mut before: Vec<CurvePoint>, took: SolverStatistics) -> Option<Self> {
        let start = before.pop()?;
        let now = start.tips.clone();
        Some(Later { growth, before, start, took, now })
    }

    /// Makes its first row.
    /// Errors: no equilibrium, or nothing can be read at a tip.
    pub fn open(&mut self) -> Result<()> {
        self.growth.open()?;
        self.look();
        Ok(())
    }

    /// Goes on from a state of its driver, in place of [`Later::open`]; whether it is one of this plate and law.
    pub fn restore(&mut self, state: State) -> Result<bool> {
        let fits = self.growth.restore(state)?;
        if fits {
            self.look();
        }
        Ok(fits)
    }

    /// The row at which it begins.
    pub fn start(&self) -> &CurvePoint {
        &self.start
    }

    /// Takes in where the tips are.
    pub fn look(&mut self) {
        self.now = since_start(self.growth.now().tips, &self.start);
    }

    /// The last row.
    pub fn now(&self) -> GrowthStatus<'_> {
        let now = self.growth.now();
        GrowthStatus { cycles: self.start.cycles + now.cycles, tips: &self.now, ..now }
    }

    /// All rows; handed over once. The row at which it begins is that which knows K of its tips.
    pub fn curve(&mut self) -> Vec<CurvePoint> {
        let (mut curve, start) = (std::mem::take(&mut self.before), &self.start);
        curve.extend(self.growth.curve().into_iter().map(|row| CurvePoint {
            cycles: start.cycles + row.cycles,
            broken_bonds: start.broken_bonds + row.broken_bonds,
            tips: since_start(&row.tips, start),
            ..row
        }));
        curve
    }

    /// What its next increments depend on.
    pub fn state(&self) -> State {
        let before = self.before.iter().chain([&self.start]).cloned().collect();
        State::HandedOver(HandedOver { before, took: self.took, tips: Box::new(self.growth.state()) })
    }

    /// What the whole run took.
    pub fn statistics(&self) -> SolverStatistics {
        let now = self.growth.statistics();
        SolverStatistics { solves: self.took.solves + now.solves, iterations: self.took.iterations + now.iterations, ..now }
    }
}

/// Tips whose growth counts from the row at which a run was taken over, with the growth before.
fn since_start(tips: &[TipRecord], start: &CurvePoint) -> Vec<TipRecord> {
    tips.iter().zip(&start.tips).map(|(tip, before)| TipRecord { growth: before.growth + tip.growth, ..*tip }).collect()
}
