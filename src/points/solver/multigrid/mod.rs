//! Lattice multigrid as preconditioner: symmetric V-cycles with Chebyshev smoothing, Galerkin coarse operators, crack-aware
//! interpolation, and a shifted Cholesky factor on the coarsest level, which makes floating plates no special case.
//!
//! Coarse lattices are laid symmetrically over fine ones, so that a symmetric plate has a symmetric preconditioner and
//! mirror twins keep equal displacements to round-off even before an iteration has converged.
//!
//! It stands for the springs. The dilatation of a state-based law is left to the iteration: it changes no eigenvalue by more than
//! the ratio of bulk moduli, `(C₁₁ + C₁₂) / 4 G`, 1.25 at ν = 0.3 in plane strain.

pub mod coarse;
mod fine;
pub mod smoother;
pub mod transfer;

use faer::linalg::solvers::DenseSolveCore;
use rayon::prelude::*;

use super::field::Layout;
use super::product::Product;
use crate::body::Body;
use crate::body::lattice::LANES;
use crate::state::Bonds;
use coarse::{BlockRows, CoarseOperator};
use fine::Fine;
use perilife_base::watch::{self, Stage};
use smoother::{Operator, Smoother, Step, Work};
use transfer::{Link, Transfer};

/// Smoothing steps before and after each coarse correction: with two an iteration is a fifth cheaper and there are a fifth more.
const DEGREE: usize = 3;
/// Unknowns below which a level is solved by a dense pseudo-inverse.
const COARSEST: usize = 300;
/// Stiffness between two coarse places below which, relative to the diagonal, they count as severed.
const SEVERED: f64 = 1e-7;

/// Shift of the coarsest operator over its largest diagonal entry.
const SHIFT: f64 = 1e-7;

/// Values that one task rounds.
const PART: usize = 1 << 14;
/// Coarsening factor of the levels after the first.
const COARSENING: usize = 2;

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
    pub fn new(body: &Body, bonds: &Bonds, product: &Product<N>) -> Self {
        // Who asked it to end is heard by the first equilibrium.
        let _ = watch::at(Stage::Solver, 0.0);
        let fine = Fine::new(body, bonds, product);
        let layout = *product.layout();
        let (columns, rows) = (body.lattice.columns, body.lattice.rows);
        let mut work = Work::new(&layout);
        let mut smoother = Smoother::new(
            layout,
            fine.interior_diagonal(),
            |row, chunk| fine.is_whole(row, chunk),
            |column, row| fine.is_point(column, row).then(|| fine.diagonal(column, row)),
        );
        smoother.estimate_top(&Springs { product, bonds }, &mut work);
        let factor = first_factor(body.stencil.reach, body.stencil.horizon / body.stencil.spacing);
        let regular = |row, chunk| bonds.chunk_is_regular(row, chunk);
        let transfer = Transfer::<N>::new(layout, rows, factor, 1.0, regular, |c, r| fine.is_point(c, r), |a, b| fine.link(a, b));
        let reach = factor as isize - 1 + body.stencil.reach as isize;
        let odd = |row, chunk| !(fine.is_whole(row, chunk) && transfer.is_plain(row, chunk));
        let surroundings = regular_surroundings(&transfer, [columns, rows], reach, odd);
        let operator =
            CoarseOperator::galerkin(&transfer, [columns, rows], &fine, |c, r| surroundings[r * transfer.coarse_size()[0] + c]);
        let mut levels = vec![Level::new(transfer, operator)];
        let mut unit = factor as f64;
        while let Some(level) = levels[levels.len() - 1].coarsened(unit) {
            unit *= COARSENING as f64;
            levels.push(level);
        }
        let coarsest = Coarsest::new(&levels[levels.len() - 1]);
        Multigrid { smoother, levels, coarsest, work, depth: Depth::First }
    }

    /// Takes over the changed diagonal of a few points without rebuilding coarse levels.
    pub fn refresh_points(&mut self, body: &Body, bonds: &Bonds, product: &Product<N>, places: &[usize]) {
        let fine = Fine::new(body, bonds, product);
        for &place in places {
            let (column, row) = body.lattice.column_row(place);
            self.smoother.set_block(column, row, &fine.diagonal(column, row));
        }
    }

    /// The same, coarse levels around these points included, and the coarsest anew.
    pub fn refresh_levels(&mut self, body: &Body, bonds: &Bonds, product: &Product<N>, places: &[usize]) {
        self.refresh_points(body, bonds, product, places);
        let fine = Fine::new(body, bonds, product);
        let mut changed: Vec<[usize; 2]> = places.iter().map(|&place| body.lattice.column_row(place).into()).collect();
        let mut size = [body.lattice.columns, body.lattice.rows];
        for index in 0..self.levels.len() {
            let (finer, coarser) = self.levels.split_at_mut(index);
            let level = &mut coarser[0];
            changed = match finer.last() {
                None => {
                    let (is_point, link) = (|c, r| fine.is_point(c, r), |a, b| fine.link(a, b));
                    level.refresh(&changed, size, body.stencil.reach, is_point, link, &fine)
                }
                Some(Level { operator, .. }) => {
                    let is_point = |c: usize, r: usize| scale(operator, [c, r]) > 0.0;
                    let link = |a, b| link(operator, a, b);
                    level.refresh(&changed, size, coarse::REACH as usize, is_point, link, operator)
                }
            };
            size = level.transfer.coarse_size();
        }
        self.coarsest = Coarsest::new(&self.levels[self.levels.len() - 1]);
    }

    /// M r, one V-cycle from zero in single precision.
    pub fn precondition(&mut self, bonds: &Bonds, product: &Product<N>, r: &[f64]) -> &mut [f32] {
        let Multigrid { smoother, levels, coarsest, work, depth } = self;
        work.r.par_chunks_mut(PART).zip(r.par_chunks(PART)).for_each(|(single, r)| {
            single.iter_mut().zip(r).for_each(|(single, r)| *single = *r as f32);
        });
        cycle(&Springs { product, bonds }, smoother, work, |residual, correction| {
            descend(levels, coarsest, residual, correction, *depth);
            product.fixed().iter().for_each(|&index| correction[index] = 0.0);
        });
        &mut work.x
    }
}

/// The springs of the body as the smoother takes them.
struct Springs<'a, const N: usize> {
    product: &'a Product<N>,
    bonds: &'a Bonds,
}

impl<const N: usize> Operator for Springs<'_, N> {
    fn layout(&self) -> &Layout {
        self.product.layout()
    }

    fn prepare(&self, x: &mut [f32]) {
        self.product.mirror(x);
    }

    #[inline(always)]
    fn subtract_row(&self, row: usize, x: &[f32], r: &mut [f32]) {
        self.product.subtract_row(self.bonds, row, x, r);
    }
}

/// One V-cycle from rest for the residual in `work.r`; its solution stands in `work.x`. `correct` sets the correction of the
/// coarser levels for a residual.
fn cycle<const N: usize>(
    operator: &impl Operator,
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
    fn new(transfer: Transfer<N>, operator: CoarseOperator<N>) -> Self {
        let layout = *operator.layout();
        let mut work = Work::new(&layout);
        let mut smoother = Smoother::new(
            layout,
            operator.common.as_ref().map(|common| common[coarse::block_of(0, 0)]),
            |row, chunk| operator.is_common(row, chunk),
            |column, row| Some(operator.block(column, row, 0, 0)),
        );
        smoother.estimate_top(&operator, &mut work);
        Level { transfer, operator, smoother, work }
    }

    /// Takes in that the finer operator of a size, whose rows reach so many places, has changed at some of its places; the places of
    /// this level that change with them.
    fn refresh(
        &mut self,
        changed: &[[usize; 2]],
        size: [usize; 2],
        reach: usize,
        is_point: impl Fn(usize, usize) -> bool + Sync,
        link: impl Fn([usize; 2], [usize; 2]) -> Link + Sync,
        finer: &impl BlockRows<N>,
    ) -> Vec<[usize; 2]> {
        let Level { transfer, operator, smoother, .. } = self;
        let mut sources = transfer.refresh(changed, is_point, link);
        sources.extend(changed);
        let places = transfer.coarse_around(&sources, reach);
        operator.refresh(transfer, size, finer, &places);
        for &[column, row] in &places {
            smoother.set_block(column, row, &operator.block(column, row, 0, 0));
        }
        places
    }

    /// The next coarser level; `None` if this one is small enough for a dense inverse. `unit` is the spacing of this one.
    fn coarsened(&self, unit: f64) -> Option<Self> {
        let (operator, size) = (&self.operator, self.transfer.coarse_size());
        if size[0] * size[1] * N <= COARSEST || size[0].min(size[1]) < 4 {
            return None;
        }
        let common = |row: usize, chunk: usize| operator.is_common(row, chunk);
        let is_point = |c: usize, r: usize| scale(operator, [c, r]) > 0.0;
        let link = |a, b| link(operator, a, b);
        let transfer = Transfer::<N>::new(*operator.layout(), size[1], COARSENING, unit, common, is_point, link);
        let odd = |row, chunk| !(common(row, chunk) && transfer.is_plain(row, chunk));
        let reach = COARSENING as isize - 1 + coarse::REACH;
        let surroundings = regular_surroundings(&transfer, size, reach, odd);
        let regular = |c: usize, r: usize| surroundings[r * transfer.coarse_size()[0] + c];
        let next = CoarseOperator::galerkin(&transfer, size, operator, regular);
        Some(Level::new(transfer, next))
    }
}

/// Stiffness of a place of a level with itself.
fn scale<const N: usize>(operator: &CoarseOperator<N>, [column, row]: [usize; 2]) -> f64 {
    trace(&operator.block(column, row, 0, 0))
}

/// Whether a place of a level may use a coarser one that stands at another.
fn link<const N: usize>(operator: &CoarseOperator<N>, a: [usize; 2], b: [usize; 2]) -> Link {
    let [dx, dy] = [0, 1].map(|i| b[i] as isize - a[i] as isize);
    let norm = operator.block(a[0], a[1], dx, dy).iter().flatten().map(|v| v.abs()).fold(0.0, f64::max);
    if norm > SEVERED * scale(operator, a) || (dx, dy) == (0, 0) { Link::Joined } else { Link::Severed }
}

/// For each coarse place, whether all chunks of fine places (of `columns` x `rows`) that come within `reach` of it are there,
/// and none of them is odd.
fn regular_surroundings<const N: usize>(
    transfer: &Transfer<N>,
    [columns, rows]: [usize; 2],
    reach: isize,
    odd: impl Fn(usize, usize) -> bool,
) -> Vec<bool> {
    let chunks = columns.div_ceil(LANES);
    // Sums over rectangles of odd chunks: prefix[r][c] counts those left of c and below r.
    let width = chunks + 1;
    let mut prefix = vec![0_u32; width * (rows + 1)];
    for row in 0..rows {
        for chunk in 0..chunks {
            prefix[(row + 1) * width + chunk + 1] =
                u32::from(odd(row, chunk)) + prefix[row * width + chunk + 1] + prefix[(row + 1) * width + chunk]
                    - prefix[row * width + chunk];
        }
    }
    let size = transfer.coarse_size();
    let mut regular = vec![false; size[0] * size[1]];
    for row in 0..size[1] {
        for column in 0..size[0] {
            let [c, r] = transfer.seat([column, row]);
            let (left, right, below, above) = (c - reach, c + reach, r - reach, r + reach);
            if left >= 0 && below >= 0 && right < columns as isize && above < rows as isize {
                let (left, right) = (left as usize / LANES, right as usize / LANES + 1);
                let sum = |row: usize, chunk: usize| i64::from(prefix[row * width + chunk]);
                let (below, above) = (below as usize, above as usize + 1);
                regular[row * size[0] + column] =
                    sum(above, right) - sum(below, right) - sum(above, left) + sum(below, left) == 0;
            }
        }
    }
    regular
}

impl Coarsest {
    fn new<const N: usize>(level: &Level<N>) -> Self {
        let (operator, layout) = (&level.operator, level.operator.layout());
        let size = level.transfer.coarse_size();
        let mut number = vec![usize::MAX; size[0] * size[1]];
        let mut unknowns = Vec::new();
        let mut places = Vec::new();
        for row in 0..size[1] {
            for column in 0..size[0] {
                if trace(&operator.block(column, row, 0, 0)) > 0.0 {
                    number[row * size[0] + column] = places.len();
                    places.push((column, row));
                    let at = (row + layout.padding) * layout.row_len() + column + layout.padding;
                    unknowns.extend((0..N).map(|c| at + c * layout.stride));
                }
            }
        }
        let n = unknowns.len();
        let mut matrix = faer::Mat::<f64>::zeros(n, n);
        for (i, &(column, row)) in places.iter().enumerate() {
            operator.visit_row(column, row, |[dx, dy], block| {
                let j = number[row.wrapping_add_signed(dy) * size[0] + column.wrapping_add_signed(dx)];
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

fn trace<const N: usize>(block: &[[f64; N]; N]) -> f64 {
    (0..N).map(|c| block[c][c]).sum()
}
