//! The rows of a run by K of its tips, and where it ends between two of them.

use std::sync::Arc;

use super::contact::Contact;
use super::{PROBE_HORIZONS, RING_HORIZONS_IN_LEVELS, Tip, TipField, TipsState, solver};
use crate::body::balanced::flanks::FlankRange;
use crate::error::{Error, Result};
use crate::fatigue::crack_tip::TipState;
use crate::fatigue::growth_law::GrowthLaw;
use crate::fatigue::pieces::remove_fragments;
use crate::growth::cross_check::CrossCheck;
use crate::growth::plate::Plate;
use crate::growth::record::{CurvePoint, StopReason, TipRecord};
use crate::growth::rows;
use crate::growth::{CrackGrowth, Fields, GrowthStatus, SolverStatistics, State};
use crate::units::MM;

/// Increments after which the solver is built anew from the bonds, so that a run can be resumed there. That takes as long as three to
/// four increments.
const INCREMENTS_PER_SOLVER: usize = 32;

impl TipField<'_> {
    pub(super) fn last(&self) -> &CurvePoint {
        // `open` or `restore` makes the first row, before the first increment.
        &self.curve[self.curve.len() - 1]
    }

    /// The plate as it stands, as a row; ΔK and da/dN are those of the fastest tip.
    fn row(&self, cycles: f64, work: f64, broken_bonds: usize) -> CurvePoint {
        let now = |tip: &Tip| TipRecord {
            state: if tip.state == TipState::Active && tip.is_closed { TipState::Closed } else { tip.state },
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

    /// Why there is no increment from the last row: a known end is reached, K_max of a tip is the toughness, no tip is left or grows, or
    /// one has come to the rim of the finest points.
    pub(super) fn reason_before(&self) -> Option<StopReason> {
        let states: Vec<TipState> = self.state.tips.iter().map(|tip| tip.state).collect();
        if let Some(reason) = rows::reason_to_stop(self.case, self.end, self.last(), &states, self.fastest().is_some()) {
            return Some(reason);
        }
        let active = || self.state.tips.iter().filter(|tip| tip.state == TipState::Active);
        let body = &self.plate.body;
        let reach = RING_HORIZONS_IN_LEVELS * body.horizon();
        active().any(|tip| body.is_near_rim(self.position(tip), reach)).then_some(StopReason::LeftRefinement)
    }

    /// The row after an increment of so many cycles, and the reason to stop: run-out and toughness end the run between two rows, `end`
    /// after this one.
    pub(super) fn row_after(
        &self,
        cycles: f64,
        work: f64,
        broken_bonds: usize,
        end: Option<StopReason>,
    ) -> (CurvePoint, Option<StopReason>) {
        let last = self.last();
        let next = self.row(last.cycles + cycles, work, last.broken_bonds + broken_bonds);
        rows::row_after(self.case, last, next, end)
    }
}

impl CrackGrowth for TipField<'_> {
    fn open(&mut self) -> Result<()> {
        // What is read belongs to a length that differs from the one asked for by part of a spacing: that takes the slope of K.
        let drawn_back = self.state.drawn_back(PROBE_HORIZONS * self.plate.body.horizon());
        let changed = self.correct_flanks(&drawn_back, FlankRange::All);
        self.settle(&changed, &drawn_back)?;
        self.read_slopes();
        let mut cut = std::mem::take(&mut self.at_tips);
        let plate = self.plate.clone();
        cut.iter().for_each(|&bond| self.bonds.cut(&plate.body, bond));
        remove_fragments(&plate.body, &mut self.bonds, &cut);
        let lines = self.state.lines.clone();
        cut.extend(self.correct_flanks(&lines, FlankRange::All));
        self.settle(&cut, &lines)?;
        self.read_fields();
        self.choose_directions();
        self.choose_rates();
        self.update_remaining_life();
        if let Some(tip) = self.state.tips.iter().find(|tip| !tip.equivalent().is_finite()) {
            let [x, y] = self.position(tip).map(|metres| metres / MM);
            let problem = format!("{}: no stress intensity can be read at the crack tip at ({x:.4}, {y:.4}) mm", self.case.name);
            return Err(Error::Mechanics(format!("{problem}; give a smaller model.spacing_mm")));
        }
        self.curve = vec![self.row(0.0, self.work(), 0)];
        self.rows_at_rebuild = 1;
        Ok(())
    }

    fn now(&self) -> GrowthStatus<'_> {
        let CurvePoint { cycles, crack_length, delta_k, ref tips, .. } = *self.last();
        GrowthStatus { cycles, cycles_of_run: cycles, crack_length, delta_k, tips, is_counting: true }
    }

    fn plate(&self) -> Option<Arc<Plate>> {
        Some(self.plate.clone())
    }

    fn fields(&mut self) -> Result<Option<Fields>> {
        let share = self.load_share();
        let displacement: Vec<f64> = self.displacement.iter().map(|u| share * u).collect();
        Ok(Some(self.plate.fields(&self.bonds, &displacement, &self.state.remaining_life)))
    }

    fn law(&self) -> Option<&dyn GrowthLaw> {
        Some(&*self.law)
    }

    fn should_rebuild_solver(&self) -> bool {
        self.curve.len() >= self.rows_at_rebuild + INCREMENTS_PER_SOLVER
    }

    fn rebuild_solver(&mut self) -> Result<()> {
        self.rows_at_rebuild = self.curve.len();
        self.equilibrium = solver(self.case, &self.plate, &self.bonds);
        let lines = self.state.lines.clone();
        self.settle(&[], &lines)
    }

    fn state(&self) -> State {
        State::Tips(TipsState {
            growth: self.state.clone(),
            broken: self.bonds.broken(&self.plate.body),
            scaled: self.bonds.scaled(&self.plate.body),
            closed: self.contact.closed_places().collect(),
            displacement: self.displacement.clone(),
            curve: self.curve.clone(),
            statistics: self.statistics(),
        })
    }

    fn restore(&mut self, state: State) -> Result<bool> {
        let State::Tips(TipsState { growth, broken, scaled, closed, displacement, curve, statistics }) = state else {
            return Ok(false);
        };
        let plate = self.plate.clone();
        let places = plate.body.multiplier.len();
        let fits = growth.fits(&self.state)
            && !curve.is_empty()
            && broken
                .iter()
                .chain(scaled.iter().map(|(bond, _)| bond))
                .chain(growth.remaining_life.iter().map(|(bond, _)| bond))
                .all(|&bond| (bond as usize) < places);
        if !fits {
            return Ok(false);
        }
        broken.iter().chain(&self.at_tips).for_each(|&bond| self.bonds.cut(&plate.body, bond));
        scaled.iter().for_each(|&(bond, multiplier)| self.bonds.set(&plate.body, bond, multiplier));
        (self.state, self.displacement, self.curve) = (growth, displacement, curve);
        self.contact = Contact::resumed(closed);
        (self.solves, self.iterations) = (statistics.solves, statistics.iterations);
        Ok(self.rebuild_solver().is_ok())
    }

    fn curve(&mut self) -> (Vec<CurvePoint>, f64) {
        (std::mem::take(&mut self.curve), 0.0)
    }

    fn statistics(&self) -> SolverStatistics {
        let points_solved = self.equilibrium.points(&self.plate.body);
        SolverStatistics {
            points_solved,
            solves: self.solves,
            iterations: self.iterations,
            solver: Some(self.equilibrium.used()),
        }
    }

    fn cross_check(&self, cycles: f64) -> Option<CrossCheck> {
        self.state.balance.check(cycles)
    }

    fn warnings(&self) -> Vec<String> {
        self.warnings.iter().cloned().chain(self.contact_warning()).collect()
    }
}
