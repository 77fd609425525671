//! Bonds that break by overload, not by fatigue.

use crate::ageing::stretch;
use crate::case::Case;
use perilife_points::body::{Body, Bond};
use perilife_points::solver::Equilibrium;
use perilife_points::solver::field::Layout;
use perilife_points::state::Bonds;

/// Relative difference of sums that are equal but for round-off.
const ROUND_OFF: f64 = 1e-9;
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

/// Bonds stretched so far that they may go beyond the critical stretch before the next whole solve, wherever they are: all whose
/// displacement has to be right after every break, beside those around the tips. To be asked after a whole solve.
pub(super) fn stretched(body: &Body, bonds: &Bonds, case: &Case, displacement: &[f64], window: Option<&[u32]>) -> Vec<Bond> {
    let limit = WATCHED_SHARE * case.fatigue.critical_stretch;
    // Without a window the displacement is right everywhere.
    if limit.is_infinite() || window.is_none() {
        return Vec::new();
    }
    let beyond = stretched_beyond(limit, body, bonds, displacement, &body.points, |_| true);
    beyond.into_iter().map(|(bond, _)| bond).collect()
}

/// Bonds that can fail, from one of `owners` to a place that `counts`, stretched beyond a limit.
fn stretched_beyond(
    limit: f64,
    body: &Body,
    bonds: &Bonds,
    displacement: &[f64],
    owners: &[u32],
    counts: impl Fn(usize) -> bool,
) -> Vec<(Bond, f64)> {
    let layout = Layout::of(&body.lattice, body.stencil.unknowns);
    let places = body.places();
    let mut beyond = Vec::new();
    for (k, spring) in body.stencil.bonds.iter().enumerate() {
        // Hardly ever is one stretched so far: runs of neighbours are looked at as a whole first.
        let opening_least = limit * spring.length * (1.0 - ROUND_OFF);
        for run in owners.chunk_by(|a, b| a + 1 == *b) {
            let first = run[0] as usize;
            let from = layout.index(first);
            let to = from.wrapping_add_signed(layout.step(spring.dx, spring.dy));
            let component = |at: usize, c: usize| &displacement[at + c * layout.stride..][..run.len()];
            let ends = [component(from, 0), component(to, 0), component(from, 1), component(to, 1)];
            if !reaches(ends, spring.normal, opening_least) {
                continue;
            }
            let owned = run.iter().map(|&place| (k * places + place as usize) as Bond);
            let stretched = owned.map(|bond| (bond, stretch(body, &layout, displacement, bond)));
            beyond.extend(
                stretched
                    .filter(|&(bond, s)| s > limit && bonds.is_intact(bond) && counts(body.ends(bond).2) && body.can_fail(bond)),
            );
        }
    }
    beyond
}

/// Whether one of a run of bonds opens by more than `least` along its normal, intact or not; both components of both ends.
fn reaches([x_from, x_to, y_from, y_to]: [&[f64]; 4], normal: [f64; 2], least: f64) -> bool {
    let along_x = x_from.iter().zip(x_to).map(|(from, to)| normal[0] * (to - from));
    let along_y = y_from.iter().zip(y_to).map(|(from, to)| normal[1] * (to - from));
    along_x.zip(along_y).fold(false, |found, (x, y)| found | (x + y > least))
}
