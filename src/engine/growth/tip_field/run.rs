//! The rows of a run by K of its tips, and where it ends between two of them.

use std::sync::Arc;

use super::contact::Contact;
use super::{PROBE_HORIZONS, Tip, TipField, TipsState, solver};
use crate::body::balanced::flanks::FlankRange;
use crate::body::pre_crack::bonds_across;
use crate::body::{Body, Bond};
use crate::error::{Error, Result};
use crate::fatigue::ZONE_RADIUS_HORIZONS;
use crate::fatigue::crack_tip::TipState;
use crate::fatigue::growth_law::GrowthLaw;
use crate::fatigue::pieces::remove_fragments;
use crate::growth::cross_check::CrossCheck;
use crate::growth::plate;
use crate::growth::record::{CurvePoint, TipRecord};
use crate::growth::{CrackGrowth, Fields, GrowthStatus, SolverStatistics, State};
use crate::specimen::geometry::meeting_share;
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
    pub(super) fn row(&self, cycles: f64, work: f64, broken_bonds: usize) -> CurvePoint {
        let now = |tip: &Tip| TipRecord {
            state: if tip.state == TipState::Active && tip.is_closed { TipState::Closed } else { tip.state },
            position: self.position(tip),
            growth: tip.growth,
            factors: Some(tip.factors),
            t_stress: Some(tip.t_stress),
        };
        let tips = self.state.tips.iter().map(now).collect();
        let lead = self.fastest().map(|tip| &self.state.tips[tip]);
        let (tips, lead) = ((tips, &self.state.lines[..]), lead.map(|tip| (tip.equivalent(), tip.rate)));
        CurvePoint::of_tips(self.case, [cycles, work], broken_bonds, tips, lead)
    }

    /// Lets the bonds ahead of all active tips lose remaining life λ up to where the tips are now; broken bonds are left out.
    ///
    /// The law of a bond, `dλ/dN = -A ε^p`, makes a tip grow steadily at `da/dN = β A δ^(1-p/2) (K_eq/E')^p`
    /// ([`crate::fatigue::rate_constant`]): on the length ℓ of the fatigue zone ahead of the tip a bond that the line crosses loses its whole
    /// remaining life. Here the rate is known from K, so that these bonds lose it at `dλ/dN = -(da/dN)/ℓ`: λ is 1 where the line crosses
    /// them ℓ ahead of the tip and falls linearly to 0 at the tip. Remaining life never rises: bonds beside a crack that has turned away
    /// keep what they have left.
    pub(super) fn update_remaining_life(&mut self) {
        let body = &self.body;
        let length = ZONE_RADIUS_HORIZONS * body.horizon();
        let ahead = |tip: &Tip| {
            let (from, [x, y]) = (self.position(tip), self.heading(tip.end));
            let to = [from[0] + length * x, from[1] + length * y];
            let life = move |bond: Bond| {
                let (_, a, b) = body.ends(bond);
                let fraction = meeting_share(from, to, body.lattice.position(a), body.lattice.position(b))?;
                Some((bond, fraction.clamp(0.0, 1.0)))
            };
            bonds_across(body, from, to).into_iter().filter_map(life).collect::<Vec<_>>()
        };
        let new = self.state.tips.iter().filter(|tip| tip.state == TipState::Active).flat_map(ahead);
        let mut lives: Vec<(Bond, f64)> = self.state.remaining_life.iter().copied().chain(new).collect();
        lives.retain(|&(bond, _)| self.bonds.is_intact(bond));
        // Of equal bonds the least life comes first and stays.
        lives.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        lives.dedup_by_key(|(bond, _)| *bond);
        self.state.remaining_life = lives;
    }
}

impl CrackGrowth for TipField<'_> {
    fn open(&mut self) -> Result<()> {
        // What is read belongs to a length that differs from the one asked for by part of a spacing: that takes the slope of K.
        let drawn_back = self.state.drawn_back(PROBE_HORIZONS * self.body.horizon());
        let changed = self.correct_flanks(&drawn_back, FlankRange::All);
        self.settle(&changed, &drawn_back)?;
        self.read_slopes();
        let mut cut = std::mem::take(&mut self.at_tips);
        cut.iter().for_each(|&bond| self.bonds.cut(&self.body, bond));
        remove_fragments(&self.body, &mut self.bonds, &cut);
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

    fn body(&self) -> Option<Arc<Body>> {
        Some(self.body.clone())
    }

    fn fields(&mut self) -> Result<Option<Fields>> {
        let share = self.load_share();
        let displacement: Vec<f64> = self.displacement.iter().map(|u| share * u).collect();
        Ok(Some(plate::fields(&self.body, &self.bonds, &displacement, &self.state.remaining_life)))
    }

    fn law(&self) -> Option<&dyn GrowthLaw> {
        Some(&*self.law)
    }

    fn should_rebuild_solver(&self) -> bool {
        self.curve.len() >= self.rows_at_rebuild + INCREMENTS_PER_SOLVER
    }

    fn rebuild_solver(&mut self) -> Result<()> {
        self.rows_at_rebuild = self.curve.len();
        self.equilibrium = solver(self.case, &self.body, &self.bonds);
        let lines = self.state.lines.clone();
        self.settle(&[], &lines)
    }

    fn state(&self) -> State {
        State::Tips(TipsState {
            growth: self.state.clone(),
            broken: self.bonds.broken(&self.body),
            scaled: self.bonds.scaled(&self.body),
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
        let places = self.body.multiplier.len();
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
        broken.iter().chain(&self.at_tips).for_each(|&bond| self.bonds.cut(&self.body, bond));
        scaled.iter().for_each(|&(bond, multiplier)| self.bonds.set(&self.body, bond, multiplier));
        (self.state, self.displacement, self.curve) = (growth, displacement, curve);
        self.contact = Contact::resumed(closed);
        (self.solves, self.iterations) = (statistics.solves, statistics.iterations);
        Ok(self.rebuild_solver().is_ok())
    }

    fn curve(&mut self) -> (Vec<CurvePoint>, f64) {
        (std::mem::take(&mut self.curve), 0.0)
    }

    fn statistics(&self) -> SolverStatistics {
        let points_solved = self.equilibrium.points(&self.body);
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
