//! Dilatation of nearly incompressible plates (plane strain, ν above 0.4): stress beyond that of ν = 0.4 comes from means over cells.
//!
//! Moving least squares lock as λ/G grows (Dolbow and Belytschko 1999, Comput. Mech. 23:30; Huerta and Fernández-Méndez 2001, IJNME 51:1361):
//! with full integration every point requires no dilatation. With means (B-bar: Hughes 1980, IJNME 15:1413) about one condition is left
//! for each node:
//! ```text
//! K_ab = h ∫ e_aᵀ D(λ₀) e_b dA + h (λ - λ₀) Σ A m_a m_b,   m_a = 1/A ∫ div φ_a dA,   λ₀ = min(λ, 4 G)
//! ```
//! over the parts A into which cracks divide cells. K of a pulled plate and a lug is within 0.2 % of finite elements at ν = 0.48 to 0.499; without
//! means it is 4 % low.

use std::collections::HashMap;

use super::front::FrontalMatrix;
use perilife_plate::specimen::Point;
use perilife_plate::specimen::geometry::turn;
use perilife_plate::williams::Elasticity;

/// Kolosov's constant at ν = 0.4 in plane strain; in plane stress it is always above.
const KAPPA_LEAST: f64 = 1.4;
/// Radius of influence of a node in its spacings, at least, of an incompressible plate: with 2.2 K is up to 0.8 % high beside cracks that lie on
/// the edges of cells.
const INFLUENCE_LEAST: f64 = 2.75;

/// A part of a cell.
#[derive(Debug, Clone)]
pub struct Patch {
    /// Sides of the cracks that it is on.
    pub side: u64,
    pub area: f64,
    /// Node, unknown and its mean dilatation, 1/m.
    pub means: Vec<(u32, u32, f64)>,
}

/// Pieces of cracks near a cell, and its parts.
pub type Cell = (Vec<[Point; 2]>, Vec<Patch>);

/// Means over the cells of a plate: λ - λ₀, Pa, that over λ, and cells by leaf.
#[derive(Debug, Clone)]
pub struct Dilatation {
    modulus: f64,
    share: f64,
    cells: HashMap<usize, Cell>,
}

/// Elastic constants that count point by point, λ - λ₀, Pa, and that over λ.
pub fn split(elasticity: Elasticity) -> (Elasticity, [f64; 2]) {
    let mut pointwise = elasticity;
    pointwise.kappa = pointwise.kappa.max(KAPPA_LEAST);
    let [whole, least] = [elasticity, pointwise].map(|of| of.stress(&[[1.0, 0.0], [0.0, 0.0]])[1]);
    // The share is not a number at ν = 0.
    (pointwise, [whole - least, (1.0 - least / whole).max(0.0)])
}

/// Radius of influence of a node in its spacings, where compressible plates have the `usual` one.
pub fn influence_radius(elasticity: Elasticity, usual: f64) -> f64 {
    usual + split(elasticity).1[1] * (INFLUENCE_LEAST - usual).max(0.0)
}

/// Sides of these lines that a point is on, however many there are: a hash (Fowler, Noll and Vo).
pub fn side(cracks: &[[Point; 2]], at: Point) -> u64 {
    let one = |sides: u64, &[a, b]: &[Point; 2]| (sides ^ u64::from(turn(a, b, at) > 0.0)).wrapping_mul(0x0100_0000_01b3);
    cracks.iter().fold(0xcbf2_9ce4_8422_2325, one)
}

impl Dilatation {
    /// By leaf, where not all of λ counts point by point.
    pub fn new(elasticity: Elasticity, cells: HashMap<usize, Cell>) -> Self {
        let (_, [modulus, share]) = split(elasticity);
        Dilatation { modulus, share, cells }
    }

    /// Adds `h (λ - λ₀) Σ A m_a m_b` of a leaf to a front in which a node has its unknowns, the first of which is `first[node]`, from
    /// `places[node]` on.
    pub fn add(&self, leaf: usize, thickness: f64, [first, places]: [&[u32]; 2], front: &mut FrontalMatrix) {
        for Patch { area, means, .. } in self.cells.get(&leaf).iter().flat_map(|(_, patches)| patches) {
            let place = |&(node, unknown, mean)| ((places[node as usize] + unknown - first[node as usize]) as usize, mean);
            let mut placed: Vec<(usize, f64)> = means.iter().map(place).collect();
            placed.sort_unstable_by_key(|(place, _)| *place);
            for (k, &(column, mean)) in placed.iter().enumerate() {
                let ((sums, first), stress) = (front.column(column), thickness * self.modulus * area * mean);
                placed[k..].iter().for_each(|(row, mean)| sums[row - first] += stress * mean);
            }
        }
    }

    /// Gives a gradient at a point of a leaf the dilatation that makes the stress there.
    pub fn project(&self, leaf: usize, u: &[f64], at: Point, [[xx, _], [_, yy]]: &mut [[f64; 2]; 2]) {
        let Some((cracks, patches)) = self.cells.get(&leaf) else { return };
        let of_point = side(cracks, at);
        let Some(patch) = patches.iter().find(|patch| patch.side == of_point) else { return };
        let mean: f64 = patch.means.iter().map(|&(_, unknown, mean)| mean * u[unknown as usize]).sum();
        let more = 0.5 * self.share * (mean - *xx - *yy);
        *xx += more;
        *yy += more;
    }
}
