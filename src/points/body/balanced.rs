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

use std::collections::HashMap;

use super::Body;
use super::sharing::Sharing;
use super::surface_correction::settled;
use crate::bond_law::stencil::{Stencil, StencilBond};
use least_squares::{BondGain, Gain, Link, Problem};
use perilife_base::error::Result;
use perilife_plate::specimen::facets::Facet;

/// Rows whose bonds change behind the points that miss a neighbour: ahead of the end of a slot there are fewer bonds than
/// equations otherwise.
pub const ROWS_MORE: usize = 1;
/// Rows whose bonds change at least; short horizons have fewer bonds than equations otherwise.
pub const ROWS_LEAST: usize = 3;

/// Rows of points that a consistent load reaches: the fewer, the more the last row takes. Stencils with no more bonds than a
/// point has equations cannot pass the load on from a third row.
pub fn load_rows(stencil: &Stencil) -> usize {
    if stencil.bonds.len() > least_squares::EQUATIONS { stencil.reach.max(ROWS_LEAST) } else { 2 }
}

/// Sets the multipliers of the bonds near the rim of the uncracked body.
/// Errors: no multipliers within the bounds come near equilibrium.
pub(super) fn balance(body: &mut Body, rim: &[Facet], sharing: &Sharing) -> Result<()> {
    let (near_rim, gains) = (near_rim(body), gains(body));
    let areas = areas(body, rim.iter().map(|facet| (facet, sharing.of(facet))));
    let is_asked = |place: &usize| {
        let changes = |bond: usize, other: usize| body.multiplier[bond] > 0.0 && (near_rim[*place] || near_rim[other]);
        areas.contains_key(place) || body.around(*place).any(|(.., bond, other)| changes(bond, other))
    };
    let members = body.points.iter().map(|&point| point as usize).filter(is_asked).collect();
    let equations = Equations::new(body, members, &areas, |_| 1.0, |place| near_rim[place]);
    let (links, sought) = equations.sought(body, &body.multiplier);
    // Inside the plate all bonds are there with multiplier 1.
    let missing = equations.missing(body, &gains, |_| 1.0, |bond, _| body.multiplier[bond]);
    let change = Problem::new(&gains, links, missing).solve("this outline")?;
    for (bond, change) in sought.into_iter().zip(change) {
        body.multiplier[bond] = settled(1.0 + change);
    }
    Ok(())
}

/// Points that the equations are asked of.
struct Equations {
    /// Places, ascending.
    members: Vec<usize>,
    /// Which of the members every place is, [`u32::MAX`] none.
    number: Vec<u32>,
    /// Share of its equations that is asked of every member.
    share: Vec<f64>,
    /// Whether the bonds of a member change: it, or one near it, misses a bond.
    changes: Vec<bool>,
    /// Rim that every member stands for.
    areas: Vec<[f64; 2]>,
}

impl Equations {
    fn new(
        body: &Body,
        members: Vec<usize>,
        areas: &HashMap<usize, [f64; 2]>,
        share: impl Fn(usize) -> f64,
        changes: impl Fn(usize) -> bool,
    ) -> Self {
        let mut number = vec![u32::MAX; body.places()];
        members.iter().enumerate().for_each(|(i, &place)| number[place] = i as u32);
        Equations {
            number,
            share: members.iter().map(|&place| share(place)).collect(),
            changes: members.iter().map(|&place| changes(place)).collect(),
            areas: members.iter().map(|place| areas.get(place).copied().unwrap_or_default()).collect(),
            members,
        }
    }

    /// Bonds that carry between two members: the numbers of these, which entry of the stencil, which bond.
    fn bonds<'a>(&'a self, body: &'a Body, now: &'a [f32]) -> impl Iterator<Item = (Link, usize)> + 'a {
        let of_owner = move |(i, &owner): (usize, &usize)| {
            body.steps.iter().enumerate().filter_map(move |(k, &step)| {
                let (to, bond) = (self.number[owner.wrapping_add_signed(step)], k * body.places() + owner);
                (to != u32::MAX && now[bond] > 0.0).then_some((Link { from: i as u32, to, k }, bond))
            })
        };
        self.members.iter().enumerate().flat_map(of_owner)
    }

    fn is_of_core(&self, link: &Link) -> bool {
        [link.from, link.to].into_iter().any(|end| self.share[end as usize] == 0.0)
    }

    fn may_change(&self, link: &Link) -> bool {
        [link.from, link.to].into_iter().any(|end| self.changes[end as usize])
    }

    /// Bonds whose multipliers are sought.
    fn sought(&self, body: &Body, now: &[f32]) -> (Vec<Link>, Vec<usize>) {
        self.bonds(body, now).filter(|(link, _)| !self.is_of_core(link) && self.may_change(link)).unzip()
    }

    /// What is asked of the members, and what bonds leave over that carry by another multiplier than that of the `whole`.
    fn missing(
        &self,
        body: &Body,
        gains: &[BondGain],
        whole: impl Fn(usize) -> f32,
        multiplier: impl Fn(usize, Option<Link>) -> f32,
    ) -> Vec<Gain> {
        let of_member = |(i, &place): (usize, &usize)| {
            let (mut left, mut kept): (Gain, Gain) = (asked(self.areas[i]), asked([0.0; 2]));
            for (k, sign, bond, other) in body.around(place) {
                let to = self.number[other];
                let link = (to != u32::MAX).then_some(Link { from: i as u32, to, k });
                let [whole, carried] = [whole(bond), multiplier(bond, link)].map(f64::from);
                let (sum, change) = if carried == 0.0 { (&mut left, whole) } else { (&mut kept, carried - whole) };
                if change != 0.0 {
                    sum.iter_mut().zip(gains[k].at(sign)).for_each(|(l, g)| *l += change * g);
                }
            }
            std::array::from_fn(|c| self.share[i] * left[c] - kept[c])
        };
        self.members.iter().enumerate().map(of_member).collect()
    }
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

/// Rim that places stand for: Σ share × length × normal, in lattice axes and spacings.
fn areas<'a>(body: &Body, shared: impl Iterator<Item = (&'a Facet, Vec<(u32, f64)>)>) -> HashMap<usize, [f64; 2]> {
    let mut areas: HashMap<usize, [f64; 2]> = HashMap::new();
    for (facet, shares) in shared {
        let whole = body.lattice.to_axes(facet.normal.map(|n| n * facet.length / body.lattice.spacing));
        for (place, share) in shares {
            let sum = areas.entry(place as usize).or_default();
            *sum = [sum[0] + share * whole[0], sum[1] + share * whole[1]];
        }
    }
    areas
}

/// Points that miss a neighbour and the rows behind them.
fn near_rim(body: &Body) -> Vec<bool> {
    let mut near = vec![false; body.places()];
    for place in body.points.iter().map(|&point| point as usize) {
        near[place] = body.around(place).any(|(.., bond, _)| body.multiplier[bond] == 0.0);
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
