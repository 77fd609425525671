//! The rows of a run on a plate of nodes, and from where it can be resumed.

use serde::{Deserialize, Serialize};

use super::ElementFree;
use super::front::Front;
use crate::element_free::solve::{raster, raster_fields};
use crate::error::{Error, Result};
use crate::fatigue::crack_tip::TipState;
use crate::fatigue::growth_law::GrowthLaw;
use crate::growth::cross_check::{CrossCheck, EnergyBalance};
use crate::growth::record::{CurvePoint, TipRecord};
use crate::growth::{CrackGrowth, Fields, GrowthStatus, SolverStatistics, State};
use crate::levels::PointGrid;
use crate::solver::SolverUsed;
use crate::specimen::CrackLine;

/// Rows after which a run can be resumed. Nothing is built anew for that.
const ROWS_PER_CHECKPOINT: usize = 8;

/// All that an increment depends on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Fronts {
    /// Cracks.
    pub lines: Vec<CrackLine>,
    /// Their tips.
    pub fronts: Vec<Front>,
    /// Growth of the fastest tip in the next increment at the most, m.
    pub step: f64,
    /// K against the energy that the plate releases.
    pub balance: EnergyBalance,
    /// How much finer nodes are than usual, as K of the initial tips asks.
    pub fineness: f64,
}

/// State of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FrontsState {
    state: Fronts,
    past: Option<[f64; 2]>,
    work: f64,
    curve: Vec<CurvePoint>,
    figures: [usize; 2],
    warnings: Vec<String>,
}

impl ElementFree<'_> {
    /// The plate as it stands, as a row `cycles` after the last one; ΔK and da/dN are those of the fastest tip.
    pub(super) fn row(&self, cycles: f64, work: f64) -> CurvePoint {
        let now = |front: &Front| TipRecord {
            state: if front.state == TipState::Active && front.factors[0] < 0.0 { TipState::Closed } else { front.state },
            position: self.position(front),
            growth: front.growth,
            factors: Some(front.factors),
            t_stress: Some(front.t_stress),
        };
        let tips = self.state.fronts.iter().map(now).collect();
        let lead = self.fastest().map(|tip| &self.state.fronts[tip]);
        let cycles = self.curve.last().map_or(0.0, |row| row.cycles) + cycles;
        let (tips, lead) = ((tips, &self.state.lines[..]), lead.map(|front| (front.equivalent(), front.rate)));
        CurvePoint::of_tips(self.case, [cycles, work], 0, tips, lead)
    }
}

impl CrackGrowth for ElementFree<'_> {
    fn open(&mut self) -> Result<()> {
        self.choose_fineness().map_err(|error| match error {
            Error::LossOfStiffness => Error::Mechanics(format!("{}: the initial cracks cut the plate in two", self.case.name)),
            other => other,
        })?;
        self.aim();
        self.rate();
        self.state.step = self.first_step();
        self.curve = vec![self.row(0.0, self.load_work())];
        self.rows_at_checkpoint = 1;
        Ok(())
    }

    fn now(&self) -> GrowthStatus<'_> {
        let CurvePoint { cycles, crack_length, delta_k, ref tips, .. } = self.curve[self.curve.len() - 1];
        GrowthStatus { cycles, cycles_of_run: cycles, crack_length, delta_k, tips, is_counting: true }
    }

    fn curve(&mut self) -> (Vec<CurvePoint>, f64) {
        (std::mem::take(&mut self.curve), 0.0)
    }

    fn state(&self) -> State {
        State::Nodes(FrontsState {
            state: self.state.clone(),
            past: self.past,
            work: self.work,
            curve: self.curve.clone(),
            figures: [self.solves, self.nodes],
            warnings: self.warnings.clone(),
        })
    }

    fn restore(&mut self, state: State) -> Result<bool> {
        let State::Nodes(FrontsState { state, past, work, curve, figures, warnings }) = state else { return Ok(false) };
        let ends = |fronts: &[Front]| fronts.iter().map(|front| front.end).collect::<Vec<_>>();
        if curve.is_empty() || ends(&state.fronts) != ends(&self.state.fronts) || state.lines.len() != self.state.lines.len() {
            return Ok(false);
        }
        (self.state, self.past, self.work, self.curve, self.warnings) = (state, past, work, curve, warnings);
        [self.solves, self.nodes] = figures;
        self.rows_at_checkpoint = self.curve.len();
        Ok(true)
    }

    fn grid(&self) -> Option<PointGrid> {
        Some(raster(&self.case.specimen, self.resolution().far))
    }

    fn fields(&mut self) -> Result<Option<Fields>> {
        if self.plate.is_none() {
            // Of a resumed run: no solve of its increments.
            let solves = self.solves;
            self.settle()?;
            self.solves = solves;
        }
        let Some((plate, solution)) = &self.plate else { return Ok(None) };
        let share = self.case.loading.share(self.work);
        let (specimen, far) = (&self.case.specimen, self.resolution().far);
        let (displacement, stress) = raster_fields(specimen, plate, &solution.u, far, self.case.material.plane, share);
        Ok(Some(Fields { damage: vec![0.0; displacement.len()], remaining_life: Vec::new(), displacement, stress }))
    }

    fn law(&self) -> Option<&dyn GrowthLaw> {
        Some(&*self.law)
    }

    fn should_rebuild_solver(&self) -> bool {
        self.curve.len() >= self.rows_at_checkpoint + ROWS_PER_CHECKPOINT
    }

    fn rebuild_solver(&mut self) -> Result<()> {
        // Every equilibrium begins anew.
        self.rows_at_checkpoint = self.curve.len();
        Ok(())
    }

    fn statistics(&self) -> SolverStatistics {
        SolverStatistics { points_solved: self.nodes, solves: self.solves, iterations: 0, solver: Some(SolverUsed::Direct) }
    }

    fn cross_check(&self, cycles: f64) -> Option<CrossCheck> {
        self.state.balance.check(cycles)
    }

    fn warnings(&self) -> Vec<String> {
        self.warnings.clone()
    }
}
