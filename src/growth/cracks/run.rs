//! The rows of a run by K of its tips, and from where it can be resumed.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::tip::{CracksState, Tip};
use super::{CrackedPlate, Cracks};
use crate::cross_check::CrossCheck;
use crate::record::{CurvePoint, TipRecord};
use crate::{CrackGrowth, Fields, SolverStatistics};
use perilife_base::error::{Error, Result};
use perilife_base::raster::PointGrid;
use perilife_base::units::place_mm;
use perilife_laws::growth_law::GrowthLaw;
use perilife_points::body::Body;
use perilife_points::crack_tip::TipState;

/// All that the next increments depend on, with what the engine carries of its plate.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CracksRun<S> {
    cracks: CracksState,
    plate: S,
    curve: Vec<CurvePoint>,
    warnings: Vec<String>,
}

impl<P: CrackedPlate> Cracks<'_, P> {
    pub(super) fn last(&self) -> &CurvePoint {
        // `open` or `restore` makes the first row, before the first increment.
        &self.curve[self.curve.len() - 1]
    }

    /// Rows with an equilibrium of their own.
    fn rows_solved(&self) -> usize {
        self.curve.iter().filter(|row| row.is_solved).count()
    }

    /// The plate as it stands, as a row; ΔK and da/dN are those of the fastest tip.
    pub(super) fn row(&self, cycles: f64, work: f64, broken_bonds: usize) -> CurvePoint {
        let now = |tip: &Tip| TipRecord {
            state: if tip.is_active() && tip.is_closed { TipState::Closed } else { tip.state },
            position: self.state.position(tip),
            growth: tip.growth,
            factors: Some(tip.factors),
            t_stress: Some(tip.t_stress),
            response: tip.response,
            growth_rate: Some(if tip.is_growing() { tip.rate } else { 0.0 }),
        };
        let tips = self.state.tips.iter().map(now).collect();
        let lead = self.fastest().map(|tip| &self.state.tips[tip]);
        let (tips, now) = ((tips, &self.state.lines[..]), lead.map(|tip| (tip.equivalent(), tip.rate)));
        let row = CurvePoint::of_tips(self.case, [cycles, work], broken_bonds, tips, now);
        match lead.filter(|_| !work.is_nan()) {
            Some(lead) => row.with_response(lead.equivalent(), lead.response, &self.case.loading),
            None => row,
        }
    }

    /// Warning of tips whose K_eq is largest at a lower load.
    fn reversed_warning(&self) -> Option<String> {
        let is_reversed = |tip: &Tip| tip.response.at(1.0) < 1.0 - 1e-9 && tip.equivalent() > 0.0;
        let tips = self.state.tips.iter().enumerate().filter(|(_, tip)| is_reversed(tip));
        let tips = tips.map(|(index, _)| index.to_string()).collect::<Vec<_>>().join(", ");
        (!tips.is_empty()).then(|| format!("contact: tip {tips}: K_eq is largest at a lower load; K is that of this load"))
    }

    /// Warning of tips that the load closes.
    fn contact_warning(&self) -> Option<String> {
        let closed = self.state.tips.iter().enumerate().filter(|(_, tip)| tip.was_closed);
        let tips = closed.map(|(index, _)| index.to_string()).collect::<Vec<_>>().join(", ");
        (!tips.is_empty())
            .then(|| format!("contact: tip {tips} is closed by the load and does not grow; crack faces touch without friction"))
    }
}

impl<P: CrackedPlate> Cracks<'_, P> {
    /// All that the next increments depend on where the solver is built anew.
    pub fn run(&self) -> CracksRun<P::Saved> {
        let (cracks, plate) = (self.state.clone(), self.plate.save());
        CracksRun { cracks, plate, curve: self.curve.clone(), warnings: self.warnings.clone() }
    }

    /// Goes on from a run, in place of the first row; whether it is one of this plate.
    pub fn restore(&mut self, run: CracksRun<P::Saved>) -> bool {
        let CracksRun { cracks, plate, curve, warnings } = run;
        if curve.is_empty() || !cracks.fits(&self.state) || !self.plate.restore(plate) {
            return false;
        }
        (self.state, self.curve, self.warnings) = (cracks, curve, warnings);
        self.rebuild_solver().is_ok()
    }
}

impl<P: CrackedPlate> CrackGrowth for Cracks<'_, P> {
    fn open(&mut self) -> Result<()> {
        let name = &self.case.name;
        self.plate.open(self.case, &self.state).map_err(|error| match error {
            Error::LossOfStiffness => Error::Mechanics(format!("{name}: the initial cracks cut the plate in two")),
            other => other,
        })?;
        let readings = self.read()?;
        self.turn_by(&readings);
        self.set_rates_by(&readings);
        if let Some(tip) = self.state.tips.iter().find(|tip| !tip.equivalent().is_finite()) {
            let place = place_mm(self.state.position(tip));
            let problem = format!("{name}: no stress intensity can be read at the crack tip at {place}");
            return Err(Error::Mechanics(format!("{problem}; reduce model.spacing_mm")));
        }
        self.state.step = self.first_step(0.0);
        self.plate.update(&self.state);
        self.curve = vec![self.row(0.0, self.work(), 0)];
        self.rows_at_rebuild = 1;
        Ok(())
    }

    fn now(&self) -> &CurvePoint {
        self.last()
    }

    fn body(&self) -> Option<Arc<Body>> {
        self.plate.body()
    }

    fn grid(&self) -> Option<PointGrid> {
        self.plate.grid(self.case)
    }

    fn fields(&mut self) -> Result<Option<Fields>> {
        self.plate.fields(self.case, &self.state)
    }

    fn law(&self) -> Option<&dyn GrowthLaw> {
        Some(&*self.law)
    }

    fn should_rebuild_solver(&self) -> bool {
        self.rows_solved() >= self.rows_at_rebuild + self.scales.rows_per_checkpoint
    }

    fn rebuild_solver(&mut self) -> Result<()> {
        self.rows_at_rebuild = self.rows_solved();
        self.plate.rebuild(self.case, &self.state)
    }

    fn curve(&mut self) -> Vec<CurvePoint> {
        std::mem::take(&mut self.curve)
    }

    fn statistics(&self) -> SolverStatistics {
        SolverStatistics { step_error: self.state.step_error, ..self.plate.statistics() }
    }

    fn cross_check(&self, cycles: f64) -> Option<CrossCheck> {
        self.state.balance.check(cycles)
    }

    fn warnings(&self) -> Vec<String> {
        let of_contact = self.contact_warning().into_iter().chain(self.reversed_warning());
        self.plate.warnings().into_iter().chain(self.warnings.iter().cloned()).chain(of_contact).collect()
    }
}
