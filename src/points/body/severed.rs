//! Crack length in severed bonds.
//!
//! A straight crack of length Δa with unit normal n severs, of the bonds with vector ξ_k, `Δa |ξ_k·n| / Δ²`. Weighting a
//! bond with its spring stiffness times length, g_k, the bonds it severs weigh `ρ(n) Δa`, `ρ(n) = Σ_k g_k |ξ_k·n| / Δ²`
//! over the half stencil. Severed bonds of weight G therefore stand for the length `G / ρ(n)`.

use super::Body;
use super::pre_crack::bonds_across;
use perilife_plate::specimen::geometry::{along, direction, distance, meeting_share};
use perilife_plate::specimen::{CrackLine, Point};

/// Length of crack before its end, in horizons, over which severed bonds are counted at the most.
const WINDOW_HORIZONS: f64 = 4.0;
/// Share of that length over which the count fades in.
const FADE: f64 = 0.75;

/// Weight g_k of a stencil bond: normal stiffness times length.
pub fn severed_weight(body: &Body, k: usize) -> f64 {
    let bond = &body.stencil.bonds[k];
    bond.k_n * bond.length
}

/// ρ(n): weight of the bonds severed by a unit length of crack with unit normal n (lattice axes).
pub fn severed_per_length(body: &Body, normal: Point) -> f64 {
    let bonds = &body.stencil.bonds;
    let severed = |k: usize| {
        let bond = &bonds[k];
        severed_weight(body, k) * bond.length * (bond.normal[0] * normal[0] + bond.normal[1] * normal[1]).abs()
    };
    (0..bonds.len()).map(severed).sum::<f64>() / body.lattice.spacing.powi(2)
}

/// Turn between two pieces of a line, rad, from which bonds around the corner no longer count as those of a straight crack.
const CORNER: f64 = 0.1;
/// Least straight length before an end, in horizons, whose bonds tell where it reaches.
const STRAIGHT_HORIZONS: f64 = 0.7;

/// How much farther a crack reaches at one of its ends, once cut into bonds, than its line does, m; between about plus and minus half a
/// spacing, and zero where the line has a corner so near that its bonds do not tell.
///
/// `length` is the length of crack that belongs to this end: all of it, or half where both ends are tips. Bonds are counted over a
/// window before the end that fades in smoothly, so that where it starts does not matter.
pub fn represented_excess(body: &Body, line: &CrackLine, at_last: bool, length: f64) -> f64 {
    let mut pieces: Vec<[Point; 2]> = line.pieces().collect();
    if at_last {
        pieces.reverse();
    }
    // Pieces in their own sense, from the end on, with the way back to their nearer ends.
    let window_most = length.min(WINDOW_HORIZONS * body.horizon());
    let (mut near, mut last): (Vec<([Point; 2], f64)>, Option<Point>) = (Vec::new(), None);
    let mut way = 0.0;
    for [a, b] in pieces {
        let ahead = direction(a, b);
        if last.is_some_and(|last| last[0] * ahead[0] + last[1] * ahead[1] < CORNER.cos()) || way >= window_most {
            break;
        }
        near.push(([a, b], way));
        way += distance(a, b);
        last = Some(ahead);
    }
    let window = window_most.min(way);
    if window < STRAIGHT_HORIZONS * body.horizon() {
        return 0.0;
    }
    let mut seen = std::collections::HashSet::new();
    let mut counted = 0.0;
    for ([a, b], back) in near {
        let piece = distance(a, b);
        let kept = (window - back).min(piece);
        // The part of the piece within the window.
        let (from, to) = if at_last { (along(b, a, kept / piece), b) } else { (a, along(a, b, kept / piece)) };
        let ahead = body.lattice.to_axes(direction(a, b));
        let per_length = severed_per_length(body, [-ahead[1], ahead[0]]);
        for bond in bonds_across(body, from, to).into_iter().filter(|&bond| seen.insert(bond)) {
            let (tip, start) = if at_last { (to, from) } else { (from, to) };
            let (_, one, other) = body.ends(bond);
            // A bond along the crack cannot cross it; round-off may call one crossing, which then stands at the tip.
            let share = 1.0 - meeting_share(start, tip, body.lattice.position(one), body.lattice.position(other)).unwrap_or(1.0);
            let left = 1.0 - (back + share.clamp(0.0, 1.0) * kept) / window;
            let t = (left / FADE).clamp(0.0, 1.0);
            counted += severed_weight(body, body.ends(bond).0) * (t * t * (3.0 - 2.0 * t)) / per_length;
        }
    }
    counted - (1.0 - 0.5 * FADE) * window
}
