//! Sparse Cholesky factorisation by faer: the reference that other solvers are compared with.

use faer::linalg::solvers::Solve;
use faer::sparse::{SparseColMat, Triplet};

use super::field::dot;
use super::product::Product;
use super::{LinearSolver, Solved, System};
use crate::body::{Body, Bond};
use crate::error::{Error, Result};
use crate::state::Bonds;

/// Factorises anew for every solve.
#[derive(Debug, Clone, Default)]
pub struct DirectSolver {}

impl<const N: usize> LinearSolver<N> for DirectSolver {
    fn solve(&mut self, system: System<'_, N>, u: &mut [f64]) -> Result<Solved> {
        let System { body, bonds, product, f } = system;
        let layout = product.layout();
        let mut number = vec![usize::MAX; layout.len()];
        let mut indices = Vec::new();
        let held: std::collections::HashSet<usize> = product.fixed().iter().copied().chain(pins(body, bonds, product)).collect();
        for &place in &body.points {
            let at = layout.index(place as usize);
            for index in (0..N).map(|c| at + c * layout.stride) {
                if !held.contains(&index) {
                    number[index] = indices.len();
                    indices.push(index);
                }
            }
        }
        let mut entries: Vec<Triplet<usize, usize, f64>> = Vec::with_capacity(indices.len() * 40);
        let places = body.places();
        for &point in &body.points {
            let place = point as usize;
            for (k, &step) in body.steps.iter().enumerate() {
                let share = f64::from(bonds.multiplier[k * places + place]);
                if share == 0.0 {
                    continue;
                }
                let other = place.wrapping_add_signed(step);
                let (from, to) = (layout.index(place), layout.index(other));
                for (sign, a, b) in [(1.0, from, to), (-1.0, to, from)] {
                    let (own, off) = product.bond_blocks(k, sign, share);
                    for c in 0..N {
                        let row = number[a + c * layout.stride];
                        if row == usize::MAX {
                            continue;
                        }
                        for d in 0..N {
                            for (column, value) in
                                [(number[a + d * layout.stride], own[c][d]), (number[b + d * layout.stride], off[c][d])]
                            {
                                if column != usize::MAX && value != 0.0 && column <= row {
                                    entries.push(Triplet::new(row, column, value));
                                }
                            }
                        }
                    }
                }
            }
        }
        // Points without bonds have empty rows: a unit diagonal keeps them at rest.
        let mut filled = vec![false; indices.len()];
        entries.iter().filter(|t| t.row == t.col).for_each(|t| filled[t.row] = true);
        entries.extend(filled.iter().enumerate().filter(|(_, f)| !**f).map(|(i, _)| Triplet::new(i, i, 1.0)));
        let n = indices.len();
        let matrix = SparseColMat::<usize, f64>::try_new_from_triplets(n, n, &entries)
            .map_err(|e| Error::Mechanics(format!("the stiffness matrix could not be built: {e:?}")))?;
        drop(entries);
        let factor = matrix
            .sp_cholesky(faer::Side::Lower)
            .map_err(|e| Error::Mechanics(format!("the stiffness matrix is not positive definite: {e:?}")))?;
        let rhs = faer::Mat::from_fn(n, 1, |i, _| f[indices[i]]);
        let solution = factor.solve(&rhs);
        u.fill(0.0);
        for (i, &index) in indices.iter().enumerate() {
            u[index] = solution[(i, 0)];
        }
        Ok(Solved { iterations: 0, work: dot(layout, f, u) })
    }

    fn broke(&mut self, _: &Body, _: &Bonds, _: &Product<N>, _: &[Bond]) {}
}

/// Components that hold a floating plate without carrying load.
fn pins<const N: usize>(body: &Body, bonds: &Bonds, product: &Product<N>) -> Vec<usize> {
    if !product.fixed().is_empty() {
        return Vec::new();
    }
    let layout = product.layout();
    let carrying = || body.points.iter().map(|&p| p as usize).filter(|&p| bonds.intact_at(body, p) > 3);
    let (Some(first), Some(last)) = (carrying().next(), carrying().next_back()) else { return Vec::new() };
    let pinned = pinned_components::<N>(body, first, last);
    pinned.into_iter().map(|(place, component)| layout.index(place) + component * layout.stride).collect()
}

/// Of two distant points the components that hold a floating plate: both of one and, where the law lets the plate turn
/// freely, the one across of the other. A law that resists rotation has an equilibrium position to turn to.
pub(super) fn pinned_components<const N: usize>(body: &Body, first: usize, last: usize) -> Vec<(usize, usize)> {
    let (a, b) = (body.lattice.column_row(first), body.lattice.column_row(last));
    let across = usize::from(b.1.abs_diff(a.1) <= b.0.abs_diff(a.0));
    let turns = N == 3 || body.stencil.bonds.iter().all(|bond| bond.k_t <= 1e-9 * bond.k_n);
    let mut held = vec![(first, 0), (first, 1)];
    held.extend(turns.then_some((last, across)));
    held
}
