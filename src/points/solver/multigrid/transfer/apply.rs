//! Vectors between the levels: prolongation and restriction, row by row, plain chunks by vectors.

use rayon::prelude::*;

use super::{EMPTY, Layout, PLAIN, Transfer, Weights};
use crate::body::lattice::LANES;

impl<const N: usize> Transfer<N> {
    /// fine = P coarse.
    pub fn prolong(&self, coarse: &[f32], fine: &mut [f32]) {
        let (fine_len, padding, rows_per_task) = (self.fine.row_len(), self.fine.padding, self.fine.rows_per_task());
        let fine_stride = self.fine.stride;
        let body = &mut fine[padding * fine_len..(padding + self.fine_rows) * fine_len];
        let arch = pulp::Arch::new();
        body.par_chunks_mut(fine_len * rows_per_task).enumerate().for_each(|(task, rows)| {
            let mut between = vec![0.0; self.coarse.row_len()];
            for (i, out) in rows.chunks_exact_mut(fine_len).enumerate() {
                let row = task * rows_per_task + i;
                arch.dispatch(Prolonged { transfer: self, row, coarse, between: &mut between, out: &mut *out });
                for chunk in 0..self.chunks {
                    match self.slots[row * self.chunks + chunk] {
                        PLAIN => {}
                        EMPTY => (0..N).for_each(|c| {
                            let start = self.fine.padding + chunk * LANES + c * fine_stride;
                            out[start..start + LANES].fill(0.0);
                        }),
                        slot => self.prolong_chunk(row, chunk, &self.own[slot as usize], coarse, out),
                    }
                }
            }
        });
    }

    /// The places of a chunk with weights of their own.
    fn prolong_chunk(&self, row: usize, chunk: usize, weights: &[Weights; LANES], coarse: &[f32], out: &mut [f32]) {
        let (fine_stride, stride) = (self.fine.stride, self.coarse.stride);
        for (lane, weights) in weights.iter().enumerate() {
            let column = chunk * LANES + lane;
            let mut sums = [0.0; N];
            if column < self.fine.columns {
                let (first, arm) = (self.coarse_index(column, row), self.arm(weights, column, row));
                for (corner, weight) in
                    weights.share.map(|share| share as f32).into_iter().enumerate().filter(|(_, weight)| *weight != 0.0)
                {
                    let at = first + (corner & 1) + (corner >> 1) * self.coarse.row_len();
                    let turn = if N == 3 { coarse[at + 2 * stride] } else { 0.0 };
                    let arm = arm.map_or([0.0; 2], |arm| self.arm_of_corner(arm, corner)).map(|arm| arm as f32);
                    sums[0] += weight * (coarse[at] - turn * arm[1]);
                    sums[1] += weight * (coarse[at + stride] + turn * arm[0]);
                    if N == 3 {
                        sums[2] += weight * turn;
                    }
                }
            }
            for (c, sum) in sums.into_iter().enumerate() {
                out[self.fine.padding + column + c * fine_stride] = sum;
            }
        }
    }

    /// coarse = Pᵀ fine, each coarse row gathered from the fine rows around it.
    pub fn restrict(&self, fine: &[f32], coarse: &mut [f32]) {
        let (row_len, padding) = (self.coarse.row_len(), self.coarse.padding);
        let rows_per_task = self.fine.rows_per_task().div_ceil(self.factor);
        let body = &mut coarse[padding * row_len..(self.coarse.rows - padding) * row_len];
        let arch = pulp::Arch::new();
        body.par_chunks_mut(row_len * rows_per_task).enumerate().for_each(|(task, rows)| {
            let mut sums = vec![0.0; self.fine.row_len()];
            for (i, out) in rows.chunks_exact_mut(row_len).enumerate() {
                out.fill(0.0);
                sums.fill(0.0);
                self.gather(arch, task * rows_per_task + i, fine, &mut sums, out);
            }
        });
    }

    /// Row of the coarse lattice from the fine rows around it; `sums` holds a fine row.
    fn gather(&self, arch: pulp::Arch, coarse_row: usize, fine: &[f32], sums: &mut [f32], out: &mut [f32]) {
        // Fine rows whose lower coarse row is this one, or the one below it.
        for upper in [1, 0] {
            let Some(lower) = coarse_row.checked_sub(upper) else { continue };
            for shift in 0..self.factor {
                let Some(row) = (lower * self.factor + shift).checked_sub(self.offset[1]) else { continue };
                let share = self.rows_around(row).1;
                let weight = if upper == 1 { share } else { 1.0 - share };
                if row >= self.fine_rows || weight == 0.0 {
                    continue;
                }
                let start = (row + self.fine.padding) * self.fine.row_len();
                let from = &fine[start..start + self.fine.row_len()];
                let plain = &self.slots[row * self.chunks..(row + 1) * self.chunks];
                arch.dispatch(Weighed { layout: &self.fine, plain, weight, from, sums: &mut *sums });
                for chunk in (0..self.chunks).filter(|&chunk| plain[chunk] != PLAIN && plain[chunk] != EMPTY) {
                    self.restrict_chunk(row, chunk, upper, from, out);
                }
            }
        }
        for c in 0..N {
            let from = &sums[c * self.fine.stride + self.fine.padding..][..self.fine.columns];
            let out = &mut out[c * self.coarse.stride + self.coarse.padding..(c + 1) * self.coarse.stride];
            for (value, &(lower, share)) in from.iter().zip(&self.lower) {
                out[lower as usize] += (1.0 - share) * value;
                out[lower as usize + 1] += share * value;
            }
        }
    }

    /// The places of a chunk with weights of their own, for the coarse row below (0) or above (1) them.
    fn restrict_chunk(&self, row: usize, chunk: usize, upper: usize, from: &[f32], out: &mut [f32]) {
        let (fine_stride, stride) = (self.fine.stride, self.coarse.stride);
        let weights = &self.own[self.slots[row * self.chunks + chunk] as usize];
        for (lane, weights) in weights.iter().enumerate() {
            let column = chunk * LANES + lane;
            if column >= self.fine.columns {
                break;
            }
            let at = self.fine.padding + column;
            let (u, v) = (from[at], from[at + fine_stride]);
            let w = if N == 3 { from[at + 2 * fine_stride] } else { 0.0 };
            let (first, arm) = (self.lower[column].0 as usize + self.coarse.padding, self.arm(weights, column, row));
            for right in 0..2 {
                let corner = right + 2 * upper;
                let weight = weights.share[corner] as f32;
                let arm = arm.map_or([0.0; 2], |arm| self.arm_of_corner(arm, corner)).map(|arm| arm as f32);
                out[first + right] += weight * u;
                out[first + right + stride] += weight * v;
                if N == 3 {
                    out[first + right + 2 * stride] += weight * (w + arm[0] * v - arm[1] * u);
                }
            }
        }
    }
}

/// A fine row with plain weights all along.
struct Prolonged<'a, const N: usize> {
    transfer: &'a Transfer<N>,
    row: usize,
    coarse: &'a [f32],
    /// A coarse row.
    between: &'a mut [f32],
    out: &'a mut [f32],
}

impl<const N: usize> pulp::WithSimd for Prolonged<'_, N> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        let Prolonged { transfer, row, coarse, between, out } = self;
        let (lower, share) = transfer.rows_around(row);
        let row_len = transfer.coarse.row_len();
        let start = (lower + transfer.coarse.padding) * row_len;
        let (below, above) = (&coarse[start..start + row_len], &coarse[start + row_len..start + 2 * row_len]);
        for ((between, below), above) in between.iter_mut().zip(below).zip(above) {
            *between = (1.0 - share) * below + share * above;
        }
        for c in 0..N {
            let from = &between[c * transfer.coarse.stride + transfer.coarse.padding..(c + 1) * transfer.coarse.stride];
            let out = &mut out[c * transfer.fine.stride + transfer.fine.padding..][..transfer.fine.columns];
            for (out, &(lower, share)) in out.iter_mut().zip(&transfer.lower) {
                *out = (1.0 - share) * from[lower as usize] + share * from[lower as usize + 1];
            }
        }
    }
}

/// sums += weight x the plain chunks of a fine row.
struct Weighed<'a> {
    layout: &'a Layout,
    plain: &'a [u32],
    weight: f32,
    from: &'a [f32],
    sums: &'a mut [f32],
}

impl pulp::WithSimd for Weighed<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        for c in 0..self.layout.unknowns {
            let start = c * self.layout.stride + self.layout.padding;
            let length = self.plain.len() * LANES;
            let (from, sums) = (&self.from[start..start + length], &mut self.sums[start..start + length]);
            let chunks = from.chunks_exact(LANES).zip(sums.chunks_exact_mut(LANES));
            for ((from, sums), _) in chunks.zip(self.plain).filter(|(_, slot)| **slot == PLAIN) {
                for lane in 0..LANES {
                    sums[lane] += self.weight * from[lane];
                }
            }
        }
    }
}
