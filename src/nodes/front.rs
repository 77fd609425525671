//! A front: the dense matrix of the unknowns of a part of the plate, of which some are eliminated; products of dense rows.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{LltRegularization, cholesky_in_place, cholesky_in_place_scratch};
use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::reborrow::{Reborrow, ReborrowMut};
use faer::{Accum, MatMut, MatRef, Par, Spec};

/// A symmetric matrix by its lower triangle, the unknowns that are eliminated first.
///
/// In blocks `A = [A₁₁ ·; A₂₁ A₂₂]`: columns of A₁₁ and A₂₁ stand in one piece, which becomes the factor `[L₁₁; L₂₁]`; A₂₂ becomes the
/// complement `A₂₂ - L₂₁ L₂₁ᵀ` (Schur), which other fronts take up.
#[derive(Debug, Clone, Default)]
pub struct FrontalMatrix {
    own: usize,
    rest: usize,
    panel: Vec<f64>,
    complement: Vec<f64>,
}

impl FrontalMatrix {
    /// A zero matrix of `own` unknowns to be eliminated and `rest` others.
    pub fn new(own: usize, rest: usize) -> Self {
        // Zeros of the other sign are written: memory of plain zeros comes from the system page by page, twice where it is read first, and
        // each time all threads are interrupted.
        FrontalMatrix { own, rest, panel: vec![-0.0; (own + rest) * own], complement: vec![-0.0; rest * rest] }
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

    /// The two columns of a node, with the row at which they begin.
    pub fn columns(&mut self, column: usize) -> ([&mut [f64]; 2], usize) {
        let (size, own) = (self.own + self.rest, self.own);
        let (columns, size, from, first) =
            if column < own { (&mut self.panel, size, column, 0) } else { (&mut self.complement, self.rest, column - own, own) };
        let (x, y) = columns[from * size..(from + 2) * size].split_at_mut(size);
        ([x, y], first)
    }

    /// Adds to an element and so to its mirror image, whichever is the one below the diagonal.
    pub fn add(&mut self, a: usize, b: usize, value: f64) {
        let (column, first) = self.column(a.min(b));
        column[a.max(b) - first] += value;
    }

    /// Takes up the complement of an eliminated part, whose other unknowns have these ascending `places` here.
    pub fn take(&mut self, part: &mut FrontalMatrix, places: &[u32]) {
        let complement = std::mem::take(&mut part.complement);
        // Stretches of unknowns that follow one another here as well.
        let mut stretches: Vec<[usize; 2]> = Vec::new();
        for k in 0..places.len() {
            match stretches.last_mut() {
                Some([_, end]) if places[k] == places[k - 1] + 1 => *end = k + 1,
                _ => stretches.push([k, k + 1]),
            }
        }
        for (index, &[start, end]) in stretches.iter().enumerate() {
            for column in start..end {
                let values = &complement[column * part.rest..(column + 1) * part.rest];
                let (sums, first) = self.column(places[column] as usize);
                for &[from, to] in std::iter::once(&[column, end]).chain(&stretches[index + 1..]) {
                    let row = places[from] as usize - first;
                    sums[row..row + to - from].iter_mut().zip(&values[from..to]).for_each(|(sum, value)| *sum += value);
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
        if !factor(MatMut::from_column_major_slice_mut(&mut self.panel, own + rest, own)) {
            return false;
        }
        let below = MatRef::from_column_major_slice(&self.panel, own + rest, own).split_at_row(own).1;
        take_off_square(MatMut::from_column_major_slice_mut(&mut self.complement, rest, rest), below);
        true
    }

    /// `y₁ = L₁₁⁻¹ b₁`, `b₂ -= L₂₁ y₁` in place, of the unknowns with these numbers.
    pub fn solve_forward(&self, unknowns: &[u32], b: &mut [f64]) {
        let size = self.own + self.rest;
        let mut local: Vec<f64> = unknowns.iter().map(|&unknown| b[unknown as usize]).collect();
        for k in 0..self.own {
            let column = &self.panel[k * size + k..(k + 1) * size];
            let y = local[k] / column[0];
            local[k] = y;
            local[k + 1..].iter_mut().zip(&column[1..]).for_each(|(b, l)| *b -= l * y);
        }
        unknowns.iter().zip(local).for_each(|(&unknown, local)| b[unknown as usize] = local);
    }

    /// [`FrontalMatrix::solve_forward`] of several right sides at a time, of those that load unknowns of the front.
    pub fn solve_forward_together(&self, unknowns: &[u32], sides: &mut [Vec<f64>]) {
        let size = self.own + self.rest;
        let is_loaded = |b: &&mut Vec<f64>| unknowns[..self.own].iter().any(|&unknown| b[unknown as usize] != 0.0);
        let mut loaded: Vec<&mut Vec<f64>> = sides.iter_mut().filter(is_loaded).collect();
        if loaded.is_empty() {
            return;
        }
        let mut local: Vec<f64> = loaded.iter().flat_map(|b| unknowns.iter().map(|&unknown| b[unknown as usize])).collect();
        let (corner, below) = MatRef::from_column_major_slice(&self.panel, size, self.own).split_at_row(self.own);
        let (mut own, rest) = MatMut::from_column_major_slice_mut(&mut local, size, loaded.len()).split_at_row_mut(self.own);
        solve_lower_triangular_in_place(corner, own.as_mut(), Par::Seq);
        matmul(rest, Accum::Add, below, own.as_ref(), -1.0, Par::Seq);
        for (b, local) in loaded.iter_mut().zip(local.chunks_exact(size)) {
            unknowns.iter().zip(local).for_each(|(&unknown, local)| b[unknown as usize] = *local);
        }
    }

    /// `x₁ = L₁₁⁻ᵀ (y₁ - L₂₁ᵀ x₂)` in place.
    pub fn solve_backward(&self, unknowns: &[u32], b: &mut [f64]) {
        let size = self.own + self.rest;
        let mut local: Vec<f64> = unknowns.iter().map(|&unknown| b[unknown as usize]).collect();
        for k in (0..self.own).rev() {
            let column = &self.panel[k * size + k..(k + 1) * size];
            local[k] = (local[k] - dot(&column[1..], &local[k + 1..])) / column[0];
        }
        unknowns[..self.own].iter().zip(local).for_each(|(&unknown, local)| b[unknown as usize] = local);
    }
}

/// Columns of a panel that are factored at a time; what is larger is divided between threads, by its size alone.
const UNDIVIDED: usize = 128;

/// `[L₁₁; L₂₁]` in place of the columns `[A₁₁; A₂₁]` of a matrix; whether it is positive definite.
fn factor(panel: MatMut<'_, f64>) -> bool {
    let own = panel.ncols();
    if own > UNDIVIDED {
        let half = own / 2;
        let (mut left, right) = panel.split_at_col_mut(half);
        if !factor(left.rb_mut()) {
            return false;
        }
        let mut right = right.split_at_row_mut(half).1;
        let (corner, below) = right.rb_mut().split_at_row_mut(own - half);
        let (of_corner, of_below) = left.rb().split_at_row(half).1.split_at_row(own - half);
        rayon::join(|| take_off_square(corner, of_corner), || take_off(below, of_below, of_corner));
        return factor(right);
    }
    let (mut corner, below) = panel.split_at_row_mut(own);
    let scratch = cholesky_in_place_scratch::<f64>(own, Par::Seq, Spec::default());
    let Ok(mut memory) = MemBuffer::try_new(scratch) else { return false };
    let (regularisation, stack) = (LltRegularization::default(), MemStack::new(&mut memory));
    let is_definite = cholesky_in_place(corner.rb_mut(), regularisation, Par::Seq, stack, Spec::default()).is_ok();
    if is_definite {
        solve_rows(corner.rb(), below);
    }
    is_definite
}

/// `L₂₁ L₁₁ᵀ = A₂₁` in place of A₂₁.
fn solve_rows(corner: MatRef<'_, f64>, below: MatMut<'_, f64>) {
    let rows = below.nrows();
    if rows > 2 * UNDIVIDED {
        let (upper, lower) = below.split_at_row_mut(rows / 2);
        rayon::join(|| solve_rows(corner, upper), || solve_rows(corner, lower));
    } else {
        solve_lower_triangular_in_place(corner, below.transpose_mut(), Par::Seq);
    }
}

/// `C - L Lᵀ` in place of the lower triangle of C.
fn take_off_square(complement: MatMut<'_, f64>, l: MatRef<'_, f64>) {
    let rows = l.nrows();
    if rows > 2 * UNDIVIDED {
        let (first, _, mixed, second) = complement.split_at_mut(rows / 2, rows / 2);
        let (upper, lower) = l.split_at_row(rows / 2);
        let others = || rayon::join(|| take_off_square(first, upper), || take_off_square(second, lower));
        rayon::join(|| take_off(mixed, lower, upper), others);
    } else {
        let (whole, lower) = (BlockStructure::Rectangular, BlockStructure::TriangularLower);
        triangular::matmul(complement, lower, Accum::Add, l, whole, l.transpose(), whole, -1.0, Par::Seq);
    }
}

/// `C - A Bᵀ` in place of C.
fn take_off(product: MatMut<'_, f64>, a: MatRef<'_, f64>, b: MatRef<'_, f64>) {
    let rows = a.nrows();
    if rows > 2 * UNDIVIDED {
        let (first, second) = product.split_at_row_mut(rows / 2);
        let (upper, lower) = a.split_at_row(rows / 2);
        rayon::join(|| take_off(first, upper, b), || take_off(second, lower, b));
    } else {
        matmul(product, Accum::Add, a, b.transpose(), -1.0, Par::Seq);
    }
}

/// Sum of products, eight at a time: a sum in order cannot be computed side by side.
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    let (a, b) = (a.chunks_exact(8), b.chunks_exact(8));
    let rest: f64 = a.remainder().iter().zip(b.remainder()).map(|(a, b)| a * b).sum();
    let mut sums = [0.0; 8];
    for (a, b) in a.zip(b) {
        sums.iter_mut().zip(a.iter().zip(b)).for_each(|(sum, (a, b))| *sum += a * b);
    }
    rest + sums.iter().sum::<f64>()
}

/// Products of the columns of A with those of B, all of `size` numbers: those of one column of A after the other.
pub fn columns_product(a: &[f64], b: &[f64], size: usize) -> Vec<f64> {
    let [m, n] = [a, b].map(|of| of.len() / size.max(1));
    let mut product = vec![0.0; m * n];
    let (a, b) = (MatRef::from_column_major_slice(a, size, m), MatRef::from_column_major_slice(b, size, n));
    matmul(MatMut::from_column_major_slice_mut(&mut product, n, m), Accum::Replace, b.transpose(), a, 1.0, Par::Seq);
    product
}

/// Lower triangle of the columns of `Aᵀ B`, both of `rows` rows of length `n` that follow one another.
pub fn lower_product(a: &[f64], b: &[f64], [rows, n]: [usize; 2], product: &mut Vec<f64>) {
    product.resize(n * n, 0.0);
    triangular::matmul(
        MatMut::from_column_major_slice_mut(product, n, n),
        BlockStructure::TriangularLower,
        Accum::Replace,
        MatRef::from_row_major_slice(a, rows, n).transpose(),
        BlockStructure::Rectangular,
        MatRef::from_row_major_slice(b, rows, n),
        BlockStructure::Rectangular,
        1.0,
        Par::Seq,
    );
}

/// Columns of `Aᵀ B`, of `rows` rows of lengths m and n.
pub fn whole_product(a: &[f64], b: &[f64], [rows, m, n]: [usize; 3], product: &mut Vec<f64>) {
    product.resize(m * n, 0.0);
    let (a, b) = (MatRef::from_row_major_slice(a, rows, m), MatRef::from_row_major_slice(b, rows, n));
    matmul(MatMut::from_column_major_slice_mut(product, m, n), Accum::Replace, a.transpose(), b, 1.0, Par::Seq);
}
