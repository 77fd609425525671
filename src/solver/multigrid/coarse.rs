//! Coarse operators: five by five stencils of N x N blocks, one for every coarse place (Galerkin, A_c = Pᵀ A P).

use rayon::prelude::*;

use super::super::field::Layout;
use super::transfer::{Transfer, times_interpolation};
use crate::body::lattice::LANES;

/// Stencil half width of a coarse operator.
const REACH: isize = 2;
/// Blocks of a coarse stencil.
pub const BLOCKS: usize = 25;

/// Block index of a neighbour within reach.
#[must_use]
pub fn block_of(dx: isize, dy: isize) -> usize {
    ((dy + REACH) * (2 * REACH + 1) + dx + REACH) as usize
}

/// Operator of a coarse level.
#[derive(Debug, Clone)]
pub struct CoarseOperator<const N: usize> {
    layout: Layout,
    rows: usize,
    /// Columns rounded up to whole chunks.
    width: usize,
    /// For each row, block, component pair: the values along the row.
    values: Vec<f64>,
    /// The same in single precision: what products read. They are bound by memory, and only smoothing uses them; rigid
    /// motion, which must stay free of force, is judged from `values` alone.
    single: Vec<f32>,
}

/// A row of blocks of the fine operator: neighbour offsets with their blocks.
pub type BlockRow<const N: usize> = Vec<([isize; 2], [[f64; N]; N])>;

impl<const N: usize> CoarseOperator<N> {
    fn zeros(layout: Layout) -> Self {
        let rows = layout.rows - 2 * layout.padding;
        let width = layout.columns.next_multiple_of(LANES);
        CoarseOperator { layout, rows, width, values: vec![0.0; rows * BLOCKS * N * N * width], single: Vec::new() }
    }

    /// Layout of its vectors.
    #[must_use]
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    fn at(&self, column: usize, row: usize, block: usize, c: usize, d: usize) -> usize {
        ((row * BLOCKS + block) * N * N + c * N + d) * self.width + column
    }

    /// Block between a place and its neighbour.
    #[must_use]
    pub fn block(&self, column: usize, row: usize, dx: isize, dy: isize) -> [[f64; N]; N] {
        let index = block_of(dx, dy);
        std::array::from_fn(|c| std::array::from_fn(|d| self.values[self.at(column, row, index, c, d)]))
    }

    /// Blocks of a place that are not zero.
    #[must_use]
    pub fn block_row(&self, column: usize, row: usize) -> BlockRow<N> {
        let mut blocks = Vec::with_capacity(BLOCKS);
        for dy in -REACH..=REACH {
            for dx in -REACH..=REACH {
                let block = self.block(column, row, dx, dy);
                if block.iter().flatten().any(|&v| v != 0.0) {
                    blocks.push(([dx, dy], block));
                }
            }
        }
        blocks
    }

    /// Pᵀ A P of a fine operator given row by row of blocks. `regular(column, row)` names coarse places whose whole
    /// surroundings are interior and uncut: they all share the row of the first of them.
    pub fn galerkin(
        transfer: &Transfer<N>,
        size: [usize; 2],
        block_row: impl Fn(usize, usize) -> BlockRow<N> + Sync,
        regular: impl Fn(usize, usize) -> bool + Sync,
    ) -> Self {
        let mut operator = CoarseOperator::zeros(*transfer.coarse());
        let coarse_size = transfer.coarse_size();
        let template = (0..coarse_size[1])
            .flat_map(|row| (0..coarse_size[0]).map(move |column| [column, row]))
            .find(|&[column, row]| regular(column, row))
            .map(|place| coarse_row(transfer, size, &block_row, place));
        let width = operator.width;
        operator.values.par_chunks_mut(BLOCKS * N * N * width).enumerate().for_each(|(row, values)| {
            for column in 0..coarse_size[0] {
                let own;
                let blocks = match &template {
                    Some(template) if regular(column, row) => template,
                    _ => {
                        own = coarse_row(transfer, size, &block_row, [column, row]);
                        &own
                    }
                };
                for (index, block) in blocks.iter().enumerate() {
                    for c in 0..N {
                        for d in 0..N {
                            values[(index * N * N + c * N + d) * width + column] = block[c][d];
                        }
                    }
                }
            }
        });
        operator.single = operator.values.iter().map(|&v| v as f32).collect();
        operator
    }

    /// Keeps single precision only, once the next coarser operator has been built.
    pub fn compact(&mut self) {
        self.values = Vec::new();
    }

    /// r -= A d (or r = A d).
    pub fn apply(&self, d: &[f64], r: &mut [f64], subtract: bool) {
        let (row_len, padding) = (self.layout.row_len(), self.layout.padding);
        let arch = pulp::Arch::new();
        let work = |row: usize, out: &mut [f64]| arch.dispatch(RowProduct { operator: self, d, row, out, subtract });
        let body = &mut r[padding * row_len..(padding + self.rows) * row_len];
        if self.rows * self.width > 1000 {
            body.par_chunks_mut(row_len).enumerate().for_each(|(row, out)| work(row, out));
        } else {
            body.chunks_mut(row_len).enumerate().for_each(|(row, out)| work(row, out));
        }
    }
}

/// One row of a product, run with the widest vectors the processor has.
struct RowProduct<'a, const N: usize> {
    operator: &'a CoarseOperator<N>,
    d: &'a [f64],
    row: usize,
    out: &'a mut [f64],
    subtract: bool,
}

impl<const N: usize> pulp::WithSimd for RowProduct<'_, N> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        let RowProduct { operator, d, row, out, subtract } = self;
        let layout = &operator.layout;
        let (row_len, padding, stride) = (layout.row_len(), layout.padding, layout.stride);
        for chunk in 0..operator.width / LANES {
            let mut sums = [[0.0; LANES]; N];
            for dy in -REACH..=REACH {
                for dx in -REACH..=REACH {
                    let block = block_of(dx, dy);
                    let from =
                        (row + padding).wrapping_add_signed(dy) * row_len + (padding + chunk * LANES).wrapping_add_signed(dx);
                    for component in 0..N {
                        let x = &d[from + component * stride..from + component * stride + LANES];
                        for (c, sum) in sums.iter_mut().enumerate() {
                            let start = operator.at(chunk * LANES, row, block, c, component);
                            let a = &operator.single[start..start + LANES];
                            for lane in 0..LANES {
                                sum[lane] = f64::from(a[lane]).mul_add(x[lane], sum[lane]);
                            }
                        }
                    }
                }
            }
            for (c, sum) in sums.iter().enumerate() {
                let start = c * stride + padding + chunk * LANES;
                for (target, value) in out[start..start + LANES].iter_mut().zip(sum) {
                    *target = if subtract { *target - value } else { *value };
                }
            }
        }
    }
}

/// Row of Pᵀ A P at one coarse place.
fn coarse_row<const N: usize>(
    transfer: &Transfer<N>,
    size: [usize; 2],
    block_row: &impl Fn(usize, usize) -> BlockRow<N>,
    place: [usize; 2],
) -> [[[f64; N]; N]; BLOCKS] {
    let mut result = [[[0.0; N]; N]; BLOCKS];
    let seat = transfer.seat(place);
    let half = transfer.factor as isize - 1;
    let inside = |low: isize, high: isize, count: usize| (low.max(0) as usize)..((high + 1).clamp(0, count as isize) as usize);
    for row in inside(seat[1] - half, seat[1] + half, size[1]) {
        for column in inside(seat[0] - half, seat[0] + half, size[0]) {
            let Some(&(_, weight, arm)) =
                transfer.parents(column, row).iter().find(|(parent, weight, _)| *parent == place && *weight != 0.0)
            else {
                continue;
            };
            let mut t = [[[0.0; N]; N]; BLOCKS];
            for ([dx, dy], block) in block_row(column, row) {
                let other = [column.wrapping_add_signed(dx), row.wrapping_add_signed(dy)];
                for (parent, weight, arm) in transfer.parents(other[0], other[1]) {
                    if weight != 0.0 {
                        let index = block_of(parent[0] as isize - place[0] as isize, parent[1] as isize - place[1] as isize);
                        times_interpolation(&block, weight, arm, &mut t[index]);
                    }
                }
            }
            for (sum, t) in result.iter_mut().zip(&t) {
                for d in 0..N {
                    for c in 0..N {
                        sum[c][d] += weight * t[c][d];
                    }
                    if N == 3 {
                        sum[2][d] += weight * (t[1][d] * arm[0] - t[0][d] * arm[1]);
                    }
                }
            }
        }
    }
    result
}
