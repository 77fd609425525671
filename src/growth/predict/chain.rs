//! One life by stages that follow each other: cycles, growth and broken bonds are counted on from N = 0.

use std::cell::OnceCell;
use std::ops::{Deref, DerefMut};

use serde::{Deserialize, Serialize};

use super::initiation::{PhaseOne, phase_one};
use super::{increment, laws};
use crate::bond_strain::{BondStrain, BondStrainState, hand_over};
use crate::case::{Case, Engine};
use crate::cracks::CracksRun;
use crate::cross_check::CrossCheck;
use crate::hand_calculation::HandCalculation;
use crate::nodes::{ElementFree, NodeState};
use crate::part_through::{self, PartThroughGrowth};
use crate::points::{PointState, TipField};
use crate::record::{CurvePoint, DepthRecord, StopReason, TipRecord, Turn};
use crate::{CrackGrowth, SolverStatistics};
use perilife_base::error::Result;
use perilife_laws::retardation::Underway;

/// What drives the cracks for a part of a life.
pub enum Stage<'a> {
    /// Cracks that do not form within the cycles asked for, on the plate that has them.
    Forming(ElementFree<'a>, StopReason),
    /// K of a handbook.
    Formula(HandCalculation<'a>),
    /// K of a front that does not go through; then nodes.
    Front(PartThroughGrowth<'a>),
    /// Bonds that break by their own strain; of cracks from slots, then points.
    Bonds(BondStrain<'a>),
    /// K of tips on nodes.
    Nodes(ElementFree<'a>),
    /// K of tips on points and bonds.
    Points(TipField<'a>),
}

impl<'a> Stage<'a> {
    /// The one that a case asks for, before its first row.
    /// Errors: a plate that it cannot take, no law.
    fn of(case: &'a Case) -> Result<Self> {
        Ok(match case.engine() {
            Engine::Handbook => Stage::Formula(HandCalculation::start(case, laws::growth_law(case)?)?),
            Engine::PartThrough => Stage::Front(PartThroughGrowth::start(case, laws::growth_law(case)?, laws::order(case)?)?),
            Engine::Nodes => Stage::Nodes(ElementFree::start(case, laws::growth_law(case)?)?),
            Engine::Points => Stage::Points(TipField::start(case, laws::growth_law(case)?)?),
            Engine::Bonds | Engine::BondsThenPoints => {
                Stage::Bonds(BondStrain::start(case, |horizon| laws::bond_law(case, horizon))?)
            }
        })
    }

    /// Makes the next row; what ends the stage with it, or in its place.
    fn step(&mut self) -> Result<Option<Turn>> {
        Ok(match self {
            Stage::Forming(_, reason) => Some(Turn::Stop(*reason)),
            Stage::Formula(hand) => hand.next_interval()?.map(Turn::Stop),
            Stage::Front(front) => front.next_step()?,
            Stage::Bonds(bonds) => bonds.next_step()?,
            Stage::Nodes(cracks) => increment(cracks).map(Turn::Stop),
            Stage::Points(cracks) => increment(cracks).map(Turn::Stop),
        })
    }

    /// What the next increments depend on; those by formulas are never taken up in their midst.
    fn state(&self) -> Option<State> {
        match self {
            Stage::Bonds(bonds) => Some(State::Bonds(bonds.state())),
            Stage::Nodes(cracks) => Some(State::Nodes(cracks.run())),
            Stage::Points(cracks) => Some(State::Points(cracks.run())),
            _ => None,
        }
    }

    /// Goes on from a state, in place of its first row; whether it is one of this plate and law.
    fn restore(&mut self, state: State) -> Result<bool> {
        match (self, state) {
            (Stage::Bonds(bonds), State::Bonds(state)) => bonds.restore(state),
            (Stage::Nodes(cracks), State::Nodes(run)) => Ok(cracks.restore(run)),
            (Stage::Points(cracks), State::Points(run)) => Ok(cracks.restore(run)),
            _ => Ok(false),
        }
    }
}

impl<'a> Deref for Stage<'a> {
    type Target = dyn CrackGrowth + 'a;

    fn deref(&self) -> &Self::Target {
        match self {
            Stage::Forming(cracks, _) | Stage::Nodes(cracks) => cracks,
            Stage::Formula(hand) => hand,
            Stage::Front(front) => front,
            Stage::Bonds(bonds) => bonds,
            Stage::Points(cracks) => cracks,
        }
    }
}

impl DerefMut for Stage<'_> {
    fn deref_mut(&mut self) -> &mut Self::Target {
        match self {
            Stage::Forming(cracks, _) | Stage::Nodes(cracks) => cracks,
            Stage::Formula(hand) => hand,
            Stage::Front(front) => front,
            Stage::Bonds(bonds) => bonds,
            Stage::Points(cracks) => cracks,
        }
    }
}

/// State of a stage at a place where its solver is built anew.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
enum State {
    Bonds(BondStrainState),
    Nodes(CracksRun<NodeState>),
    Points(CracksRun<PointState>),
}

/// What the stages that are over leave to the one that runs.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
struct Before {
    /// Cycles until the cracks have formed.
    formed: f64,
    /// The rows of the others, with the one at which this stage begins.
    rows: Vec<CurvePoint>,
    took: SolverStatistics,
    /// Where the loads and the zone of the last overload are then.
    overload: Option<Underway>,
}

/// Where a life is taken up.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ChainState {
    before: Before,
    stage: Option<State>,
}

impl Before {
    fn cycles(&self) -> f64 {
        self.rows.last().map_or(self.formed, |row| row.cycles)
    }

    fn tips(&self, tips: &[TipRecord]) -> Vec<TipRecord> {
        let grown = |tip: usize| self.rows.last().and_then(|row| row.tips.get(tip)).map_or(0.0, |tip| tip.growth);
        tips.iter().enumerate().map(|(tip, now)| TipRecord { growth: grown(tip) + now.growth, ..*now }).collect()
    }

    /// A row of the stage as one of the life.
    fn row(&self, row: CurvePoint) -> CurvePoint {
        let start = self.rows.last();
        let through = || Some(DepthRecord { k_i: None, growth_rate: None, ..start?.depth? });
        CurvePoint {
            cycles: self.cycles() + row.cycles,
            broken_bonds: start.map_or(0, |start| start.broken_bonds) + row.broken_bonds,
            tips: self.tips(&row.tips),
            depth: row.depth.or_else(through),
            ..row
        }
    }
}

/// A life: the stage that runs, behind those that are over.
pub struct Chain<'a> {
    /// The case of the first stage, and of the one that follows it.
    case: &'a Case,
    later: &'a OnceCell<Case>,
    pub phase_one: Option<PhaseOne>,
    before: Before,
    pub(super) stage: Stage<'a>,
    /// The last row.
    now: CurvePoint,
}

impl<'a> Chain<'a> {
    /// A life before its first row; `first` and `later` get the cases of its stages, of which the first has the cycles that phase I leaves.
    /// Errors: no phase I of a case that asks for one; a plate that the first stage cannot take.
    pub fn start(case: &Case, first: &'a OnceCell<Case>, later: &'a OnceCell<Case>) -> Result<Self> {
        let phase_one = phase_one(case)?;
        let limit = case.stop.cycles_max;
        let formed = phase_one.and_then(|phase| phase.cycles).unwrap_or(0.0).min(limit);
        let first = first.get_or_init(|| {
            let mut first = case.clone();
            first.stop.cycles_max -= if formed < limit { formed } else { 0.0 };
            first
        });
        let stage = match phase_one.map(|phase| phase.cycles) {
            Some(None) => Stage::Forming(ElementFree::start(first, laws::growth_law(first)?)?, StopReason::NothingAges),
            Some(Some(_)) if formed >= limit => {
                Stage::Forming(ElementFree::start(first, laws::growth_law(first)?)?, StopReason::RunOut)
            }
            _ => Stage::of(first)?,
        };
        Ok(Chain { phase_one, before: Before { formed, ..Before::default() }, ..Chain::of(first, later, stage) })
    }

    /// A life of one stage at first.
    pub fn of(case: &'a Case, later: &'a OnceCell<Case>, stage: Stage<'a>) -> Self {
        Chain { case, later, phase_one: None, before: Before::default(), stage, now: CurvePoint::bare(0.0, f64::NAN, Vec::new()) }
    }

    /// Makes the first row: the plate with its initial cracks, in equilibrium.
    /// Errors: no equilibrium, or nothing can be read at a tip.
    pub fn open(&mut self) -> Result<()> {
        self.stage.open()?;
        self.look();
        Ok(())
    }

    /// Makes the next row, by the next stage where one is over; the reason why there is no next one.
    /// Errors: those of the stage.
    pub fn step(&mut self) -> Result<Option<StopReason>> {
        let reason = match self.stage.step()? {
            Some(Turn::Stop(reason)) => Some(reason),
            Some(Turn::HandOver) => self.hand_over().map(|()| None)?,
            None => None,
        };
        self.look();
        Ok(reason)
    }

    fn hand_over(&mut self) -> Result<()> {
        let (rows, took) = (self.curve(), self.statistics());
        let mut overload = if let Stage::Front(front) = &self.stage { front.overload() } else { None };
        overload.iter_mut().for_each(|at| at.cycles += self.before.formed);
        if let Some(mut stage) = self.next(rows.last())? {
            stage.open()?;
            (self.stage, self.before) = (stage, Before { rows, took, overload, ..self.before });
        }
        Ok(())
    }

    /// The stage from a row on, before its first equilibrium.
    fn next(&self, last: Option<&CurvePoint>) -> Result<Option<Stage<'a>>> {
        let Some(last) = last else { return Ok(None) };
        let mut next = match self.case.engine() {
            Engine::PartThrough => part_through::broken_through(self.case, last)?,
            Engine::BondsThenPoints => hand_over::cracked(self.case, &last.tips),
            _ => return Ok(None),
        };
        next.stop.cycles_max -= last.cycles - self.before.formed;
        Stage::of(self.later.get_or_init(|| next)).map(Some)
    }

    fn look(&mut self) {
        self.now = self.before.row(self.stage.now().clone());
    }

    /// The last row.
    pub fn now(&self) -> &CurvePoint {
        &self.now
    }

    /// All rows; handed over once. The row between two stages is that of the later one, which knows K of its tips.
    pub fn curve(&mut self) -> Vec<CurvePoint> {
        let own: Vec<CurvePoint> = self.stage.curve().into_iter().map(|row| self.before.row(row)).collect();
        let over = self.before.rows.len().saturating_sub(1);
        self.before.rows[..over].iter().cloned().chain(own).collect()
    }

    /// All that the next increments depend on where the solver is built anew.
    pub(super) fn state(&self) -> ChainState {
        ChainState { before: self.before.clone(), stage: self.stage.state() }
    }

    /// Goes on from a state of an earlier run, in place of [`Chain::open`]; whether it is one of this plate and law.
    /// Errors: those of the stage.
    pub(super) fn restore(&mut self, state: ChainState) -> Result<bool> {
        if let Some(stage) = self.next(state.before.rows.last())? {
            self.stage = stage;
        }
        self.before = state.before;
        let fits = state.stage.map_or(Ok(false), |stage| self.stage.restore(stage))?;
        if fits {
            self.look();
        }
        Ok(fits)
    }

    /// What the life took.
    pub fn statistics(&self) -> SolverStatistics {
        let (now, took) = (self.stage.statistics(), self.before.took);
        SolverStatistics { solves: took.solves + now.solves, iterations: took.iterations + now.iterations, ..now }
    }

    /// Where the loads and the zone of the last overload are after rows whose cycles are counted in the order of their spectrum.
    pub(super) fn overload(&self) -> Option<Underway> {
        self.before.overload
    }

    /// K of a life of so many `cycles` against an independent one, where it grew far enough for that.
    pub fn cross_check(&self, cycles: f64) -> Option<CrossCheck> {
        self.stage.cross_check(cycles - self.before.cycles())
    }

    /// What the user should know of its stages.
    pub fn warnings(&self) -> Vec<String> {
        let start = self.before.rows.last();
        let note = start.map(|row| if row.depth.is_some() { part_through::note(row) } else { hand_over::note(row) });
        self.stage.warnings().into_iter().chain(note).collect()
    }
}
