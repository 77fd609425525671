//! Load steps by dynamic relaxation, for any interaction: the displacement of the loads only rises, and where the curve snaps
//! back the plate jumps.
//!
//! A step is taken back and halved when it damages too much or finds no rest, down to a sixteenth of the nominal step, and grown
//! again after calm ones. Where the smallest step still breaks more, rows are taken down while bonds break at one load. Over a jump energy is released that no step can share out: it is reported as excess.

use super::super::bonds::BondState;
use super::super::interaction::Interaction;
use super::super::outcome::SceneEnd;
use super::account::{Account, Recorder, State};
use super::full_load::FullLoad;
use super::path::Walked;
use super::relaxation::{Loads, Relaxation, RestEnd, Rested};
use crate::error::Result;

/// Smallest step over the nominal one.
const LEAST: f64 = 1.0 / 16.0;
/// Bonds that a step may break without being halved: about those of one point.
const BROKEN: usize = 28;
/// Growth of damage that a step may bring to a bond, one pass, without being halved.
const DAMAGED: f64 = 0.1;
/// Load of platens over its peak at which the body has failed.
const FAILED: f64 = 0.9;

/// Works through load steps.
///
/// # Errors
/// A run that was cancelled.
pub fn follow(
    full: &FullLoad,
    steps: usize,
    relaxation: &Relaxation,
    interaction: &mut dyn Interaction,
    bonds: &mut BondState,
    mut recorder: Recorder<'_, '_>,
) -> Result<Walked> {
    let relaxation = &Relaxation { broken: BROKEN, ..*relaxation };
    let mut u = vec![0.0; full.held.len()];
    let mut account = Account::default();
    let (nominal, mut step) = (1.0 / steps as f64, 1.0 / steps as f64);
    let mut evaluations = 0;
    let mut end = SceneEnd::Done;
    let mut peak = 0.0;
    // Whether the last row was taken down while bonds went on breaking at one load.
    let mut breaking = false;
    while breaking || account.state.level < 1.0 - 1e-12 {
        let level = if breaking { account.state.level } else { (account.state.level + step).min(1.0) };
        let before = (u.clone(), bonds.clone());
        let rested = advance(full, account.state.level, level, relaxation, interaction, bonds, &mut u);
        evaluations += rested.evaluations;
        let failed = !matches!(rested.end, RestEnd::AtRest | RestEnd::Breaking);
        let reaction = rested.reaction;
        let too_much =
            rested.end == RestEnd::Breaking || reaction.broken > BROKEN || (reaction.broken == 0 && reaction.damaged > DAMAGED);
        if (failed || too_much) && !breaking && step > LEAST * nominal {
            (u, *bonds) = before;
            step *= 0.5;
            continue;
        }
        if failed {
            u = before.0;
            end = if rested.end == RestEnd::BlownUp { SceneEnd::Unstable } else { SceneEnd::NoConvergence };
            break;
        }
        account.fracture += reaction.released;
        recorder.log.broke(account.rows + 1, reaction.broken);
        breaking = rested.end == RestEnd::Breaking;
        let driven = interaction.driven();
        account.go(State::new(full, level, &u, &rested.force, reaction.strain).with_driven(driven));
        account.row(&mut recorder, &u, &rested.force, driven, bonds)?;
        if recorder.log.is_separated() {
            end = SceneEnd::Separated;
            break;
        }
        // What is split between platens goes on touching them: its failure shows in the load.
        peak = driven.map_or(0.0, |driven| driven.load.max(peak));
        if driven.is_some_and(|driven| driven.load < FAILED * peak) {
            end = SceneEnd::LoadFallen;
            break;
        }
        if reaction.broken == 0 && 2.0 * reaction.damaged < DAMAGED {
            step = (2.0 * step).min(nominal);
        }
    }
    Ok(Walked { end, u, account, evaluations, touching: None })
}

/// Moves on from rest at one share of the full load to rest at another.
pub fn advance(
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
    u.iter_mut().zip(&full.motion).zip(&full.held).filter(|(_, held)| **held).for_each(|((u, motion), _)| *u = to * motion);
    let external: Vec<f64> = full.external.iter().map(|force| to * force).collect();
    relaxation.relax(interaction, bonds, Loads { held: &full.held, external: &external }, u)
}
