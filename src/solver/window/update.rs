//! Broken bonds as low-rank changes of a condensed stiffness.
//!
//! A broken bond takes `w wᵀ` from the stiffness for each of its springs, w = √k (n, -n) and √k (t, -t, -r, -r). With the
//! vectors as columns of W (Woodbury 1950):
//!
//! ```text
//! (S - W Wᵀ)⁻¹ = G + G W C⁻¹ Wᵀ G,   C = 1 - Wᵀ G W,   G = S⁻¹
//! ```
//!
//! A column more adds a row to the Cholesky factor of C. Displacement under the same load follows as
//! `u = u₀ + G W y`, `C y = Wᵀ u₀`, and the work of the load grows by `y·Wᵀ u₀`.

use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::{Accum, Mat, Par};

/// Square of a pivot of C below which the window is about to lose a part of itself.
const PIVOT_MIN: f64 = 1e-9;

/// One spring of a broken bond: index in the window's vector and weight.
pub type Spring = Vec<(usize, f64)>;

/// Springs broken since the inverse was made.
#[derive(Debug, Default)]
pub struct Update {
    springs: Vec<Spring>,
    /// Rows of the Cholesky factor of C, one after the other.
    rows: Vec<Vec<f64>>,
    /// Wᵀ u₀.
    opening: Vec<f64>,
}

impl Update {
    /// Springs taken in so far.
    #[must_use]
    pub fn rank(&self) -> usize {
        self.springs.len()
    }

    /// Takes in a broken spring; `false` where the stiffness left would not be positive definite.
    #[must_use]
    pub fn add(&mut self, inverse: &Mat<f64>, base: &[f64], spring: Spring) -> bool {
        let product = |a: &Spring, b: &Spring| -> f64 {
            b.iter().map(|&(j, wj)| wj * a.iter().map(|&(i, wi)| wi * inverse[(i, j)]).sum::<f64>()).sum()
        };
        let mut row: Vec<f64> = Vec::with_capacity(self.rank() + 1);
        for (other, factor) in self.springs.iter().zip(&self.rows) {
            let done: f64 = factor.iter().zip(&row).map(|(l, r)| l * r).sum();
            row.push((-product(other, &spring) - done) / factor[factor.len() - 1]);
        }
        let pivot = 1.0 - product(&spring, &spring) - row.iter().map(|l| l * l).sum::<f64>();
        if pivot.is_nan() || pivot <= PIVOT_MIN {
            return false;
        }
        row.push(pivot.sqrt());
        self.opening.push(spring.iter().map(|&(i, w)| w * base[i]).sum());
        self.rows.push(row);
        self.springs.push(spring);
        true
    }

    /// Displacement of the window from that before the breaks, and the gain of the load's work.
    #[must_use]
    pub fn displacement(&self, inverse: &Mat<f64>, base: &[f64]) -> (Vec<f64>, f64) {
        // L z = b, Lᵀ y = z.
        let mut y: Vec<f64> = Vec::with_capacity(self.rank());
        for (row, b) in self.rows.iter().zip(&self.opening) {
            let done: f64 = row.iter().zip(&y).map(|(l, z)| l * z).sum();
            y.push((b - done) / row[row.len() - 1]);
        }
        for i in (0..self.rank()).rev() {
            y[i] /= self.rows[i][i];
            for j in 0..i {
                y[j] -= self.rows[i][j] * y[i];
            }
        }
        let gain = y.iter().zip(&self.opening).map(|(y, b)| y * b).sum();
        let mut force = vec![0.0; base.len()];
        for (spring, y) in self.springs.iter().zip(&y) {
            spring.iter().for_each(|&(i, w)| force[i] += w * y);
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
        for (row, spring) in self.springs.iter().enumerate() {
            for &(i, w) in spring {
                for (j, g) in inverse.col_as_slice(i).iter().enumerate() {
                    reduced[(row, j)] += w * g;
                }
            }
        }
        let factor = Mat::from_fn(rank, rank, |i, j| if i >= j { self.rows[i][j] } else { 0.0 });
        solve_lower_triangular_in_place(factor.as_ref(), reduced.as_mut(), Par::Seq);
        triangular::matmul(
            inverse.as_mut(),
            BlockStructure::TriangularLower,
            Accum::Add,
            reduced.transpose(),
            BlockStructure::Rectangular,
            reduced.as_ref(),
            BlockStructure::Rectangular,
            1.0,
            Par::Seq,
        );
        for column in 0..order {
            for row in 0..column {
                inverse[(row, column)] = inverse[(column, row)];
            }
        }
        *self = Update::default();
    }
}
