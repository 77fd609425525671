//! Load steps of a fixed number of relaxation iterations: the plate follows the load in damped motion, and bonds are damaged in
//! every iteration.
//!
//! This is how many published examples are worked through (Kilic and Madenci 2010; Madenci and Oterkus 2014, chapter 7; source
//! 000): one iteration for every increment of displacement, so that "time steps" there count both. It follows a plate through
//! snap-back, since damping takes up what equilibrium cannot, and costs one evaluation of the forces an iteration. What it gives is
//! not equilibrium: load and onset depend on how fast the load grows against the swing, and approach the path of equilibrium
//! only as the increments shrink. Springs without platens only.

use super::super::bonds::BondState;
use super::super::interaction::{Damaging, Interaction};
use super::super::outcome::SceneEnd;
use super::account::{Account, Recorder, State};
use super::full_load::FullLoad;
use super::path::Walked;
use super::relaxation::{Loads, Swing, mobility};
use crate::error::Result;

/// Rows at the most; with more steps every so many-th is kept, and only there is separation looked for.
const ROWS: usize = 4000;
/// Strain energy over the largest work from which the motion counts as blown up: all energy comes from the loads.
const BLOWN_UP: f64 = 2.0;

/// A march.
pub struct March<'a> {
    /// Loads.
    pub full: &'a FullLoad,
    /// Load steps.
    pub steps: usize,
    /// Iterations of relaxation in each.
    pub iterations: usize,
}

impl March<'_> {
    /// Follows the load to its full value, or until the plate is in two.
    ///
    /// # Errors
    /// A run that was cancelled.
    pub fn follow(
        &self,
        interaction: &mut dyn Interaction,
        bonds: &mut BondState,
        mut recorder: Recorder<'_, '_>,
    ) -> Result<Walked> {
        let full = self.full;
        let mut u = vec![0.0; full.held.len()];
        let mut force = u.clone();
        let mut swing = Swing::at_rest(u.len());
        // Damage only softens the plate: what is stable for it whole stays so.
        let mobility = mobility(interaction, bonds, &full.held);
        let mut account = Account::default();
        let mut end = SceneEnd::Done;
        let mut evaluations = 0;
        let stride = self.steps.div_ceil(ROWS);
        'march: for step in 1..=self.steps {
            let level = step as f64 / self.steps as f64;
            u.iter_mut()
                .zip(&full.motion)
                .zip(&full.held)
                .filter(|(_, held)| **held)
                .for_each(|((u, motion), _)| *u = level * motion);
            let external: Vec<f64> = full.external.iter().map(|force| level * force).collect();
            let loads = Loads { held: &full.held, external: &external };
            for _ in 0..self.iterations {
                let reaction = interaction.internal_force(&u, bonds, Damaging::Allowed, &mut force);
                account.fracture += reaction.released;
                recorder.log.broke(step, reaction.broken);
                account.go(State::new(full, level, &u, &force, reaction.strain));
                let sums = swing.take(loads, &mobility, &force);
                if account.is_impossible(BLOWN_UP) {
                    end = SceneEnd::Unstable;
                    break 'march;
                }
                swing.step(&mobility, (evaluations > 0).then(|| sums.damping()), &mut u);
                evaluations += 1;
            }
            if step % stride != 0 && step != self.steps {
                continue;
            }
            account.rows = step - 1;
            account.row(&mut recorder, &u, &force, None, bonds)?;
            if recorder.log.is_separated() {
                end = SceneEnd::Separated;
                break;
            }
        }
        Ok(Walked { end, u, account, evaluations, touching: None })
    }
}
