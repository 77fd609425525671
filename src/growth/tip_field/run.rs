//! The rows of a run whose cracks are driven by the K of their tips.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::{Step, TipField, TipFieldState};
use crate::body::Bond;
use crate::case::Case;
use crate::error::Result;
use crate::fatigue::growth_law::GrowthLaw;
use crate::growth::end_of_life::{End, first_end};
use crate::growth::plate::Plate;
use crate::growth::record::{CurvePoint, StopReason};
use crate::growth::{CrackGrowth, Effort, Fields, Now, State};

/// Relative difference between lengths that are equal but for round-off.
const ROUND_OFF: f64 = 1e-12;

/// Blocks after which a run begins anew from its bonds, so that it can be taken up there. To begin anew takes as long as three to four
/// blocks.
const BLOCKS_ANEW: usize = 32;

/// [`CrackGrowth`] by [`TipField`].
pub struct TipFieldRun<'a> {
    case: &'a Case,
    growth: TipField<'a>,
    curve: Vec<CurvePoint>,
    end: Option<End>,
    /// Rows at the last time that the solver was built.
    anew: usize,
    warnings: Vec<String>,
}

/// All that the next blocks depend on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TipsState {
    growth: TipFieldState,
    broken: Vec<Bond>,
    displacement: Vec<f64>,
    curve: Vec<CurvePoint>,
    effort: Effort,
}

impl<'a> TipFieldRun<'a> {
    /// The plate with its initial cracks, before its first equilibrium.
    ///
    /// # Errors
    /// As [`Plate::build`] and [`TipField::start`].
    pub fn start(case: &'a Case, law: Box<dyn GrowthLaw>) -> Result<Self> {
        let plate = Plate::build(&case.specimen, &case.specimen, &case.material, &case.model)?;
        let growth = TipField::start(case, Arc::new(plate), law)?;
        let warnings = growth.warnings();
        Ok(TipFieldRun { case, growth, curve: Vec::new(), end: first_end(case), anew: 0, warnings })
    }

    fn last(&self) -> &CurvePoint {
        // `open` or `restore` makes the first row, before the first block.
        &self.curve[self.curve.len() - 1]
    }

    /// The plate as it stands, as a row; ΔK and da/dN are those of the fastest tip.
    fn row(&self, cycles: f64, work: f64, broken_bonds: usize) -> CurvePoint {
        let tips = self.growth.tips();
        let growths: Vec<f64> = tips.iter().map(|tip| tip.growth).collect();
        let (k_max, growth_rate) = self.growth.leading().unwrap_or((f64::NAN, f64::NAN));
        CurvePoint {
            cycles,
            crack_length: self.case.specimen.crack_length_after(&growths),
            delta_k: self.case.loading.range_share() * k_max,
            growth_rate,
            work,
            broken_bonds,
            tips,
        }
    }

    /// Range of K at which its maximum is the toughness, Pa√m.
    fn delta_k_most(&self) -> Option<f64> {
        self.case.material.toughness.map(|toughness| self.case.loading.range_share() * toughness)
    }

    /// Reasons that show on the last row: a known end is reached, or K_max of a tip is the toughness.
    fn reason_to_stop(&self) -> Option<StopReason> {
        let last = self.last();
        if let Some(end) = self.end.filter(|end| last.crack_length >= end.crack_length * (1.0 - ROUND_OFF)) {
            return Some(end.reason);
        }
        self.delta_k_most().filter(|most| last.delta_k >= *most).map(|_| StopReason::Toughness)
    }

    /// The row after a block, and the reason to stop that the block brought: run-out and toughness end it between two rows.
    fn after(&self, step: &Step) -> (CurvePoint, Option<StopReason>) {
        let last = self.last();
        let cycles = last.cycles + step.cycles;
        let next = self.row(cycles, step.work, last.broken_bonds + step.cut);
        let cycles_max = self.case.stop.cycles_max;
        if cycles > cycles_max {
            return (next.between(last, (cycles_max - last.cycles) / step.cycles), Some(StopReason::RunOut));
        }
        if let Some(most) = self.delta_k_most().filter(|most| next.delta_k > *most && last.delta_k < *most) {
            let share = (most - last.delta_k) / (next.delta_k - last.delta_k);
            return (next.between(last, share), Some(StopReason::Toughness));
        }
        (next, step.end)
    }
}

impl CrackGrowth for TipFieldRun<'_> {
    fn open(&mut self) -> Result<()> {
        self.growth.open()?;
        self.curve = vec![self.row(0.0, self.growth.work(), 0)];
        self.anew = 1;
        Ok(())
    }

    fn advance(&mut self) -> Result<Option<StopReason>> {
        if let Some(reason) = self.reason_to_stop() {
            return Ok(Some(reason));
        }
        let until = self.end.map_or(f64::INFINITY, |end| end.crack_length);
        let step = self.growth.advance(self.last().cycles, until);
        let (next, reason) = self.after(&step);
        if step.cut > 0 || step.cycles > 0.0 {
            self.curve.push(next);
        }
        Ok(reason)
    }

    fn now(&self) -> Now<'_> {
        let CurvePoint { cycles, crack_length, delta_k, ref tips, .. } = *self.last();
        Now { cycles, cycles_of_run: cycles, crack_length, delta_k, tips, is_counting: true, is_settled: true }
    }

    fn plate(&self) -> Option<Arc<Plate>> {
        Some(self.growth.plate().clone())
    }

    fn fields(&mut self) -> Result<Option<Fields>> {
        Ok(Some(self.growth.plate().fields(&self.growth.bonds, &self.growth.displacement)))
    }

    fn law(&self) -> Option<&dyn GrowthLaw> {
        Some(self.growth.law())
    }

    fn is_due(&self) -> bool {
        self.curve.len() >= self.anew + BLOCKS_ANEW
    }

    fn begin_anew(&mut self) -> Result<()> {
        self.anew = self.curve.len();
        self.growth.begin_anew()
    }

    fn state(&self) -> State {
        let TipField { bonds, state, displacement, .. } = &self.growth;
        State::Tips(TipsState {
            growth: state.clone(),
            broken: bonds.broken(self.growth.body()),
            displacement: displacement.clone(),
            curve: self.curve.clone(),
            effort: self.effort(),
        })
    }

    fn restore(&mut self, state: State) -> Result<bool> {
        let State::Tips(TipsState { growth, broken, displacement, curve, effort }) = state else { return Ok(false) };
        let places = self.growth.body().multiplier.len();
        let fits = growth.fits(&self.growth.state) && !curve.is_empty() && broken.iter().all(|&bond| (bond as usize) < places);
        if !fits {
            return Ok(false);
        }
        (self.anew, self.curve) = (curve.len(), curve);
        Ok(self.growth.go_on_from(growth, &broken, displacement, (effort.solves, effort.iterations)))
    }

    fn close(&mut self, stop: StopReason) -> Result<StopReason> {
        Ok(stop)
    }

    fn curve(&mut self) -> (Vec<CurvePoint>, f64) {
        (std::mem::take(&mut self.curve), 0.0)
    }

    fn effort(&self) -> Effort {
        let TipField { solves, iterations, .. } = self.growth;
        Effort { points_solved: self.growth.points(), solves, iterations }
    }

    fn warnings(&self) -> Vec<String> {
        self.warnings.clone()
    }
}
