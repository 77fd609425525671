//! Balanced surface correction: uniform strain is in equilibrium with its boundary traction at every point.
//!
//! Near a boundary a point misses bonds, so uniform strain leaves forces over. The multipliers m of the bonds there are
//! chosen, as near to 1 as possible, so that it does not. With springs `k_n = c_n q`, `k_t = c_t q` and unit vectors n,
//! the force of strain e on a point is linear in `Σ m q r n_i n_j n_k`, and the traction of the continuum on the piece of
//! rim A that the point stands for asks
//!
//! `Σ m q r n_i n_j n_k = -S₂₂ (A_i δ_jk + A_j δ_ik + A_k δ_ij)`, `S₂₂ = Σ q r² n_x² n_y²` over the half stencil:
//!
//! four equations a point for all three strains and every Poisson's ratio at once, since the lattice is isotropic
//! (S₄ = 3 S₂₂). The rotation of a point stays zero where `Σ m q r² n_x n_y = Σ m q r² (n_x² - n_y²) = 0`. A corner cannot do
//! that: all its bonds lie in one quadrant and turn it the same way. So these two are asked for softly, and
//! what is left comes in as couples of the load (`couples.rs`).
//!
//! A solution exists for all strains only if the loads are consistent, `Σ x_i A_j = δ_ij × area` ([`super::sharing`]): by
//! reciprocity of two strain states the plate must be as wide for one as it is for the other. Loads put on the last
//! row of points violate that by spacing × (1/width - 1/length).
//!
//! The dilatation of a state-based law has the same four equations: `Σ m k_n r n = -4 S₂₂ A` is their trace.
//!
//! Only bonds change that have an end within one row of a point that misses a neighbour; the others keep 1. Damped least squares on equilibrium, after an idea of point-wise
//! energy matching (Madenci and Oterkus 2014, Peridynamic Theory and Its Applications, ch. 4), here with forces.

pub mod flanks;
pub mod least_squares;

use super::Body;
use super::sharing::Sharing;
use super::surface_correction::settled;
use crate::bond_law::stencil::{Stencil, StencilBond};
use least_squares::{BondGain, Gain, Link, Problem};
use perilife_base::error::{Error, Result};
use perilife_plate::specimen::facets::Facet;

/// Rows whose bonds change behind the points that miss a neighbour: ahead of the end of a slot there are fewer bonds than
/// equations otherwise.
pub const ROWS_MORE: usize = 1;
/// Rows whose bonds change at least; short horizons have fewer bonds than equations otherwise.
pub const ROWS_LEAST: usize = 3;
pub const BOUNDS: [f64; 2] = [0.2, 5.0];

/// Rows of points that a consistent load reaches: the fewer, the more the last row takes. Stencils with no more bonds than a
/// point has equations cannot pass the load on from a third row.
pub fn load_rows(stencil: &Stencil) -> usize {
    if stencil.bonds.len() > least_squares::EQUATIONS { stencil.reach.max(ROWS_LEAST) } else { 2 }
}

/// Sets the multipliers of the bonds near the rim of the uncracked body.
/// Errors: no multipliers within the bounds come near equilibrium.
pub(super) fn balance(body: &mut Body, rim: &[Facet], sharing: &Sharing) -> Result<()> {
    let places = body.places();
    let near_rim = near_rim(body);
    let stencil_gains = gains(body);
    let areas = areas(body, rim, sharing);

    let mut involved: Vec<bool> = areas.iter().map(|a| a[0] != 0.0 || a[1] != 0.0).collect();
    let changed = |owner: usize, k: usize| {
        let other = owner.wrapping_add_signed(body.steps[k]);
        (body.multiplier[k * places + owner] > 0.0 && (near_rim[owner] || near_rim[other])).then_some(other)
    };
    for &point in &body.points {
        for k in 0..body.steps.len() {
            if let Some(other) = changed(point as usize, k) {
                involved[point as usize] = true;
                involved[other] = true;
            }
        }
    }
    let mut number = vec![u32::MAX; places];
    let members: Vec<usize> = body.points.iter().map(|&p| p as usize).filter(|&p| involved[p]).collect();
    members.iter().enumerate().for_each(|(i, &place)| number[place] = i as u32);

    let (mut links, mut bonds) = (Vec::new(), Vec::new());
    for &owner in &members {
        for k in 0..body.steps.len() {
            if let Some(other) = changed(owner, k) {
                links.push(Link { from: number[owner], to: number[other], k });
                bonds.push(k * places + owner);
            }
        }
    }
    // What all bonds leave over at multiplier 1.
    let missing: Vec<Gain> = members
        .iter()
        .map(|&place| {
            let mut left = asked(areas[place]);
            for (k, gain) in stencil_gains.iter().enumerate() {
                let behind = place.wrapping_add_signed(-body.steps[k]);
                for (owner, own) in [(place, gain.at_owner), (behind, gain.at_other)] {
                    if body.multiplier[k * places + owner] > 0.0 {
                        left.iter_mut().zip(own).for_each(|(l, g)| *l -= g);
                    }
                }
            }
            left
        })
        .collect();
    let change = Problem::new(&stencil_gains, links, missing).solve(BOUNDS.map(|bound| bound - 1.0)).ok_or_else(|| {
        Error::Mechanics(
            "the balanced surface correction found no bond multipliers for this outline; reduce the spacing, or use \
             model.surface_correction = \"volume_and_surface\""
                .to_owned(),
        )
    })?;
    for (bond, change) in bonds.into_iter().zip(change) {
        body.multiplier[bond] = settled(1.0 + change);
    }
    Ok(())
}

/// Share of every bond of the stencil in the equations of its two ends, spacing 1 and S₂₂ = 1.
fn gains(body: &Body) -> Vec<BondGain> {
    let spacing = body.lattice.spacing;
    let s22: f64 =
        body.stencil.bonds.iter().map(|bond| bond.k_n * (bond.length / spacing * bond.normal[0] * bond.normal[1]).powi(2)).sum();
    let of_bond = |bond: &StencilBond| gain(bond.k_n / s22, bond.length / spacing, bond.normal);
    body.stencil.bonds.iter().map(of_bond).collect()
}

/// Share of a bond in the equations of its two ends: spring over S₂₂, length, direction from the owner in lattice axes.
pub fn gain(spring: f64, length: f64, [x, y]: [f64; 2]) -> BondGain {
    let force = spring * length;
    let turn = force * length;
    let at = |sign: f64| {
        let f = sign * force;
        [f * x * x * x, f * x * x * y, f * x * y * y, f * y * y * y, turn * x * y, 0.5 * turn * (x * x - y * y)]
    };
    BondGain { at_owner: at(1.0), at_other: at(-1.0) }
}

/// What the continuum asks of the equations of a point that stands for this rim.
pub fn asked(area: [f64; 2]) -> Gain {
    let [ax, ay] = area;
    [-3.0 * ax, -ay, -ax, -3.0 * ay, 0.0, 0.0]
}

/// Rim that every place stands for: Σ share × length × normal, in lattice axes and spacings.
fn areas(body: &Body, rim: &[Facet], sharing: &Sharing) -> Vec<[f64; 2]> {
    let mut areas = vec![[0.0; 2]; body.places()];
    for facet in rim {
        let whole = body.lattice.to_axes(facet.normal.map(|n| n * facet.length / body.lattice.spacing));
        for (place, share) in sharing.of(facet) {
            let sum = &mut areas[place as usize];
            *sum = [sum[0] + share * whole[0], sum[1] + share * whole[1]];
        }
    }
    areas
}

/// Points that miss a neighbour and the rows behind them.
fn near_rim(body: &Body) -> Vec<bool> {
    let places = body.places();
    let mut near = vec![false; places];
    for &point in &body.points {
        let place = point as usize;
        near[place] = body.steps.iter().enumerate().any(|(k, &step)| {
            body.multiplier[k * places + place] == 0.0 || body.multiplier[k * places + place.wrapping_add_signed(-step)] == 0.0
        });
    }
    for _ in body.stencil.reach..ROWS_LEAST.max(body.stencil.reach + ROWS_MORE) {
        let before = near.clone();
        for &point in &body.points {
            let place = point as usize;
            let sides = [(1, 0), (-1, 0), (0, 1), (0, -1)].map(|(dx, dy)| body.lattice.step(dx, dy));
            near[place] = sides.iter().any(|&step| before[place.wrapping_add_signed(step)]) || before[place];
        }
    }
    near
}
