//! Interpolation between a lattice and the coarser one above it, aware of cracks.
//!
//! A fine place takes its value from the up to four coarse places around it with bilinear weights. A coarse place that
//! lies across a crack is dropped: on the body this is the case when the bond from the fine point to the coarse one is
//! broken, on coarser levels when the stiffness between the two has vanished. The remaining weights are scaled to sum 1,
//! and, where points turn freely, the coarse place then moves the fine one as a rigid body, `u = u_J + θ_J × (x - x_J)`,
//! so that rigid motion stays exact where the linear field no longer is.

mod apply;

use rayon::prelude::*;

use super::super::field::Layout;
use crate::body::lattice::LANES;

/// Slot of a chunk of fine places with plain bilinear weights.
const PLAIN: u32 = u32::MAX;
/// Slot of a chunk without places in use.
const EMPTY: u32 = u32::MAX - 1;

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
    pub factor: usize,
    /// Fine spacing of this level in lattice spacings: arm of the rotation θ = φ Δ per place.
    unit: f64,
    /// Fine columns and rows by which coarse place (0, 0) stands before fine place (0, 0).
    offset: [usize; 2],
    fine: Layout,
    fine_rows: usize,
    coarse: Layout,
    /// Lower coarse column of every fine column, and the share of the way to the next.
    lower: Vec<(u32, f32)>,
    /// Chunks of a fine row.
    chunks: usize,
    /// For every chunk of a fine row where its weights stand, [`PLAIN`] if they are bilinear, [`EMPTY`] if there are none.
    slots: Vec<u32>,
    own: Vec<[Weights; LANES]>,
}

/// Weights of the four coarse places around a fine place: in double precision, so that the coarse operator is free of force in
/// rigid motion.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Weights {
    share: [f64; 4],
    /// Whether the fine place moves rigidly with its coarse places.
    rigid: bool,
}

impl<const N: usize> Transfer<N> {
    /// Lays a coarse lattice over a fine one of `columns` x `rows` places. `link(place, coarse place)` in (column, row)
    /// says whether a fine place may use a coarse one; `is_point` whether a fine place is in use, `is_regular` whether
    /// all bonds of a chunk (row, chunk) are whole; `unit` is the spacing of the fine level in lattice spacings.
    pub fn new(
        fine: Layout,
        rows: usize,
        factor: usize,
        unit: f64,
        is_regular: impl Fn(usize, usize) -> bool,
        is_point: impl Fn(usize, usize) -> bool + Sync,
        link: impl Fn([usize; 2], [usize; 2]) -> Link + Sync,
    ) -> Self {
        let columns = fine.columns;
        // Coarse places lie symmetrically where that is possible. Where fine ones lie before the first of them, a further one stands outside.
        let is_symmetric = |first: usize, count: usize| 2 * first < count && (count - 1 - 2 * first).is_multiple_of(factor);
        let offset = [columns, rows].map(|count| match (0..factor).find(|&first| is_symmetric(first, count)) {
            None | Some(0) => 0,
            Some(first) => factor - first,
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
        let chunks = columns.div_ceil(LANES);
        let place = |column: usize| column + offset[0];
        let lower = (0..columns).map(|c| ((place(c) / factor) as u32, (place(c) % factor) as f32 / factor as f32)).collect();
        let slots = vec![PLAIN; rows * chunks];
        let mut transfer =
            Transfer { factor, unit, offset, fine, fine_rows: rows, coarse, lower, chunks, slots, own: Vec::new() };
        let irregular: Vec<usize> = (0..rows * chunks).filter(|&index| !is_regular(index / chunks, index % chunks)).collect();
        let weights = |&index: &usize| transfer.weights_of_chunk(index / chunks, index % chunks, &is_point, &link);
        let found: Vec<Option<[Weights; LANES]>> = irregular.par_iter().map(weights).collect();
        for (index, weights) in irregular.into_iter().zip(found) {
            let Some(weights) = weights else { continue };
            if weights.iter().all(|weights| weights.share == [0.0; 4]) {
                transfer.slots[index] = EMPTY;
            } else {
                transfer.slots[index] = transfer.own.len() as u32;
                transfer.own.push(weights);
            }
        }
        transfer
    }

    /// Weighs the places in and around `changed` ones anew, with what [`Transfer::new`] was given; those whose weights are others now.
    pub fn refresh(
        &mut self,
        changed: &[[usize; 2]],
        is_point: impl Fn(usize, usize) -> bool + Sync,
        link: impl Fn([usize; 2], [usize; 2]) -> Link + Sync,
    ) -> Vec<[usize; 2]> {
        // A place uses coarse ones that are less than the factor away.
        let reach = self.factor - 1;
        let mut affected = vec![false; self.slots.len()];
        for &[column, row] in changed {
            let chunks = column.saturating_sub(reach) / LANES..=(column + reach).min(self.fine.columns - 1) / LANES;
            for row in row.saturating_sub(reach)..=(row + reach).min(self.fine_rows - 1) {
                affected[row * self.chunks..][chunks.clone()].fill(true);
            }
        }
        let affected: Vec<usize> = (0..affected.len()).filter(|&index| affected[index]).collect();
        let weights = |&index: &usize| self.weights_of_chunk(index / self.chunks, index % self.chunks, &is_point, &link);
        let found: Vec<Option<[Weights; LANES]>> = affected.par_iter().map(weights).collect();
        let mut others = Vec::new();
        for (index, weights) in affected.into_iter().zip(found) {
            let (row, first) = (index / self.chunks, index % self.chunks * LANES);
            let slot = self.slots[index];
            if weights.is_none() && slot == PLAIN {
                continue;
            }
            let plain = |lane: usize| match first + lane {
                column if column < self.fine.columns => Weights { share: self.bilinear([column, row]), rigid: false },
                _ => Weights::default(),
            };
            let new = weights.unwrap_or_else(|| std::array::from_fn(plain));
            let old = match slot {
                PLAIN => std::array::from_fn(plain),
                EMPTY => [Weights::default(); LANES],
                slot => self.own[slot as usize],
            };
            let differs = |lane: &usize| old[*lane] != new[*lane];
            let before = others.len();
            others.extend((0..LANES).filter(differs).map(|lane| [first + lane, row]));
            if others.len() == before {
                continue;
            }
            if slot == PLAIN || slot == EMPTY {
                self.slots[index] = self.own.len() as u32;
                self.own.push(new);
            } else {
                self.own[slot as usize] = new;
            }
        }
        others
    }

    /// Coarse places whose rows of the coarse operator take in one of some fine places, the fine operator reaching so many places.
    pub fn coarse_around(&self, fine: &[[usize; 2]], reach: usize) -> Vec<[usize; 2]> {
        let [columns, rows] = self.coarse_size();
        let reach = self.factor - 1 + reach;
        let mut taken = vec![false; columns * rows];
        let range = |at: usize, axis: usize, count: usize| {
            let at = at + self.offset[axis];
            at.saturating_sub(reach).div_ceil(self.factor)..((at + reach) / self.factor + 1).min(count)
        };
        for &[column, row] in fine {
            for row in range(row, 1, rows) {
                taken[row * columns..][range(column, 0, columns)].fill(true);
            }
        }
        (0..taken.len()).filter(|&index| taken[index]).map(|index| [index % columns, index / columns]).collect()
    }

    /// Weights of the places of a chunk; `None` if all are in use and plain.
    fn weights_of_chunk(
        &self,
        row: usize,
        chunk: usize,
        is_point: &impl Fn(usize, usize) -> bool,
        link: &impl Fn([usize; 2], [usize; 2]) -> Link,
    ) -> Option<[Weights; LANES]> {
        let mut weights = [Weights::default(); LANES];
        let mut plain = true;
        for (lane, weights) in weights.iter_mut().enumerate() {
            let column = chunk * LANES + lane;
            if column < self.fine.columns && is_point(column, row) {
                *weights = self.weigh([column, row], is_point, link);
                let bilinear = self.bilinear([column, row]);
                plain &= !weights.rigid && (0..4).all(|i| (weights.share[i] - bilinear[i]).abs() < 1e-12);
            } else {
                plain = false;
            }
        }
        (!plain).then_some(weights)
    }

    fn weigh(
        &self,
        place: [usize; 2],
        is_point: &impl Fn(usize, usize) -> bool,
        link: &impl Fn([usize; 2], [usize; 2]) -> Link,
    ) -> Weights {
        let (corners, _) = self.corners(place);
        let mut share = [0.0; 4];
        let (mut severed, mut ghosts) = (false, [false; 4]);
        for (corner, bilinear) in self.bilinear(place).into_iter().enumerate().filter(|(_, bilinear)| *bilinear > 0.0) {
            let seat = [self.fine_seat(corners[0] + (corner & 1), 0), self.fine_seat(corners[1] + (corner >> 1), 1)];
            let found = match seat {
                [Some(c), Some(r)] if is_point(c, r) => link(place, [c, r]),
                _ => Link::Ghost,
            };
            severed |= found == Link::Severed;
            ghosts[corner] = found == Link::Ghost;
            share[corner] = if found == Link::Severed { 0.0 } else { bilinear };
        }
        // A place without material cannot tell sides: it serves only away from cracks.
        if severed {
            share.iter_mut().zip(ghosts).filter(|(_, ghost)| *ghost).for_each(|(share, _)| *share = 0.0);
        }
        let sum: f64 = share.iter().sum();
        if sum > 0.0 {
            share.iter_mut().for_each(|share| *share /= sum);
        }
        Weights { share, rigid: severed && N == 3 }
    }

    /// Bilinear weights of the four coarse places around a fine one.
    fn bilinear(&self, place: [usize; 2]) -> [f64; 4] {
        let (_, fraction) = self.corners(place);
        let share = |axis: usize, upper: usize| if upper == 1 { fraction[axis] } else { 1.0 - fraction[axis] };
        std::array::from_fn(|corner| share(0, corner & 1) * share(1, corner >> 1))
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

    pub fn coarse(&self) -> &Layout {
        &self.coarse
    }

    /// Rows and columns of the coarse level.
    pub fn coarse_size(&self) -> [usize; 2] {
        [self.coarse.columns, self.coarse.rows - 2 * self.coarse.padding]
    }

    /// Fine column and row (which may lie outside) of a coarse place.
    pub fn seat(&self, coarse: [usize; 2]) -> [isize; 2] {
        [0, 1].map(|axis| (coarse[axis] * self.factor) as isize - self.offset[axis] as isize)
    }

    /// Coarse places (column, row) of a fine place with their interpolation blocks; empty entries have weight 0.
    pub fn parents(&self, column: usize, row: usize) -> [([usize; 2], f64, [f64; 2]); 4] {
        let (lower, _) = self.corners([column, row]);
        let seat = |corner: usize| [lower[0] + (corner & 1), lower[1] + (corner >> 1)];
        let slot = self.slots[row * self.chunks + column / LANES];
        if slot == PLAIN {
            let weights = self.bilinear([column, row]);
            return std::array::from_fn(|corner| (seat(corner), weights[corner], [0.0; 2]));
        }
        if slot == EMPTY {
            return std::array::from_fn(|corner| (seat(corner), 0.0, [0.0; 2]));
        }
        let weights = &self.own[slot as usize][column % LANES];
        let arm = self.arm(weights, column, row);
        std::array::from_fn(|corner| {
            (seat(corner), weights.share[corner], arm.map_or([0.0; 2], |arm| self.arm_of_corner(arm, corner)))
        })
    }

    /// Whether all fine places of a chunk of a row use plain bilinear weights.
    pub fn is_plain(&self, row: usize, chunk: usize) -> bool {
        self.slots[row * self.chunks + chunk] == PLAIN
    }

    /// Coarse row below a fine one, and the share of the way to the next.
    fn rows_around(&self, row: usize) -> (usize, f32) {
        let at = row + self.offset[1];
        (at / self.factor, (at % self.factor) as f32 / self.factor as f32)
    }

    /// Vector index of the lower left coarse place of a fine place.
    fn coarse_index(&self, column: usize, row: usize) -> usize {
        let (corner, _) = self.corners([column, row]);
        (corner[1] + self.coarse.padding) * self.coarse.row_len() + corner[0] + self.coarse.padding
    }

    /// Arm from the lower left coarse place to a fine place that moves rigidly, in lattice spacings.
    fn arm(&self, weights: &Weights, column: usize, row: usize) -> Option<[f64; 2]> {
        weights.rigid.then(|| [column + self.offset[0], row + self.offset[1]].map(|at| (at % self.factor) as f64 * self.unit))
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
