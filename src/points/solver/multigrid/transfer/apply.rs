//! Vectors between the levels: prolongation and restriction, row by row, plain chunks by vectors.

use super::{Slot, Transfer, Weights};
use crate::body::lattice::LANES;

impl<const N: usize> Transfer<N> {
    /// fine = P coarse.
    pub fn prolong(&self, coarse: &[f32], fine: &mut [f32]) {
        self.fine.for_rows(
            self.fine.rows_per_task(),
            [fine],
            #[inline(always)]
            |row, [out]: [&mut [f32]; 1]| {
                let (lower, share) = self.rows_around(row);
                let [below, above] = [lower, lower + 1].map(|row| self.coarse.padded_row(row, coarse));
                let between: Vec<f32> =
                    below.iter().zip(above).map(|(below, above)| (1.0 - share) * below + share * above).collect();
                for c in 0..N {
                    let from = &between[c * self.coarse.stride + self.coarse.padding..(c + 1) * self.coarse.stride];
                    let out = &mut out[c * self.fine.stride + self.fine.padding..][..self.fine.columns];
                    for (out, &(lower, share)) in out.iter_mut().zip(&self.lower) {
                        *out = (1.0 - share) * from[lower as usize] + share * from[lower as usize + 1];
                    }
                }
                for chunk in 0..self.own.chunks {
                    match self.own.at(row, chunk) {
                        Slot::Common => {}
                        Slot::Empty => self.prolong_chunk(row, chunk, &[Weights::default(); LANES], coarse, out),
                        Slot::Own(weights) => self.prolong_chunk(row, chunk, weights, coarse, out),
                    }
                }
            },
        );
    }

    /// The places of a chunk with weights of their own.
    fn prolong_chunk(&self, row: usize, chunk: usize, weights: &[Weights; LANES], coarse: &[f32], out: &mut [f32]) {
        let stride = self.coarse.stride;
        let columns = chunk * LANES..((chunk + 1) * LANES).min(self.fine.columns);
        for (column, weights) in columns.zip(weights) {
            let mut sums = [0.0; N];
            let ([lower, below], _) = self.corners([column, row]);
            let first = (below + self.coarse.padding) * self.coarse.row_len() + lower + self.coarse.padding;
            for (corner, weight) in weights.share.into_iter().enumerate().filter(|(_, weight)| *weight != 0.0) {
                let weight = weight as f32;
                let at = first + (corner & 1) + (corner >> 1) * self.coarse.row_len();
                let turn = if N == 3 { coarse[at + 2 * stride] } else { 0.0 };
                let arm = self.arm(weights, [column, row], corner).map(|arm| arm as f32);
                sums[0] += weight * (coarse[at] - turn * arm[1]);
                sums[1] += weight * (coarse[at + stride] + turn * arm[0]);
                if N == 3 {
                    sums[2] += weight * turn;
                }
            }
            for (c, sum) in sums.into_iter().enumerate() {
                out[self.fine.padding + column + c * self.fine.stride] = sum;
            }
        }
    }

    /// coarse = Pᵀ fine, each coarse row gathered from the fine rows around it.
    pub fn restrict(&self, fine: &[f32], coarse: &mut [f32]) {
        let rows_per_task = self.fine.rows_per_task().div_ceil(self.factor);
        self.coarse.for_rows(
            rows_per_task,
            [coarse],
            #[inline(always)]
            |row, [out]: [&mut [f32]; 1]| self.gather(row, fine, out),
        );
    }

    /// Row of the coarse lattice from the fine rows around it.
    #[inline(always)]
    fn gather(&self, coarse_row: usize, fine: &[f32], out: &mut [f32]) {
        out.fill(0.0);
        let mut sums = vec![0.0; self.fine.row_len()];
        // Fine rows whose lower coarse row is this one, or the one below it.
        for upper in [1, 0] {
            let Some(lower) = coarse_row.checked_sub(upper) else { continue };
            for shift in 0..self.factor {
                let Some(row) = (lower * self.factor + shift).checked_sub(self.offset[1]) else { continue };
                let share = self.rows_around(row).1;
                let weight = if upper == 1 { share } else { 1.0 - share };
                if row >= self.fine.size()[1] || weight == 0.0 {
                    continue;
                }
                let from = self.fine.padded_row(row, fine);
                for chunk in 0..self.own.chunks {
                    match self.own.at(row, chunk) {
                        Slot::Empty => {}
                        Slot::Own(weights) => self.restrict_chunk([chunk * LANES, row], weights, upper, from, out),
                        Slot::Common => {
                            for c in 0..N {
                                let chunk = c * self.fine.stride + self.fine.padding + chunk * LANES;
                                for (sum, value) in sums[chunk..chunk + LANES].iter_mut().zip(&from[chunk..chunk + LANES]) {
                                    *sum += weight * value;
                                }
                            }
                        }
                    }
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

    /// The places of a chunk from `first` on with weights of their own, for the coarse row below (0) or above (1) them.
    fn restrict_chunk(&self, first: [usize; 2], weights: &[Weights; LANES], upper: usize, from: &[f32], out: &mut [f32]) {
        let (fine_stride, stride) = (self.fine.stride, self.coarse.stride);
        for (column, weights) in (first[0]..(first[0] + LANES).min(self.fine.columns)).zip(weights) {
            let at = self.fine.padding + column;
            let (u, v) = (from[at], from[at + fine_stride]);
            let w = if N == 3 { from[at + 2 * fine_stride] } else { 0.0 };
            let to = self.lower[column].0 as usize + self.coarse.padding;
            for right in 0..2 {
                let corner = right + 2 * upper;
                let weight = weights.share[corner] as f32;
                let arm = self.arm(weights, [column, first[1]], corner).map(|arm| arm as f32);
                out[to + right] += weight * u;
                out[to + right + stride] += weight * v;
                if N == 3 {
                    out[to + right + 2 * stride] += weight * (w + arm[0] * v - arm[1] * u);
                }
            }
        }
    }

    /// Coarse row below a fine one, and the share of the way to the next.
    #[inline(always)]
    fn rows_around(&self, row: usize) -> (usize, f32) {
        let at = row + self.offset[1];
        (at / self.factor, (at % self.factor) as f32 / self.factor as f32)
    }
}
