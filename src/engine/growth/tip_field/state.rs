//! What a run by K of the tips carries from increment to increment.

use serde::{Deserialize, Serialize};

use super::contact::ClosedPlace;
use super::kink::Kink;
use super::readings::{Coalescence, Reading, Readings};
use super::steering::{Steering, equivalent_factor};
use crate::body::Bond;
use crate::fatigue::crack_tip::TipState;
use crate::growth::SolverStatistics;
use crate::growth::cross_check::EnergyBalance;
use crate::growth::record::CurvePoint;
use crate::specimen::{CrackLine, LineEnd, Specimen};

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
    /// Stress along the crack T at maximum load, Pa.
    pub t_stress: f64,
    /// da/dN at the present length, m/cycle.
    pub rate: f64,
    /// That of the increment before, and the growth of the fastest tip since.
    pub(super) before: Option<[f64; 2]>,
    /// Its rate at the start of the last increment and its own growth in it, where no corner lies between.
    pub(super) past: Option<[f64; 2]>,
    /// Length of crack that belonged to it at the start, m.
    pub(super) length: f64,
    /// Length that its cut bonds stand for beyond that of its line, m.
    pub(super) length_offset: f64,
    /// What its ring said last; none before, and where it has ended.
    pub(super) reading: Option<Reading>,
    pub(super) readings: Readings,
    /// Of K_II, of a tip of both modes before it grows.
    pub(super) sliding_readings: Readings,
    pub(super) coalescence: Coalescence,
    pub(super) steering: Steering,
    /// The kink at its last corner.
    pub(super) kink: Option<Kink>,
    /// Whether its flanks are in contact, or would be: it does not grow.
    pub(super) is_closed: bool,
    /// Whether that was so at any time.
    pub(super) was_closed: bool,
}

impl Tip {
    pub(super) fn new(specimen: &Specimen, end: LineEnd) -> Self {
        // All of its crack belongs to it, or half where both ends are tips.
        let line = &specimen.crack_lines()[end.line];
        Tip {
            end,
            state: TipState::Active,
            growth: 0.0,
            factors: [0.0; 2],
            t_stress: 0.0,
            rate: 0.0,
            before: None,
            past: None,
            length: line.length() / specimen.tips_of(line).max(1) as f64,
            length_offset: 0.0,
            reading: None,
            readings: Readings::default(),
            sliding_readings: Readings::default(),
            coalescence: Coalescence::default(),
            steering: Steering::default(),
            kink: None,
            is_closed: false,
            was_closed: false,
        }
    }

    /// Whether it grows under this load.
    pub(super) fn is_growing(&self) -> bool {
        self.state == TipState::Active && self.rate > 0.0
    }

    /// Takes in a segment of the length `growth` in an increment in which the fastest tip grew by `fastest`, m, and what has become of it.
    pub(super) fn has_grown(&mut self, growth: f64, fastest: f64, state: TipState) {
        self.before = Some([self.rate, fastest]);
        self.past = (growth > 0.0 && self.steering.corner().is_none()).then_some([self.rate, growth]);
        self.growth += growth;
        self.state = state;
    }

    /// Takes in an increment without growth in which the fastest tip grew by `fastest`, m.
    pub(super) fn stood_still(&mut self, fastest: f64) {
        (self.before, self.past) = (Some([self.rate, fastest]), None);
    }

    /// Forgets how K has changed and where it aimed.
    pub(super) fn forget_history(&mut self) {
        (self.before, self.past) = (None, None);
        (self.readings, self.steering) = (Readings::default(), Steering::default());
        self.sliding_readings = Readings::default();
        (self.coalescence, self.kink) = (Coalescence::default(), None);
    }

    /// K_II of a tip of both modes that has not grown over what is read where its field stands in mode II, `offset` ahead of its line,
    /// for a crack shorter `by` so much, m. The core of a nonlocal crack reaches a fifth of a horizon farther in mode II than in mode I.
    pub(super) fn sliding_ratio(&self, k_ii: f64, offset: f64, by: f64, horizon: f64) -> f64 {
        let mut readings = self.sliding_readings.clone();
        readings.take(k_ii.abs(), 0.0, offset, None, horizon);
        readings.ratio(by, self.length, horizon)
    }

    /// K_eq at maximum load of the requested length, Pa√m.
    pub(super) fn equivalent(&self) -> f64 {
        equivalent_factor(self.factors)
    }
}

/// All that a run carries from increment to increment but the displacement, which the solver makes of the bonds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TipFieldState {
    /// Cracks.
    pub lines: Vec<CrackLine>,
    /// Their tips.
    pub tips: Vec<Tip>,
    /// Growth of a tip in the next increment at the most, m.
    pub(super) step: f64,
    /// K against the energy that the plate releases.
    pub(super) balance: EnergyBalance,
    /// Remaining life λ of bonds that have spent some of it, ascending.
    pub(super) remaining_life: Vec<(Bond, f64)>,
}

impl TipFieldState {
    /// The cracks, shorter by `back`, m, at every tip, by a quarter at the most.
    pub(super) fn drawn_back(&self, back: f64) -> Vec<CrackLine> {
        let mut lines = self.lines.clone();
        self.tips.iter().for_each(|tip| {
            let line = &self.lines[tip.end.line];
            lines[tip.end.line].stretch(tip.end.at_last, -back.min(0.25 * line.length()));
        });
        lines
    }

    /// Whether it may be a later state of the same cracks.
    pub fn fits(&self, start: &TipFieldState) -> bool {
        let ends = |state: &TipFieldState| state.tips.iter().map(|tip| tip.end).collect::<Vec<_>>();
        self.lines.len() == start.lines.len() && ends(self) == ends(start)
    }
}

/// All that the next increments depend on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TipsState {
    pub(super) growth: TipFieldState,
    pub(super) broken: Vec<Bond>,
    /// Bonds beside flanks, and their multipliers.
    pub(super) scaled: Vec<(Bond, f32)>,
    /// Places of the cracks whose flanks are in contact.
    pub(super) closed: Vec<ClosedPlace>,
    pub(super) displacement: Vec<f64>,
    pub(super) curve: Vec<CurvePoint>,
    pub(super) statistics: SolverStatistics,
}
