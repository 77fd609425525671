//! The balanced correction beside the flanks of cracks.
//!
//! Points beside a crack miss the bonds that it cut, as those on a rim do, and a layer of them is too soft along the crack. Loads
//! that a plate cannot carry otherwise go another way then: K of a central crack, whose flanks are pressed along by about the
//! stress of the load, is read 0.3 to 1 % high where a horizon is a fifth of what is left of the plate, K_II of a slanted one 1 to
//! 2 %. So the equations of the rim ([`super`]) are asked of these points, too: uniform strain, with the traction of the continuum on the
//! flanks, is in equilibrium. What a crack takes from the equations of a point is `Σ m q r n_i n_j n_k` over its cut bonds.
//!
//! At the tip nothing is asked: the bonds of the core are those of the cut plate. From there on the equations come in over half a
//! horizon. They are asked for less sharply than on the rim, whose multipliers are found once: so no multiplier comes to its bounds,
//! which would cost tens of factorisations a block.

use std::collections::HashMap;

use super::least_squares::{Gain, Link, Problem};
use super::{BOUNDS, asked, gains, load_rows};
use crate::body::facets::{Facet, behind};
use crate::body::pre_crack::{places_near, tie_break};
use crate::body::sharing::{WIDEN, WIDENINGS, linear_shares};
use crate::body::{Body, Bond};
use crate::specimen::geometry::{along, direction, distance, distance_to_segment, segments_touch};
use crate::specimen::{CrackLine, Point};

/// ε of the equations of force. At 1e-4 and 1e-2 K of central cracks differs by 0.02 and 0.1 %.
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
pub enum Stretch {
    /// Along all cracks.
    All,
    /// Around their tips, after they have grown by less than a horizon.
    Tips,
}

/// Bonds beside cracks that are cut, and their new multipliers, where these differ from those of `now`, ascending; `tips` are those of
/// the cracks' ends that have not reached a rim, `ends` all.
#[must_use]
pub fn multipliers(
    body: &Body,
    now: &[f32],
    lines: &[CrackLine],
    tips: &[Point],
    ends: &[Point],
    stretch: Stretch,
) -> Vec<(Bond, f32)> {
    let (places, spacing, horizon) = (body.places(), body.lattice.spacing, body.horizon());
    let followed = FOLLOWED_HORIZONS * horizon;
    let nearest = |of: &[Point], at: Point| of.iter().map(|end| distance(*end, at)).fold(f64::INFINITY, f64::min);
    let is_open = |at: Point| stretch == Stretch::All || nearest(ends, at) < followed;
    // As the bonds see them.
    let pieces: Vec<[Point; 2]> = lines
        .iter()
        .flat_map(CrackLine::pieces)
        .filter(|[a, b]| {
            stretch == Stretch::All || ends.iter().any(|end| distance_to_segment(*end, *a, *b) < followed + 3.0 * horizon)
        })
        .map(|[a, b]| {
            let shift = tie_break(body, a, b);
            [a, b].map(|p| [p[0] + shift[0], p[1] + shift[1]])
        })
        .collect();

    // Points whose equations may change: those with cut bonds, the rows behind them and the other ends of their bonds.
    let reach = horizon + 1.5 * spacing;
    let near = pieces.iter().flat_map(|&[a, b]| places_near(body, a, b, reach));
    let mut members: Vec<usize> = near.filter(|&place| is_open(body.lattice.position(place))).collect();
    members.sort_unstable();
    members.dedup();
    let number: HashMap<usize, u32> = members.iter().enumerate().map(|(i, &place)| (place, i as u32)).collect();
    let share: Vec<f64> = members
        .iter()
        .map(|&place| {
            let t = (nearest(tips, body.lattice.position(place)) / (FADE_HORIZONS * horizon)).min(1.0);
            t * t * (3.0 - 2.0 * t)
        })
        .collect();
    let areas = areas(body, &pieces, &number);

    let at = |k: usize, place: usize| {
        [(place, k), (place.wrapping_add_signed(-body.steps[k]), k)].map(|(owner, k)| k * places + owner)
    };
    let is_cut = |bond: usize| body.multiplier[bond] > 0.0 && now[bond] == 0.0;
    let misses: Vec<bool> =
        members.iter().map(|&place| (0..body.steps.len()).any(|k| at(k, place).into_iter().any(is_cut))).collect();
    let in_row = |place: usize| {
        let sides = [(0, 0), (1, 0), (-1, 0), (0, 1), (0, -1)].map(|(dx, dy)| body.lattice.step(dx, dy));
        sides.iter().any(|&step| number.get(&place.wrapping_add_signed(step)).is_some_and(|&i| misses[i as usize]))
    };
    let changing: Vec<bool> = members.iter().map(|&place| in_row(place)).collect();
    let (mut links, mut names, mut new) = (Vec::new(), Vec::new(), HashMap::new());
    for (i, &owner) in members.iter().enumerate() {
        for (k, &step) in body.steps.iter().enumerate() {
            let bond = k * places + owner;
            let Some(&other) = number.get(&owner.wrapping_add_signed(step)) else { continue };
            let j = other as usize;
            if now[bond] == 0.0 {
                continue;
            }
            if share[i].min(share[j]) == 0.0 {
                // Of the core of a tip, which it may not have been when the crack was shorter.
                new.insert(bond, body.multiplier[bond]);
            } else if changing[i] || changing[j] {
                links.push(Link { from: i as u32, to: other, k });
                names.push(bond);
                // What is sought counts as a change of the body's own.
                new.insert(bond, body.multiplier[bond]);
            }
        }
    }

    // What is asked, less what bonds carry that keep the multiplier they have.
    let gains = gains(body);
    let missing: Vec<Gain> = members
        .iter()
        .enumerate()
        .map(|(i, &place)| {
            let (mut left, mut kept): (Gain, Gain) = (asked(areas[i]), asked([0.0; 2]));
            for (k, gain) in gains.iter().enumerate() {
                for (bond, own) in at(k, place).into_iter().zip([gain.at_owner, gain.at_other]) {
                    let whole = f64::from(body.multiplier[bond]);
                    let carried = f64::from(new.get(&bond).copied().unwrap_or(now[bond]));
                    if carried == 0.0 {
                        left.iter_mut().zip(own).for_each(|(l, g)| *l += whole * g);
                    } else if carried != whole {
                        kept.iter_mut().zip(own).for_each(|(l, g)| *l += (carried - whole) * g);
                    }
                }
            }
            std::array::from_fn(|c| share[i] * left[c] - kept[c])
        })
        .collect();
    let bounds = BOUNDS.map(|bound| bound - 1.0);
    let changes = Problem::new(&gains, links, missing).solve_to(&SOFTNESS, bounds).unwrap_or_else(|| vec![0.0; names.len()]);
    for (bond, change) in names.into_iter().zip(changes) {
        let whole = f64::from(body.multiplier[bond]);
        if change.abs() >= ROUND_OFF {
            new.insert(bond, (whole + change).max(BOUNDS[0] * whole) as f32);
        }
    }
    let differs = |&(bond, multiplier): &(usize, f32)| multiplier != now[bond];
    let mut changed: Vec<(Bond, f32)> = new.into_iter().filter(differs).map(|(bond, m)| (bond as Bond, m)).collect();
    changed.sort_unstable_by_key(|(bond, _)| *bond);
    changed
}

/// Flank that every member stands for, as [`super`] has it of the rim.
fn areas(body: &Body, pieces: &[[Point; 2]], number: &HashMap<usize, u32>) -> Vec<[f64; 2]> {
    let (lattice, spacing) = (&body.lattice, body.lattice.spacing);
    let rows = load_rows(&body.stencil) as f64;
    let mut areas = vec![[0.0; 2]; number.len()];
    for &[a, b] in pieces {
        let (length, [x, y]) = (distance(a, b), direction(a, b));
        let count = (PIECES_PER_SPACING * length / spacing).ceil().max(1.0);
        for i in 0..count as usize {
            let at = along(a, b, (i as f64 + 0.5) / count);
            let beside: Vec<&[Point; 2]> =
                pieces.iter().filter(|[p, q]| distance_to_segment(at, *p, *q) < 2.0 * (rows + 1.0) * spacing).collect();
            for normal in [[y, -x], [-y, x]] {
                let facet = Facet { at, normal, length: length / count };
                let from = behind(&facet, spacing);
                let sees = |place: u32| {
                    let to = lattice.position(place as usize);
                    !beside.iter().any(|[p, q]| segments_touch(from, to, *p, *q))
                };
                let [column, row] = lattice.locate(at);
                let shares = (0..WIDENINGS).find_map(|i| {
                    let widen = WIDEN.powi(i as i32);
                    let (deep, wide) = (widen * (rows + 0.5), widen);
                    let candidates = places_near(body, at, at, deep.hypot(wide) * spacing).map(|place| {
                        let (c, r) = lattice.column_row(place);
                        (place as u32, [c as f64 - column, r as f64 - row], 1.0)
                    });
                    linear_shares(lattice.to_axes(normal), deep, wide, candidates, sees)
                });
                let whole = lattice.to_axes(normal.map(|n| n * facet.length / spacing));
                for (place, share) in shares.unwrap_or_default() {
                    if let Some(&i) = number.get(&(place as usize)) {
                        let sum = &mut areas[i as usize];
                        *sum = [sum[0] + share * whole[0], sum[1] + share * whole[1]];
                    }
                }
            }
        }
    }
    areas
}
