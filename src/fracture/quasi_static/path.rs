//! The equilibrium path of springs with damage, controlled by damage itself: load and displacement rise and fall as the path
//! asks.
//!
//! Every state on the path is exact equilibrium at the load where the next bond is damaged ([`Control::next`]). From there
//!
//! - where bonds are damaged gradually, the largest damage grows by τ: `D(n+1)` from the law at the load of that growth, with
//!   the displacements of D(n+1), found by repeated secant solutions until no damage changes by more than a tolerance; τ is
//!   halved where that takes long and grown again where it does not;
//! - where a bond has come to the end of its curve, or its law knows no gradual damage, it breaks alone (with its mirror
//!   twins) while its stretch stays at the limit: the load dips to where its last force is gone.
//!
//! Bonds that parts sliding past each other stretch in truth but not in linear measures are torn where they stand.
//!
//! Of the usual controls (arc length, energy released, largest growth of damage) this one is explicit: the load follows from one
//! pass over the bonds, it exists for any damage and has one value, so there are no roots to choose between and a step never
//! fails to find the path.

use super::super::bonds::BondState;
use super::super::contact::Touching;
use super::super::failure::Failure;
use super::super::outcome::SceneEnd;
use super::super::pieces::is_separated;
use super::account::{Account, Recorder, State};
use super::control::Control;
use super::equilibrium::Equilibrium;
use super::full_load::FullLoad;
use crate::error::{Error, Result};
use crate::levels::Net;
use crate::levels::equilibrium::Shape;
use crate::specimen::Crack;

/// Settings of path following.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Growth of the largest damage in a step, τ, at the most.
    pub growth: f64,
    /// Change of damage at which a step is quiet.
    pub quiet: f64,
    /// Solutions in a step after which τ is halved for the next; half of them, and it grows again.
    pub solutions: usize,
    /// Steps after which a run ends.
    pub steps: usize,
}

impl Default for Settings {
    fn default() -> Self {
        Settings { growth: 0.04, quiet: 1e-3, solutions: 12, steps: 100_000 }
    }
}

/// Change of load over the peak, or of displacement over a nominal step, from which a state gets a row.
const ROW_LOAD: f64 = 0.01;
/// Broken bonds from which a state gets a row.
const ROW_BROKEN: usize = 10;

/// A path to follow.
pub struct Path<'a> {
    /// Points and bonds.
    pub net: &'a Net,
    /// Cracks of the start, whose flanks may touch.
    pub cracks: &'a [Crack],
    /// Loads.
    pub full: &'a FullLoad,
    /// Law of damage, not in its printed form.
    pub failure: &'a Failure,
    /// Nominal load steps: a row at least every so many-th of the full load.
    pub steps: usize,
    /// Settings.
    pub settings: Settings,
}

/// A path on its way.
struct Walk<'a, 'r, 'n> {
    path: &'a Path<'a>,
    equilibrium: Equilibrium<'a>,
    control: Control<'a>,
    shape: Shape,
    account: Account,
    recorder: Recorder<'r, 'n>,
    broken_at_row: usize,
    broken: usize,
    load_at_row: f64,
    level_at_row: f64,
    load_peak: f64,
    growth: f64,
}

/// Where a path ended.
pub struct Walked {
    /// Why.
    pub end: SceneEnd,
    /// Last displacement, m.
    pub u: Vec<f64>,
    /// Energies.
    pub account: Account,
    /// Evaluations of the forces.
    pub evaluations: usize,
    /// How flanks stand at the end, where they are kept apart.
    pub touching: Option<Touching>,
}

impl Path<'_> {
    /// Follows the path from rest to full load, or until the plate is in two.
    ///
    /// # Errors
    /// A run that was cancelled, no equilibrium at the start.
    pub fn follow(&self, bonds: &mut BondState, recorder: Recorder<'_, '_>) -> Result<Walked> {
        let size = self.full.held.len();
        let mut walk = Walk {
            path: self,
            equilibrium: Equilibrium::new(self.net, self.cracks, self.full)?,
            control: Control::new(self.net, self.failure),
            shape: Shape::at_rest(size),
            account: Account::default(),
            recorder,
            broken_at_row: 0,
            broken: 0,
            load_at_row: 0.0,
            level_at_row: 0.0,
            load_peak: 0.0,
            growth: self.settings.growth,
        };
        walk.equilibrium.solve(bonds, &mut walk.shape)?;
        self.full.check_balance(self.net, &walk.shape.force)?;
        let end = walk.run(bonds)?;
        let spent = walk.equilibrium.spent();
        tracing::info!(solves = spent.solves, iterations = spent.iterations, factorisations = spent.factorisations, "path");
        let (level, touching) = (walk.account.state.level, walk.equilibrium.touching());
        let u = walk.shape.u.iter().map(|u| level * u).collect();
        Ok(Walked { end, u, account: walk.account, evaluations: spent.iterations + spent.solves, touching: Some(touching) })
    }
}

impl Walk<'_, '_, '_> {
    fn run(&mut self, bonds: &mut BondState) -> Result<SceneEnd> {
        // Whether the way to the next state is elastic.
        let mut elastic = true;
        for _ in 0..self.path.settings.steps {
            self.control.look(&self.shape.u, bonds);
            let next = self.control.next(bonds);
            // On an elastic way no further than the next nominal step.
            let nominal = if elastic { self.nominal_level() } else { f64::INFINITY };
            let level = next.level.min(nominal).min(1.0);
            self.account.go(self.state(level));
            self.row(level == nominal || level >= 1.0, bonds)?;
            let (torn, energy) = self.control.break_overlong(&self.shape.u, level, bonds);
            if torn == 0 && level >= 1.0 {
                return Ok(SceneEnd::Done);
            }
            if torn == 0 && level < next.level {
                continue;
            }
            let found = if torn > 0 {
                self.tear(torn, energy, bonds)
            } else {
                let start = bonds.share.clone();
                if next.breaks { self.break_bonds(level, &start, bonds) } else { self.damage(&start, bonds) }
            };
            if found.is_err() {
                return Ok(SceneEnd::NoConvergence);
            }
            elastic = torn > 0 || next.breaks;
            if elastic && is_separated(self.path.net, self.recorder.boundary, bonds) {
                self.row(true, bonds)?;
                return Ok(SceneEnd::Separated);
            }
        }
        Ok(SceneEnd::NoConvergence)
    }

    /// State on the ray of the present shape.
    fn state(&self, level: f64) -> State {
        State::new(self.path.full, 1.0, &self.shape.u, &self.shape.force, self.shape.strain).at(level)
    }

    /// Breaks the bonds whose limit is reached at this level, and goes to where their last force is gone.
    fn break_bonds(&mut self, level: f64, start: &[f64], bonds: &mut BondState) -> Result<()> {
        if self.broken == 0 {
            // The onset is the state in which the first bond breaks, and has a row.
            self.row(true, bonds)?;
        }
        let broken = self.control.break_at(level, bonds);
        self.account.fracture += self.control.taken(start, bonds, &self.shape.u, level);
        self.recorder.log.broke(self.account.rows + usize::from(self.broken > 0), broken.len());
        self.broken += broken.len();
        self.equilibrium.solve(bonds, &mut self.shape)?;
        let gone = self.control.level_of(&broken, &self.shape.u);
        self.account.go(self.state(if gone.is_finite() { gone.min(level) } else { level }));
        Ok(())
    }

    /// Goes on at the same displacement without bonds that slid apart.
    fn tear(&mut self, torn: usize, energy: f64, bonds: &mut BondState) -> Result<()> {
        self.account.fracture += energy;
        self.broken += torn;
        self.recorder.log.broke(self.account.rows + 1, torn);
        self.equilibrium.solve(bonds, &mut self.shape)?;
        self.account.go(self.state(self.account.state.level));
        Ok(())
    }

    /// Lets the largest damage grow by τ.
    fn damage(&mut self, start: &[f64], bonds: &mut BondState) -> Result<()> {
        let Settings { growth, quiet, solutions, .. } = self.path.settings;
        for solution in 1.. {
            let level = self.control.level_of_growth(start, self.growth);
            let change = self.control.damage(start, level, bonds);
            let is_quiet = solution > 1 && change <= quiet;
            if is_quiet || solution > 4 * solutions {
                if !is_quiet || solution > solutions {
                    self.growth *= 0.5;
                } else if 2 * solution <= solutions {
                    self.growth = (2.0 * self.growth).min(growth);
                }
            }
            self.equilibrium.solve(bonds, &mut self.shape)?;
            if is_quiet || solution > 4 * solutions {
                self.account.fracture += self.control.taken(start, bonds, &self.shape.u, level);
                return Ok(());
            }
            self.control.look(&self.shape.u, bonds);
        }
        Err(Error::Mechanics("a step found no quiet damage".to_owned()))
    }

    /// The next nominal load step.
    fn nominal_level(&self) -> f64 {
        let steps = self.path.steps as f64;
        ((self.account.state.level * steps * (1.0 + 1e-12)).floor() + 1.0) / steps
    }

    /// A row for the present state if it differs enough from the last, or must have one.
    fn row(&mut self, must: bool, bonds: &BondState) -> Result<()> {
        let level = self.account.state.level;
        // Generalised load of the driven and the pushed together.
        let load = if level > 0.0 { 2.0 * self.account.state.strain / level } else { 0.0 };
        self.load_peak = self.load_peak.max(load);
        let moved = (level - self.level_at_row).abs() * self.path.steps as f64 >= 0.5
            || (load - self.load_at_row).abs() >= ROW_LOAD * self.load_peak;
        let is_onset = self.broken > 0 && self.broken_at_row == 0;
        if !(must || moved || is_onset || self.broken >= self.broken_at_row + ROW_BROKEN) {
            return Ok(());
        }
        (self.broken_at_row, self.level_at_row, self.load_at_row) = (self.broken, level, load);
        let on_ray = |values: &[f64]| values.iter().map(|v| level * v).collect::<Vec<f64>>();
        let (u, force) = (on_ray(&self.shape.u), on_ray(&self.shape.force));
        self.account.row(&mut self.recorder, &u, &force, None, bonds)
    }
}
