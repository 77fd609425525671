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

use rayon::prelude::*;

use super::cells::{Dividers, QuadraturePoint, quadrature};
use super::field::{Discretisation, Local};
use super::front::Front;
use perilife_plate::specimen::geometry::turn;
use perilife_plate::specimen::{Point, Specimen};
use perilife_plate::williams::Elasticity;

/// Kolosov's constant at ν = 0.4 in plane strain; in plane stress it is always above.
const KAPPA_LEAST: f64 = 1.4;
/// Radius of influence of a node in its spacings, at least, of an incompressible plate: with 2.2 K is up to 0.8 % high beside cracks that lie on
/// the edges of cells.
const INFLUENCE_LEAST: f64 = 2.75;

/// A part of a cell: sides of the cracks that it is on, area, m², and node, unknown and its mean dilatation, 1/m.
#[derive(Debug, Clone)]
struct Patch {
    side: u64,
    area: f64,
    means: Vec<(u32, u32, f64)>,
}

/// Means over the cells of a plate: λ - λ₀, Pa, that over λ, and by leaf the pieces of cracks near a cell and its parts, none where all of λ counts
/// point by point.
#[derive(Debug, Clone, Default)]
pub struct Dilatation {
    modulus: f64,
    share: f64,
    cells: HashMap<usize, (Vec<[Point; 2]>, Vec<Patch>)>,
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

/// Sides of these lines that a point is on.
fn side(cracks: &[[Point; 2]], at: Point) -> u64 {
    cracks.iter().fold(0, |sides, &[a, b]| 2 * sides + u64::from(turn(a, b, at) > 0.0))
}

impl Dilatation {
    /// Means over the cells of a plate.
    pub fn of(specimen: &Specimen, plate: &Discretisation) -> Self {
        let (_, [modulus, share]) = split(plate.elasticity());
        if share == 0.0 {
            return Dilatation::default();
        }
        let dividers = Dividers::of(plate);
        let of_cell = |(local, sums): &mut (Local, Vec<f64>), (leaf, mut points): (usize, Vec<QuadraturePoint>)| {
            let cracks = dividers.of_cell(leaf).cracks;
            let of_point = |point: &QuadraturePoint| side(&cracks, point.at);
            plate.load(leaf, local);
            points.sort_by_key(of_point);
            let patches: Vec<Patch> = points
                .chunk_by(|a, b| of_point(a) == of_point(b))
                .map(|points| {
                    let (mut area, mut means) = (0.0, Vec::new());
                    for point in points {
                        // Where nodes do not span the basis, `assembly` decides.
                        if plate.at_loaded(leaf, point.at, local) {
                            area += point.area;
                            plate.each_unknown(local, |node, unknown, (_, [[xx, _], [_, yy]])| {
                                let sum = &mut sums[unknown as usize];
                                if *sum == 0.0 {
                                    means.push((node, unknown, 0.0));
                                }
                                *sum += point.area * (xx + yy);
                            });
                        }
                    }
                    means.iter_mut().for_each(|mean| mean.2 = std::mem::take(&mut sums[mean.1 as usize]) / area);
                    Patch { side: of_point(&points[0]), area, means }
                })
                .collect();
            (leaf, (cracks, patches))
        };
        let room = || (Local::default(), vec![0.0; plate.unknowns()]);
        let cells = quadrature(specimen, plate).into_par_iter().map_init(room, of_cell).collect();
        Dilatation { modulus, share, cells }
    }

    /// Adds `h (λ - λ₀) Σ A m_a m_b` of a leaf to a front in which a node has its unknowns, the first of which is `first[node]`, from
    /// `places[node]` on.
    pub fn add(&self, leaf: usize, thickness: f64, [first, places]: [&[u32]; 2], front: &mut Front) {
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
