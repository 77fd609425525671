//! The equilibrium path of springs with damage, controlled by damage itself: load and displacement rise and fall as the path
//! asks.
//!
//! Every state on the path is exact equilibrium at the load where the next bond is damaged (`Control::next`). From there
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
//!
//! The solver remembers earlier states: its factor is that of one of them, and its conjugate gradients end within a tolerance that
//! shows it. After every so many states it begins anew from the bonds, whether anyone keeps the run or not, so that all that
//! follows depends on what a checkpoint holds.

use serde::{Deserialize, Serialize};

use super::super::bonds::BondState;
use super::super::checkpoint::{Course, of_another};
use super::super::failure::Failure;
use super::super::outcome::SceneEnd;
use super::account::{Account, State, Walked};
use super::control::Control;
use super::equilibrium::{Equilibrium, FullLoad, Kept, Shape};
use perilife_base::error::{Error, Result};
use perilife_plate::specimen::Crack;

/// States after which the solver begins anew. That takes one factorisation, as much as some twelve iterations, and a state takes
/// three to some hundred of them.
const STATES_PER_SOLVER: usize = 40;
/// Change of load over the peak, or of displacement over a nominal step, from which a state gets a row.
const ROW_LOAD: f64 = 0.01;
/// Broken bonds from which a state gets a row.
const ROW_BROKEN: usize = 10;

/// Load over the peak below which a plate without equilibrium is severed: what is left of it is no more than a hinge.
const SEVERED: f64 = 1e-3;

/// Growth of the largest damage in a step, τ, at the most.
const GROWTH: f64 = 0.04;
/// Change of damage at which a step is quiet.
const QUIET: f64 = 1e-3;
/// Solutions in a step after which τ is halved for the next; half of them, and it grows again.
const SOLUTIONS: usize = 12;
/// States after which a run ends.
const STATES_MAX: usize = 100_000;

/// Follows the path of a law of damage, not in its printed form, from rest to full load or until the plate is in two, or from where the
/// run is taken up; flanks of these cracks may touch. There is a row at least every so many-th of the full load, `steps`.
/// Errors: a run that was cancelled, no equilibrium at the start, a checkpoint of another run.
pub fn follow(
    cracks: &[Crack],
    full: &FullLoad,
    failure: &Failure,
    steps: usize,
    bonds: &mut BondState,
    course: &mut Course<'_>,
) -> Result<Walked> {
    let net = course.log.net;
    let mut equilibrium = Equilibrium::new(net, cracks, full)?;
    let size = full.held.len();
    let at = match course.take_up::<(Standing, Kept)>(bonds)? {
        None => {
            let mut shape = Shape::at_rest(size);
            equilibrium.solve(bonds, &mut shape)?;
            full.check_balance(net, &shape.force)?;
            Standing { shape, elastic: true, growth: GROWTH, ..Standing::default() }
        }
        Some((at, kept)) if at.shape.u.len() == size && at.shape.force.len() == size => {
            equilibrium.renew(&kept, bonds);
            at
        }
        Some(_) => return Err(of_another()),
    };
    let mut walk = Walk { full, steps: steps as f64, equilibrium, control: Control::new(net, failure), course, at };
    let end = walk.run(bonds)?;
    let Walk { equilibrium, at, .. } = walk;
    let spent = equilibrium.spent();
    tracing::info!(solves = spent.solves, iterations = spent.iterations, factorisations = spent.factorisations, "path");
    let level = at.account.state.level;
    Ok(Walked {
        end,
        u: at.shape.u.iter().map(|u| level * u).collect(),
        account: at.account,
        evaluations: spent.iterations + spent.solves,
        touching: Some(equilibrium.touching()),
    })
}

/// A path on its way.
struct Walk<'a, 'n> {
    full: &'a FullLoad,
    /// Nominal load steps.
    steps: f64,
    equilibrium: Equilibrium<'a>,
    control: Control<'a>,
    course: &'a mut Course<'n>,
    at: Standing,
}

/// Where a walk stands between two states: all that the next one depends on beside bonds and solver.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
struct Standing {
    shape: Shape,
    account: Account,
    states: usize,
    /// Whether the way to the next state is elastic.
    elastic: bool,
    /// Growth of the largest damage in the next step.
    growth: f64,
    broken: usize,
    broken_at_row: usize,
    load_at_row: f64,
    level_at_row: f64,
    load_peak: f64,
}

impl Walk<'_, '_> {
    /// Goes from state to state, up to the last.
    fn run(&mut self, bonds: &mut BondState) -> Result<SceneEnd> {
        while self.at.states < STATES_MAX {
            if let Some(end) = self.next_state(bonds)? {
                return Ok(end);
            }
            self.at.states += 1;
            if self.at.states.is_multiple_of(STATES_PER_SOLVER) {
                let kept = self.equilibrium.kept();
                self.equilibrium.renew(&kept, bonds);
                self.course.may_keep(bonds, || (&self.at, &kept));
            }
        }
        Ok(SceneEnd::NoConvergence)
    }

    /// Takes the present state to the next damage; why there is no next one.
    fn next_state(&mut self, bonds: &mut BondState) -> Result<Option<SceneEnd>> {
        self.control.look(&self.at.shape.u, bonds);
        let next = self.control.next(bonds);
        // On an elastic way no further than the next nominal step.
        let now = self.at.account.state.level;
        let nominal =
            if self.at.elastic { ((now * self.steps * (1.0 + 1e-12)).floor() + 1.0) / self.steps } else { f64::INFINITY };
        let level = next.level.min(nominal).min(1.0);
        self.at.account.go(self.state(level));
        self.row(level == nominal || level >= 1.0, bonds)?;
        let (torn, energy) = self.control.break_overlong(&self.at.shape.u, level, bonds);
        if torn == 0 && level >= 1.0 {
            return Ok(Some(SceneEnd::Done));
        }
        if torn == 0 && level < next.level {
            return Ok(None);
        }
        let found = if torn > 0 {
            self.tear(torn, energy, bonds)
        } else {
            let start = bonds.share.clone();
            if next.breaks { self.break_bonds(level, &start, bonds) } else { self.damage(&start, bonds) }
        };
        if found.is_err() {
            let is_severed = self.load() < SEVERED * self.at.load_peak;
            return Ok(Some(if is_severed { SceneEnd::Separated } else { SceneEnd::NoConvergence }));
        }
        self.at.elastic = torn > 0 || next.breaks;
        if self.at.elastic && self.course.log.boundary.is_separated(self.course.log.net, bonds) {
            self.row(true, bonds)?;
            return Ok(Some(SceneEnd::Separated));
        }
        Ok(None)
    }

    /// State on the ray of the present shape.
    fn state(&self, level: f64) -> State {
        State::new(self.full, 1.0, &self.at.shape.u, &self.at.shape.force, self.at.shape.strain).at(level)
    }

    /// Breaks the bonds whose limit is reached at this level, and goes to where their last force is gone.
    fn break_bonds(&mut self, level: f64, start: &[f64], bonds: &mut BondState) -> Result<()> {
        if self.at.broken == 0 {
            // The onset is the state in which the first bond breaks, and has a row.
            self.row(true, bonds)?;
        }
        let broken = self.control.break_at(level, bonds);
        self.at.account.fracture += self.control.taken(start, bonds, &self.at.shape.u, level);
        self.course.log.broke(self.at.account.rows + usize::from(self.at.broken > 0), broken.len());
        self.at.broken += broken.len();
        self.equilibrium.solve(bonds, &mut self.at.shape)?;
        let gone = self.control.level_of(&broken, &self.at.shape.u);
        self.at.account.go(self.state(if gone.is_finite() { gone.min(level) } else { level }));
        Ok(())
    }

    /// Goes on at the same displacement without bonds that slid apart.
    fn tear(&mut self, torn: usize, energy: f64, bonds: &mut BondState) -> Result<()> {
        self.at.account.fracture += energy;
        self.at.broken += torn;
        self.course.log.broke(self.at.account.rows + 1, torn);
        self.equilibrium.solve(bonds, &mut self.at.shape)?;
        self.at.account.go(self.state(self.at.account.state.level));
        Ok(())
    }

    /// Lets the largest damage grow by τ.
    fn damage(&mut self, start: &[f64], bonds: &mut BondState) -> Result<()> {
        for solution in 1.. {
            let level = self.control.level_of_growth(start, self.at.growth);
            let change = self.control.damage(start, level, bonds);
            let is_quiet = solution > 1 && change <= QUIET;
            if is_quiet || solution > 4 * SOLUTIONS {
                if !is_quiet || solution > SOLUTIONS {
                    self.at.growth *= 0.5;
                } else if 2 * solution <= SOLUTIONS {
                    self.at.growth = (2.0 * self.at.growth).min(GROWTH);
                }
            }
            self.equilibrium.solve(bonds, &mut self.at.shape)?;
            if is_quiet || solution > 4 * SOLUTIONS {
                self.at.account.fracture += self.control.taken(start, bonds, &self.at.shape.u, level);
                return Ok(());
            }
            self.control.look(&self.at.shape.u, bonds);
        }
        Err(Error::Mechanics("damage of a step did not converge".to_owned()))
    }

    /// Generalised load of the driven and the pushed together.
    fn load(&self) -> f64 {
        let State { level, strain, .. } = self.at.account.state;
        if level > 0.0 { 2.0 * strain / level } else { 0.0 }
    }

    /// A row for the present state if it differs enough from the last, or must have one.
    fn row(&mut self, must: bool, bonds: &BondState) -> Result<()> {
        let (level, load) = (self.at.account.state.level, self.load());
        self.at.load_peak = self.at.load_peak.max(load);
        let moved = (level - self.at.level_at_row).abs() * self.steps >= 0.5
            || (load - self.at.load_at_row).abs() >= ROW_LOAD * self.at.load_peak;
        let is_onset = self.at.broken > 0 && self.at.broken_at_row == 0;
        if !(must || moved || is_onset || self.at.broken >= self.at.broken_at_row + ROW_BROKEN) {
            return Ok(());
        }
        (self.at.broken_at_row, self.at.level_at_row, self.at.load_at_row) = (self.at.broken, level, load);
        let on_ray = |values: &[f64]| values.iter().map(|v| level * v).collect::<Vec<f64>>();
        let (u, force) = (on_ray(&self.at.shape.u), on_ray(&self.at.shape.force));
        self.at.account.row(self.course, &u, &force, None, bonds)
    }
}
