//! The rows of a run by K of its tips, and where it ends between two of them.

use std::sync::Arc;

use super::{Block, PROBE_HORIZONS, Tip, TipField, TipsState, balance};
use crate::body::balanced::flanks::Stretch;
use crate::error::{Error, Result};
use crate::fatigue::growth_law::GrowthLaw;
use crate::fatigue::pieces::set_aside;
use crate::growth::cross_check::CrossCheck;
use crate::growth::plate::Plate;
use crate::growth::record::{CurvePoint, StopReason, TipRecord};
use crate::growth::{CrackGrowth, Effort, Fields, Now, State};
use crate::units::MM;

/// Blocks after which a run begins anew from its bonds, so that it can be taken up there. To begin anew takes as long as three to four
/// blocks.
const BLOCKS_ANEW: usize = 32;
/// Relative difference between lengths that are equal but for round-off.
const ROUND_OFF: f64 = 1e-12;

impl TipField<'_> {
    fn last(&self) -> &CurvePoint {
        // `open` or `restore` makes the first row, before the first block.
        &self.curve[self.curve.len() - 1]
    }

    /// The plate as it stands, as a row; ΔK and da/dN are those of the fastest tip.
    fn row(&self, cycles: f64, work: f64, broken_bonds: usize) -> CurvePoint {
        let now = |tip: &Tip| TipRecord {
            position: self.position(tip),
            growth: tip.growth,
            factors: Some(tip.factors),
            t_stress: Some(tip.t_stress),
        };
        let tips: Vec<TipRecord> = self.state.tips.iter().map(now).collect();
        let growths: Vec<f64> = tips.iter().map(|tip| tip.growth).collect();
        let lead = self.fastest().map(|tip| &self.state.tips[tip]);
        let (k_max, growth_rate) = lead.map_or((f64::NAN, f64::NAN), |tip| (tip.equivalent(), tip.rate));
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
    fn after(&self, block: &Block) -> (CurvePoint, Option<StopReason>) {
        let last = self.last();
        let cycles = last.cycles + block.cycles;
        let next = self.row(cycles, block.work, last.broken_bonds + block.cut);
        let cycles_max = self.case.stop.cycles_max;
        if cycles > cycles_max {
            return (next.between(last, (cycles_max - last.cycles) / block.cycles), Some(StopReason::RunOut));
        }
        if let Some(most) = self.delta_k_most().filter(|most| next.delta_k > *most && last.delta_k < *most) {
            let share = (most - last.delta_k) / (next.delta_k - last.delta_k);
            return (next.between(last, share), Some(StopReason::Toughness));
        }
        (next, block.end)
    }
}

impl CrackGrowth for TipField<'_> {
    fn open(&mut self) -> Result<()> {
        // What is read belongs to a length that differs from the one asked for by part of a spacing: that takes the slope of K.
        let drawn_back = self.state.drawn_back(PROBE_HORIZONS * self.plate.body.horizon());
        let changed = self.correct_flanks(&drawn_back, Stretch::All);
        self.settle(&changed)?;
        self.read_slopes();
        let mut cut = std::mem::take(&mut self.at_tips);
        let plate = self.plate.clone();
        cut.iter().for_each(|&bond| self.bonds.cut(&plate.body, bond));
        set_aside(&plate.body, &mut self.bonds, &cut);
        let lines = self.state.lines.clone();
        cut.extend(self.correct_flanks(&lines, Stretch::All));
        self.settle(&cut)?;
        self.read_factors();
        if let Some(tip) = self.state.tips.iter().find(|tip| !tip.equivalent().is_finite()) {
            let [x, y] = self.position(tip).map(|metres| metres / MM);
            let problem = format!("{}: no stress intensity can be read at the crack tip at ({x:.4}, {y:.4}) mm", self.case.name);
            return Err(Error::Mechanics(format!("{problem}; give a smaller model.spacing_mm")));
        }
        self.curve = vec![self.row(0.0, self.equilibrium.work(), 0)];
        self.anew = 1;
        Ok(())
    }

    fn advance(&mut self) -> Result<Option<StopReason>> {
        if let Some(reason) = self.reason_to_stop() {
            return Ok(Some(reason));
        }
        let until = self.end.map_or(f64::INFINITY, |end| end.crack_length);
        let block = self.block(self.last().cycles, until);
        let (next, reason) = self.after(&block);
        if block.cut > 0 || block.cycles > 0.0 {
            self.curve.push(next);
        }
        Ok(reason)
    }

    fn now(&self) -> Now<'_> {
        let CurvePoint { cycles, crack_length, delta_k, ref tips, .. } = *self.last();
        Now { cycles, cycles_of_run: cycles, crack_length, delta_k, tips, is_counting: true, is_settled: true }
    }

    fn plate(&self) -> Option<Arc<Plate>> {
        Some(self.plate.clone())
    }

    fn fields(&mut self) -> Result<Option<Fields>> {
        Ok(Some(self.plate.fields(&self.bonds, &self.displacement)))
    }

    fn law(&self) -> Option<&dyn GrowthLaw> {
        Some(&*self.law)
    }

    fn is_due(&self) -> bool {
        self.curve.len() >= self.anew + BLOCKS_ANEW
    }

    fn begin_anew(&mut self) -> Result<()> {
        self.anew = self.curve.len();
        self.equilibrium = balance(self.case, &self.plate, &self.bonds);
        self.settle(&[])
    }

    fn state(&self) -> State {
        State::Tips(TipsState {
            growth: self.state.clone(),
            broken: self.bonds.broken(&self.plate.body),
            scaled: self.bonds.scaled(&self.plate.body),
            displacement: self.displacement.clone(),
            curve: self.curve.clone(),
            effort: self.effort(),
        })
    }

    fn restore(&mut self, state: State) -> Result<bool> {
        let State::Tips(TipsState { growth, broken, scaled, displacement, curve, effort }) = state else { return Ok(false) };
        let plate = self.plate.clone();
        let places = plate.body.multiplier.len();
        let fits = growth.fits(&self.state)
            && !curve.is_empty()
            && broken.iter().chain(scaled.iter().map(|(bond, _)| bond)).all(|&bond| (bond as usize) < places);
        if !fits {
            return Ok(false);
        }
        broken.iter().chain(&self.at_tips).for_each(|&bond| self.bonds.cut(&plate.body, bond));
        scaled.iter().for_each(|&(bond, multiplier)| self.bonds.set(&plate.body, bond, multiplier));
        (self.state, self.displacement, self.curve) = (growth, displacement, curve);
        (self.solves, self.iterations) = (effort.solves, effort.iterations);
        Ok(self.begin_anew().is_ok())
    }

    fn close(&mut self, stop: StopReason) -> Result<StopReason> {
        Ok(stop)
    }

    fn curve(&mut self) -> (Vec<CurvePoint>, f64) {
        (std::mem::take(&mut self.curve), 0.0)
    }

    fn effort(&self) -> Effort {
        let points_solved = self.equilibrium.points(&self.plate.body);
        Effort { points_solved, solves: self.solves, iterations: self.iterations, solver: Some(self.equilibrium.used()) }
    }

    fn cross_check(&self, cycles: f64) -> Option<CrossCheck> {
        self.state.balance.check(cycles)
    }

    fn warnings(&self) -> Vec<String> {
        self.warnings.iter().cloned().chain(self.contact_warning()).collect()
    }
}
