//! Work on the rows of K x while they are in cache: product and all that follows from it in one sweep over the vectors.

use super::{Into, Product};
use crate::state::Bonds;

/// What follows from a row of K x.
pub trait RowPass {
    /// Takes row `row` of the lattice with all its components, padding included (zero there). Inlined into a kernel that is
    /// compiled for every vector width: mark it `#[inline(always)]`.
    fn take(&mut self, row: usize, kx: &[f64]);
}

/// Some rows and their pass, compiled for every vector width and run with the widest the processor has.
struct Sweep<'a, const N: usize, P> {
    product: &'a Product<N>,
    bonds: &'a Bonds,
    x: &'a [f64],
    rows: std::ops::Range<usize>,
    pass: &'a mut P,
}

impl<const N: usize, P: RowPass> pulp::WithSimd for Sweep<'_, N, P> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        let mut kx = vec![0.0; self.product.layout.row_len()];
        for row in self.rows {
            self.product.double.row(self.bonds, row, self.x, &mut kx, Into::Set);
            self.pass.take(row, &kx);
        }
    }
}

impl<const N: usize> Product<N> {
    /// Hands rows of K x to `pass` one after the other. Springs alone; held components are not cleared, and x holds its mirror images
    /// already.
    pub fn sweep(&self, bonds: &Bonds, x: &[f64], rows: std::ops::Range<usize>, pass: &mut impl RowPass) {
        pulp::Arch::new().dispatch(Sweep { product: self, bonds, x, rows, pass });
    }
}
