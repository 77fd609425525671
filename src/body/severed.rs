//! Crack length in severed bonds.
//!
//! A straight crack of length Δa with unit normal n severs, of the bonds with vector ξ_k, `Δa |ξ_k·n| / Δ²`. Weighting a
//! bond with its spring stiffness times length, g_k, the bonds it severs weigh `ρ(n) Δa`, `ρ(n) = Σ_k g_k |ξ_k·n| / Δ²`
//! over the half stencil. Severed bonds of weight G therefore stand for the length `G / ρ(n)`.

use super::pre_crack::bonds_across;
use super::{Body, Bond};
use crate::specimen::geometry::{along, direction, distance, meeting_share, turn};
use crate::specimen::{Crack, Point};

/// Length of crack before its end, in horizons, over which severed bonds are counted at the most.
const WINDOW_HORIZONS: f64 = 4.0;
/// Share of that length over which the count fades in.
const FADE: f64 = 0.75;

/// Weight g_k of a stencil bond: normal stiffness times length.
#[must_use]
pub fn severed_weight(body: &Body, k: usize) -> f64 {
    let bond = &body.stencil.bonds[k];
    bond.k_n * bond.length
}

/// ρ(n): weight of the bonds severed by a unit length of crack with unit normal n (lattice axes).
#[must_use]
pub fn severed_per_length(body: &Body, normal: Point) -> f64 {
    let bonds = &body.stencil.bonds;
    let severed = |k: usize| {
        let bond = &bonds[k];
        severed_weight(body, k) * bond.length * (bond.normal[0] * normal[0] + bond.normal[1] * normal[1]).abs()
    };
    (0..bonds.len()).map(severed).sum::<f64>() / body.lattice.spacing.powi(2)
}

/// Where a straight crack cut into the bonds really ends, against where it was asked to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RepresentedEnd {
    /// How much farther the crack reaches, m; between about plus and minus half a spacing.
    pub excess: f64,
    /// How far the middle of the gap lies to the left of the crack line, seen towards the end, m: a crack through points
    /// leaves them all on one side.
    pub aside: f64,
}

/// The end `to` (or `from`) of a crack as the bonds it cuts represent it.
///
/// `length` is the length of crack that belongs to this end: all of it, or half where both ends are tips. Bonds are counted
/// over a window before the end that fades in smoothly, so that where it starts does not matter; their middles show where
/// the gap lies.
#[must_use]
pub fn represented_end(body: &Body, crack: &Crack, at_to: bool, length: f64) -> RepresentedEnd {
    let window = length.min(WINDOW_HORIZONS * body.horizon());
    let (tip, other) = if at_to { (crack.to, crack.from) } else { (crack.from, crack.to) };
    let start = along(tip, other, window / distance(crack.from, crack.to));
    // In the sense of the crack: a crack through points leaves them on the side that this sense decides.
    let across = if at_to { bonds_across(body, start, tip) } else { bonds_across(body, tip, start) };
    let (mut counted, mut moment) = (0.0, 0.0);
    for bond in across {
        let weight = severed_weight(body, body.ends(bond).0) * smooth_step(crossing(body, bond, start, tip) / FADE);
        counted += weight;
        moment += weight * turn(start, tip, body.middle(bond)) / window;
    }
    let ahead = body.lattice.to_axes(direction(start, tip));
    let excess = counted / severed_per_length(body, [-ahead[1], ahead[0]]) - (1.0 - 0.5 * FADE) * window;
    RepresentedEnd { excess, aside: if counted > 0.0 { moment / counted } else { 0.0 } }
}

/// Where a bond crosses the crack, as share of the way from `start` to `tip`.
fn crossing(body: &Body, bond: Bond, start: Point, tip: Point) -> f64 {
    let (_, from, to) = body.ends(bond);
    // A bond along the crack cannot cross it; round-off may call one crossing, which then stands at the tip.
    meeting_share(start, tip, body.lattice.position(from), body.lattice.position(to)).unwrap_or(1.0)
}

/// 0 below 0, 1 above 1, `3t² - 2t³` between.
fn smooth_step(t: f64) -> f64 {
    let t = t.clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}
