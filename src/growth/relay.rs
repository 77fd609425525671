//! A run of two drivers, one after the other: one curve, cycles, growth and broken bonds counted on from N = 0.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::cross_check::CrossCheck;
use super::record::{CurvePoint, StopReason, TipRecord};
use super::{CrackGrowth, Fields, GrowthStatus, SolverStatistics, State};
use perilife_base::error::Result;
use perilife_laws::growth_law::GrowthLaw;
use perilife_laws::retardation::Underway;
use perilife_points::body::Body;

/// What ends a step of the first driver other than the next one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Turn {
    HandOver,
    Stop(StopReason),
}

/// How one driver hands a plate over to another.
pub trait HandOver {
    type First: CrackGrowth;
    type Second: CrackGrowth;

    /// The next row of the first driver.
    /// Errors: mechanics that fail.
    fn step(&self, first: &mut Self::First) -> Result<Option<Turn>>;

    /// The second driver from a row on, before its first equilibrium; `None` where it was begun before.
    /// Errors: a plate that it cannot take.
    fn second(&mut self, first: &Self::First, last: &CurvePoint) -> Result<Option<Self::Second>>;

    /// Takes the rows of an earlier run up to its hand-over; whether they are of this plate.
    fn take(&self, first: &mut Self::First, rows: &[CurvePoint]) -> Result<bool>;

    /// A row of the second driver as one of the whole run.
    fn completed(&self, _first: &Self::First, row: CurvePoint) -> CurvePoint {
        row
    }

    /// What the user should know of the row of the hand-over, or of a run without one.
    fn note(&self, first: &Self::First, start: Option<&CurvePoint>) -> Option<String>;
}

/// [`CrackGrowth`] by two drivers.
pub struct Relay<H: HandOver> {
    first: H::First,
    how: H,
    then: Option<Then<H::Second>>,
}

/// The run from the hand-over on.
struct Then<G> {
    growth: G,
    /// The rows up to there, but the last.
    before: Vec<CurvePoint>,
    /// The last of them, at which the second driver begins.
    start: CurvePoint,
    /// What the run took until then.
    took: SolverStatistics,
    /// The tips of the last row, which count their growth from N = 0.
    now: Vec<TipRecord>,
}

/// State of a run that was handed over.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct HandedOver {
    pub before: Vec<CurvePoint>,
    /// What the run took until then.
    pub took: SolverStatistics,
    pub tips: Box<State>,
}

impl<G: CrackGrowth> Then<G> {
    /// Takes in where the tips are.
    fn look(&mut self) {
        self.now = since_start(self.growth.now().tips, &self.start);
    }
}

/// Tips whose growth counts from the row of the hand-over, with the growth before.
fn since_start(tips: &[TipRecord], start: &CurvePoint) -> Vec<TipRecord> {
    tips.iter().zip(&start.tips).map(|(tip, before)| TipRecord { growth: before.growth + tip.growth, ..*tip }).collect()
}

impl<H: HandOver> Relay<H> {
    pub fn new(first: H::First, how: H) -> Self {
        Relay { first, how, then: None }
    }

    /// The next step of the first driver, or the next `increment` of the second; the reason why there is no next one.
    /// Errors: those of the first driver, or no first row of the second.
    pub fn advance(&mut self, increment: impl FnOnce(&mut H::Second) -> Option<StopReason>) -> Result<Option<StopReason>> {
        if let Some(then) = &mut self.then {
            let reason = increment(&mut then.growth);
            then.look();
            return Ok(reason);
        }
        match self.how.step(&mut self.first)? {
            Some(Turn::Stop(reason)) => return Ok(Some(reason)),
            Some(Turn::HandOver) => {
                let (before, took) = (self.first.curve(), self.first.statistics());
                if let Some(mut then) = self.after(before, took)? {
                    then.growth.open()?;
                    then.look();
                    self.then = Some(then);
                }
            }
            None => {}
        }
        Ok(None)
    }

    /// The run from the last of some rows on, before its first equilibrium; `None` where it was begun before, or there are no rows.
    fn after(&mut self, mut before: Vec<CurvePoint>, took: SolverStatistics) -> Result<Option<Then<H::Second>>> {
        let Some(start) = before.pop() else { return Ok(None) };
        let then = self.how.second(&self.first, &start)?;
        Ok(then.map(|growth| Then { growth, before, now: start.tips.clone(), start, took }))
    }

    fn now_growing(&self) -> &dyn CrackGrowth {
        self.then.as_ref().map_or(&self.first, |then| &then.growth)
    }

    fn growing(&mut self) -> &mut dyn CrackGrowth {
        match &mut self.then {
            Some(then) => &mut then.growth,
            None => &mut self.first,
        }
    }
}

impl<H: HandOver> CrackGrowth for Relay<H> {
    fn open(&mut self) -> Result<()> {
        self.first.open()
    }

    fn now(&self) -> GrowthStatus<'_> {
        let now = self.now_growing().now();
        match &self.then {
            Some(then) => GrowthStatus { cycles: then.start.cycles + now.cycles, tips: &then.now, ..now },
            None => now,
        }
    }

    /// All rows. The row of the hand-over is that which knows K of its tips.
    fn curve(&mut self) -> Vec<CurvePoint> {
        let Some(then) = &mut self.then else { return self.first.curve() };
        let (mut curve, start) = (std::mem::take(&mut then.before), &then.start);
        curve.extend(then.growth.curve().into_iter().map(|row| {
            let row = CurvePoint {
                cycles: start.cycles + row.cycles,
                broken_bonds: start.broken_bonds + row.broken_bonds,
                tips: since_start(&row.tips, start),
                ..row
            };
            self.how.completed(&self.first, row)
        }));
        curve
    }

    fn state(&self) -> State {
        let Some(then) = &self.then else { return self.first.state() };
        let before = then.before.iter().chain([&then.start]).cloned().collect();
        State::HandedOver(HandedOver { before, took: then.took, tips: Box::new(then.growth.state()) })
    }

    fn restore(&mut self, state: State) -> Result<bool> {
        let HandedOver { before, took, tips } = match state {
            State::HandedOver(handed_over) => handed_over,
            state => return self.first.restore(state),
        };
        if !self.how.take(&mut self.first, &before)? {
            return Ok(false);
        }
        let Some(mut then) = self.after(before, took)? else { return Ok(false) };
        let fits = then.growth.restore(*tips)?;
        if fits {
            then.look();
            self.then = Some(then);
        }
        Ok(fits)
    }

    fn body(&self) -> Option<Arc<Body>> {
        self.now_growing().body()
    }

    fn fields(&mut self) -> Result<Option<Fields>> {
        self.growing().fields()
    }

    fn law(&self) -> Option<&dyn GrowthLaw> {
        self.now_growing().law()
    }

    fn should_rebuild_solver(&self) -> bool {
        self.now_growing().should_rebuild_solver()
    }

    fn rebuild_solver(&mut self) -> Result<()> {
        self.growing().rebuild_solver()
    }

    fn close(&mut self, stop: StopReason) -> Result<StopReason> {
        self.growing().close(stop)
    }

    fn statistics(&self) -> SolverStatistics {
        let (now, took) = (self.now_growing().statistics(), self.then.as_ref().map(|then| then.took).unwrap_or_default());
        SolverStatistics { solves: took.solves + now.solves, iterations: took.iterations + now.iterations, ..now }
    }

    fn overload(&self) -> Option<Underway> {
        self.first.overload()
    }

    fn cross_check(&self, cycles: f64) -> Option<CrossCheck> {
        self.now_growing().cross_check(cycles - self.then.as_ref().map_or(0.0, |then| then.start.cycles))
    }

    fn warnings(&self) -> Vec<String> {
        let note = self.how.note(&self.first, self.then.as_ref().map(|then| &then.start));
        self.now_growing().warnings().into_iter().chain(note).collect()
    }
}
