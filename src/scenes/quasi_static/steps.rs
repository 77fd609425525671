//! Load steps by dynamic relaxation, for any interaction.
//!
//! To rest, the displacement of the loads only rises, and where the curve snaps back the plate jumps. A step is taken back and halved when
//! it damages too much or finds no rest, down to a sixteenth of the nominal step, and grown again after calm ones. Where the smallest
//! step still breaks more, rows are taken down while bonds break at one load. Over a jump energy is released that no step can share
//! out: it is reported as excess.
//!
//! With a fixed number of relaxation iterations in a step ([`march`]) the plate follows the load in damped motion, and bonds are damaged in
//! every iteration.
//!
//! This is how many published examples are worked through (Kilic and Madenci 2010; Madenci and Oterkus 2014, chapter 7; source
//! 000): one iteration for every increment of displacement, so that "time steps" there count both. It follows a plate through
//! snap-back, since damping takes up what equilibrium cannot, and costs one evaluation of the forces an iteration. What it gives is
//! not equilibrium: load and onset depend on how fast the load grows against the swing, and approach the path of equilibrium
//! only as the increments shrink. Springs without platens only.

use serde::{Deserialize, Serialize};

use super::super::bonds::BondState;
use super::super::checkpoint::{Course, of_another};
use super::super::interaction::{Damaging, Interaction, Memory};
use super::super::outcome::SceneEnd;
use super::account::{Account, State, Walked};
use super::equilibrium::FullLoad;
use super::relaxation::{Loads, Relaxation, RestEnd, Rested, Swing, mobility};
use perilife_base::error::Result;

/// Smallest step over the nominal one.
const LEAST: f64 = 1.0 / 16.0;
/// Bonds that a step may break without being halved: about those of one point.
const BROKEN: usize = 28;
/// Growth of damage that a step may bring to a bond, one pass, without being halved.
const DAMAGED: f64 = 0.1;
/// Load of platens over its peak at which the body has failed.
const FAILED: f64 = 0.9;

/// Where a run stands after a row: all that its next steps depend on beside bonds and interaction.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
struct Standing {
    u: Vec<f64>,
    account: Account,
    /// The next load step, share of the full load.
    step: f64,
    evaluations: usize,
    /// Largest load of platens so far, N.
    peak: f64,
    /// Whether the last row was taken down while bonds went on breaking at one load.
    breaking: bool,
}

/// Works through load steps, from rest or from where the run is taken up.
/// Errors: a run that was cancelled, a checkpoint of another one.
pub fn follow(
    full: &FullLoad,
    steps: usize,
    relaxation: &Relaxation,
    interaction: &mut dyn Interaction,
    bonds: &mut BondState,
    course: &mut Course<'_>,
) -> Result<Walked> {
    let relaxation = &Relaxation { broken: BROKEN, ..*relaxation };
    let (nominal, size) = (1.0 / steps as f64, full.held.len());
    let mut at = match course.take_up::<(Standing, Memory)>(bonds)? {
        None => Standing { u: vec![0.0; size], step: nominal, ..Standing::default() },
        Some((at, memory)) if at.u.len() == size && interaction.restore(&memory, bonds) => at,
        Some(_) => return Err(of_another()),
    };
    let mut end = SceneEnd::Done;
    while at.breaking || at.account.state.level < 1.0 - 1e-12 {
        let from = at.account.state.level;
        let level = if at.breaking { from } else { (from + at.step).min(1.0) };
        let before = (at.u.clone(), bonds.clone());
        let rested = advance(full, from, level, relaxation, interaction, bonds, &mut at.u);
        at.evaluations += rested.evaluations;
        let failed = !matches!(rested.end, RestEnd::AtRest | RestEnd::Breaking);
        let reaction = rested.reaction;
        let too_much =
            rested.end == RestEnd::Breaking || reaction.broken > BROKEN || (reaction.broken == 0 && reaction.damaged > DAMAGED);
        if (failed || too_much) && !at.breaking && at.step > LEAST * nominal {
            (at.u, *bonds) = before;
            at.step *= 0.5;
            continue;
        }
        if failed {
            at.u = before.0;
            end = if rested.end == RestEnd::BlownUp { SceneEnd::Unstable } else { SceneEnd::NoConvergence };
            break;
        }
        at.account.fracture += reaction.released;
        course.log.broke(at.account.rows + 1, reaction.broken);
        at.breaking = rested.end == RestEnd::Breaking;
        let driven = interaction.driven();
        at.account.go(State::new(full, level, &at.u, &rested.force, reaction.strain).with_driven(driven));
        at.account.row(course, &at.u, &rested.force, driven, bonds)?;
        if course.log.is_separated() {
            end = SceneEnd::Separated;
            break;
        }
        // What is split between platens goes on touching them: its failure shows in the load.
        at.peak = driven.map_or(0.0, |driven| driven.load.max(at.peak));
        if driven.is_some_and(|driven| driven.load < FAILED * at.peak) {
            end = SceneEnd::LoadFallen;
            break;
        }
        if reaction.broken == 0 && 2.0 * reaction.damaged < DAMAGED {
            at.step = (2.0 * at.step).min(nominal);
        }
        course.may_keep(bonds, || (&at, interaction.memory()));
    }
    let Standing { u, account, evaluations, .. } = at;
    Ok(Walked { end, u, account, evaluations, touching: None })
}

/// Moves on from rest at one share of the full load to rest at another.
fn advance(
    full: &FullLoad,
    from: f64,
    to: f64,
    relaxation: &Relaxation,
    interaction: &mut dyn Interaction,
    bonds: &mut BondState,
    u: &mut [f64],
) -> Rested {
    interaction.load_to(to);
    // In proportion is the best guess there is without a solution.
    let ratio = if from > 0.0 { to / from } else { 0.0 };
    u.iter_mut().for_each(|u| *u *= ratio);
    let external = load_to(full, to, u);
    relaxation.relax(interaction, bonds, Loads { held: &full.held, external: &external }, u)
}

/// Puts the held unknowns where they are at a share of the full load; gives the forces on the others, N.
fn load_to(full: &FullLoad, level: f64, u: &mut [f64]) -> Vec<f64> {
    let held = u.iter_mut().zip(&full.motion).zip(&full.held).filter(|(_, held)| **held);
    held.for_each(|((u, motion), _)| *u = level * motion);
    full.external.iter().map(|force| level * force).collect()
}

/// Rows at the most; with more steps every so many-th is kept, and only there is separation looked for.
const ROWS: usize = 4000;
/// Strain energy over the largest work from which the motion counts as blown up: all energy comes from the loads.
const BLOWN_UP: f64 = 2.0;

/// Where a march stands after a row: all that its next steps depend on beside bonds and interaction.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct MarchStanding {
    step: usize,
    u: Vec<f64>,
    swing: Swing,
    account: Account,
    evaluations: usize,
}

/// Follows the load to its full value in so many steps of so many iterations of relaxation, or until the plate is in two, from rest or from where the run is taken up.
/// Errors: a run that was cancelled, a checkpoint of another one.
pub fn march(
    full: &FullLoad,
    [steps, iterations]: [usize; 2],
    interaction: &mut dyn Interaction,
    bonds: &mut BondState,
    course: &mut Course<'_>,
) -> Result<Walked> {
    let size = full.held.len();
    // Damage only softens the plate: what is stable for it whole stays so.
    let mobility = mobility(interaction, bonds, &full.held);
    let mut at = match course.take_up::<(MarchStanding, Memory)>(bonds)? {
        None => MarchStanding {
            step: 0,
            u: vec![0.0; size],
            swing: Swing::at_rest(size),
            account: Account::default(),
            evaluations: 0,
        },
        Some((at, memory)) if at.has(size) && interaction.restore(&memory, bonds) => at,
        Some(_) => return Err(of_another()),
    };
    let mut force = vec![0.0; size];
    let mut end = SceneEnd::Done;
    let stride = steps.div_ceil(ROWS);
    'march: for step in at.step + 1..=steps {
        let level = step as f64 / steps as f64;
        at.step = step;
        let external = load_to(full, level, &mut at.u);
        let loads = Loads { held: &full.held, external: &external };
        for _ in 0..iterations {
            let reaction = interaction.internal_force(&at.u, bonds, Damaging::Allowed, &mut force);
            at.account.fracture += reaction.released;
            course.log.broke(step, reaction.broken);
            at.account.go(State::new(full, level, &at.u, &force, reaction.strain));
            let sums = at.swing.take(loads, &mobility, &force);
            if at.account.state.strain.is_nan() || at.account.state.strain > BLOWN_UP * at.account.largest {
                end = SceneEnd::Unstable;
                break 'march;
            }
            at.swing.step(&mobility, (at.evaluations > 0).then(|| sums.damping()), &mut at.u);
            at.evaluations += 1;
        }
        if step % stride != 0 && step != steps {
            continue;
        }
        at.account.rows = step - 1;
        at.account.row(course, &at.u, &force, None, bonds)?;
        if course.log.is_separated() {
            end = SceneEnd::Separated;
            break;
        }
        course.may_keep(bonds, || (&at, interaction.memory()));
    }
    let MarchStanding { u, account, evaluations, .. } = at;
    Ok(Walked { end, u, account, evaluations, touching: None })
}

impl MarchStanding {
    /// Whether it is that of so many unknowns.
    fn has(&self, unknowns: usize) -> bool {
        self.u.len() == unknowns && self.swing.has(unknowns)
    }
}
