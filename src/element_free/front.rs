//! A front: the dense matrix of the unknowns of a part of the plate, of which some are eliminated.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{LltRegularization, cholesky_in_place, cholesky_in_place_scratch};
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::{Accum, MatMut, Par, Spec};

/// A symmetric matrix by its lower triangle, the unknowns that are eliminated first.
///
/// In blocks `A = [A₁₁ ·; A₂₁ A₂₂]`: columns of A₁₁ and A₂₁ stand in one piece, which becomes the factor `[L₁₁; L₂₁]`; A₂₂ becomes the
/// complement `A₂₂ - L₂₁ L₂₁ᵀ` (Schur), which other fronts take up.
#[derive(Debug, Clone, Default)]
pub struct Front {
    own: usize,
    rest: usize,
    panel: Vec<f64>,
    complement: Vec<f64>,
}

impl Front {
    /// A zero matrix of `own` unknowns to be eliminated and `rest` others.
    #[must_use]
    pub fn new(own: usize, rest: usize) -> Self {
        Front { own, rest, panel: vec![0.0; (own + rest) * own], complement: vec![0.0; rest * rest] }
    }

    /// A column, with the row at which it begins.
    pub fn column(&mut self, column: usize) -> (&mut [f64], usize) {
        let (own, rest) = (self.own, self.rest);
        if column < own {
            let size = own + rest;
            (&mut self.panel[column * size..(column + 1) * size], 0)
        } else {
            let column = column - own;
            (&mut self.complement[column * rest..(column + 1) * rest], own)
        }
    }

    /// Adds to an element and so to its mirror image, whichever is the one below the diagonal.
    pub fn add(&mut self, a: usize, b: usize, value: f64) {
        let (column, first) = self.column(a.min(b));
        column[a.max(b) - first] += value;
    }

    /// Takes up the complement of an eliminated part, whose other unknowns have these `places` here.
    pub fn take(&mut self, part: &mut Front, places: &[u32]) {
        let complement = std::mem::take(&mut part.complement);
        for (k, &place) in places.iter().enumerate() {
            let values = &complement[k * part.rest + k..(k + 1) * part.rest];
            let place = place as usize;
            let (column, first) = self.column(place);
            // Those that are above the diagonal here.
            let mut above = false;
            for (&row, value) in places[k..].iter().zip(values) {
                let row = row as usize;
                if row >= place { column[row - first] += value } else { above = true }
            }
            if above {
                for (&row, value) in places[k..].iter().zip(values) {
                    if (row as usize) < place {
                        self.add(row as usize, place, *value);
                    }
                }
            }
        }
    }

    /// Eliminates its own unknowns; whether the matrix is positive definite as far as they go.
    pub fn eliminate(&mut self) -> bool {
        let (own, rest) = (self.own, self.rest);
        if own == 0 {
            return true;
        }
        let panel = MatMut::from_column_major_slice_mut(&mut self.panel, own + rest, own);
        let (mut corner, mut below) = panel.split_at_row_mut(own);
        let scratch = cholesky_in_place_scratch::<f64>(own, Par::Seq, Spec::default());
        let Ok(mut memory) = MemBuffer::try_new(scratch) else { return false };
        let regularisation = LltRegularization::default();
        let stack = MemStack::new(&mut memory);
        if cholesky_in_place(corner.as_mut(), regularisation, Par::Seq, stack, Spec::default()).is_err() {
            return false;
        }
        if rest > 0 {
            // L₂₁ L₁₁ᵀ = A₂₁
            solve_lower_triangular_in_place(corner.as_ref(), below.as_mut().transpose_mut(), Par::Seq);
            triangular::matmul(
                MatMut::from_column_major_slice_mut(&mut self.complement, rest, rest),
                BlockStructure::TriangularLower,
                Accum::Add,
                below.as_ref(),
                BlockStructure::Rectangular,
                below.as_ref().transpose(),
                BlockStructure::Rectangular,
                -1.0,
                Par::Seq,
            );
        }
        true
    }

    /// `y₁ = L₁₁⁻¹ b₁`, `b₂ -= L₂₁ y₁` in place, of the unknowns with these numbers.
    pub fn solve_forward(&self, unknowns: &[u32], b: &mut [f64]) {
        let size = self.own + self.rest;
        for (k, &unknown) in unknowns[..self.own].iter().enumerate() {
            let column = &self.panel[k * size + k..(k + 1) * size];
            let y = b[unknown as usize] / column[0];
            b[unknown as usize] = y;
            unknowns[k + 1..].iter().zip(&column[1..]).for_each(|(&row, l)| b[row as usize] -= l * y);
        }
    }

    /// `x₁ = L₁₁⁻ᵀ (y₁ - L₂₁ᵀ x₂)` in place.
    pub fn solve_backward(&self, unknowns: &[u32], b: &mut [f64]) {
        let size = self.own + self.rest;
        for (k, &unknown) in unknowns[..self.own].iter().enumerate().rev() {
            let column = &self.panel[k * size + k..(k + 1) * size];
            let sum: f64 = unknowns[k + 1..].iter().zip(&column[1..]).map(|(&row, l)| b[row as usize] * l).sum();
            b[unknown as usize] = (b[unknown as usize] - sum) / column[0];
        }
    }
}
