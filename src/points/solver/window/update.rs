//! Broken bonds as low-rank changes of a condensed stiffness.
//!
//! A broken bond adds `s w wᵀ` to the stiffness for each of its terms, s = ±1: -1 and w = √k (n, -n) or √k (t, -t, -r, -r) for
//! its springs. With the vectors as columns of W and the signs on the diagonal of Σ (Woodbury 1950):
//!
//! ```text
//! (S + W Σ Wᵀ)⁻¹ = G + G W C⁻¹ Wᵀ G,   C = -(Σ + Wᵀ G W),   G = S⁻¹
//! ```
//!
//! A column more adds a row to the factors L D Lᵀ of C; its pivot has the sign of -s as long as the plate holds together.
//! Displacement under the same load follows as `u = u₀ + G W y`, `C y = Wᵀ u₀`, and the work of the load grows by `y·Wᵀ u₀`.

use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::linalg::triangular_solve::solve_unit_lower_triangular_in_place;
use faer::{Accum, Mat, Par};

use super::condense::complete_upper;
use crate::solver::spring::Term;

/// Pivot of C below which the window is about to lose a part of itself.
const PIVOT_MIN: f64 = 1e-9;

/// Terms since the inverse was made.
#[derive(Debug, Default)]
pub struct Update {
    terms: Vec<Term>,
    /// Rows of L below the unit diagonal, one after the other.
    rows: Vec<Vec<f64>>,
    pivots: Vec<f64>,
    /// Wᵀ u₀.
    deformation: Vec<f64>,
}

impl Update {
    /// Terms taken in so far.
    pub fn rank(&self) -> usize {
        self.terms.len()
    }

    /// Takes in a term; `false` where the plate would not hold together.
    pub fn add(&mut self, inverse: &Mat<f64>, base: &[f64], term: Term) -> bool {
        let product = |a: &Term, b: &Term| -> f64 {
            b.vector.iter().map(|&(j, wj)| wj * a.vector.iter().map(|&(i, wi)| wi * inverse[(i, j)]).sum::<f64>()).sum()
        };
        // L D of the new row, then L.
        let mut row: Vec<f64> = Vec::with_capacity(self.rank());
        for (other, factor) in self.terms.iter().zip(&self.rows) {
            let done: f64 = factor.iter().zip(&row).map(|(l, r)| l * r).sum();
            row.push(-product(other, &term) - done);
        }
        let mut pivot = -term.sign - product(&term, &term);
        for (entry, d) in row.iter_mut().zip(&self.pivots) {
            let scaled = *entry / d;
            pivot -= scaled * *entry;
            *entry = scaled;
        }
        let holds = -term.sign * pivot;
        if holds.is_nan() || holds <= PIVOT_MIN {
            return false;
        }
        self.deformation.push(term.vector.iter().map(|&(i, w)| w * base[i]).sum());
        self.rows.push(row);
        self.pivots.push(pivot);
        self.terms.push(term);
        true
    }

    /// Displacement of the window from that before the breaks, and the gain of the load's work.
    pub fn displacement(&self, inverse: &Mat<f64>, base: &[f64]) -> (Vec<f64>, f64) {
        // L z = b, D Lᵀ y = z.
        let mut y: Vec<f64> = Vec::with_capacity(self.rank());
        for (row, b) in self.rows.iter().zip(&self.deformation) {
            let done: f64 = row.iter().zip(&y).map(|(l, z)| l * z).sum();
            y.push(b - done);
        }
        y.iter_mut().zip(&self.pivots).for_each(|(y, d)| *y /= d);
        for i in (0..self.rank()).rev() {
            for j in 0..i {
                y[j] -= self.rows[i][j] * y[i];
            }
        }
        let gain = y.iter().zip(&self.deformation).map(|(y, b)| y * b).sum();
        let mut force = vec![0.0; base.len()];
        for (term, y) in self.terms.iter().zip(&y) {
            term.vector.iter().for_each(|&(i, w)| force[i] += w * y);
        }
        let mut displacement = base.to_vec();
        for (j, &force) in force.iter().enumerate().filter(|(_, force)| **force != 0.0) {
            for (u, g) in displacement.iter_mut().zip(inverse.col_as_slice(j)) {
                *u += force * g;
            }
        }
        (displacement, gain)
    }

    /// Puts all breaks into the inverse and forgets them.
    pub fn fold(&mut self, inverse: &mut Mat<f64>) {
        let (order, rank) = (inverse.nrows(), self.rank());
        // Columns of (G W)ᵀ, then L⁻¹ (G W)ᵀ.
        let mut reduced = Mat::<f64>::zeros(rank, order);
        for (row, term) in self.terms.iter().enumerate() {
            for &(i, w) in &term.vector {
                for (j, g) in inverse.col_as_slice(i).iter().enumerate() {
                    reduced[(row, j)] += w * g;
                }
            }
        }
        let factor = Mat::from_fn(rank, rank, |i, j| if i > j { self.rows[i][j] } else { 0.0 });
        solve_unit_lower_triangular_in_place(factor.as_ref(), reduced.as_mut(), Par::Seq);
        let mut scaled = reduced.clone();
        for j in 0..order {
            scaled.col_as_slice_mut(j).iter_mut().zip(&self.pivots).for_each(|(value, pivot)| *value /= pivot);
        }
        triangular::matmul(
            inverse.as_mut(),
            BlockStructure::TriangularLower,
            Accum::Add,
            reduced.transpose(),
            BlockStructure::Rectangular,
            scaled.as_ref(),
            BlockStructure::Rectangular,
            1.0,
            Par::Seq,
        );
        complete_upper(inverse);
        *self = Update::default();
    }
}
