//! What a run by K of the tips carries from block to block, and what a block gives.

use serde::{Deserialize, Serialize};

use super::readings::Readings;
use super::steering::{Steering, equivalent_factor};
use crate::fatigue::crack_tip::TipState;
use crate::growth::record::StopReason;
use crate::specimen::{CrackLine, LineEnd};

/// A tip that grows by its own K.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Tip {
    /// Which crack it ends.
    pub end: LineEnd,
    /// What has become of it.
    pub state: TipState,
    /// Growth since the start, m.
    pub growth: f64,
    /// K_I and K_II, Pa√m, at the present length.
    pub factors: [f64; 2],
    /// da/dN at the present length, m/cycle.
    pub rate: f64,
    /// That of the block before, and the growth of the fastest tip since.
    pub(super) before: Option<[f64; 2]>,
    /// Its rate at the start of the last block and its own growth in it, where no corner lies between.
    pub(super) past: Option<[f64; 2]>,
    /// Length of crack that belonged to it at the start, m.
    pub(super) length: f64,
    pub(super) readings: Readings,
    pub(super) steering: Steering,
}

impl Tip {
    /// K_eq at maximum load of the requested length, Pa√m.
    pub(super) fn equivalent(&self) -> f64 {
        equivalent_factor(self.factors)
    }
}

/// All that a run carries from block to block but the displacement, which the solver makes of the bonds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TipFieldState {
    /// Cracks.
    pub lines: Vec<CrackLine>,
    /// Their tips.
    pub tips: Vec<Tip>,
    /// Growth of a tip in the next block at the most, m.
    pub(super) step: f64,
}

impl TipFieldState {
    /// Whether it may be a later state of the same cracks.
    #[must_use]
    pub fn fits(&self, start: &TipFieldState) -> bool {
        let ends = |state: &TipFieldState| state.tips.iter().map(|tip| tip.end).collect::<Vec<_>>();
        self.lines.len() == start.lines.len() && ends(self) == ends(start)
    }
}

/// What a block did.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// Cycles it took.
    pub cycles: f64,
    /// Work of the loads at its end, J; NaN where there is no equilibrium.
    pub work: f64,
    /// Bonds cut.
    pub cut: usize,
    /// Why there is no next one.
    pub end: Option<StopReason>,
}
