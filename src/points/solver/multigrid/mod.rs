//! Lattice multigrid as preconditioner: symmetric V-cycles with Chebyshev smoothing, Galerkin coarse operators, crack-aware
//! interpolation, and a shifted Cholesky factor on the coarsest level, which makes floating plates no special case.
//!
//! Coarse lattices are laid symmetrically over fine ones, so that a symmetric plate has a symmetric preconditioner and
//! mirror twins keep equal displacements to round-off even before an iteration has converged.
//!
//! It stands for the springs. The dilatation of a state-based law is left to the iteration: it changes no eigenvalue by more than
//! the ratio of bulk moduli, `(C₁₁ + C₁₂) / 4 G`, 1.25 at ν = 0.3 in plane strain.

mod chunked;
pub mod coarse;
pub mod fine;
pub mod smoother;
pub mod transfer;

use faer::linalg::solvers::DenseSolveCore;
use rayon::prelude::*;

use super::field::Layout;
use coarse::CoarseOperator;
use fine::Fine;
use perilife_base::watch::{self, Stage};
use smoother::{Smoother, Step, Work};
use transfer::{Link, Transfer};

/// Smoothing steps before and after each coarse correction: with two an iteration is a fifth cheaper and there are a fifth more.
const DEGREE: usize = 3;
/// Unknowns below which a level is solved by a dense pseudo-inverse.
const COARSEST: usize = 300;
/// Shift of the coarsest operator over its largest diagonal entry.
const SHIFT: f64 = 1e-7;
/// Coarsening factor of the levels after the first.
const COARSENING: usize = 2;

/// Stiffness between two places.
pub type Block<const N: usize> = [[f64; N]; N];

/// The stiffness of a level: block rows for the next coarser one, products for smoothing. Places are column and row.
pub trait Stiffness<const N: usize>: Sync {
    fn layout(&self) -> &Layout;
    /// Places that a row reaches to either side.
    fn reach(&self) -> usize;
    /// Whether all places of a chunk of a row have the block row of the inside.
    fn is_common(&self, row: usize, chunk: usize) -> bool;
    /// Diagonal block of the inside.
    fn inside(&self) -> Option<Block<N>>;
    /// Diagonal block of a place, bonds to its own images included; zero where there is no point.
    fn diagonal(&self, place: [usize; 2]) -> Block<N>;
    fn is_point(&self, place: [usize; 2]) -> bool;
    /// Shows every block of a place that is not zero: the way to the neighbour, the block.
    fn visit_row(&self, place: [usize; 2], visit: impl FnMut([isize; 2], &Block<N>));
    /// Whether a place may use a coarser one that stands at another place, a point.
    fn link(&self, a: [usize; 2], b: [usize; 2]) -> Link;
    /// Makes a vector ready for products.
    fn prepare(&self, _x: &mut [f32]) {}
    /// r -= A x on one row of the level, `r` being that padded row. Compiled into the loops that call it.
    fn subtract_row(&self, row: usize, x: &[f32], r: &mut [f32]);
}

struct Level<const N: usize> {
    transfer: Transfer<N>,
    operator: CoarseOperator<N>,
    smoother: Smoother<N>,
    work: Work,
}

/// Dense pseudo-inverse of the coarsest operator.
struct Coarsest {
    unknowns: Vec<usize>,
    inverse: Vec<f64>,
}

/// Multigrid hierarchy of a body in one state of its bonds.
pub struct Multigrid<const N: usize> {
    smoother: Smoother<N>,
    levels: Vec<Level<N>>,
    coarsest: Coarsest,
    work: Work,
    pub(super) depth: Depth,
}

/// Coarsening factor of the first level for bonds of a reach: the coarse stencil must not outgrow five by five, and the
/// farthest coarse place a point uses must be within its bonds, or bonded to what it is bonded to.
fn first_factor(reach: usize, horizon_ratio: f64) -> usize {
    match reach {
        0..=2 if horizon_ratio < 8.0_f64.sqrt() => 2,
        0..=2 => 3,
        3 | 4 => 4,
        _ => reach - 1,
    }
}

impl<const N: usize> Multigrid<N> {
    /// Builds the hierarchy for the present bonds.
    pub fn new(fine: &Fine<'_, N>) -> Self {
        // Who asked it to end is heard by the first equilibrium.
        let _ = watch::at(Stage::Solver, 0.0);
        let (smoother, work) = Smoother::new(fine);
        let stencil = &fine.body.stencil;
        let factor = first_factor(stencil.reach, stencil.horizon / stencil.spacing);
        let (mut levels, mut unit) = (vec![Level::over(fine, factor, 1.0)], factor as f64);
        loop {
            let finer = &levels[levels.len() - 1].operator;
            let [columns, rows] = finer.layout().size();
            if columns * rows * N <= COARSEST || columns.min(rows) < 4 {
                let coarsest = Coarsest::new(finer);
                return Multigrid { smoother, levels, coarsest, work, depth: Depth::First };
            }
            let level = Level::over(finer, COARSENING, unit);
            unit *= COARSENING as f64;
            levels.push(level);
        }
    }

    /// Takes in that bonds of some points have changed: their diagonals, the coarse levels around them, and the coarsest anew.
    pub fn refresh(&mut self, fine: &Fine<'_, N>, changed: &[usize]) {
        let seat = |&place: &usize| <[usize; 2]>::from(fine.body.lattice.column_row(place));
        let mut changed: Vec<[usize; 2]> = changed.iter().map(seat).collect();
        for &place in &changed {
            self.smoother.set_block(place, &fine.diagonal(place));
        }
        for index in 0..self.levels.len() {
            let (finer, coarser) = self.levels.split_at_mut(index);
            changed = match finer.last() {
                None => coarser[0].refresh(fine, &changed),
                Some(finer) => coarser[0].refresh(&finer.operator, &changed),
            };
        }
        self.coarsest = Coarsest::new(&self.levels[self.levels.len() - 1].operator);
    }

    /// M r, one V-cycle from zero in single precision.
    pub fn precondition(&mut self, fine: &Fine<'_, N>, r: &[f64]) -> &mut [f32] {
        let Multigrid { smoother, levels, coarsest, work, depth } = self;
        let part = fine.layout().part();
        work.r.par_chunks_mut(part).zip(r.par_chunks(part)).for_each(|(single, r)| {
            single.iter_mut().zip(r).for_each(|(single, r)| *single = *r as f32);
        });
        cycle(fine, smoother, work, |residual, correction| {
            descend(levels, coarsest, residual, correction, *depth);
            fine.product.fixed().iter().for_each(|&index| correction[index] = 0.0);
        });
        &mut work.x
    }
}

/// One V-cycle from rest for the residual in `work.r`; its solution stands in `work.x`. `correct` sets the correction of the
/// coarser levels for a residual.
fn cycle<const N: usize>(
    operator: &impl Stiffness<N>,
    smoother: &Smoother<N>,
    work: &mut Work,
    correct: impl FnOnce(&[f32], &mut [f32]),
) {
    let Work { r, x, d, e } = work;
    let steps = smoother.coefficients(DEGREE);
    smoother.start(steps[0].1, r, d, x);
    for &(a, b) in &steps[1..] {
        smoother.relax(operator, Step { a, b, takes_last: false }, d, r, e, x);
        std::mem::swap(d, e);
    }
    smoother.residual(operator, d, r);
    correct(r, d);
    for (i, &(a, b)) in steps.iter().enumerate() {
        smoother.relax(operator, Step { a, b, takes_last: i == 0 }, d, r, e, x);
        std::mem::swap(d, e);
    }
}

/// Where a cycle stands, for the number of cycles.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Depth {
    First,
    Below,
    /// One cycle on every level: two are no positive operator where one makes a motion more than twice as large as it is, as it can where
    /// a plate is nearly a mechanism.
    Cautious,
}

impl Depth {
    fn below(self) -> Self {
        if self == Depth::Cautious { self } else { Depth::Below }
    }
}

/// correction = P (coarse correction for the residual).
fn descend<const N: usize>(levels: &mut [Level<N>], coarsest: &Coarsest, residual: &[f32], correction: &mut [f32], depth: Depth) {
    let Some((level, rest)) = levels.split_first_mut() else { return };
    let Level { transfer, operator, smoother, work } = level;
    transfer.restrict(residual, &mut work.r);
    if rest.is_empty() {
        coarsest.solve(&work.r, &mut work.x);
    } else {
        cycle(operator, smoother, work, |residual, correction| descend(rest, coarsest, residual, correction, depth.below()));
        if depth == Depth::Below || (depth == Depth::First && rest.len() == 1) {
            // Once more below the first level, which costs little: holes and cracks are drawn badly there.
            let Work { r, d, .. } = work;
            smoother.residual(operator, d, r);
            let first = work.x.clone();
            cycle(operator, smoother, work, |residual, correction| descend(rest, coarsest, residual, correction, depth.below()));
            work.x.iter_mut().zip(&first).for_each(|(x, first)| *x += first);
        }
    }
    transfer.prolong(&work.x, correction);
}

impl<const N: usize> Level<N> {
    /// The level over a finer one, whose spacing is `unit` in lattice spacings.
    fn over(finer: &impl Stiffness<N>, factor: usize, unit: f64) -> Self {
        let transfer = Transfer::new(finer, factor, unit);
        let operator = CoarseOperator::galerkin(&transfer, finer);
        let (smoother, work) = Smoother::new(&operator);
        Level { transfer, operator, smoother, work }
    }

    /// Takes in that the finer operator has changed at some of its places; the places of this level that change with them.
    fn refresh(&mut self, finer: &impl Stiffness<N>, changed: &[[usize; 2]]) -> Vec<[usize; 2]> {
        let Level { transfer, operator, smoother, .. } = self;
        let mut sources = transfer.refresh(changed, finer);
        sources.extend(changed);
        let places = transfer.coarse_around(&sources, finer.reach());
        operator.refresh(transfer, finer, &places);
        for &place in &places {
            smoother.set_block(place, &operator.diagonal(place));
        }
        places
    }
}

impl Coarsest {
    fn new<const N: usize>(operator: &CoarseOperator<N>) -> Self {
        let layout = operator.layout();
        let [columns, rows] = layout.size();
        let all = (0..rows).flat_map(|row| (0..columns).map(move |column| [column, row]));
        let places: Vec<[usize; 2]> = all.filter(|&place| operator.is_point(place)).collect();
        let mut number = vec![usize::MAX; columns * rows];
        places.iter().enumerate().for_each(|(i, [column, row])| number[row * columns + column] = i);
        let at = |&[column, row]: &[usize; 2]| (row + layout.padding) * layout.row_len() + column + layout.padding;
        let unknowns: Vec<usize> = places.iter().map(at).flat_map(|at| (0..N).map(move |c| at + c * layout.stride)).collect();
        let n = unknowns.len();
        let mut matrix = faer::Mat::<f64>::zeros(n, n);
        for (i, &[column, row]) in places.iter().enumerate() {
            operator.visit_row([column, row], |[dx, dy], block| {
                let j = number[row.wrapping_add_signed(dy) * columns + column.wrapping_add_signed(dx)];
                for (c, row) in block.iter().enumerate() {
                    for (d, &value) in row.iter().enumerate() {
                        matrix[(i * N + c, j * N + d)] = value;
                    }
                }
            });
        }
        let mut inverse = vec![0.0; n * n];
        // A shift in place of a pseudo-inverse: rigid motion that round-off brings in is taken off the fine level anyway.
        let top = (0..n).map(|k| matrix[(k, k)]).fold(0.0, f64::max);
        (0..n).for_each(|k| matrix[(k, k)] += SHIFT * top);
        if let Ok(factor) = matrix.llt(faer::Side::Lower) {
            let found = factor.inverse();
            (0..n * n).for_each(|at| inverse[at] = found[(at / n, at % n)]);
        }
        Coarsest { unknowns, inverse }
    }

    fn solve(&self, r: &[f32], x: &mut [f32]) {
        let n = self.unknowns.len();
        let mut sums = vec![0.0; n];
        // The inverse is symmetric: its rows are its columns.
        for (column, &index) in self.inverse.chunks(n.max(1)).zip(&self.unknowns) {
            let r = f64::from(r[index]);
            sums.iter_mut().zip(column).for_each(|(sum, a)| *sum += a * r);
        }
        self.unknowns.iter().zip(sums).for_each(|(&index, sum)| x[index] = sum as f32);
    }
}
