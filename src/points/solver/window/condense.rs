//! Static condensation of a plate onto the points of a window: `S = K_ww - K_we K_ee⁻¹ K_ew` for window points w and all
//! others e.
//!
//! Substructuring by recursive bisection (George 1973, nested dissection): a region of the plate is cut by a separator that no
//! bond crosses (a strip as wide as the bonds reach), both halves are condensed onto their surroundings, and the
//! separator is eliminated from their sum. Only the dense matrices of the branch at hand are in memory; window points are never eliminated.

use std::sync::{Arc, Mutex, PoisonError};

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::ldlt;
use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::linalg::triangular_solve::solve_unit_lower_triangular_in_place;
use faer::prelude::{Reborrow, ReborrowMut};
use faer::{Accum, Mat, MatMut, MatRef, Par};

use crate::body::Body;
use crate::solver::assembly::{Assembly, for_joints};
use crate::state::Bonds;
use perilife_base::watch::{self, Watch};

/// Lattice places of a region that is eliminated at once.
const LEAF: usize = 64;
/// Lattice places of a region whose halves are worth two threads.
const FORK: usize = 1024;
/// Products of numbers in an operation on matrices whose halves are worth two threads.
const FORK_PRODUCTS: usize = 1 << 25;

/// The inverse of the condensed stiffness: displacement of the window's points under forces on them.
#[derive(Debug)]
pub struct Condensed {
    /// Window points, ascending.
    pub places: Vec<u32>,
    /// (S⁻¹)_ij, M unknowns a point, both triangles.
    pub inverse: Mat<f64>,
}

/// Condenses the plate with its present bonds onto `window` (ascending places, each with a bond). `None` where the
/// stiffness is not positive definite in these digits.
///
/// Points held altogether, and not of the window, take part as ground only, so that a small part of a large plate costs no
/// more than its size. A plate that floats is held at its window, at `pins` (indices of the window's vector): displacement is
/// then relative to these, which strains do not feel.
pub fn condense<const M: usize, A: Assembly<M>>(
    body: &Body,
    bonds: &Bonds,
    assembly: &A,
    window: &[u32],
    pins: &[usize],
) -> Option<Condensed> {
    let mut kept = vec![false; body.places()];
    window.iter().for_each(|&place| kept[place as usize] = true);
    let mut ground = vec![false; body.places()];
    for place in body.points.iter().map(|&place| place as usize) {
        ground[place] = !kept[place] && (0..M).all(|c| assembly.is_held(place, c));
    }
    let condenser = Condenser { body, bonds, assembly, kept, ground, pool: Pool::default(), watch: watch::watching() };
    let rest = condenser.eliminate(condenser.around_moving())?;

    // What is left couples window points only; bonds among them come in now.
    let mut sum = condenser.front(window, &[]);
    sum.add(&rest);
    condenser.assemble(&mut sum, window, &|other| condenser.kept[other] || condenser.ground[other]);
    for (at, &place) in window.iter().enumerate() {
        condenser.hold(&mut sum.matrix, at, place);
    }
    pins.iter().for_each(|&index| sum.matrix.hold(index));
    let order = sum.matrix.order;
    let mut factors = sum.matrix.as_mut();
    condenser.factorise(factors.rb_mut())?;
    let mut inverse = Mat::zeros(order, order);
    let mut memory = MemBuffer::new(ldlt::inverse::inverse_scratch::<f64>(order, Par::Seq));
    let factors = factors.rb();
    ldlt::inverse::inverse(inverse.as_mut(), factors, factors.diagonal(), Par::Seq, MemStack::new(&mut memory));
    complete_upper(&mut inverse);
    Some(Condensed { places: window.to_vec(), inverse })
}

/// Columns and rows of the lattice, each from..to.
#[derive(Debug, Clone, Copy)]
struct Rectangle {
    columns: (usize, usize),
    rows: (usize, usize),
}

impl Rectangle {
    fn contains(&self, (column, row): (usize, usize)) -> bool {
        (self.columns.0..self.columns.1).contains(&column) && (self.rows.0..self.rows.1).contains(&row)
    }

    fn places(&self) -> usize {
        (self.columns.1 - self.columns.0) * (self.rows.1 - self.rows.0)
    }

    /// Halves on both sides of a separator `reach` wide across the longer side; `None` for a leaf.
    fn split(&self, reach: usize) -> Option<[Rectangle; 3]> {
        let (width, height) = (self.columns.1 - self.columns.0, self.rows.1 - self.rows.0);
        if self.places() <= LEAF || width.max(height) < 2 * reach + 2 {
            return None;
        }
        let cut = |(from, to): (usize, usize)| {
            let first = from + (to - from - reach) / 2;
            [(from, first), (first + reach, to), (first, first + reach)]
        };
        Some(if width >= height {
            cut(self.columns).map(|columns| Rectangle { columns, ..*self })
        } else {
            cut(self.rows).map(|rows| Rectangle { rows, ..*self })
        })
    }
}

/// Copies the lower triangle of a symmetric matrix to the upper one.
pub(super) fn complete_upper(matrix: &mut Mat<f64>) {
    const BLOCK: usize = 32;
    let order = matrix.nrows();
    for first in (0..order).step_by(BLOCK) {
        for column in 0..order {
            for row in first..(first + BLOCK).min(column) {
                matrix[(row, column)] = matrix[(column, row)];
            }
        }
    }
}

/// Memory of matrices that are done with, for others to come: new pages would cost more than what is computed in them.
#[derive(Default)]
struct Pool {
    free: Mutex<Vec<Vec<f64>>>,
}

impl Pool {
    /// Memory for at least so many numbers, with anything in it: the smallest that is free. Sizes are powers of two, so that
    /// much fits again; what is not written to takes no memory.
    fn take(&self, length: usize) -> Vec<f64> {
        let length = length.next_power_of_two();
        let mut free = self.free.lock().unwrap_or_else(PoisonError::into_inner);
        let fitting = (0..free.len()).filter(|&i| free[i].len() >= length).min_by_key(|&i| free[i].len());
        let found = fitting.map(|i| free.swap_remove(i));
        drop(free);
        found.unwrap_or_else(|| vec![0.0; length])
    }

    fn give(&self, memory: Vec<f64>) {
        self.free.lock().unwrap_or_else(PoisonError::into_inner).push(memory);
    }
}

/// The lower triangle of a square matrix, column by column; above it stands anything.
struct Square {
    order: usize,
    values: Vec<f64>,
}

impl Square {
    /// Zero, in memory of at least `order`² numbers.
    fn zeros(order: usize, memory: Vec<f64>) -> Self {
        let mut zeros = Square { order, values: memory };
        (0..order).for_each(|column| zeros.column_mut(column)[column..].fill(0.0));
        zeros
    }

    fn as_mut(&mut self) -> MatMut<'_, f64> {
        MatMut::from_column_major_slice_mut(&mut self.values[..self.order * self.order], self.order, self.order)
    }

    fn column(&self, column: usize) -> &[f64] {
        &self.values[column * self.order..(column + 1) * self.order]
    }

    fn column_mut(&mut self, column: usize) -> &mut [f64] {
        &mut self.values[column * self.order..(column + 1) * self.order]
    }

    /// Adds to an entry of the lower triangle.
    fn add(&mut self, row: usize, column: usize, value: f64) {
        self.values[column * self.order + row] += value;
    }

    /// Adds a block at point row `a` and column `b` <= `a`.
    fn add_block<const N: usize>(&mut self, a: usize, b: usize, block: &[[f64; N]; N]) {
        for (i, row) in block.iter().enumerate() {
            for (j, &value) in row.iter().enumerate().filter(|(j, _)| a > b || i >= *j) {
                self.add(N * a + i, N * b + j, value);
            }
        }
    }

    /// Takes an unknown out of the system: a unit diagonal alone in its row and column.
    fn hold(&mut self, index: usize) {
        for i in 0..self.order {
            self.values[index.min(i) * self.order + index.max(i)] = if i == index { 1.0 } else { 0.0 };
        }
    }
}

/// A dense symmetric matrix over some points; the lower triangle counts.
struct DenseFront<const N: usize> {
    /// Points to eliminate and then points to keep, each ascending.
    points: Vec<u32>,
    /// How many are to be eliminated, or have been.
    inner: usize,
    matrix: Square,
}

impl<const N: usize> DenseFront<N> {
    /// Where a point stands.
    fn at(&self, place: u32) -> usize {
        let (inner, outer) = self.points.split_at(self.inner);
        let (Ok(at) | Err(at)) = inner.binary_search(&place).or_else(|_| outer.binary_search(&place).map(|at| at + self.inner));
        debug_assert_eq!(self.points.get(at), Some(&place));
        at
    }

    /// Adds what is left of another matrix, over some of the same points.
    fn add(&mut self, other: &DenseFront<N>) {
        let left = other.points[other.inner..].iter().map(|&place| N * self.at(place));
        let to: Vec<usize> = left.flat_map(|first| first..first + N).collect();
        let done = N * other.inner;
        // Neighbours stay neighbours but for the border of what is eliminated here.
        let mut runs: Vec<std::ops::Range<usize>> = Vec::new();
        for i in 0..to.len() {
            match runs.last_mut() {
                Some(run) if to[i] == to[i - 1] + 1 => run.end = i + 1,
                _ => runs.push(i..i + 1),
            }
        }
        for (j, &column) in to.iter().enumerate() {
            let source = &other.matrix.column(done + j)[done..];
            for run in runs.iter().filter(|run| run.end > j) {
                let from = run.start.max(j);
                let (row, values) = (to[from], &source[from..run.end]);
                if row >= column {
                    let target = &mut self.matrix.column_mut(column)[row..row + values.len()];
                    target.iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
                } else {
                    // The lower triangle has these on the other side of the diagonal.
                    values.iter().enumerate().for_each(|(i, value)| self.matrix.add(column, row + i, *value));
                }
            }
        }
    }
}

struct Condenser<'a, const M: usize, A> {
    body: &'a Body,
    bonds: &'a Bonds,
    assembly: &'a A,
    kept: Vec<bool>,
    /// Points held in all components, the window's not counted.
    ground: Vec<bool>,
    pool: Pool,
    /// Who watches: halves are condensed by other threads too.
    watch: Option<Arc<Watch>>,
}

impl<const M: usize, A: Assembly<M>> Condenser<'_, M, A> {
    /// The region of all points that are not ground.
    fn around_moving(&self) -> Rectangle {
        let moving = self.body.points.iter().map(|&place| place as usize).filter(|&place| !self.ground[place]);
        let none = Rectangle { columns: (usize::MAX, 0), rows: (usize::MAX, 0) };
        let around = moving.map(|place| self.body.lattice.column_row(place)).fold(none, |all, (column, row)| Rectangle {
            columns: (all.columns.0.min(column), all.columns.1.max(column + 1)),
            rows: (all.rows.0.min(row), all.rows.1.max(row + 1)),
        });
        if around.columns.1 == 0 { Rectangle { columns: (0, 0), rows: (0, 0) } } else { around }
    }

    /// Condenses all points of a region but the window's onto their surroundings and the window; `None` also where the work was
    /// asked to end, which the next equilibrium says.
    fn eliminate(&self, region: Rectangle) -> Option<DenseFront<M>> {
        if self.watch.as_ref().is_some_and(|watch| watch.is_cancelled()) {
            return None;
        }
        let (below, own) = match region.split(self.body.lattice.padding) {
            None => (Vec::new(), region),
            Some([a, b, separator]) => {
                let (a, b) = if region.places() >= FORK {
                    rayon::join(|| self.eliminate(a), || self.eliminate(b))
                } else {
                    (self.eliminate(a), self.eliminate(b))
                };
                (vec![a?, b?], separator)
            }
        };
        let inner = self.carrying(own);
        // Done are the points of both halves; bonds to them were taken in there.
        let done = |place: usize| {
            let at = self.body.lattice.column_row(place);
            region.contains(at) && !own.contains(at) && !self.kept[place]
        };
        let mut outer: Vec<u32> = below.iter().flat_map(|front| &front.points[front.inner..]).copied().collect();
        for &place in &inner {
            let ends = self.bonds.at(self.body, place as usize).map(|(.., end)| self.body.behind(end).0);
            outer.extend(ends.filter(|&other| !done(other) && !self.ground[other]).map(|other| other as u32));
        }
        outer.sort_unstable();
        outer.dedup();
        outer.retain(|place| inner.binary_search(place).is_err());

        let mut front = self.front(&inner, &outer);
        for child in below {
            front.add(&child);
            self.pool.give(child.matrix.values);
        }
        self.assemble(&mut front, &inner, &|other| self.ground[other] || !done(other));
        for (at, &place) in inner.iter().enumerate() {
            self.hold(&mut front.matrix, at, place);
        }
        self.eliminate_first(&mut front.matrix, M * inner.len())?;
        Some(front)
    }

    /// A front without stiffness.
    fn front(&self, inner: &[u32], outer: &[u32]) -> DenseFront<M> {
        let points = [inner, outer].concat();
        let order = M * points.len();
        DenseFront { points, inner: inner.len(), matrix: Square::zeros(order, self.pool.take(order * order)) }
    }

    /// Points of a region, outside the window, that have a bond, ascending.
    fn carrying(&self, region: Rectangle) -> Vec<u32> {
        let lattice = &self.body.lattice;
        let places = (region.rows.0..region.rows.1)
            .flat_map(|row| (region.columns.0..region.columns.1).map(move |column| lattice.place(column, row)));
        let carries = |&p: &usize| self.body.is_point[p] && self.bonds.intact_at(self.body, p) > 0;
        places.filter(|p| carries(p) && !self.kept[*p] && !self.ground[*p]).map(|place| place as u32).collect()
    }

    /// Adds the stiffness of the bonds of `points` (ascending) to those points that `counts`; bonds among `points` once.
    fn assemble(&self, front: &mut DenseFront<M>, points: &[u32], counts: &dyn Fn(usize) -> bool) {
        for &place in points {
            let a = front.at(place);
            let last = M * a + M - 1;
            front.matrix.add(last, last, self.assembly.point(place as usize));
            for_joints(self.assembly, self.body, self.bonds, place as usize, |joint, owned| {
                let other = joint.other;
                // A bond across a line of symmetry is met from both of its ends, each time as that between a point and an image.
                let is_second = if joint.is_image { other < place as usize } else { !owned };
                if !counts(other) || (is_second && points.binary_search(&(other as u32)).is_ok()) {
                    return;
                }
                let ((own_a, off_ab), (own_b, off_ba)) = (joint.here, joint.there);
                let b = (!self.ground[other]).then(|| front.at(other as u32));
                let matrix = &mut front.matrix;
                matrix.add_block(a, a, &own_a);
                let Some(b) = b else { return };
                if a == b {
                    // A bond to the point's own image: its row of the stiffness.
                    matrix.add_block(a, a, &off_ab);
                    return;
                }
                matrix.add_block(b, b, &own_b);
                if a > b {
                    matrix.add_block(a, b, &off_ab);
                } else {
                    matrix.add_block(b, a, &off_ba);
                }
            });
        }
    }

    /// Takes held components of a point out of the system.
    fn hold(&self, matrix: &mut Square, at: usize, place: u32) {
        for c in (0..M).filter(|&c| self.assembly.is_held(place as usize, c)) {
            matrix.hold(M * at + c);
        }
    }

    /// Factors L D Lᵀ in the lower triangle, D on the diagonal; `None` where a pivot has not the sign it should.
    fn factorise(&self, mut matrix: MatMut<'_, f64>) -> Option<()> {
        let (order, par) = (matrix.nrows(), Par::Seq);
        let mut memory = MemBuffer::new(ldlt::factor::cholesky_in_place_scratch::<f64>(order, par, faer::Spec::default()));
        let regularization = ldlt::factor::LdltRegularization::default();
        let stack = MemStack::new(&mut memory);
        ldlt::factor::cholesky_in_place(matrix.rb_mut(), regularization, par, stack, faer::Spec::default()).ok()?;
        let is_right = |i: usize| matrix[(i, i)] * self.assembly.pivot_sign(i % M) > 0.0 || matrix[(i, i)] == 1.0;
        (0..order).all(is_right).then_some(())
    }

    /// Eliminates the first `count` unknowns: what is left stands in the lower triangle after them.
    fn eliminate_first(&self, matrix: &mut Square, count: usize) -> Option<()> {
        let (mut first, _, mut coupling, left) = matrix.as_mut().split_at_mut(count, count);
        self.factorise(first.rb_mut())?;
        // C L⁻ᵀ, and the same times D⁻¹.
        solve_rows(first.rb(), coupling.rb_mut());
        let rows = coupling.nrows();
        let mut memory = self.pool.take(rows * count);
        let mut scaled = MatMut::from_column_major_slice_mut(&mut memory[..rows * count], rows, count);
        for j in 0..count {
            let pivot = first[(j, j)];
            let column = coupling.rb().col(j).iter();
            scaled.rb_mut().col_mut(j).iter_mut().zip(column).for_each(|(scaled, value)| *scaled = value / pivot);
        }
        subtract_product(left, coupling.rb(), scaled.rb());
        self.pool.give(memory);
        Some(())
    }
}

/// rows = rows L⁻ᵀ for a unit lower triangle L. Parts for two threads are the same however many there are.
fn solve_rows(lower: MatRef<'_, f64>, rows: MatMut<'_, f64>) {
    if rows.nrows() * lower.nrows() * lower.nrows() < FORK_PRODUCTS {
        return solve_unit_lower_triangular_in_place(lower, rows.transpose_mut(), Par::Seq);
    }
    let half = rows.nrows() / 2;
    let (above, below) = rows.split_at_row_mut(half);
    rayon::join(|| solve_rows(lower, above), || solve_rows(lower, below));
}

/// Lower triangle of `left` -= that of a bᵀ.
fn subtract_product(left: MatMut<'_, f64>, a: MatRef<'_, f64>, b: MatRef<'_, f64>) {
    let order = left.nrows();
    if order * order * a.ncols() < FORK_PRODUCTS {
        let (lower, full) = (BlockStructure::TriangularLower, BlockStructure::Rectangular);
        return triangular::matmul(left, lower, Accum::Add, a, full, b.transpose(), full, -1.0, Par::Seq);
    }
    let half = order / 2;
    let (above, _, beside, below) = left.split_at_mut(half, half);
    let ((a_above, a_below), (b_above, b_below)) = (a.split_at_row(half), b.split_at_row(half));
    let triangles = || {
        rayon::join(|| subtract_product(above, a_above, b_above), || subtract_product(below, a_below, b_below));
    };
    rayon::join(|| matmul(beside, Accum::Add, a_below, b_above.transpose(), -1.0, Par::Seq), triangles);
}
