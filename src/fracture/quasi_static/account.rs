//! Energies of a scene without time, and its rows.
//!
//! Work between two states of equilibrium by the trapezoidal rule, `½ (R + R')·Δū + ½ (f + f')·Δu`: on a ray of elastic loading
//! it is exact. What is neither strain nor fracture energy has become motion that a scene without time does not follow: the
//! excess over a jump.

use serde::{Deserialize, Serialize};

use super::super::bonds::BondState;
use super::super::boundary::Boundary;
use super::super::checkpoint::Place;
use super::super::course::Course;
use super::super::interaction::Driven;
use super::super::log::Log;
use super::super::outcome::HistoryRow;
use super::full_load::FullLoad;
use crate::error::Result;

/// A state of equilibrium.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct State {
    /// Share of the full load.
    pub level: f64,
    /// Work of the held unknowns per share of the full load, J.
    driven: f64,
    /// Work that the forces of full load would do over its displacement, J.
    pushed: f64,
    /// Strain energy, J.
    pub strain: f64,
}

impl State {
    /// The state with this displacement, forces of the bonds and strain energy.
    pub fn new(full: &FullLoad, level: f64, u: &[f64], force: &[f64], strain: f64) -> Self {
        let [driven, pushed] = full.works(u, force);
        State { level, driven, pushed, strain }
    }

    /// The same with the forces of rigid bodies that the interaction moves by itself.
    pub fn with_driven(mut self, driven: Option<Driven>) -> Self {
        self.driven += driven.map_or(0.0, |driven| driven.rate);
        self
    }

    /// The state on the ray to this one of full load.
    pub fn at(self, level: f64) -> Self {
        State { level, driven: level * self.driven, pushed: level * self.pushed, strain: level * level * self.strain }
    }
}

/// Sums of a run.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Account {
    /// Where the run is.
    pub state: State,
    /// Work so far, J.
    pub work: f64,
    /// Energy taken by damage, J.
    pub fracture: f64,
    /// Rows so far.
    pub rows: usize,
    /// Largest work so far, J.
    largest: f64,
}

impl Account {
    /// Goes on to another state of equilibrium.
    pub fn go(&mut self, to: State) {
        let from = std::mem::replace(&mut self.state, to);
        let driven = 0.5 * (from.driven + to.driven) * (to.level - from.level);
        let pushed = 0.5 * (from.level + to.level) * (to.pushed - from.pushed);
        self.work += driven + pushed;
        self.largest = self.largest.max(self.work);
    }

    /// Work that is neither strain nor fracture energy, over the largest work.
    pub fn excess(&self) -> f64 {
        let nowhere = self.work - self.state.strain - self.fracture;
        if self.largest > 0.0 { nowhere / self.largest } else { 0.0 }
    }

    /// Whether the strain energy is not finite, or exceeds so many times all the work there ever was.
    pub fn is_impossible(&self, times: f64) -> bool {
        self.state.strain.is_nan() || self.state.strain > times * self.largest
    }

    /// Takes down a row with this displacement and forces of the bonds.
    pub fn row(
        &mut self,
        to: &mut Recorder<'_, '_>,
        u: &[f64],
        force: &[f64],
        driven: Option<Driven>,
        bonds: &BondState,
    ) -> Result<()> {
        self.rows += 1;
        let of_points = || to.boundary.measure(to.unknowns, self.state.level, u, force);
        let (displacement, load) = driven.map_or_else(of_points, |driven| (driven.displacement, driven.load));
        let row = HistoryRow {
            step: self.rows,
            displacement,
            load,
            strain: self.state.strain,
            fracture: self.fracture,
            work: self.work,
            ..HistoryRow::default()
        };
        to.log.row(row, u, bonds);
        to.course.step_done(self.state.level)
    }
}

/// Where rows go.
pub struct Recorder<'r, 'n> {
    /// Log of the run.
    pub log: &'r mut Log<'n>,
    /// Hears of every row.
    pub course: Course<'r>,
    /// Loads whose displacement and force a row holds.
    pub boundary: &'r Boundary,
    /// Unknowns of a point.
    pub unknowns: usize,
}

impl Recorder<'_, '_> {
    /// Puts log and bonds where the run is taken up (`Course::take_up`).
    ///
    /// # Errors
    /// A checkpoint of another plate.
    pub fn take_up(&mut self, bonds: &mut BondState) -> Result<Option<Place>> {
        self.course.take_up(self.log, bonds)
    }

    /// Offers what it takes to go on from here.
    pub fn may_keep(&self, bonds: &BondState, place: &dyn Fn() -> Place) {
        self.course.may_keep(self.log, bonds, place);
    }
}
