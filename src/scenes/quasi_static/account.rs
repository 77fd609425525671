//! Loads of a scene without time, all of which grow in proportion, its energies, and its rows.
//!
//! Work between two states of equilibrium by the trapezoidal rule, `½ (R + R')·Δū + ½ (f + f')·Δu`: on a ray of elastic loading
//! it is exact. What is neither strain nor fracture energy has become motion that a scene without time does not follow: the
//! excess over a jump.

use serde::{Deserialize, Serialize};

use super::super::bonds::BondState;
use super::super::checkpoint::Course;
use super::super::contact::Touching;
use super::super::interaction::Driven;
use super::super::outcome::{HistoryRow, SceneEnd};
use super::equilibrium::FullLoad;
use perilife_base::error::Result;

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
    pub state: State,
    /// Work so far, J.
    pub work: f64,
    /// Energy taken by damage, J.
    pub fracture: f64,
    pub rows: usize,
    /// Largest work so far, J.
    pub largest: f64,
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

    /// Takes down a row with this displacement and forces of the bonds.
    pub fn row(
        &mut self,
        course: &mut Course<'_>,
        u: &[f64],
        force: &[f64],
        driven: Option<Driven>,
        bonds: &BondState,
    ) -> Result<()> {
        self.rows += 1;
        let of_points = || course.log.boundary.measure(course.log.net.unknowns, self.state.level, u, force);
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
        course.log.row(row, u, bonds);
        course.step_done(self.state.level)
    }
}

/// Where a procedure without time ended.
pub struct Walked {
    pub end: SceneEnd,
    /// Last displacement, m.
    pub u: Vec<f64>,
    pub account: Account,
    pub evaluations: usize,
    /// How flanks stand at the end, where they are kept apart.
    pub touching: Option<Touching>,
}
