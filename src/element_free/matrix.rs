//! Dense matrices of some unknowns, and products of rows.

use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::{Accum, MatMut, MatRef, Par};

/// `factor v vᵀ` of some unknowns: a support.
#[derive(Debug, Clone, Default)]
pub struct Square {
    /// Unknowns, ascending.
    pub unknowns: Vec<u32>,
    /// v.
    pub v: Vec<f64>,
    /// Its factor.
    pub factor: f64,
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
