//! Chebyshev smoothing with the inverse diagonal blocks (Adams, Brezina, Hu, Tuminaro 2003, J. Comput. Phys. 188:593).
//!
//! Vectors are in single precision: smoothing only preconditions, and it is bound by memory. A step goes through memory once:
//! row by row it takes the product off the residual, forms the correction and adds it.

use nalgebra::DMatrix;
use rayon::prelude::*;

use super::super::field::{Layout, norm};
use super::super::kernel::load;
use crate::body::lattice::LANES;

/// Upper over lower end of the damped part of the spectrum.
const SPECTRUM_RATIO: f64 = 15.0;
/// Margin on the estimated largest eigenvalue.
const SAFETY: f64 = 1.08;
/// Steps of the power iteration. The largest eigenvalue may be that of a few points at a rim, which show late among a million: after 12
/// steps it was found too small on some plates, smoothing made their motion larger, and a solve took 45 to 230 iterations instead of 10.
const POWER_STEPS: usize = 30;
/// Slot of a chunk that has the common block.
const COMMON: u32 = u32::MAX;
/// Slot of a chunk without places.
const EMPTY: u32 = u32::MAX - 1;
/// Most pairs of components of a symmetric block.
const PAIRS: usize = 6;

/// What is smoothed: the stiffness of a level.
pub trait Operator: Sync {
    fn layout(&self) -> &Layout;
    /// Makes a vector ready for products.
    fn prepare(&self, _x: &mut [f32]) {}
    /// r -= A x on one row of the level, `r` being that padded row. Compiled into the loops that call it.
    fn subtract_row(&self, row: usize, x: &[f32], r: &mut [f32]);
}

/// Inverse diagonal blocks of some places side by side, by pairs c <= d of components.
type Inverses = [[f32; LANES]; PAIRS];

/// Inverse N x N diagonal blocks of an operator, and the spectrum that smoothing damps.
#[derive(Debug, Clone)]
pub struct Smoother<const N: usize> {
    layout: Layout,
    rows: usize,
    chunks: usize,
    /// For every chunk of a row where its blocks stand, [`COMMON`] inside the plate, [`EMPTY`] outside.
    slots: Vec<u32>,
    common: Inverses,
    own: Vec<Inverses>,
    /// Largest eigenvalue of D⁻¹ A, with margin.
    pub top: f64,
}

/// Vectors of a level.
pub struct Work {
    pub r: Vec<f32>,
    pub x: Vec<f32>,
    /// Last correction.
    pub d: Vec<f32>,
    /// The next one, or that of the level below.
    pub e: Vec<f32>,
}

impl Work {
    /// Zero vectors.
    pub fn new(layout: &Layout) -> Self {
        let zeros = || vec![0.0; layout.len()];
        Work { r: zeros(), x: zeros(), d: zeros(), e: zeros() }
    }
}

/// One step: r -= A d; next = a d + b D⁻¹ r; x += next, and d too where it is not yet in x.
#[derive(Debug, Clone, Copy)]
pub struct Step {
    /// Share of the last correction.
    pub a: f64,
    /// Share of the preconditioned residual.
    pub b: f64,
    /// Whether x takes d too.
    pub takes_last: bool,
}

impl<const N: usize> Smoother<N> {
    /// Smoother for an operator with the block `common` at every place of the chunks `(row, chunk)` that are common, and its
    /// own `(column, row)` block elsewhere, `None` where there is no place.
    pub fn new(
        layout: Layout,
        common: Option<[[f64; N]; N]>,
        is_common: impl Fn(usize, usize) -> bool,
        block: impl Fn(usize, usize) -> Option<[[f64; N]; N]> + Sync,
    ) -> Self {
        let (rows, chunks) = (layout.rows - 2 * layout.padding, layout.columns.div_ceil(LANES));
        let mut slots = vec![COMMON; rows * chunks];
        let mut places = Vec::new();
        for (index, slot) in slots.iter_mut().enumerate() {
            let (row, chunk) = (index / chunks, index % chunks);
            if common.is_none() || !is_common(row, chunk) {
                *slot = EMPTY;
                places.push((row, chunk));
            }
        }
        let inverses = |&(row, chunk): &(usize, usize)| {
            let mut own = [[0.0; LANES]; PAIRS];
            for lane in (0..LANES).filter(|lane| chunk * LANES + lane < layout.columns) {
                if let Some(block) = block(chunk * LANES + lane, row) {
                    put(&mut own, lane, &pseudo_inverse(&block));
                }
            }
            own
        };
        let found: Vec<Inverses> = places.par_iter().map(inverses).collect();
        let mut own = Vec::with_capacity(found.len());
        for (&(row, chunk), inverses) in places.iter().zip(found) {
            let is_empty = inverses.as_flattened().iter().all(|&v| v == 0.0);
            slots[row * chunks + chunk] = if is_empty { EMPTY } else { own.len() as u32 };
            if !is_empty {
                own.push(inverses);
            }
        }
        let mut everywhere = [[0.0; LANES]; PAIRS];
        if let Some(block) = common {
            let inverse = pseudo_inverse(&block);
            (0..LANES).for_each(|lane| put(&mut everywhere, lane, &inverse));
        }
        Smoother { layout, rows, chunks, slots, common: everywhere, own, top: 1.0 }
    }

    /// Replaces the diagonal block of one place.
    pub fn set_block(&mut self, column: usize, row: usize, block: &[[f64; N]; N]) {
        let slot = &mut self.slots[row * self.chunks + column / LANES];
        if *slot == COMMON || *slot == EMPTY {
            let before = if *slot == COMMON { self.common } else { [[0.0; LANES]; PAIRS] };
            *slot = self.own.len() as u32;
            self.own.push(before);
        }
        put(&mut self.own[*slot as usize], column % LANES, &pseudo_inverse(block));
    }

    /// d = b D⁻¹ r, x = d: the first step from rest.
    pub fn start(&self, b: f64, r: &[f32], d: &mut [f32], x: &mut [f32]) {
        let (row_len, rows_per_task) = (self.layout.row_len(), self.layout.rows_per_task());
        let arch = pulp::Arch::new();
        self.body_mut(d)
            .par_chunks_mut(row_len * rows_per_task)
            .zip(self.body_mut(x).par_chunks_mut(row_len * rows_per_task))
            .enumerate()
            .for_each(|(task, (d, x))| {
                let first = task * rows_per_task;
                arch.dispatch(Rest { smoother: self, b: b as f32, first, r, d, x });
            });
    }

    /// One step; `d` is only made ready for the product.
    pub fn relax(&self, operator: &impl Operator, step: Step, d: &mut [f32], r: &mut [f32], next: &mut [f32], x: &mut [f32]) {
        operator.prepare(d);
        let (row_len, rows_per_task) = (self.layout.row_len(), self.layout.rows_per_task());
        let length = row_len * rows_per_task;
        let arch = pulp::Arch::new();
        let d = &*d;
        let rows = self.body_mut(r).par_chunks_mut(length).zip(self.body_mut(next).par_chunks_mut(length));
        rows.zip(self.body_mut(x).par_chunks_mut(length)).enumerate().for_each(|(task, ((r, next), x))| {
            let first = task * rows_per_task;
            arch.dispatch(Relax { smoother: self, operator, step, first, d, r, next, x });
        });
    }

    /// r -= A d.
    pub fn residual(&self, operator: &impl Operator, d: &mut [f32], r: &mut [f32]) {
        operator.prepare(d);
        let (row_len, rows_per_task) = (self.layout.row_len(), self.layout.rows_per_task());
        let arch = pulp::Arch::new();
        let d = &*d;
        self.body_mut(r).par_chunks_mut(row_len * rows_per_task).enumerate().for_each(|(task, r)| {
            arch.dispatch(Residual { operator, row_len, first: task * rows_per_task, d, r });
        });
    }

    /// The rows of a vector that are not padding.
    fn body_mut<'a>(&self, v: &'a mut [f32]) -> &'a mut [f32] {
        let (row_len, padding) = (self.layout.row_len(), self.layout.padding);
        &mut v[padding * row_len..(padding + self.rows) * row_len]
    }

    /// Chunks of a row that have places; vectors are zero in the others and stay so.
    #[inline(always)]
    fn inhabited(&self, row: usize) -> impl Iterator<Item = usize> + '_ {
        (0..self.chunks).filter(move |chunk| self.slots[row * self.chunks + chunk] != EMPTY)
    }

    /// D⁻¹ r of a chunk; `r` is a padded row.
    #[inline(always)]
    fn inverse_times(&self, row: usize, chunk: usize, r: &[f32]) -> [[f32; LANES]; N] {
        let slot = self.slots[row * self.chunks + chunk];
        let inverse = if slot == COMMON { &self.common } else { &self.own[slot as usize] };
        let start = self.layout.padding + chunk * LANES;
        let mut sums = [[0.0_f32; LANES]; N];
        for d in 0..N {
            let r = load::<f32, LANES>(r, start + d * self.layout.stride);
            for (c, sum) in sums.iter_mut().enumerate() {
                let entry = &inverse[pair::<N>(c, d)];
                for lane in 0..LANES {
                    sum[lane] = entry[lane].mul_add(r[lane], sum[lane]);
                }
            }
        }
        sums
    }

    /// Estimates the largest eigenvalue of D⁻¹ A by power iteration from a fixed start that holds all frequencies.
    pub fn estimate_top(&mut self, operator: &impl Operator, work: &mut Work) {
        let Work { r, x, d, e } = work;
        // A fixed pseudo-random start: reproducible, with weight on every mode.
        let mut seed = 0x9E37_79B9_7F4A_7C15_u64;
        for value in r.iter_mut() {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            *value = (seed >> 40) as f32 / (1_u64 << 24) as f32 - 0.5;
        }
        // Places without material have zero blocks: the first product clears them.
        self.start(1.0, r, d, x);
        let step = Step { a: 0.0, b: -1.0, takes_last: false };
        for _ in 0..POWER_STEPS {
            r.fill(0.0);
            self.relax(operator, step, d, r, e, x);
            std::mem::swap(d, e);
        }
        // Both with what makes them ready, so that their norms compare.
        operator.prepare(d);
        let before = norm(&self.layout, e);
        self.top = if before > 0.0 { SAFETY * (norm(&self.layout, d) / before).max(1.0) } else { 1.0 };
        [r, x, d, e].into_iter().for_each(|v| v.fill(0.0));
    }

    /// Coefficients (a, b) of `degree` Chebyshev steps on [top / ratio, top].
    pub fn coefficients(&self, degree: usize) -> Vec<(f64, f64)> {
        let (high, low) = (self.top, self.top / SPECTRUM_RATIO);
        let (theta, delta) = (0.5 * (high + low), 0.5 * (high - low));
        let sigma = theta / delta;
        let mut rho = 1.0 / sigma;
        let mut steps = vec![(0.0, 1.0 / theta)];
        for _ in 1..degree {
            let next = 1.0 / (2.0 * sigma - rho);
            steps.push((next * rho, 2.0 * next / delta));
            rho = next;
        }
        steps
    }
}

/// Rows of [`Smoother::start`].
struct Rest<'a, const N: usize> {
    smoother: &'a Smoother<N>,
    b: f32,
    first: usize,
    r: &'a [f32],
    d: &'a mut [f32],
    x: &'a mut [f32],
}

impl<const N: usize> pulp::WithSimd for Rest<'_, N> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        let layout = &self.smoother.layout;
        let row_len = layout.row_len();
        for (i, (d, x)) in self.d.chunks_exact_mut(row_len).zip(self.x.chunks_exact_mut(row_len)).enumerate() {
            let row = self.first + i;
            let r = &self.r[(row + layout.padding) * row_len..(row + layout.padding + 1) * row_len];
            for chunk in self.smoother.inhabited(row) {
                let sums = self.smoother.inverse_times(row, chunk, r);
                for (c, sum) in sums.iter().enumerate() {
                    let start = c * layout.stride + layout.padding + chunk * LANES;
                    let scaled = sum.map(|sum| self.b * sum);
                    d[start..start + LANES].copy_from_slice(&scaled);
                    x[start..start + LANES].copy_from_slice(&scaled);
                }
            }
        }
    }
}

/// Rows of [`Smoother::relax`].
struct Relax<'a, O, const N: usize> {
    smoother: &'a Smoother<N>,
    operator: &'a O,
    step: Step,
    first: usize,
    d: &'a [f32],
    r: &'a mut [f32],
    next: &'a mut [f32],
    x: &'a mut [f32],
}

impl<O: Operator, const N: usize> pulp::WithSimd for Relax<'_, O, N> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        let layout = &self.smoother.layout;
        let row_len = layout.row_len();
        let (a, b, last) = (self.step.a as f32, self.step.b as f32, if self.step.takes_last { 1.0_f32 } else { 0.0 });
        let rows = self.r.chunks_exact_mut(row_len).zip(self.next.chunks_exact_mut(row_len));
        for (i, ((r, next), x)) in rows.zip(self.x.chunks_exact_mut(row_len)).enumerate() {
            let row = self.first + i;
            self.operator.subtract_row(row, self.d, r);
            let d = &self.d[(row + layout.padding) * row_len..(row + layout.padding + 1) * row_len];
            for chunk in self.smoother.inhabited(row) {
                let sums = self.smoother.inverse_times(row, chunk, r);
                for (c, sum) in sums.iter().enumerate() {
                    let start = c * layout.stride + layout.padding + chunk * LANES;
                    let (d, before) = (load::<f32, LANES>(d, start), load::<f32, LANES>(x, start));
                    // Whole registers: loops over the slices themselves are not turned into vector instructions.
                    let (mut step, mut sums) = ([0.0_f32; LANES], [0.0_f32; LANES]);
                    for lane in 0..LANES {
                        step[lane] = a.mul_add(d[lane], b * sum[lane]);
                        sums[lane] = before[lane] + last.mul_add(d[lane], step[lane]);
                    }
                    next[start..start + LANES].copy_from_slice(&step);
                    x[start..start + LANES].copy_from_slice(&sums);
                }
            }
        }
    }
}

/// Rows of [`Smoother::residual`].
struct Residual<'a, O> {
    operator: &'a O,
    row_len: usize,
    first: usize,
    d: &'a [f32],
    r: &'a mut [f32],
}

impl<O: Operator> pulp::WithSimd for Residual<'_, O> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        for (i, r) in self.r.chunks_exact_mut(self.row_len).enumerate() {
            self.operator.subtract_row(self.first + i, self.d, r);
        }
    }
}

/// Index of a pair of components of a symmetric block.
#[inline(always)]
const fn pair<const N: usize>(c: usize, d: usize) -> usize {
    let (low, high) = if c < d { (c, d) } else { (d, c) };
    low * N + high - low * (low + 1) / 2
}

/// Puts the inverse block of one place.
fn put<const N: usize>(inverses: &mut Inverses, lane: usize, inverse: &[[f64; N]; N]) {
    for c in 0..N {
        for d in c..N {
            inverses[pair::<N>(c, d)][lane] = inverse[c][d] as f32;
        }
    }
}

/// Inverse of a symmetric positive semidefinite block on its range; a point without bonds, or one that hangs on a hinge,
/// has directions without stiffness: no correction is made along them.
fn pseudo_inverse<const N: usize>(block: &[[f64; N]; N]) -> [[f64; N]; N] {
    let matrix = DMatrix::from_fn(N, N, |i, j| block[i][j]);
    let trace = matrix.trace();
    if trace <= 0.0 {
        return [[0.0; N]; N];
    }
    if let Some(inverse) = matrix.clone().cholesky().map(|c| c.inverse())
        && inverse.iter().all(|v| v.is_finite() && v.abs() * trace < 1e9)
    {
        return std::array::from_fn(|i| std::array::from_fn(|j| inverse[(i, j)]));
    }
    let eigen = matrix.symmetric_eigen();
    std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            (0..N)
                .filter(|&k| eigen.eigenvalues[k] > 1e-9 * trace)
                .map(|k| eigen.eigenvectors[(i, k)] * eigen.eigenvectors[(j, k)] / eigen.eigenvalues[k])
                .sum()
        })
    })
}
