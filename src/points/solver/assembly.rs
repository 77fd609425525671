//! The stiffness bond by bond, for solvers that need its entries.

use super::dilatation::Dilatation;
use super::product::Product;
use super::spring::Blocks;
use crate::body::Body;
use crate::body::mirror::{Flips, signs};
use crate::state::Bonds;

/// Entries of a stiffness with M unknowns a point.
pub trait Assembly<const M: usize>: Sync {
    /// What stencil bond k in direction `sign` (+1 from its owner, -1 from the other end), with its multiplier, brings to the
    /// block of the point with itself and to that with the other end.
    fn bond(&self, k: usize, sign: f64, multiplier: f64) -> Blocks<M>;
    /// What the point brings by itself to the diagonal of its last unknown.
    fn point(&self, place: usize) -> f64;
    /// Whether a component of a point is held.
    fn is_held(&self, place: usize, component: usize) -> bool;
    fn pivot_sign(&self, component: usize) -> f64;
    /// Signs of the unknowns of a mirror image.
    fn signs(&self, flips: Flips) -> [f64; M];
}

/// A bond between a point and another, or a mirror image of one, as entries of the stiffness.
pub struct Joint<const M: usize> {
    /// The other point, or that whose mirror image is the other end.
    pub other: usize,
    pub is_image: bool,
    /// Blocks of the row of the point: with itself, with the other.
    pub here: Blocks<M>,
    /// Blocks of the row of the other: with itself, with the point.
    pub there: Blocks<M>,
}

/// Calls `take` for every intact bond of a point.
pub fn for_joints<const M: usize>(
    assembly: &impl Assembly<M>,
    body: &Body,
    bonds: &Bonds,
    place: usize,
    mut take: impl FnMut(Joint<M>, bool),
) {
    for (k, sign, bond, end) in body.around(place) {
        let share = f64::from(bonds.multiplier[bond]);
        if share == 0.0 {
            continue;
        }
        let (other, flips) = body.behind(end);
        let (mut here, mut there) = (assembly.bond(k, sign, share), assembly.bond(k, -sign, share));
        let is_image = flips != [false; 2];
        if is_image {
            let signs = assembly.signs(flips);
            for c in 0..M {
                for d in 0..M {
                    here.1[c][d] *= signs[d];
                    there.0[c][d] *= signs[c] * signs[d];
                    there.1[c][d] *= signs[c];
                }
            }
        }
        take(Joint { other, is_image, here, there }, sign > 0.0);
    }
}

/// The springs of a body.
pub struct Springs<'a, const N: usize>(pub &'a Product<N>);

impl<const N: usize> Assembly<N> for Springs<'_, N> {
    fn bond(&self, k: usize, sign: f64, multiplier: f64) -> Blocks<N> {
        self.0.bond_blocks(k, sign, multiplier)
    }

    fn point(&self, _: usize) -> f64 {
        0.0
    }

    fn is_held(&self, place: usize, component: usize) -> bool {
        self.0.is_held(place, component)
    }

    fn pivot_sign(&self, _: usize) -> f64 {
        1.0
    }

    fn signs(&self, flips: Flips) -> [f64; N] {
        std::array::from_fn(|c| signs(flips)[c])
    }
}

/// Springs and dilatation, the stress P of a point being its third unknown ([`super::dilatation`]).
pub struct Mixed<'a, const N: usize> {
    pub product: &'a Product<N>,
    pub dilatation: &'a Dilatation,
    pub body: &'a Body,
    pub bonds: &'a Bonds,
}

/// Unknowns of a point with its stress.
pub const MIXED: usize = 3;

impl<const N: usize> Assembly<MIXED> for Mixed<'_, N> {
    fn bond(&self, k: usize, sign: f64, multiplier: f64) -> Blocks<MIXED> {
        let springs = self.product.bond_blocks(k, sign, multiplier);
        let (mut own, mut off) = ([[0.0; MIXED]; MIXED], [[0.0; MIXED]; MIXED]);
        let force = self.dilatation.force(k);
        for i in 0..2 {
            for j in 0..2 {
                own[i][j] = springs.0[i][j];
                off[i][j] = springs.1[i][j];
            }
            // Either end's D holds k_n r n·(u' - u), n from the owner to the other end.
            let along = sign * multiplier * force[i];
            own[i][2] = -along;
            own[2][i] = -along;
            off[i][2] = -along;
            off[2][i] = along;
        }
        (own, off)
    }

    fn point(&self, place: usize) -> f64 {
        -self.dilatation.compliance(self.body, self.bonds, place)
    }

    fn is_held(&self, place: usize, component: usize) -> bool {
        component < N && self.product.is_held(place, component)
    }

    fn pivot_sign(&self, component: usize) -> f64 {
        if component < 2 { 1.0 } else { -self.dilatation.sign() }
    }

    fn signs(&self, flips: Flips) -> [f64; MIXED] {
        let [x, y, _] = signs(flips);
        [x, y, 1.0]
    }
}
