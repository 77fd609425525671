//! Balanced correction on points of several levels: uniform strain in equilibrium at the rim and where levels meet.
//!
//! The equations are those of [`perilife_points::body::balanced`], with pairs of points for bonds: the two bonds of a pair of unequal horizons
//! pull along the same line on the same points and so are one spring. Where levels meet, a point sees more on one side than
//! on the other, and uniform strain leaves forces over just as at a rim, but for the traction: multipliers of the pairs
//! there, as near to 1 as possible, take them away. Momentum stays exact, since a pair still pulls both ends alike.

use std::collections::BTreeMap;

use super::levels::Levels;
use super::loads::Sharing;
use perilife_base::error::Result;
use perilife_plate::specimen::Specimen;
use perilife_plate::specimen::facets::facets;
use perilife_points::body::balanced::least_squares::{BondGain, Gain, Link, Problem};
use perilife_points::body::balanced::{ROWS_LEAST, ROWS_MORE, asked, gain};
use perilife_points::bond_law::stencil::Stencil;
use perilife_points::net::Net;

/// A pair of points with its bonds.
struct Pair {
    bonds: Vec<u32>,
    gain: BondGain,
}

/// Sets the multipliers of the bonds near the rim and near changes of level, on the uncracked net.
/// Errors: no multipliers within the bounds come near equilibrium.
pub fn balance(net: &mut Net, specimen: &Specimen, levels: &Levels, stencils: &[Stencil], sharing: &Sharing<'_>) -> Result<()> {
    let finest = levels.finest().spacing;
    let irregular = irregular(net, levels, stencils);
    let pairs = pairs(net, levels, &stencils[0], finest);
    let mut areas = vec![[0.0; 2]; net.len()];
    for facet in facets(specimen, finest) {
        let whole = levels.lattices[0].to_axes(facet.normal.map(|n| n * facet.length / finest));
        for (point, share) in sharing.of(&facet) {
            let sum = &mut areas[point as usize];
            *sum = [sum[0] + share * whole[0], sum[1] + share * whole[1]];
        }
    }
    let changes = |&(from, to): &(u32, u32)| irregular[from as usize] || irregular[to as usize];
    let mut involved: Vec<bool> = areas.iter().map(|a| a[0] != 0.0 || a[1] != 0.0).collect();
    for (from, to) in pairs.keys().filter(|ends| changes(ends)) {
        (involved[*from as usize], involved[*to as usize]) = (true, true);
    }
    let mut number = vec![u32::MAX; net.len()];
    let members: Vec<usize> = (0..net.len()).filter(|&i| involved[i]).collect();
    members.iter().enumerate().for_each(|(n, &i)| number[i] = n as u32);
    let mut missing: Vec<Gain> = members.iter().map(|&i| asked(areas[i])).collect();
    let (mut links, mut gains, mut changed) = (Vec::new(), Vec::new(), Vec::new());
    for (ends @ &(from, to), pair) in &pairs {
        for (end, gain) in [(from, pair.gain.at_owner), (to, pair.gain.at_other)] {
            if involved[end as usize] {
                missing[number[end as usize] as usize].iter_mut().zip(gain).for_each(|(left, g)| *left -= g);
            }
        }
        if changes(ends) {
            links.push(Link { from: number[from as usize], to: number[to as usize], k: gains.len() });
            gains.push(pair.gain);
            changed.push(&pair.bonds);
        }
    }
    let change = Problem::new(&gains, links, missing).solve("these points")?;
    for (bonds, change) in changed.into_iter().zip(change) {
        for &b in bonds {
            let bond = &mut net.bonds[b as usize];
            (bond.k_n, bond.k_t) = (bond.k_n * (1.0 + change), bond.k_t * (1.0 + change));
        }
    }
    Ok(())
}

/// Points that miss a bond of their lattice, at a rim or a change of level, and the rows behind them.
fn irregular(net: &Net, levels: &Levels, stencils: &[Stencil]) -> Vec<bool> {
    let mut found = vec![0_usize; net.len()];
    for bond in &net.bonds[..net.mutual] {
        found[bond.from as usize] += 1;
        found[bond.to as usize] += 1;
    }
    let mut irregular: Vec<bool> =
        levels.leaves.iter().zip(found).map(|(leaf, found)| found < 2 * stencils[leaf.level].bonds.len()).collect();
    for _ in stencils[0].reach..ROWS_LEAST.max(stencils[0].reach + ROWS_MORE) {
        let before = irregular.clone();
        for (leaf, irregular) in levels.leaves.iter().zip(&mut irregular) {
            let (column, row) = (leaf.column as i64, leaf.row as i64);
            let sides = [(1, 0), (-1, 0), (0, 1), (0, -1)].map(|(dx, dy)| levels.point_at(leaf.level, column + dx, row + dy));
            *irregular |= sides.into_iter().flatten().any(|side| before[side]);
        }
    }
    irregular
}

/// All pairs with a bond, in order, their lower point as owner; spacing 1 and S₂₂ = 1 on the finest lattice. Springs of the
/// same steps are equal on all levels, and so is S₂₂ in units of the spacing.
fn pairs(net: &Net, levels: &Levels, stencil: &Stencil, finest: f64) -> BTreeMap<(u32, u32), Pair> {
    let s22: f64 = stencil
        .bonds
        .iter()
        .map(|bond| bond.k_n * (bond.length / stencil.spacing * bond.normal[0] * bond.normal[1]).powi(2))
        .sum();
    let mut pairs = BTreeMap::<(u32, u32), Pair>::new();
    for (b, bond) in net.bonds.iter().enumerate() {
        let turned = bond.from > bond.to;
        let ends = if turned { (bond.to, bond.from) } else { (bond.from, bond.to) };
        let normal = levels.lattices[0].to_axes(if turned { bond.normal.map(|n| -n) } else { bond.normal });
        let own = gain(bond.k_n / s22, bond.length / finest, normal);
        let pair =
            pairs.entry(ends).or_insert(Pair { bonds: Vec::new(), gain: BondGain { at_owner: [0.0; 6], at_other: [0.0; 6] } });
        pair.bonds.push(b as u32);
        pair.gain.at_owner.iter_mut().zip(own.at_owner).for_each(|(sum, g)| *sum += g);
        pair.gain.at_other.iter_mut().zip(own.at_other).for_each(|(sum, g)| *sum += g);
    }
    pairs
}
