//! Interpolation between a lattice and the coarser one above it, aware of cracks.
//!
//! A fine place takes its value from the up to four coarse places around it with bilinear weights. A coarse place that
//! lies across a crack is dropped: on the body this is the case when the bond from the fine point to the coarse one is
//! broken, on coarser levels when the stiffness between the two has vanished. The remaining weights are scaled to sum 1,
//! and, where points turn freely, the coarse place then moves the fine one as a rigid body, `u = u_J + θ_J × (x - x_J)`,
//! so that rigid motion stays exact where the linear field no longer is.

use rayon::prelude::*;

use super::super::field::Layout;

/// Rows that one task takes.
const ROWS_PER_TASK: usize = 16;

/// How a fine place may use a coarse one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Link {
    /// On the same side.
    Joined,
    /// Across a crack.
    Severed,
    /// The coarse place stands where the fine level has no point.
    Ghost,
}

/// Interpolation from a coarse level to the fine one below.
#[derive(Debug, Clone)]
pub struct Transfer<const N: usize> {
    /// Coarsening factor.
    pub factor: usize,
    /// Fine spacing of this level in lattice spacings: arm of the rotation θ = φ Δ per place.
    unit: f64,
    /// Fine columns and rows by which coarse place (0, 0) stands before fine place (0, 0).
    offset: [usize; 2],
    fine: Layout,
    fine_rows: usize,
    coarse: Layout,
    /// Weights of the four coarse places around each fine place (columns x rows, no padding).
    weights: Vec<[f32; 4]>,
    /// Whether a fine place moves rigidly with its coarse places.
    rigid: Vec<bool>,
}

/// Offset that lays the coarse places symmetrically over `count` fine ones where that is possible.
fn symmetric_offset(count: usize, factor: usize) -> usize {
    (0..factor).find(|o| 2 * o < count && (count - 1 - 2 * o).is_multiple_of(factor)).unwrap_or(0)
}

impl<const N: usize> Transfer<N> {
    /// Lays a coarse lattice over a fine one of `columns` x `rows` places. `link(place, coarse place)` in (column, row)
    /// says whether a fine place may use a coarse one; `is_point` whether a fine place is in use; `unit` is the spacing
    /// of the fine level in lattice spacings.
    pub fn new(
        fine: Layout,
        rows: usize,
        factor: usize,
        unit: f64,
        is_point: impl Fn(usize, usize) -> bool,
        link: impl Fn([usize; 2], [usize; 2]) -> Link,
    ) -> Self {
        let columns = fine.columns;
        // Where fine places lie before the first regular coarse one, a further coarse place stands outside.
        let offset = [columns, rows].map(|count| match symmetric_offset(count, factor) {
            0 => 0,
            first => factor - first,
        });
        let count = |fine: usize, offset: usize| (fine - 1 + offset).div_ceil(factor) + 1;
        let (coarse_columns, coarse_rows) = (count(columns, offset[0]), count(rows, offset[1]));
        let padding = 2;
        let coarse = Layout {
            unknowns: N,
            stride: coarse_columns.next_multiple_of(crate::body::lattice::LANES) + 2 * padding,
            rows: coarse_rows + 2 * padding,
            padding,
            columns: coarse_columns,
        };
        let mut transfer = Transfer {
            factor,
            unit,
            offset,
            fine,
            fine_rows: rows,
            coarse,
            weights: vec![[0.0; 4]; columns * rows],
            rigid: vec![false; columns * rows],
        };
        for row in 0..rows {
            for column in 0..columns {
                if is_point(column, row) {
                    let (weights, rigid) = transfer.weigh([column, row], &is_point, &link);
                    transfer.weights[row * columns + column] = weights;
                    transfer.rigid[row * columns + column] = rigid && N == 3;
                }
            }
        }
        transfer
    }

    fn weigh(
        &self,
        place: [usize; 2],
        is_point: &impl Fn(usize, usize) -> bool,
        link: &impl Fn([usize; 2], [usize; 2]) -> Link,
    ) -> ([f32; 4], bool) {
        let (corners, fraction) = self.corners(place);
        let mut weights = [0.0_f32; 4];
        let (mut severed, mut ghosts) = (false, [false; 4]);
        for (corner, weight) in weights.iter_mut().enumerate() {
            let (a, b) = (corner & 1, corner >> 1);
            let share = |f: f64, upper: usize| if upper == 1 { f } else { 1.0 - f };
            let bilinear = share(fraction[0], a) * share(fraction[1], b);
            if bilinear == 0.0 {
                continue;
            }
            let seat = [self.fine_seat(corners[0] + a, 0), self.fine_seat(corners[1] + b, 1)];
            let found = match seat {
                [Some(c), Some(r)] if is_point(c, r) => link(place, [c, r]),
                _ => Link::Ghost,
            };
            match found {
                Link::Severed => severed = true,
                Link::Joined => *weight = bilinear as f32,
                Link::Ghost => {
                    ghosts[corner] = true;
                    *weight = bilinear as f32;
                }
            }
        }
        // A place without material cannot tell sides: it serves only away from cracks.
        if severed {
            for (weight, ghost) in weights.iter_mut().zip(ghosts) {
                if ghost {
                    *weight = 0.0;
                }
            }
        }
        let sum: f32 = weights.iter().sum();
        if sum > 0.0 {
            for weight in &mut weights {
                *weight /= sum;
            }
        }
        (weights, severed)
    }

    /// Lower left coarse place of a fine place, and the fraction of the way to the next.
    fn corners(&self, place: [usize; 2]) -> ([usize; 2], [f64; 2]) {
        let at = [place[0] + self.offset[0], place[1] + self.offset[1]];
        (at.map(|p| p / self.factor), at.map(|p| (p % self.factor) as f64 / self.factor as f64))
    }

    /// Fine column (axis 0) or row (axis 1) of a coarse one, where the fine lattice has it.
    fn fine_seat(&self, coarse: usize, axis: usize) -> Option<usize> {
        let count = if axis == 0 { self.fine.columns } else { self.fine_rows };
        (coarse * self.factor).checked_sub(self.offset[axis]).filter(|&seat| seat < count)
    }

    /// Layout of the coarse level.
    #[must_use]
    pub fn coarse(&self) -> &Layout {
        &self.coarse
    }

    /// Rows and columns of the coarse level.
    #[must_use]
    pub fn coarse_size(&self) -> [usize; 2] {
        [self.coarse.columns, self.coarse.rows - 2 * self.coarse.padding]
    }

    /// Fine column and row (which may lie outside) of a coarse place.
    #[must_use]
    pub fn seat(&self, coarse: [usize; 2]) -> [isize; 2] {
        [0, 1].map(|axis| (coarse[axis] * self.factor) as isize - self.offset[axis] as isize)
    }

    /// Coarse places (column, row) of a fine place with their interpolation blocks; empty entries have weight 0.
    #[must_use]
    pub fn parents(&self, column: usize, row: usize) -> [([usize; 2], f64, [f64; 2]); 4] {
        let (lower, _) = self.corners([column, row]);
        let index = row * self.fine.columns + column;
        let arm = self.arm(index, column, row);
        std::array::from_fn(|corner| {
            let place = [lower[0] + (corner & 1), lower[1] + (corner >> 1)];
            (place, f64::from(self.weights[index][corner]), arm.map_or([0.0; 2], |arm| self.arm_of_corner(arm, corner)))
        })
    }

    /// Whether a fine place uses plain bilinear weights.
    #[must_use]
    pub fn is_plain(&self, column: usize, row: usize) -> bool {
        let index = row * self.fine.columns + column;
        let (_, f) = self.corners([column, row]);
        let plain = |i: usize| {
            let share = |f: f64, upper: usize| if upper == 1 { f } else { 1.0 - f };
            (share(f[0], i & 1) * share(f[1], i >> 1)) as f32
        };
        !self.rigid[index] && (0..4).all(|i| (self.weights[index][i] - plain(i)).abs() < 1e-6)
    }

    /// fine += P coarse.
    pub fn prolong(&self, coarse: &[f64], fine: &mut [f64]) {
        let (fine_len, padding) = (self.fine.row_len(), self.fine.padding);
        let body = &mut fine[padding * fine_len..(padding + self.fine_rows) * fine_len];
        body.par_chunks_mut(fine_len * ROWS_PER_TASK).enumerate().for_each(|(task, rows)| {
            for (i, out) in rows.chunks_mut(fine_len).enumerate() {
                self.prolong_row(task * ROWS_PER_TASK + i, coarse, out);
            }
        });
    }

    fn prolong_row(&self, row: usize, coarse: &[f64], out: &mut [f64]) {
        let (fine_stride, stride) = (self.fine.stride, self.coarse.stride);
        for column in 0..self.fine.columns {
            let index = row * self.fine.columns + column;
            let first = self.coarse_index(column, row);
            let arm = self.arm(index, column, row);
            for (corner, &weight) in self.weights[index].iter().enumerate() {
                if weight == 0.0 {
                    continue;
                }
                let weight = f64::from(weight);
                let at = first + (corner & 1) + (corner >> 1) * self.coarse.row_len();
                let (mut u, mut v) = (coarse[at], coarse[at + stride]);
                if N == 3 {
                    let turn = coarse[at + 2 * stride];
                    if let Some(arm) = arm {
                        let arm = self.arm_of_corner(arm, corner);
                        u -= turn * arm[1];
                        v += turn * arm[0];
                    }
                    out[self.fine.padding + column + 2 * fine_stride] += weight * turn;
                }
                out[self.fine.padding + column] += weight * u;
                out[self.fine.padding + column + fine_stride] += weight * v;
            }
        }
    }

    /// coarse = Pᵀ fine, each coarse row gathered from the fine rows around it.
    pub fn restrict(&self, fine: &[f64], coarse: &mut [f64]) {
        let (row_len, padding) = (self.coarse.row_len(), self.coarse.padding);
        let rows = self.coarse.rows - 2 * padding;
        let body = &mut coarse[padding * row_len..(padding + rows) * row_len];
        body.par_chunks_mut(row_len).enumerate().for_each(|(coarse_row, out)| {
            out.fill(0.0);
            // Fine rows whose lower coarse row is this one, or the one below it.
            for upper in [1, 0] {
                let Some(lower) = coarse_row.checked_sub(upper) else { continue };
                for shift in 0..self.factor {
                    match (lower * self.factor + shift).checked_sub(self.offset[1]) {
                        Some(row) if row < self.fine_rows => self.restrict_row(row, upper, fine, out),
                        _ => {}
                    }
                }
            }
        });
    }

    fn restrict_row(&self, row: usize, upper: usize, fine: &[f64], out: &mut [f64]) {
        let (fine_stride, stride) = (self.fine.stride, self.coarse.stride);
        let start = (row + self.fine.padding) * self.fine.row_len() + self.fine.padding;
        for column in 0..self.fine.columns {
            let index = row * self.fine.columns + column;
            let first = (column + self.offset[0]) / self.factor + self.coarse.padding;
            let arm = self.arm(index, column, row);
            let (u, v) = (fine[start + column], fine[start + column + fine_stride]);
            let w = if N == 3 { fine[start + column + 2 * fine_stride] } else { 0.0 };
            for right in 0..2 {
                let corner = right + 2 * upper;
                let weight = f64::from(self.weights[index][corner]);
                if weight == 0.0 {
                    continue;
                }
                let at = first + right;
                out[at] += weight * u;
                out[at + stride] += weight * v;
                if N == 3 {
                    let lever = arm.map_or(0.0, |arm| {
                        let arm = self.arm_of_corner(arm, corner);
                        arm[0] * v - arm[1] * u
                    });
                    out[at + 2 * stride] += weight * (w + lever);
                }
            }
        }
    }

    /// Vector index of the lower left coarse place of a fine place.
    fn coarse_index(&self, column: usize, row: usize) -> usize {
        let (corner, _) = self.corners([column, row]);
        (corner[1] + self.coarse.padding) * self.coarse.row_len() + corner[0] + self.coarse.padding
    }

    /// Arm from the lower left coarse place to a fine place that moves rigidly, in lattice spacings.
    fn arm(&self, index: usize, column: usize, row: usize) -> Option<[f64; 2]> {
        self.rigid[index].then(|| [column + self.offset[0], row + self.offset[1]].map(|at| (at % self.factor) as f64 * self.unit))
    }

    /// The same arm from another of the four coarse places.
    fn arm_of_corner(&self, arm: [f64; 2], corner: usize) -> [f64; 2] {
        let step = self.factor as f64 * self.unit;
        [arm[0] - (corner & 1) as f64 * step, arm[1] - (corner >> 1) as f64 * step]
    }
}

/// Adds Pᵀ-transformed columns: `t += block P` for one parent, P = w [1, φ × arm].
pub fn times_interpolation<const N: usize>(block: &[[f64; N]; N], weight: f64, arm: [f64; 2], t: &mut [[f64; N]; N]) {
    for c in 0..N {
        for d in 0..N {
            t[c][d] += weight * block[c][d];
        }
        if N == 3 {
            t[c][2] += weight * (block[c][1] * arm[0] - block[c][0] * arm[1]);
        }
    }
}
