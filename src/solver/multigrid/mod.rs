//! Lattice multigrid as preconditioner: symmetric V-cycles with Chebyshev smoothing, Galerkin coarse operators, crack-aware
//! interpolation, and a spectral pseudo-inverse on the coarsest level, which makes floating plates no special case.
//!
//! Coarse lattices are laid symmetrically over fine ones, so that a symmetric plate has a symmetric preconditioner and
//! mirror twins keep equal displacements to round-off even before an iteration has converged.
//!
//! It stands for the springs. The dilatation of a state-based law is left to the iteration: it changes no eigenvalue by more than
//! the ratio of bulk moduli, `(C₁₁ + C₁₂) / 4 G`, 1.25 at ν = 0.3 in plane strain.

pub mod coarse;
pub mod smoother;
pub mod transfer;

use super::field::Layout;
use super::product::{Into, Product};
use crate::body::Body;
use crate::body::mirror::signs;
use crate::state::Bonds;
use coarse::{BlockRow, CoarseOperator};
use smoother::Smoother;
use transfer::{Link, Transfer};

/// Smoothing steps before and after each coarse correction.
const DEGREE: usize = 2;
/// Unknowns below which a level is solved by a dense pseudo-inverse.
const COARSEST: usize = 420;
/// Stiffness between two coarse places below which, relative to the diagonal, they count as severed.
const SEVERED: f64 = 1e-7;

/// Common neighbours that join two points whose own bond is broken: around a tip fewer reach across the crack.
const SHARED_NEIGHBOURS: usize = 3;

/// One coarse level.
struct Level<const N: usize> {
    transfer: Transfer<N>,
    operator: CoarseOperator<N>,
    smoother: Smoother<N>,
    work: Work,
}

/// Vectors of a level.
struct Work {
    r: Vec<f64>,
    x: Vec<f64>,
    d: Vec<f64>,
    e: Vec<f64>,
}

impl Work {
    fn new(layout: &Layout) -> Self {
        Work { r: layout.zeros(), x: layout.zeros(), d: layout.zeros(), e: layout.zeros() }
    }
}

/// Dense pseudo-inverse of the coarsest operator.
struct Coarsest {
    /// Vector index of each unknown.
    unknowns: Vec<usize>,
    inverse: Vec<f64>,
}

/// Multigrid hierarchy of a body in one state of its bonds.
pub struct Multigrid<const N: usize> {
    smoother: Smoother<N>,
    levels: Vec<Level<N>>,
    coarsest: Coarsest,
    work: Work,
}

/// Coarsening factor of the first level for bonds of a reach: the coarse stencil must not outgrow five by five, and the
/// farthest coarse place a point uses must be within its bonds.
fn first_factor(reach: usize, horizon_ratio: f64) -> usize {
    match reach {
        0..=2 if horizon_ratio < 8.0_f64.sqrt() => 2,
        0..=4 => 3,
        _ => reach - 1,
    }
}

impl<const N: usize> Multigrid<N> {
    /// Builds the hierarchy for the present bonds.
    #[must_use]
    pub fn new(body: &Body, bonds: &Bonds, product: &Product<N>) -> Self {
        let fine = Fine::new(body, bonds, product);
        let layout = *product.layout();
        let (columns, rows) = (body.lattice.columns, body.lattice.rows);
        let mut smoother = Smoother::new(
            layout,
            body.points.iter().map(|&p| {
                let (column, row) = body.lattice.column_row(p as usize);
                (column, row, fine.diagonal(column, row))
            }),
        );
        smoother.estimate_top(|x, y| product.apply_springs(bonds, x, y, Into::Set));
        let factor = first_factor(body.stencil.reach, body.stencil.horizon / body.stencil.spacing);
        let transfer = Transfer::<N>::new(layout, rows, factor, 1.0, |c, r| fine.is_point(c, r), |a, b| fine.link(a, b));
        let surroundings = fine.regular_surroundings(&transfer, factor as isize - 1 + body.stencil.reach as isize);
        let operator = CoarseOperator::galerkin(
            &transfer,
            [columns, rows],
            |c, r| fine.block_row(c, r),
            |c, r| surroundings[r * transfer.coarse_size()[0] + c],
        );
        let mut levels = vec![Level::new(transfer, operator)];
        let mut unit = factor as f64;
        loop {
            let level = &levels[levels.len() - 1];
            let size = level.transfer.coarse_size();
            if size[0] * size[1] * N <= COARSEST || size[0].min(size[1]) < 4 {
                break;
            }
            let operator = &level.operator;
            let scale: Vec<f64> = (0..size[1])
                .flat_map(|r| (0..size[0]).map(move |c| (c, r)))
                .map(|(c, r)| trace(&operator.block(c, r, 0, 0)))
                .collect();
            let exists = |c: usize, r: usize| scale[r * size[0] + c] > 0.0;
            let link = |a: [usize; 2], b: [usize; 2]| {
                let [dx, dy] = [0, 1].map(|i| b[i] as isize - a[i] as isize);
                let norm = operator.block(a[0], a[1], dx, dy).iter().flatten().map(|v| v.abs()).fold(0.0, f64::max);
                if norm > SEVERED * scale[a[1] * size[0] + a[0]] || (dx, dy) == (0, 0) { Link::Joined } else { Link::Severed }
            };
            let transfer = Transfer::<N>::new(*operator.layout(), size[1], 3, unit, exists, link);
            let next = CoarseOperator::galerkin(&transfer, size, |c, r| operator.block_row(c, r), |_, _| false);
            unit *= 3.0;
            levels.push(Level::new(transfer, next));
        }
        let coarsest = Coarsest::new(&levels[levels.len() - 1]);
        levels.iter_mut().for_each(|level| level.operator.compact());
        Multigrid { smoother, levels, coarsest, work: Work::new(&layout) }
    }

    /// Takes over the changed diagonal of a few points without rebuilding coarse levels.
    pub fn refresh_points(&mut self, body: &Body, bonds: &Bonds, product: &Product<N>, places: &[usize]) {
        let fine = Fine::new(body, bonds, product);
        for &place in places {
            let (column, row) = body.lattice.column_row(place);
            self.smoother.set_block(column, row, &fine.diagonal(column, row));
        }
    }

    /// z = M r, one V-cycle from zero.
    pub fn precondition(&mut self, bonds: &Bonds, product: &Product<N>, r: &[f64], z: &mut [f64]) {
        let steps = self.smoother.coefficients(DEGREE);
        let work = &mut self.work;
        work.r.copy_from_slice(r);
        z.fill(0.0);
        for (i, &(a, b)) in steps.iter().enumerate() {
            if i > 0 {
                product.apply_springs(bonds, &mut work.d, &mut work.r, Into::Subtract);
            }
            self.smoother.step(a, b, &work.r, &mut work.d, z);
        }
        product.apply_springs(bonds, &mut work.d, &mut work.r, Into::Subtract);
        work.e.fill(0.0);
        descend(&mut self.levels, &self.coarsest, &work.r, &mut work.e);
        for &index in product.fixed() {
            work.e[index] = 0.0;
        }
        z.iter_mut().zip(&work.e).for_each(|(z, e)| *z += e);
        product.apply_springs(bonds, &mut work.e, &mut work.r, Into::Subtract);
        for (i, &(a, b)) in steps.iter().enumerate() {
            if i > 0 {
                product.apply_springs(bonds, &mut work.d, &mut work.r, Into::Subtract);
            }
            self.smoother.step(a, b, &work.r, &mut work.d, z);
        }
    }
}

/// fine += P (coarse correction for the residual).
fn descend<const N: usize>(levels: &mut [Level<N>], coarsest: &Coarsest, residual: &[f64], correction: &mut [f64]) {
    let Some((level, rest)) = levels.split_first_mut() else { return };
    let Level { transfer, operator, smoother, work } = level;
    transfer.restrict(residual, &mut work.r);
    work.x.fill(0.0);
    if rest.is_empty() {
        coarsest.solve(&work.r, &mut work.x);
    } else {
        let steps = smoother.coefficients(DEGREE);
        for (i, &(a, b)) in steps.iter().enumerate() {
            if i > 0 {
                operator.apply(&work.d, &mut work.r, true);
            }
            smoother.step(a, b, &work.r, &mut work.d, &mut work.x);
        }
        operator.apply(&work.d, &mut work.r, true);
        work.e.fill(0.0);
        descend(rest, coarsest, &work.r, &mut work.e);
        work.x.iter_mut().zip(&work.e).for_each(|(x, e)| *x += e);
        operator.apply(&work.e, &mut work.r, true);
        for (i, &(a, b)) in steps.iter().enumerate() {
            if i > 0 {
                operator.apply(&work.d, &mut work.r, true);
            }
            smoother.step(a, b, &work.r, &mut work.d, &mut work.x);
        }
    }
    transfer.prolong(&work.x, correction);
}

impl<const N: usize> Level<N> {
    fn new(transfer: Transfer<N>, operator: CoarseOperator<N>) -> Self {
        let layout = *operator.layout();
        let size = transfer.coarse_size();
        let places = (0..size[1]).flat_map(|r| (0..size[0]).map(move |c| (c, r)));
        let mut smoother = Smoother::new(layout, places.map(|(c, r)| (c, r, operator.block(c, r, 0, 0))));
        smoother.estimate_top(|x, y| operator.apply(x, y, false));
        Level { transfer, operator, smoother, work: Work::new(&layout) }
    }
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
            for ([dx, dy], block) in operator.block_row(column, row) {
                let j = number[row.wrapping_add_signed(dy) * size[0] + column.wrapping_add_signed(dx)];
                for c in 0..N {
                    for d in 0..N {
                        matrix[(i * N + c, j * N + d)] = block[c][d];
                    }
                }
            }
        }
        let mut inverse = vec![0.0; n * n];
        if let Ok(eigen) = matrix.self_adjoint_eigen(faer::Side::Lower) {
            let (values, vectors) = (eigen.S().column_vector(), eigen.U());
            let top = (0..n).map(|k| values[k]).fold(0.0, f64::max);
            for k in (0..n).filter(|&k| values[k] > 1e-10 * top) {
                for i in 0..n {
                    let scaled = vectors[(i, k)] / values[k];
                    for j in 0..n {
                        inverse[i * n + j] += scaled * vectors[(j, k)];
                    }
                }
            }
        }
        Coarsest { unknowns, inverse }
    }

    fn solve(&self, r: &[f64], x: &mut [f64]) {
        let n = self.unknowns.len();
        let rhs: Vec<f64> = self.unknowns.iter().map(|&i| r[i]).collect();
        for (i, row) in self.inverse.chunks(n.max(1)).enumerate() {
            x[self.unknowns[i]] = row.iter().zip(&rhs).map(|(a, b)| a * b).sum();
        }
    }
}

fn trace<const N: usize>(block: &[[f64; N]; N]) -> f64 {
    (0..N).map(|c| block[c][c]).sum()
}

/// The body's own operator as multigrid sees it: block rows, links, regular surroundings.
struct Fine<'a, const N: usize> {
    body: &'a Body,
    bonds: &'a Bonds,
    product: &'a Product<N>,
    /// Held components of each place, bit c.
    held: std::collections::HashMap<(usize, usize), u8>,
}

impl<'a, const N: usize> Fine<'a, N> {
    fn new(body: &'a Body, bonds: &'a Bonds, product: &'a Product<N>) -> Self {
        let layout = product.layout();
        let mut held = std::collections::HashMap::new();
        for &index in product.fixed() {
            let (row, rest) = (index / layout.row_len(), index % layout.row_len());
            let (component, column) = (rest / layout.stride, rest % layout.stride);
            *held.entry((column - layout.padding, row - layout.padding)).or_insert(0) |= 1 << component;
        }
        Fine { body, bonds, product, held }
    }

    fn is_point(&self, column: usize, row: usize) -> bool {
        self.body.is_point[self.body.lattice.place(column, row)]
    }

    /// Whether a fine point may use a coarse one within bond reach: their bond carries, or, since a single bond beside a
    /// crack may be spent too, several points are bonded to both.
    fn link(&self, a: [usize; 2], b: [usize; 2]) -> Link {
        let (dx, dy) = (b[0] as i32 - a[0] as i32, b[1] as i32 - a[1] as i32);
        let place = self.body.lattice.place(a[0], a[1]);
        if (dx, dy) == (0, 0) || self.carries(place, dx, dy) {
            return Link::Joined;
        }
        let both = |sign: i32, k: usize| {
            let bond = &self.body.stencil.bonds[k];
            let (x, y) = (sign * bond.dx, sign * bond.dy);
            self.carries(place, x, y) && self.carries(place.wrapping_add_signed(self.body.lattice.step(x, y)), dx - x, dy - y)
        };
        let shared = [1, -1]
            .into_iter()
            .flat_map(|sign| (0..self.body.steps.len()).map(move |k| (sign, k)))
            .filter(|&(sign, k)| both(sign, k));
        if shared.take(SHARED_NEIGHBOURS).count() == SHARED_NEIGHBOURS { Link::Joined } else { Link::Severed }
    }

    /// Whether the bond from a place to its neighbour `dx`, `dy` away carries.
    fn carries(&self, place: usize, dx: i32, dy: i32) -> bool {
        let forward = dy > 0 || (dy == 0 && dx > 0);
        let (dx, dy, owner) =
            if forward { (dx, dy, place) } else { (-dx, -dy, place.wrapping_add_signed(self.body.lattice.step(dx, dy))) };
        let k = self.body.stencil.bonds.iter().position(|bond| (bond.dx, bond.dy) == (dx, dy));
        k.is_some_and(|k| self.bonds.multiplier[k * self.body.places() + owner] > 0.0)
    }

    fn held_at(&self, column: usize, row: usize) -> u8 {
        if self.held.is_empty() { 0 } else { self.held.get(&(column, row)).copied().unwrap_or(0) }
    }

    /// Diagonal block of a point, held components cleared, bonds to its own images included.
    fn diagonal(&self, column: usize, row: usize) -> [[f64; N]; N] {
        let mut sum = [[0.0; N]; N];
        for (_, block) in self.block_row(column, row).iter().filter(|(step, _)| *step == [0, 0]) {
            sum.iter_mut().flatten().zip(block.iter().flatten()).for_each(|(sum, value)| *sum += value);
        }
        sum
    }

    /// Blocks of a point: itself first, then its intact bonds; those to mirror images belong to the points behind them.
    fn block_row(&self, column: usize, row: usize) -> BlockRow<N> {
        let (body, places) = (self.body, self.body.places());
        let place = body.lattice.place(column, row);
        let own_held = self.held_at(column, row);
        let mut blocks: BlockRow<N> = Vec::with_capacity(2 * body.steps.len() + 1);
        let mut diagonal = [[0.0; N]; N];
        blocks.push(([0, 0], diagonal));
        for (k, bond) in body.stencil.bonds.iter().enumerate() {
            for sign in [1_isize, -1] {
                let owner = if sign > 0 { place } else { place.wrapping_add_signed(-body.steps[k]) };
                let share = self.bonds.multiplier[k * places + owner];
                if share > 0.0 {
                    let (own, mut off) = self.product.bond_blocks(k, sign as f64, f64::from(share));
                    let (other, flips) = body.behind(place.wrapping_add_signed(sign * body.steps[k]));
                    let (mut dx, mut dy) = (sign * bond.dx as isize, sign * bond.dy as isize);
                    if flips != [false; 2] {
                        let seat = body.lattice.column_row(other);
                        (dx, dy) = (seat.0 as isize - column as isize, seat.1 as isize - row as isize);
                        let signs = signs(flips);
                        off.iter_mut().flatten().enumerate().for_each(|(i, value)| *value *= signs[i % N]);
                    }
                    clear(&mut off, own_held, self.held_at(column.wrapping_add_signed(dx), row.wrapping_add_signed(dy)));
                    for c in 0..N {
                        for d in 0..N {
                            diagonal[c][d] += own[c][d];
                        }
                    }
                    blocks.push(([dx, dy], off));
                }
            }
        }
        clear(&mut diagonal, own_held, own_held);
        blocks[0].1 = diagonal;
        blocks
    }

    /// For each coarse place, whether all fine places within `reach` of it are interior, uncut, free and plainly interpolated.
    fn regular_surroundings(&self, transfer: &Transfer<N>, reach: isize) -> Vec<bool> {
        let (columns, rows) = (self.body.lattice.columns as isize, self.body.lattice.rows as isize);
        // Sums over rectangles of odd places: prefix[r][c] counts those left of c and below r.
        let width = columns as usize + 1;
        let mut prefix = vec![0_u32; width * (rows as usize + 1)];
        for row in 0..rows as usize {
            for column in 0..columns as usize {
                let chunk_regular = self.bonds.chunk_is_regular(row, column / crate::body::lattice::LANES);
                let odd = !chunk_regular || self.held_at(column, row) != 0 || !transfer.is_plain(column, row);
                prefix[(row + 1) * width + column + 1] =
                    u32::from(odd) + prefix[row * width + column + 1] + prefix[(row + 1) * width + column]
                        - prefix[row * width + column];
            }
        }
        let size = transfer.coarse_size();
        let mut regular = vec![false; size[0] * size[1]];
        for row in 0..size[1] {
            for column in 0..size[0] {
                let [c, r] = transfer.seat([column, row]);
                let (c0, c1, r0, r1) = (c - reach, c + reach + 1, r - reach, r + reach + 1);
                if c0 >= 0 && r0 >= 0 && c1 <= columns && r1 <= rows {
                    let sum = |r: isize, c: isize| i64::from(prefix[r as usize * width + c as usize]);
                    regular[row * size[0] + column] = sum(r1, c1) - sum(r0, c1) - sum(r1, c0) + sum(r0, c0) == 0;
                }
            }
        }
        regular
    }
}

fn clear<const N: usize>(block: &mut [[f64; N]; N], rows: u8, columns: u8) {
    for (c, row) in block.iter_mut().enumerate() {
        for (d, value) in row.iter_mut().enumerate() {
            if rows >> c & 1 == 1 || columns >> d & 1 == 1 {
                *value = 0.0;
            }
        }
    }
}
