//! Coarse operators: five by five stencils of N x N blocks (Galerkin, A_c = Pᵀ A P).
//!
//! Away from the rim and from cracks all places have the same stencil, which is kept once; the others keep their own.

use std::ops::Range;

use rayon::prelude::*;

use super::super::field::Layout;
use super::super::kernel::load;
use super::chunked::{Chunked, Slot};
use super::transfer::{Link, Parents, Transfer, times_interpolation};
use super::{Block, Stiffness};
use crate::body::lattice::LANES;

/// Stencil half width of a coarse operator.
const REACH: isize = 2;
/// Blocks of a coarse stencil.
const BLOCKS: usize = 25;
/// Stiffness between two coarse places below which, relative to the diagonal, they count as severed.
const SEVERED: f64 = 1e-7;

/// Blocks of one coarse place.
type CoarseRow<const N: usize> = [Block<N>; BLOCKS];

/// Stencils of the places of a chunk, by block, row, column and place. Products read them in single precision: they are bound by memory, and only
/// smoothing uses them; coarser operators, in which rigid motion must stay free of force, come from the exact ones.
#[derive(Debug, Clone)]
struct OwnRows<const N: usize> {
    exact: [[[[f64; LANES]; N]; N]; BLOCKS],
    single: [[[[f32; LANES]; N]; N]; BLOCKS],
}

impl<const N: usize> OwnRows<N> {
    const ZERO: Self = OwnRows { exact: [[[[0.0; LANES]; N]; N]; BLOCKS], single: [[[[0.0; LANES]; N]; N]; BLOCKS] };

    fn set(&mut self, lane: usize, row: &CoarseRow<N>) {
        for (block, values) in row.iter().enumerate() {
            for (c, values) in values.iter().enumerate() {
                for (d, &value) in values.iter().enumerate() {
                    self.exact[block][c][d][lane] = value;
                    self.single[block][c][d][lane] = value as f32;
                }
            }
        }
    }
}

/// Operator of a coarse level.
#[derive(Debug, Clone)]
pub struct CoarseOperator<const N: usize> {
    layout: Layout,
    common: Option<CoarseRow<N>>,
    common_single: [[[f32; N]; N]; BLOCKS],
    rows: Chunked<OwnRows<N>>,
}

/// Block index of a neighbour within reach.
fn block_of([dx, dy]: [isize; 2]) -> usize {
    ((dy + REACH) * (2 * REACH + 1) + dx + REACH) as usize
}

impl<const N: usize> CoarseOperator<N> {
    /// Block between a place and its neighbour at a step.
    fn block(&self, [column, row]: [usize; 2], step: [isize; 2]) -> Block<N> {
        let index = block_of(step);
        match (self.rows.at(row, column / LANES), &self.common) {
            (Slot::Common, Some(common)) => common[index],
            (Slot::Own(own), _) => own.exact[index].map(|row| row.map(|lanes| lanes[column % LANES])),
            _ => [[0.0; N]; N],
        }
    }

    /// Pᵀ A P of a finer operator. Coarse places whose whole surroundings are interior and uncut all share the row of the first of them.
    pub fn galerkin(transfer: &Transfer<N>, finer: &impl Stiffness<N>) -> Self {
        let layout = transfer.coarse;
        let [columns, rows] = layout.size();
        let regular = transfer.regular(finer);
        let regular = |column: usize, row: usize| regular[row * columns + column];
        let all = (0..rows * columns).map(|index| [index % columns, index / columns]);
        let (inside, odd): (Vec<_>, Vec<[usize; 2]>) = all.partition(|&[column, row]| regular(column, row));
        let common = inside.first().map(|&place| coarse_rows(transfer, finer, &[place])[0]);
        let of_odd = coarse_rows(transfer, finer, &odd);
        let is_common = |row: usize, chunk: usize| {
            (chunk * LANES..(chunk + 1) * LANES).all(|column| column < columns && regular(column, row))
        };
        let find = |row: usize, chunk: usize| {
            let (mut own, mut is_empty) = (OwnRows::ZERO, true);
            for column in chunk * LANES..((chunk + 1) * LANES).min(columns) {
                let own_row = odd.binary_search_by_key(&[row, column], |&[column, row]| [row, column]).ok().map(|i| of_odd[i]);
                let blocks = own_row.or(common).unwrap_or([[[0.0; N]; N]; BLOCKS]);
                is_empty &= blocks.as_flattened().as_flattened().iter().all(|value| *value == 0.0);
                own.set(column % LANES, &blocks);
            }
            if is_empty { Slot::Empty } else { Slot::Own(own) }
        };
        let rows = Chunked::new([columns.div_ceil(LANES), rows], is_common, find);
        let common_single = common.map_or([[[0.0; N]; N]; BLOCKS], |common| common.map(|b| b.map(|row| row.map(|v| v as f32))));
        CoarseOperator { layout, common, common_single, rows }
    }

    /// Sets the rows of some places anew.
    pub fn refresh(&mut self, transfer: &Transfer<N>, finer: &impl Stiffness<N>, places: &[[usize; 2]]) {
        let common = self.common;
        for (&[column, row], blocks) in places.iter().zip(&coarse_rows(transfer, finer, places)) {
            let begin = |is_common: bool| {
                let mut own = OwnRows::ZERO;
                common.iter().filter(|_| is_common).for_each(|common| (0..LANES).for_each(|lane| own.set(lane, common)));
                own
            };
            self.rows.own_mut(row, column / LANES, begin).set(column % LANES, blocks);
        }
    }
}

impl<const N: usize> Stiffness<N> for CoarseOperator<N> {
    fn layout(&self) -> &Layout {
        &self.layout
    }

    fn reach(&self) -> usize {
        REACH as usize
    }

    fn is_common(&self, row: usize, chunk: usize) -> bool {
        self.rows.is_common(row, chunk)
    }

    fn inside(&self) -> Option<Block<N>> {
        self.common.map(|common| common[block_of([0, 0])])
    }

    fn diagonal(&self, place: [usize; 2]) -> Block<N> {
        self.block(place, [0, 0])
    }

    fn is_point(&self, place: [usize; 2]) -> bool {
        scale(&self.diagonal(place)) > 0.0
    }

    fn visit_row(&self, place: [usize; 2], mut visit: impl FnMut([isize; 2], &Block<N>)) {
        for step in (0..BLOCKS as isize).map(|index| [index % 5 - REACH, index / 5 - REACH]) {
            let block = self.block(place, step);
            if block.as_flattened().iter().any(|&value| value != 0.0) {
                visit(step, &block);
            }
        }
    }

    fn link(&self, a: [usize; 2], b: [usize; 2]) -> Link {
        let step = [0, 1].map(|i| b[i] as isize - a[i] as isize);
        let norm = self.block(a, step).as_flattened().iter().map(|v| v.abs()).fold(0.0, f64::max);
        if norm > SEVERED * scale(&self.diagonal(a)) || step == [0, 0] { Link::Joined } else { Link::Severed }
    }

    #[inline(always)]
    fn subtract_row(&self, row: usize, x: &[f32], r: &mut [f32]) {
        let (row_len, padding, stride) = (self.layout.row_len(), self.layout.padding, self.layout.stride);
        for chunk in 0..self.rows.chunks {
            let own = match self.rows.at(row, chunk) {
                Slot::Empty => continue,
                Slot::Common => None,
                Slot::Own(own) => Some(&own.single),
            };
            let mut sums = [[0.0_f32; LANES]; N];
            for block in 0..BLOCKS {
                let (dx, dy) = ((block % 5) as isize - REACH, (block / 5) as isize - REACH);
                let from = (row + padding).wrapping_add_signed(dy) * row_len + (padding + chunk * LANES).wrapping_add_signed(dx);
                for d in 0..N {
                    let x = load::<f32, LANES>(x, from + d * stride);
                    for (c, sum) in sums.iter_mut().enumerate() {
                        if let Some(own) = own {
                            let a = &own[block][c][d];
                            for lane in 0..LANES {
                                sum[lane] = a[lane].mul_add(x[lane], sum[lane]);
                            }
                        } else {
                            let a = self.common_single[block][c][d];
                            for lane in 0..LANES {
                                sum[lane] = a.mul_add(x[lane], sum[lane]);
                            }
                        }
                    }
                }
            }
            for (c, sum) in sums.iter().enumerate() {
                let start = c * stride + padding + chunk * LANES;
                for (r, sum) in r[start..start + LANES].iter_mut().zip(sum) {
                    *r -= sum;
                }
            }
        }
    }
}

/// Stiffness of a place with itself.
fn scale<const N: usize>(diagonal: &Block<N>) -> f64 {
    (0..N).map(|c| diagonal[c][c]).sum()
}

/// Rows of Pᵀ A P at some coarse places, best in the order of the level: a fine place serves up to four of them, and in parts of a few
/// hundred its row of A P is found once.
fn coarse_rows<const N: usize>(transfer: &Transfer<N>, finer: &impl Stiffness<N>, places: &[[usize; 2]]) -> Vec<CoarseRow<N>> {
    // Of the few places that change beside a crack every thread has its share.
    let together = places.len().div_ceil(2 * rayon::current_num_threads()).clamp(16, 256);
    let size = finer.layout().size();
    let half = transfer.factor as isize - 1;
    // Fine columns (axis 0) or rows that use a coarse one.
    let users = |at: isize, axis: usize| {
        (at - half).clamp(0, size[axis] as isize) as usize..(at + half + 1).clamp(0, size[axis] as isize) as usize
    };
    let of_part = |places: &[[usize; 2]]| {
        let around: Vec<[Range<usize>; 2]> =
            places.iter().map(|&place| [0, 1].map(|axis| users(transfer.seat(place)[axis], axis))).collect();
        let low = [0, 1].map(|axis| around.iter().map(|ranges| ranges[axis].start).min().unwrap_or(0));
        let high = [0, 1].map(|axis| around.iter().map(|ranges| ranges[axis].end).max().unwrap_or(0));
        // Where the rows of A P stand, by fine place.
        let width = high[0] - low[0];
        let mut slots = vec![u32::MAX; width * (high[1] - low[1])];
        let mut known: Vec<(Parents, CoarseRow<N>)> = Vec::new();
        let mut row_of = |(place, [columns, rows]): (&[usize; 2], &[Range<usize>; 2])| {
            let mut sum = [[[0.0; N]; N]; BLOCKS];
            for [column, row] in rows.clone().flat_map(|row| columns.clone().map(move |column| [column, row])) {
                let slot = &mut slots[(row - low[1]) * width + column - low[0]];
                if *slot == u32::MAX {
                    *slot = known.len() as u32;
                    known.push((transfer.parents([column, row]), interpolated(transfer, finer, [column, row])));
                }
                let (parents, of_fine) = &known[*slot as usize];
                if let Some(&(_, weight, arm)) = parents.iter().find(|(parent, weight, _)| parent == place && *weight != 0.0) {
                    let shift = block_of([0, 1].map(|i| parents[0].0[i] as isize - place[i] as isize)) as isize
                        - block_of([0, 0]) as isize;
                    add_restricted(of_fine, weight, arm, shift, &mut sum);
                }
            }
            sum
        };
        places.iter().zip(&around).map(&mut row_of).collect::<Vec<CoarseRow<N>>>()
    };
    places.par_chunks(together).flat_map_iter(of_part).collect()
}

/// Row of A P at a fine place: blocks by coarse places around the first of its parents.
fn interpolated<const N: usize>(transfer: &Transfer<N>, finer: &impl Stiffness<N>, place: [usize; 2]) -> CoarseRow<N> {
    let mut t = [[[0.0; N]; N]; BLOCKS];
    let (first, ..) = transfer.parents(place)[0];
    finer.visit_row(place, |step, block| {
        for (parent, weight, arm) in transfer.parents([0, 1].map(|i| place[i].wrapping_add_signed(step[i]))) {
            if weight != 0.0 {
                let index = block_of([0, 1].map(|i| parent[i] as isize - first[i] as isize));
                times_interpolation(block, weight, arm, &mut t[index]);
            }
        }
    });
    t
}

/// Adds Pᵀ of one parent times a row of A P, whose blocks stand `shift` away in the sum.
fn add_restricted<const N: usize>(of_fine: &CoarseRow<N>, weight: f64, arm: [f64; 2], shift: isize, sum: &mut CoarseRow<N>) {
    for (index, t) in of_fine.iter().enumerate().filter(|(_, t)| t.as_flattened().iter().any(|value| *value != 0.0)) {
        let sum = &mut sum[index.wrapping_add_signed(shift)];
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
