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
use super::chunked::{Chunked, Slot};
use super::{Block, Stiffness};
use crate::body::lattice::LANES;

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
    pub coarse: Layout,
    /// Lower coarse column of every fine column, and the share of the way to the next.
    lower: Vec<(u32, f32)>,
    /// The same of every column and row.
    seats: [Vec<(usize, f64)>; 2],
    /// Weights of the chunks of a fine row; common are bilinear ones.
    own: Chunked<[Weights; LANES]>,
}

/// Coarse places around a fine place, the lower left first, with weight and arm.
pub type Parents = [([usize; 2], f64, [f64; 2]); 4];

/// Weights of the four coarse places around a fine place: in double precision, so that the coarse operator is free of force in
/// rigid motion.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Weights {
    share: [f64; 4],
    /// Whether the fine place moves rigidly with its coarse places.
    rigid: bool,
}

impl<const N: usize> Transfer<N> {
    /// Lays a coarse lattice over a finer level, whose spacing is `unit` in lattice spacings.
    pub fn new(finer: &impl Stiffness<N>, factor: usize, unit: f64) -> Self {
        let fine = *finer.layout();
        // Coarse places lie symmetrically where that is possible. Where fine ones lie before the first of them, a further one stands outside.
        let is_symmetric = |first: usize, count: usize| 2 * first < count && (count - 1 - 2 * first).is_multiple_of(factor);
        let offset = fine.size().map(|count| match (0..factor).find(|&first| is_symmetric(first, count)) {
            None | Some(0) => 0,
            Some(first) => factor - first,
        });
        let [columns, rows] = [0, 1].map(|axis| (fine.size()[axis] - 1 + offset[axis]).div_ceil(factor) + 1);
        let padding = 2;
        let stride = columns.next_multiple_of(LANES) + 2 * padding;
        let coarse = Layout { unknowns: N, stride, rows: rows + 2 * padding, padding, columns };
        let place = |column: usize| column + offset[0];
        let lower = (0..fine.columns).map(|c| ((place(c) / factor) as u32, (place(c) % factor) as f32 / factor as f32)).collect();
        let seats = [0, 1].map(|axis| {
            let seat = |at: usize| ((at + offset[axis]) / factor, ((at + offset[axis]) % factor) as f64 / factor as f64);
            (0..fine.size()[axis]).map(seat).collect()
        });
        let [columns, rows] = fine.size();
        let own = Chunked::new([columns.div_ceil(LANES), rows], |_, _| true, |_, _| Slot::Empty);
        let mut transfer = Transfer { factor, unit, offset, fine, coarse, lower, seats, own };
        let find = |row: usize, chunk: usize| transfer.weights_of_chunk(row, chunk, finer);
        transfer.own = Chunked::new([columns.div_ceil(LANES), rows], |row, chunk| finer.is_common(row, chunk), find);
        transfer
    }

    /// Weighs the places in and around `changed` ones anew; those whose weights are others now.
    pub fn refresh(&mut self, changed: &[[usize; 2]], finer: &impl Stiffness<N>) -> Vec<[usize; 2]> {
        // A place uses coarse ones that are less than the factor away.
        let (reach, [columns, rows], chunks) = (self.factor - 1, self.fine.size(), self.own.chunks);
        let mut affected = vec![false; rows * chunks];
        for &[column, row] in changed {
            let range = column.saturating_sub(reach) / LANES..=(column + reach).min(columns - 1) / LANES;
            for row in row.saturating_sub(reach)..=(row + reach).min(rows - 1) {
                affected[row * chunks..][range.clone()].fill(true);
            }
        }
        let affected: Vec<usize> = (0..affected.len()).filter(|&index| affected[index]).collect();
        let weights = |&index: &usize| self.weights_of_chunk(index / chunks, index % chunks, finer);
        let found: Vec<Slot<[Weights; LANES]>> = affected.par_iter().map(weights).collect();
        let mut others = Vec::new();
        for (index, found) in affected.into_iter().zip(found) {
            let (row, chunk) = (index / chunks, index % chunks);
            let plain = std::array::from_fn(|lane| self.plain([chunk * LANES + lane, row]));
            let old = *self.own.at(row, chunk).or(&plain, &[Weights::default(); LANES]);
            let new = found.or(plain, [Weights::default(); LANES]);
            if new != old {
                others.extend((0..LANES).filter(|&lane| old[lane] != new[lane]).map(|lane| [chunk * LANES + lane, row]));
                *self.own.own_mut(row, chunk, |_| new) = new;
            }
        }
        others
    }

    /// Coarse places whose rows of the coarse operator take in one of some fine places, the fine operator reaching so many places.
    pub fn coarse_around(&self, fine: &[[usize; 2]], reach: usize) -> Vec<[usize; 2]> {
        let [columns, rows] = self.coarse.size();
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

    /// For each coarse place, row by row, whether all fine places that its row of the coarse operator takes in are there, with common rows
    /// and bilinear weights.
    pub fn regular(&self, finer: &impl Stiffness<N>) -> Vec<bool> {
        let ([columns, rows], chunks, reach) = (self.fine.size(), self.own.chunks, (self.factor - 1 + finer.reach()) as isize);
        // Sums over rectangles of odd chunks: those left of c and below r.
        let width = chunks + 1;
        let mut sums = vec![0_i64; width * (rows + 1)];
        for (row, chunk) in (0..rows).flat_map(|row| (0..chunks).map(move |chunk| (row, chunk))) {
            let is_odd = !(finer.is_common(row, chunk) && self.own.is_common(row, chunk));
            let [here, below] = [row + 1, row].map(|row| row * width + chunk);
            sums[here + 1] = i64::from(is_odd) + sums[below + 1] + sums[here] - sums[below];
        }
        let [coarse_columns, coarse_rows] = self.coarse.size();
        let is_regular = |index: usize| {
            let [c, r] = self.seat([index % coarse_columns, index / coarse_columns]);
            let (left, right, below, above) = (c - reach, c + reach, r - reach, r + reach);
            left >= 0 && below >= 0 && right < columns as isize && above < rows as isize && {
                let (left, right) = (left as usize / LANES, right as usize / LANES + 1);
                let (below, above) = (below as usize * width, (above as usize + 1) * width);
                sums[above + right] - sums[below + right] - sums[above + left] + sums[below + left] == 0
            }
        };
        (0..coarse_columns * coarse_rows).map(is_regular).collect()
    }

    /// Weights of the places of a chunk.
    fn weights_of_chunk(&self, row: usize, chunk: usize, finer: &impl Stiffness<N>) -> Slot<[Weights; LANES]> {
        let places: [[usize; 2]; LANES] = std::array::from_fn(|lane| [chunk * LANES + lane, row]);
        let is_point = |place: [usize; 2]| place[0] < self.fine.columns && finer.is_point(place);
        let weights = places.map(|place| if is_point(place) { self.weigh(place, finer) } else { Weights::default() });
        let is_plain = |(weights, place): (&Weights, &[usize; 2])| {
            let plain = self.plain(*place).share;
            is_point(*place) && !weights.rigid && (0..4).all(|i| (weights.share[i] - plain[i]).abs() < 1e-12)
        };
        if weights.iter().zip(&places).all(is_plain) {
            Slot::Common
        } else if weights.iter().all(|weights| weights.share == [0.0; 4]) {
            Slot::Empty
        } else {
            Slot::Own(weights)
        }
    }

    fn weigh(&self, place: [usize; 2], finer: &impl Stiffness<N>) -> Weights {
        let (corners, _) = self.corners(place);
        let mut share = [0.0; 4];
        let (mut severed, mut ghosts) = (false, [false; 4]);
        for (corner, bilinear) in self.plain(place).share.into_iter().enumerate().filter(|(_, bilinear)| *bilinear > 0.0) {
            let seat = self.seat([corners[0] + (corner & 1), corners[1] + (corner >> 1)]);
            let is_there = (0..2).all(|axis| (0..self.fine.size()[axis] as isize).contains(&seat[axis]));
            let seat = seat.map(|at| at as usize);
            let found = if is_there && finer.is_point(seat) { finer.link(place, seat) } else { Link::Ghost };
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

    /// Bilinear weights of the four coarse places around a fine one; none beside the lattice.
    fn plain(&self, place: [usize; 2]) -> Weights {
        if place[0] >= self.fine.columns {
            return Weights::default();
        }
        let (_, fraction) = self.corners(place);
        let share = |axis: usize, upper: usize| if upper == 1 { fraction[axis] } else { 1.0 - fraction[axis] };
        Weights { share: std::array::from_fn(|corner| share(0, corner & 1) * share(1, corner >> 1)), rigid: false }
    }

    /// Lower left coarse place of a fine place, and the fraction of the way to the next.
    fn corners(&self, place: [usize; 2]) -> ([usize; 2], [f64; 2]) {
        let [x, y] = [0, 1].map(|axis| self.seats[axis][place[axis]]);
        ([x.0, y.0], [x.1, y.1])
    }

    /// Fine column and row (which may lie outside) of a coarse place.
    pub fn seat(&self, coarse: [usize; 2]) -> [isize; 2] {
        [0, 1].map(|axis| (coarse[axis] * self.factor) as isize - self.offset[axis] as isize)
    }

    /// Coarse places (column, row) of a fine place with their weights and the arms from them to a fine place that moves rigidly, in lattice
    /// spacings; empty entries have weight 0.
    pub fn parents(&self, place: [usize; 2]) -> Parents {
        let (lower, _) = self.corners(place);
        let own = self.own.at(place[1], place[0] / LANES).map(|own| own[place[0] % LANES]);
        let weights = own.or(self.plain(place), Weights::default());
        std::array::from_fn(|corner| {
            let seat = [lower[0] + (corner & 1), lower[1] + (corner >> 1)];
            (seat, weights.share[corner], self.arm(&weights, place, corner))
        })
    }

    /// Arm from one of the four coarse places around it to a fine place, in lattice spacings; none where that does not move rigidly.
    #[inline]
    fn arm(&self, weights: &Weights, place: [usize; 2], corner: usize) -> [f64; 2] {
        if !weights.rigid {
            return [0.0; 2];
        }
        let (_, fraction) = self.corners(place);
        let step = self.factor as f64 * self.unit;
        [fraction[0] - (corner & 1) as f64, fraction[1] - (corner >> 1) as f64].map(|share| share * step)
    }
}

/// Adds Pᵀ-transformed columns: `t += block P` for one parent, P = w [1, φ × arm].
pub fn times_interpolation<const N: usize>(block: &Block<N>, weight: f64, arm: [f64; 2], t: &mut Block<N>) {
    for c in 0..N {
        for d in 0..N {
            t[c][d] += weight * block[c][d];
        }
        if N == 3 {
            t[c][2] += weight * (block[c][1] * arm[0] - block[c][0] * arm[1]);
        }
    }
}
