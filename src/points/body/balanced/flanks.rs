//! The balanced correction beside the flanks of cracks.
//!
//! Points beside a crack miss the bonds that it cut, as those on a rim do, and a layer of them is too soft along the crack. Loads
//! that a plate cannot carry otherwise go another way then: K of a central crack, whose flanks are pressed along by about the
//! stress of the load, is read 0.3 to 1 % high where a horizon is a fifth of what is left of the plate, K_II of a slanted one
//! 1 %. So the equations of the rim ([`super`]) are asked of these points, too: uniform strain, with the traction of the continuum on the
//! flanks, is in equilibrium. What a crack takes from the equations of a point is `Σ m q r n_i n_j n_k` over its cut bonds.
//!
//! At the tip nothing is asked: the bonds of the core are those of the cut plate. From there on the equations come in over half a
//! horizon. They are asked for less sharply than on the rim, whose multipliers are found once: so no multiplier comes to its bounds,
//! which would cost tens of factorisations a block.

use rayon::prelude::*;

use super::least_squares::{BOUNDS, Link, Problem};
use super::{Equations, areas, gains, load_rows};
use crate::body::pre_crack::{as_cut, faces, places_near};
use crate::body::sharing::linear_shares;
use crate::body::{Body, Bond};
use perilife_plate::specimen::facets::{Facet, behind};
use perilife_plate::specimen::geometry::{distance, distance_to_segment, segments_touch};
use perilife_plate::specimen::{CrackLine, Point};

/// ε of the equations of force. At 1e-4 and 1e-2 K of central cracks differs by 0.03 and 0.1 to 0.2 %.
const SOFTNESS: [f64; 2] = [1e-3, 1e-1];
/// Distance from a tip, in horizons, over which the equations come in.
const FADE_HORIZONS: f64 = 0.5;
/// Distance from the tips, in horizons, within which multipliers follow their growth; farther behind they stay.
const FOLLOWED_HORIZONS: f64 = 3.0;
/// Pieces of a flank per spacing.
const PIECES_PER_SPACING: f64 = 4.0;
/// Change of a multiplier that is none.
const ROUND_OFF: f64 = 1e-6;

/// Where multipliers are to be found anew.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FlankRange {
    /// Along all cracks.
    All,
    /// Around their tips, after they have grown by less than a horizon.
    Tips,
}

/// Bonds beside cracks that are cut, and their new multipliers, where these differ from those of `now`, ascending; `tips` are those of
/// the cracks' ends that have not reached a rim, `ends` all.
pub fn multipliers(
    body: &Body,
    now: &[f32],
    lines: &[CrackLine],
    tips: &[Point],
    ends: &[Point],
    range: FlankRange,
) -> Vec<(Bond, f32)> {
    let beside = beside(body, now, lines, tips, ends, range);
    // What is sought counts as a change of the body's own multiplier.
    let (links, sought) = beside.sought(body, now);
    let gains = gains(body);
    let multiplier = |bond: usize, link: Option<Link>| {
        let is_found_anew = link.is_some_and(|link| beside.is_of_core(&link) || beside.may_change(&link));
        if now[bond] > 0.0 && is_found_anew { body.multiplier[bond] } else { now[bond] }
    };
    let missing = beside.missing(body, &gains, |bond| body.multiplier[bond], multiplier);
    let bounds = BOUNDS.map(|bound| bound - 1.0);
    let changes = Problem::new(&gains, links, missing).solve_to(&SOFTNESS, bounds).unwrap_or_else(|| vec![0.0; sought.len()]);
    let found = |(bond, change): (usize, f64)| {
        let whole = f64::from(body.multiplier[bond]);
        let new = if change.abs() < ROUND_OFF { whole } else { (whole + change).max(BOUNDS[0] * whole) };
        (bond, new as f32)
    };
    // Those at a tip may not have been there when the crack was shorter.
    let cores =
        beside.bonds(body, now).filter(|(link, _)| beside.is_of_core(link)).map(|(_, bond)| (bond, body.multiplier[bond]));
    let new = sought.into_iter().zip(changes).map(found).chain(cores).filter(|&(bond, new)| new != now[bond]);
    let mut changed: Vec<(Bond, f32)> = new.map(|(bond, new)| (bond as Bond, new)).collect();
    changed.sort_unstable_by_key(|(bond, _)| *bond);
    changed
}

/// The equations of points beside cracks: those with cut bonds, the rows behind them and the other ends of their bonds.
fn beside(body: &Body, now: &[f32], lines: &[CrackLine], tips: &[Point], ends: &[Point], range: FlankRange) -> Equations {
    let (spacing, horizon) = (body.lattice.spacing, body.horizon());
    let followed = FOLLOWED_HORIZONS * horizon;
    let nearest = |of: &[Point], at: Point| of.iter().map(|end| distance(*end, at)).fold(f64::INFINITY, f64::min);
    let is_open = |place: usize| range == FlankRange::All || nearest(ends, body.lattice.position(place)) < followed;
    let is_near = |[a, b]: &[Point; 2]| {
        let reach = followed + 3.0 * horizon;
        range == FlankRange::All || ends.iter().any(|end| distance_to_segment(*end, *a, *b) < reach)
    };
    let is_facet_near = |facet: &Facet| is_near(&[facet.at; 2]);
    // As the bonds see them.
    let near_pieces = lines.iter().flat_map(CrackLine::pieces).filter(is_near);
    let pieces: Vec<[Point; 2]> = near_pieces.map(|piece| as_cut(body, piece)).collect();
    let reach = horizon + 1.5 * spacing;
    let near = pieces.iter().flat_map(|&[a, b]| places_near(body, a, b, reach));
    let mut members: Vec<usize> = near.filter(|&place| is_open(place)).collect();
    members.sort_unstable();
    members.dedup();
    let share = |place: usize| {
        let t = (nearest(tips, body.lattice.position(place)) / (FADE_HORIZONS * horizon)).min(1.0);
        t * t * (3.0 - 2.0 * t)
    };
    let misses = |place: &usize| body.around(*place).any(|(.., bond, _)| body.multiplier[bond] > 0.0 && now[bond] == 0.0);
    let mut missing = vec![false; body.places()];
    members.iter().filter(|&place| misses(place)).for_each(|&place| missing[place] = true);
    let sides = [(0, 0), (1, 0), (-1, 0), (0, 1), (0, -1)].map(|(dx, dy)| body.lattice.step(dx, dy));
    let changes = |place: usize| sides.iter().any(|&step| missing[place.wrapping_add_signed(step)]);
    let facets: Vec<Facet> =
        pieces.iter().flat_map(|&piece| faces(piece, spacing / PIECES_PER_SPACING)).filter(is_facet_near).collect();
    let shares: Vec<_> =
        facets.par_iter().with_min_len(16).map(|facet| shares(body, facet, &pieces).unwrap_or_default()).collect();
    Equations::new(body, members, &areas(body, facets.iter().zip(shares)), share, changes)
}

/// Shares of points in the field at a piece of flank, on the side that it faces away from, past the cracks of which `pieces` are some or
/// all, as the bonds see them; `None` where no points determine a linear field there.
pub fn shares(body: &Body, facet: &Facet, pieces: &[[Point; 2]]) -> Option<Vec<(u32, f64)>> {
    let (lattice, spacing) = (&body.lattice, body.lattice.spacing);
    let near = reach_of_shares(body);
    let beside: Vec<&[Point; 2]> = pieces.iter().filter(|[p, q]| distance_to_segment(facet.at, *p, *q) < near).collect();
    let from = behind(facet, spacing);
    let sees = |place: u32| {
        let to = lattice.position(place as usize);
        !beside.iter().any(|[p, q]| segments_touch(from, to, *p, *q))
    };
    let [column, row] = lattice.locate(facet.at);
    let candidates = |reach: f64| {
        places_near(body, facet.at, facet.at, reach * spacing).map(move |place| {
            let (c, r) = lattice.column_row(place);
            (place as u32, [c as f64 - column, r as f64 - row], 1.0)
        })
    };
    linear_shares(lattice.to_axes(facet.normal), [load_rows(&body.stencil) as f64 + 0.5, 1.0], candidates, sees)
}

/// Distance of a crack from a piece of flank within which it may change the [`shares`], m.
pub fn reach_of_shares(body: &Body) -> f64 {
    2.0 * (load_rows(&body.stencil) as f64 + 1.0) * body.lattice.spacing
}
