//! Sparse Cholesky factorisation of matrices whose unknowns come in blocks: all of a point.
//!
//! Every unknown of a point has the neighbours of that point, so a fill-reducing order of the points is one of the unknowns, found on
//! a graph that has the square of the block size fewer entries.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::perm::PermRef;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::amd;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::{FaerError, SparseColMatRef, SymbolicSparseColMat, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Side};

/// The fronts are too small to be shared out: four parts take half as long again.
const PAR: faer::Par = faer::Par::Seq;

/// What was computed, unless it is too large for its indices. Short memory ends the process, as it does elsewhere: it is no property of a matrix.
fn fits<T>(computed: Result<T, FaerError>) -> Option<T> {
    match computed {
        Err(FaerError::OutOfMemory) => std::alloc::handle_alloc_error(std::alloc::Layout::new::<T>()),
        computed => computed.ok(),
    }
}

/// Order and structure of the factor of matrices with one pattern.
pub struct Structure(SymbolicCholesky<usize>);

impl Structure {
    /// Of a pattern whose lower triangle is made of whole blocks of `block` unknowns, one below and beside the other; `None` where
    /// it is too large.
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
        let mut memory = MemBuffer::new(scratch);
        let control = amd::Control::default();
        fits(amd::order_maybe_unsorted(&mut order, &mut place, graph.as_ref(), control, MemStack::new(&mut memory)))?;
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
        fits(factorize_symbolic_cholesky(pattern, Side::Lower, order, params)).map(Structure)
    }

    /// The factor of an A of the pattern by its lower triangle; `None` where A is not positive definite.
    pub fn factor(&self, matrix: SparseColMatRef<'_, usize, f64>) -> Option<Factor<'_>> {
        let mut values = vec![0.0; self.0.len_val()];
        let mut memory = MemBuffer::new(self.0.factorize_numeric_llt_scratch::<f64>(PAR, faer::Spec::default()));
        let (side, none) = (Side::Lower, faer::linalg::cholesky::llt::factor::LltRegularization::default());
        let stack = MemStack::new(&mut memory);
        self.0.factorize_numeric_llt(&mut values, matrix, side, none, PAR, stack, faer::Spec::default()).ok()?;
        Some(Factor { symbolic: &self.0, values })
    }
}

/// Factor L of a matrix `A = L Lᵀ`.
pub struct Factor<'a> {
    symbolic: &'a SymbolicCholesky<usize>,
    values: Vec<f64>,
}

impl Factor<'_> {
    /// Solves `A x = b` in place of b.
    pub fn solve(&self, b: &mut [f64]) {
        let mut memory = MemBuffer::new(self.symbolic.solve_in_place_scratch::<f64>(1, PAR));
        let n = b.len();
        let b = MatMut::from_column_major_slice_mut(b, n, 1);
        LltRef::new(self.symbolic, &self.values).solve_in_place_with_conj(Conj::No, b, PAR, MemStack::new(&mut memory));
    }
}
