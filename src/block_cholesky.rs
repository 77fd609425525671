//! Sparse Cholesky factorisation of matrices whose unknowns come in blocks: all of a point.
//!
//! Every unknown of a point has the neighbours of that point, so a fill-reducing order of the points is one of the unknowns, found on
//! a graph that has the square of the block size fewer entries.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::perm::PermRef;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::amd;
use faer::sparse::linalg::cholesky::{CholeskySymbolicParams, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMat, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Side};

/// Order and structure of the factor of matrices with one pattern.
pub struct Structure(SymbolicCholesky<usize>);

impl Structure {
    /// Of a pattern whose lower triangle is made of whole blocks of `block` unknowns, one below and beside the other; `None` where
    /// it is too large.
    #[must_use]
    pub fn of(pattern: SymbolicSparseColMatRef<'_, usize>, block: usize) -> Option<Self> {
        let points = pattern.ncols() / block;
        let (mut starts, mut rows) = (vec![0], Vec::new());
        for point in 0..points {
            let of_column = pattern.row_idx_of_col_raw(point * block).iter();
            rows.extend(of_column.filter(|row| **row % block == 0).map(|row| row / block));
            starts.push(rows.len());
        }
        let graph = SymbolicSparseColMat::new_unsorted_checked(points, points, starts, None, rows);
        let (mut order, mut place) = (vec![0; points], vec![0; points]);
        let scratch = amd::order_maybe_unsorted_scratch::<usize>(points, graph.compute_nnz());
        let mut memory = MemBuffer::try_new(scratch).ok()?;
        let control = amd::Control::default();
        amd::order_maybe_unsorted(&mut order, &mut place, graph.as_ref(), control, MemStack::new(&mut memory)).ok()?;
        let of_unknowns = |of_points: &[usize]| -> Vec<usize> {
            of_points.iter().flat_map(|point| (0..block).map(move |c| point * block + c)).collect()
        };
        let [order, place] = [&order, &place].map(|of_points| of_unknowns(of_points));
        let order = SymmetricOrdering::Custom(PermRef::new_checked(&order, &place, order.len()));
        // Columns of a block have one structure, which the variant by supernodes takes together.
        let params = CholeskySymbolicParams {
            supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
            ..CholeskySymbolicParams::default()
        };
        factorize_symbolic_cholesky(pattern, Side::Lower, order, params).ok().map(Structure)
    }

    /// Solves `A x = b` in place of b, for an A of the pattern by its lower triangle; `None` where A is not positive definite.
    #[must_use]
    pub fn solve(&self, matrix: SparseColMatRef<'_, usize, f64>, b: &mut [f64]) -> Option<()> {
        // The fronts are too small to be shared out: four parts take half as long again.
        let par = faer::Par::Seq;
        let mut values = vec![0.0; self.0.len_val()];
        let factor_scratch = self.0.factorize_numeric_llt_scratch::<f64>(par, faer::Spec::default());
        let solve_scratch = self.0.solve_in_place_scratch::<f64>(1, par);
        let mut memory = MemBuffer::try_new(factor_scratch.or(solve_scratch)).ok()?;
        let stack = MemStack::new(&mut memory);
        let (side, none) = (Side::Lower, faer::linalg::cholesky::llt::factor::LltRegularization::default());
        let factor = self.0.factorize_numeric_llt(&mut values, matrix, side, none, par, stack, faer::Spec::default()).ok()?;
        let n = b.len();
        factor.solve_in_place_with_conj(Conj::No, MatMut::from_column_major_slice_mut(b, n, 1), par, stack);
        Some(())
    }
}
