//! Fictitious density of dynamic relaxation.
//!
//! Central differences with time step 1 are stable while no frequency exceeds 2, that is for K ≤ 4 Λ. Row sums give that by
//! Gershgorin's theorem, `λ_i = ¼ Σ_j |K_ij|` (Underwood 1983; Kilic and Madenci 2010), whatever the scale of an unknown, so for
//! rotations too. A lattice body allows less: a spring `k (b - a)²` between two points, a and b made of the unknowns of one
//! point each, is at most `2 k (a² + b²)`, so K is at most twice its diagonal blocks, and Gershgorin's theorem is needed within
//! the block of a point only: `λ_c = ½ Σ_d |K_cd|` over the unknowns d of the same point. Never more than the row sums of the whole
//! matrix, and a quarter less inside the plate.
//!
//! The dilatation of a state-based law stores at most `g + g'` times the energy of a normal spring between points of gain g and g'
//! (Cauchy's inequality), which then counts as so much stiffer; a negative one counts as none.

use rayon::prelude::*;

use super::super::product::Product;
use crate::body::Body;
use crate::state::Bonds;

/// Λ of the unknowns of some points, N/m; 0 at points without bonds.
pub(super) fn densities<const N: usize>(body: &Body, bonds: &Bonds, product: &Product<N>, places: &[usize]) -> Vec<[f64; N]> {
    let of_place = |&place: &usize| {
        diagonal_block(body, bonds, product, place).map(|row| 0.5 * row.iter().map(|value| value.abs()).sum::<f64>())
    };
    places.par_iter().map(of_place).collect()
}

/// Diagonal block of a point, springs made stiffer by the dilatation.
fn diagonal_block<const N: usize>(body: &Body, bonds: &Bonds, product: &Product<N>, place: usize) -> [[f64; N]; N] {
    let gain = |place: usize| product.dilatation().map_or(0.0, |dilatation| dilatation.gain(body.behind(place).0).max(0.0));
    let mut block = [[0.0; N]; N];
    for (k, &step) in body.steps.iter().enumerate() {
        for sign in [1_isize, -1] {
            let owner = if sign > 0 { place } else { place.wrapping_add_signed(-step) };
            let share = f64::from(bonds.multiplier[k * body.places() + owner]);
            if share > 0.0 {
                let stiffer = gain(place) + gain(place.wrapping_add_signed(sign * step));
                let (own, _) = product.bond_blocks(k, sign as f64, share * (1.0 + stiffer));
                for (row, own) in block.iter_mut().zip(own) {
                    row.iter_mut().zip(own).for_each(|(sum, value)| *sum += value);
                }
            }
        }
    }
    block
}
