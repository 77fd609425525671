//! Coarse operators: five by five stencils of N x N blocks (Galerkin, A_c = Pᵀ A P).
//!
//! Away from the rim and from cracks all places have the same stencil, which is kept once; the others keep their own.

use rayon::prelude::*;

use super::super::field::Layout;
use super::super::kernel::load;
use super::smoother::Operator;
use super::transfer::{Transfer, times_interpolation};
use crate::body::lattice::LANES;

/// Stencil half width of a coarse operator.
pub(super) const REACH: isize = 2;
/// Blocks of a coarse stencil.
pub const BLOCKS: usize = 25;
/// Slot of a chunk that has the common stencil.
const COMMON: u32 = u32::MAX;
/// Slot of a chunk whose places have no stiffness.
const EMPTY: u32 = u32::MAX - 1;

/// Block index of a neighbour within reach.
pub fn block_of(dx: isize, dy: isize) -> usize {
    ((dy + REACH) * (2 * REACH + 1) + dx + REACH) as usize
}

/// Blocks of one coarse place.
type CoarseRow<const N: usize> = [[[f64; N]; N]; BLOCKS];

/// Operator of a coarse level.
#[derive(Debug, Clone)]
pub struct CoarseOperator<const N: usize> {
    layout: Layout,
    rows: usize,
    chunks: usize,
    /// For every chunk of a row where its stencils stand, [`COMMON`] if they are the common one.
    slots: Vec<u32>,
    pub(super) common: Option<CoarseRow<N>>,
    /// For each chunk with its own stencils, block, component pair: the values along the row.
    values: Vec<f64>,
    /// Both in single precision: what products read. They are bound by memory, and only smoothing uses them; coarser operators, in
    /// which rigid motion must stay free of force, come from `values` alone.
    single: Vec<f32>,
    common_single: Vec<f32>,
}

/// An operator that is coarsened, given row by row of blocks.
pub trait BlockRows<const N: usize>: Sync {
    /// Shows every block of a place that is not zero: the way to the neighbour, the block.
    fn visit_row(&self, column: usize, row: usize, visit: impl FnMut([isize; 2], &[[f64; N]; N]));
}

impl<const N: usize> CoarseOperator<N> {
    /// Values of a chunk.
    const CHUNK: usize = BLOCKS * N * N * LANES;

    /// Layout of its vectors.
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    /// Whether all places of a chunk of a row have the common stencil.
    pub fn is_common(&self, row: usize, chunk: usize) -> bool {
        self.slots[row * self.chunks + chunk] == COMMON
    }

    /// Block between a place and its neighbour.
    pub fn block(&self, column: usize, row: usize, dx: isize, dy: isize) -> [[f64; N]; N] {
        let index = block_of(dx, dy);
        match (self.slots[row * self.chunks + column / LANES], &self.common) {
            (COMMON, Some(common)) => common[index],
            (EMPTY, _) => [[0.0; N]; N],
            (slot, _) => {
                let first = slot as usize * Self::CHUNK + index * N * N * LANES + column % LANES;
                std::array::from_fn(|c| std::array::from_fn(|d| self.values[first + (c * N + d) * LANES]))
            }
        }
    }

    /// Pᵀ A P of a fine operator. `regular(column, row)` names coarse places whose whole
    /// surroundings are interior and uncut: they all share the row of the first of them.
    pub fn galerkin(
        transfer: &Transfer<N>,
        size: [usize; 2],
        fine: &impl BlockRows<N>,
        regular: impl Fn(usize, usize) -> bool + Sync,
    ) -> Self {
        let (layout, [columns, rows]) = (*transfer.coarse(), transfer.coarse_size());
        let chunks = columns.div_ceil(LANES);
        let template = (0..rows)
            .flat_map(|row| (0..columns).map(move |column| [column, row]))
            .find(|&[column, row]| regular(column, row))
            .map(|place| coarse_row(transfer, size, fine, place));
        let mut own = Vec::new();
        let mut slots = vec![COMMON; rows * chunks];
        for (index, slot) in slots.iter_mut().enumerate() {
            let (row, first) = (index / chunks, index % chunks * LANES);
            if !(first..first + LANES).all(|column| column < columns && regular(column, row)) {
                *slot = own.len() as u32;
                own.push((row, first));
            }
        }
        let mut values = vec![0.0; own.len() * Self::CHUNK];
        values.par_chunks_mut(Self::CHUNK).zip(&own).for_each(|(values, &(row, first))| {
            for column in first..(first + LANES).min(columns) {
                let blocks = match &template {
                    Some(template) if regular(column, row) => *template,
                    _ => coarse_row(transfer, size, fine, [column, row]),
                };
                for (entry, value) in blocks.as_flattened().as_flattened().iter().enumerate() {
                    values[entry * LANES + column - first] = *value;
                }
            }
        });
        let mut kept = 0;
        for (index, &(row, first)) in own.iter().enumerate() {
            let chunk = index * Self::CHUNK..(index + 1) * Self::CHUNK;
            let slot = &mut slots[row * chunks + first / LANES];
            if values[chunk.clone()].iter().all(|&v| v == 0.0) {
                *slot = EMPTY;
            } else {
                *slot = kept as u32;
                values.copy_within(chunk, kept * Self::CHUNK);
                kept += 1;
            }
        }
        values.truncate(kept * Self::CHUNK);
        let single = values.iter().map(|&v| v as f32).collect();
        let common_single = template.iter().flatten().flatten().flatten().map(|&v| v as f32).collect();
        CoarseOperator { layout, rows, chunks, slots, common: template, values, single, common_single }
    }

    /// Sets the rows of some places anew, with what [`CoarseOperator::galerkin`] was given.
    pub fn refresh(&mut self, transfer: &Transfer<N>, size: [usize; 2], fine: &impl BlockRows<N>, places: &[[usize; 2]]) {
        let rows: Vec<CoarseRow<N>> = places.par_iter().map(|&place| coarse_row(transfer, size, fine, place)).collect();
        for (&[column, row], blocks) in places.iter().zip(&rows) {
            let first = self.own_slot(row, column / LANES) * Self::CHUNK + column % LANES;
            for (entry, &value) in blocks.as_flattened().as_flattened().iter().enumerate() {
                self.values[first + entry * LANES] = value;
                self.single[first + entry * LANES] = value as f32;
            }
        }
    }

    /// Slot of a chunk that has stencils of its own, from now on at the latest.
    fn own_slot(&mut self, row: usize, chunk: usize) -> usize {
        let slot = &mut self.slots[row * self.chunks + chunk];
        if *slot == COMMON || *slot == EMPTY {
            let common = self.common.as_ref().filter(|_| *slot == COMMON);
            *slot = (self.values.len() / Self::CHUNK) as u32;
            let entry = |index: usize| common.map_or(0.0, |common| common.as_flattened().as_flattened()[index / LANES]);
            let before = self.values.len();
            self.values.extend((0..Self::CHUNK).map(entry));
            let single: Vec<f32> = self.values[before..].iter().map(|&v| v as f32).collect();
            self.single.extend(single);
        }
        *slot as usize
    }
}

impl<const N: usize> BlockRows<N> for CoarseOperator<N> {
    fn visit_row(&self, column: usize, row: usize, mut visit: impl FnMut([isize; 2], &[[f64; N]; N])) {
        for dy in -REACH..=REACH {
            for dx in -REACH..=REACH {
                let block = self.block(column, row, dx, dy);
                if block.as_flattened().iter().any(|&v| v != 0.0) {
                    visit([dx, dy], &block);
                }
            }
        }
    }
}

impl<const N: usize> Operator for CoarseOperator<N> {
    fn layout(&self) -> &Layout {
        &self.layout
    }

    #[inline(always)]
    fn subtract_row(&self, row: usize, x: &[f32], r: &mut [f32]) {
        let (row_len, padding, stride) = (self.layout.row_len(), self.layout.padding, self.layout.stride);
        debug_assert!(row < self.rows);
        for chunk in 0..self.chunks {
            let slot = self.slots[row * self.chunks + chunk];
            if slot == EMPTY {
                continue;
            }
            let own = if slot == COMMON { None } else { self.single.chunks_exact(Self::CHUNK).nth(slot as usize) };
            let mut sums = [[0.0_f32; LANES]; N];
            for block in 0..BLOCKS {
                let (dx, dy) = ((block % 5) as isize - REACH, (block / 5) as isize - REACH);
                let from = (row + padding).wrapping_add_signed(dy) * row_len + (padding + chunk * LANES).wrapping_add_signed(dx);
                for d in 0..N {
                    let x = load::<f32, LANES>(x, from + d * stride);
                    for (c, sum) in sums.iter_mut().enumerate() {
                        let entry = block * N * N + c * N + d;
                        if let Some(own) = own {
                            let a = load::<f32, LANES>(own, entry * LANES);
                            for lane in 0..LANES {
                                sum[lane] = a[lane].mul_add(x[lane], sum[lane]);
                            }
                        } else {
                            let a = self.common_single[entry];
                            for lane in 0..LANES {
                                sum[lane] = a.mul_add(x[lane], sum[lane]);
                            }
                        }
                    }
                }
            }
            for (c, sum) in sums.iter().enumerate() {
                let start = c * stride + padding + chunk * LANES;
                let target = &mut r[start..start + LANES];
                for lane in 0..LANES {
                    target[lane] -= sum[lane];
                }
            }
        }
    }
}

/// Row of Pᵀ A P at one coarse place.
fn coarse_row<const N: usize>(
    transfer: &Transfer<N>,
    size: [usize; 2],
    fine: &impl BlockRows<N>,
    place: [usize; 2],
) -> CoarseRow<N> {
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
            fine.visit_row(column, row, |[dx, dy], block| {
                let other = [column.wrapping_add_signed(dx), row.wrapping_add_signed(dy)];
                for (parent, weight, arm) in transfer.parents(other[0], other[1]) {
                    if weight != 0.0 {
                        let index = block_of(parent[0] as isize - place[0] as isize, parent[1] as isize - place[1] as isize);
                        times_interpolation(block, weight, arm, &mut t[index]);
                    }
                }
            });
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
