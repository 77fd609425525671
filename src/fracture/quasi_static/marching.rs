//! Load steps of a fixed number of relaxation iterations: the plate follows the load in damped motion, and bonds are damaged in
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
use super::relaxation::{Loads, Swing, mobility};
use crate::error::Result;
use crate::levels::equilibrium::FullLoad;

/// Rows at the most; with more steps every so many-th is kept, and only there is separation looked for.
const ROWS: usize = 4000;
/// Strain energy over the largest work from which the motion counts as blown up: all energy comes from the loads.
const BLOWN_UP: f64 = 2.0;

/// Where a march stands after a row: all that its next steps depend on beside bonds and interaction.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Standing {
    step: usize,
    u: Vec<f64>,
    swing: Swing,
    account: Account,
    evaluations: usize,
}

/// Follows the load to its full value in so many steps of so many iterations of relaxation, or until the plate is in two, from rest or from where the run is taken up.
/// Errors: a run that was cancelled, a checkpoint of another one.
pub fn follow(
    full: &FullLoad,
    [steps, iterations]: [usize; 2],
    interaction: &mut dyn Interaction,
    bonds: &mut BondState,
    course: &mut Course<'_>,
) -> Result<Walked> {
    let size = full.held.len();
    // Damage only softens the plate: what is stable for it whole stays so.
    let mobility = mobility(interaction, bonds, &full.held);
    let mut at = match course.take_up::<(Standing, Memory)>(bonds)? {
        None => {
            Standing { step: 0, u: vec![0.0; size], swing: Swing::at_rest(size), account: Account::default(), evaluations: 0 }
        }
        Some((at, memory)) if at.has(size) && interaction.restore(&memory, bonds) => at,
        Some(_) => return Err(of_another()),
    };
    let mut force = vec![0.0; size];
    let mut end = SceneEnd::Done;
    let stride = steps.div_ceil(ROWS);
    'march: for step in at.step + 1..=steps {
        let level = step as f64 / steps as f64;
        at.step = step;
        at.u.iter_mut()
            .zip(&full.motion)
            .zip(&full.held)
            .filter(|(_, held)| **held)
            .for_each(|((u, motion), _)| *u = level * motion);
        let external: Vec<f64> = full.external.iter().map(|force| level * force).collect();
        let loads = Loads { held: &full.held, external: &external };
        for _ in 0..iterations {
            let reaction = interaction.internal_force(&at.u, bonds, Damaging::Allowed, &mut force);
            at.account.fracture += reaction.released;
            course.log.broke(step, reaction.broken);
            at.account.go(State::new(full, level, &at.u, &force, reaction.strain));
            let sums = at.swing.take(loads, &mobility, &force);
            if at.account.is_impossible(BLOWN_UP) {
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
    let Standing { u, account, evaluations, .. } = at;
    Ok(Walked { end, u, account, evaluations, touching: None })
}

impl Standing {
    /// Whether it is that of so many unknowns.
    fn has(&self, unknowns: usize) -> bool {
        self.u.len() == unknowns && self.swing.has(unknowns)
    }
}
