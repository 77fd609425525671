//! Upper bound of the stiffness, for densities and time steps of explicit motion.

use rayon::prelude::*;

use super::control::Control;
use super::elasticity::Elasticity;
use super::neighbours::Neighbours;
use super::shape::Shape;
use crate::levels::Net;

/// Allowance for finite strain: `|F|²` up to a strain of 5 %.
const FINITE_STRAIN: f64 = 1.1;

/// A bound of every point, N/m.
///
/// `H = Σ u' ⊗ g` with `g = V' K⁻¹ ξ`, and `-Σ g` at the point itself, so the block of two points in the energy `V H:C:H/2` of
/// a third is at the most `V λ |g| |g'|`, λ the largest eigenvalue of C. The rows sum to `λ Σ V |g| Σ |g'|` over the
/// neighbourhoods to which a point belongs. Springs of stiffness `c V V'` add twice their sum; those on the uneven part, a
/// projection, at the most as much.
pub fn of_points(net: &Net, neighbours: &Neighbours, shape: &Shape, elasticity: &Elasticity, control: &Control) -> Vec<[f64; 2]> {
    // |g| at the point itself, and Σ |g| over its neighbourhood with itself.
    let sums = |i: usize| {
        let Some(inverse) = shape.inverse(i) else { return [0.0; 2] };
        let (mut whole, mut lengths) = (nalgebra::Vector2::zeros(), 0.0);
        for n in neighbours.of_point(i).iter().filter(|n| shape.counts(n.bond)) {
            let g = net.volumes[n.other as usize] * inverse * n.xi;
            whole += g;
            lengths += g.norm();
        }
        [whole.norm(), lengths + whole.norm()]
    };
    let sums: Vec<[f64; 2]> = (0..net.len()).into_par_iter().with_min_len(256).map(sums).collect();
    let spring = control.on_relative() + control.on_uneven();
    let of_point = |i: usize| {
        let volume = net.volumes[i];
        let (mut rows, mut springs) = (volume * sums[i][0] * sums[i][1], 0.0);
        for n in neighbours.of_point(i) {
            let other = n.other as usize;
            if let Some(inverse) = shape.inverse(other).filter(|_| shape.counts(n.bond)) {
                rows += net.volumes[other] * volume * (inverse * n.xi).norm() * sums[other][1];
            }
            if shape.bears(n.bond) {
                springs += 2.0 * spring * volume * net.volumes[other];
            }
        }
        [FINITE_STRAIN * elasticity.largest() * rows + springs, 0.0]
    };
    (0..net.len()).into_par_iter().with_min_len(256).map(of_point).collect()
}
