//! Bonds that break by overload, not by fatigue.

use rayon::prelude::*;

use crate::body::{Body, Bond};
use crate::case::Case;
use crate::fatigue::ageing::stretch;
use crate::solver::Equilibrium;
use crate::solver::field::Layout;
use crate::state::Bonds;

/// Share of the critical stretch at which bonds away from the tips are watched after every break.
const WATCHED_SHARE: f64 = 0.5;

/// Bonds stretched beyond the critical stretch s_t: the last ligament of a plate breaks by overload, not by fatigue.
/// Looked at are the bonds whose displacement is known: all after a whole solve, else those around the tips.
pub(super) fn overstretched(
    body: &Body,
    bonds: &Bonds,
    case: &Case,
    displacement: &[f64],
    equilibrium: &Equilibrium,
) -> Vec<Bond> {
    let limit = case.fatigue.critical_stretch;
    if limit.is_infinite() {
        return Vec::new();
    }
    let window = equilibrium.window().filter(|_| !equilibrium.is_whole());
    let beyond = stretched_beyond(limit, body, bonds, displacement, window.unwrap_or(&body.points), |other| {
        window.is_none_or(|window| window.binary_search(&(other as u32)).is_ok())
    });
    // The worst first: where they break, others are relieved.
    let worst = beyond.iter().map(|b| b.1).fold(0.0, f64::max);
    beyond.into_iter().filter(|&(_, s)| s >= 0.5 * worst).map(|(bond, _)| bond).collect()
}

/// Whether a bond outside the window is stretched so far that it may go beyond the critical stretch before the next whole
/// solve.
pub(super) fn away_is_stretched(body: &Body, bonds: &Bonds, case: &Case, displacement: &[f64], window: Option<&[u32]>) -> bool {
    let limit = WATCHED_SHARE * case.fatigue.critical_stretch;
    let Some(window) = window.filter(|_| limit.is_finite()) else { return false };
    let inside = |place: usize| window.binary_search(&(place as u32)).is_ok();
    let beyond = stretched_beyond(limit, body, bonds, displacement, &body.points, |_| true);
    beyond.into_iter().any(|(bond, _)| {
        let (_, from, to) = body.ends(bond);
        !inside(from) || !inside(to)
    })
}

/// Bonds that can fail, from one of `owners` to a place that `counts`, stretched beyond a limit.
fn stretched_beyond(
    limit: f64,
    body: &Body,
    bonds: &Bonds,
    displacement: &[f64],
    owners: &[u32],
    counts: impl Fn(usize) -> bool + Sync,
) -> Vec<(Bond, f64)> {
    let layout = Layout::of(&body.lattice, body.stencil.unknowns);
    let places = body.places();
    let of_stencil = |k: usize| {
        let counts = &counts;
        let owned = owners.iter().map(move |&place| (k * places + place as usize) as Bond);
        owned.filter(move |&bond| bonds.is_intact(bond) && counts(body.ends(bond).2))
    };
    let stretched = |bond: Bond| (bond, stretch(body, &layout, displacement, bond));
    (0..body.steps.len())
        .into_par_iter()
        .flat_map_iter(|k| of_stencil(k).map(stretched).filter(|&(bond, s)| s > limit && body.can_fail(bond)))
        .collect()
}
