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

/// A part of a cell.
#[derive(Debug, Clone)]
struct Patch {
    /// Sides of the cracks that it is on.
    side: u64,
    /// Area, m².
    area: f64,
    /// Node, unknown and its mean dilatation, 1/m.
    means: Vec<(u32, u32, f64)>,
}

/// Pieces of cracks near a cell, and its parts.
type Cell = (Vec<[Point; 2]>, Vec<Patch>);

/// Means over the cells of a plate.
#[derive(Debug, Clone, Default)]
pub struct Dilatation {
    /// λ - λ₀, Pa.
    modulus: f64,
    /// That over λ.
    share: f64,
    /// By leaf; none where all of λ counts point by point.
    cells: Vec<Cell>,
}

/// Whether means over cells take part in stress.
pub fn is_by_cells(elasticity: Elasticity) -> bool {
    elasticity.kappa < KAPPA_LEAST
}

/// Elastic constants that count point by point.
pub fn pointwise(mut elasticity: Elasticity) -> Elasticity {
    elasticity.kappa = elasticity.kappa.max(KAPPA_LEAST);
    elasticity
}

/// λ/G, and the share of λ that does not count point by point.
fn lame(elasticity: Elasticity) -> (f64, f64) {
    let [whole, least] = [elasticity, pointwise(elasticity)].map(|of| (3.0 - of.kappa) / (of.kappa - 1.0));
    (whole, 1.0 - least / whole)
}

/// Radius of influence of a node in its spacings, where compressible plates have the `usual` one.
pub fn influence_radius(elasticity: Elasticity, usual: f64) -> f64 {
    usual + lame(elasticity).1 * (INFLUENCE_LEAST - usual).max(0.0)
}

/// Sides of these lines that a point is on.
fn side(cracks: &[[Point; 2]], at: Point) -> u64 {
    cracks.iter().fold(0, |sides, &[a, b]| 2 * sides + u64::from(turn(a, b, at) > 0.0))
}

impl Dilatation {
    /// Means over the cells of a plate.
    pub fn of(specimen: &Specimen, plate: &Discretisation) -> Self {
        let elasticity = plate.elasticity();
        if !is_by_cells(elasticity) {
            return Dilatation::default();
        }
        let (whole, share) = lame(elasticity);
        let dividers = Dividers::of(plate);
        let of_cell = |(local, sums): &mut (Local, Vec<f64>), (leaf, points): (usize, Vec<QuadraturePoint>)| {
            let cracks = dividers.of_cell(leaf).cracks;
            plate.load(leaf, local);
            let mut patches: Vec<Patch> = Vec::new();
            let mut sides: Vec<u64> = points.iter().map(|point| side(&cracks, point.at)).collect();
            sides.sort_unstable();
            sides.dedup();
            for of_patch in sides {
                let (mut area, mut means) = (0.0, Vec::new());
                for point in points.iter().filter(|point| side(&cracks, point.at) == of_patch) {
                    if !plate.at_loaded(leaf, point.at, local) {
                        continue;
                    }
                    area += point.area;
                    plate.each_unknown(local, |node, unknown, (_, [[xx, _], [_, yy]])| {
                        if sums[unknown as usize] == 0.0 {
                            means.push((node, unknown, 0.0));
                        }
                        sums[unknown as usize] += point.area * (xx + yy);
                    });
                }
                means.iter_mut().for_each(|mean| mean.2 = std::mem::take(&mut sums[mean.1 as usize]) / area);
                patches.push(Patch { side: of_patch, area, means });
            }
            (leaf, (cracks, patches))
        };
        let room = || (Local::default(), vec![0.0; plate.unknowns()]);
        let found: Vec<(usize, Cell)> = quadrature(specimen, plate).into_par_iter().map_init(room, of_cell).collect();
        let mut cells = vec![Cell::default(); plate.grid.len()];
        found.into_iter().for_each(|(leaf, cell)| cells[leaf] = cell);
        Dilatation { modulus: share * whole * elasticity.shear_modulus, share, cells }
    }

    /// Adds `h (λ - λ₀) Σ A m_a m_b` of a leaf to a front in which a node has its unknowns, the first of which is `first[node]`, from
    /// `places[node]` on.
    pub fn add(&self, leaf: usize, thickness: f64, [first, places]: [&[u32]; 2], front: &mut Front) {
        for Patch { area, means, .. } in self.cells.get(leaf).iter().flat_map(|(_, patches)| patches) {
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
        let Some((cracks, patches)) = self.cells.get(leaf) else { return };
        let of_point = side(cracks, at);
        let Some(patch) = patches.iter().find(|patch| patch.side == of_point) else { return };
        let mean: f64 = patch.means.iter().map(|&(_, unknown, mean)| mean * u[unknown as usize]).sum();
        let more = 0.5 * self.share * (mean - *xx - *yy);
        *xx += more;
        *yy += more;
    }
}
