//! Chebyshev smoothing with the inverse diagonal blocks (Adams, Brezina, Hu, Tuminaro 2003, J. Comput. Phys. 188:593).
//!
//! Vectors are in single precision: smoothing only preconditions, and it is bound by memory. A step goes through memory once:
//! row by row it takes the product off the residual, forms the correction and adds it.

use nalgebra::{DMatrix, SMatrix};

use super::super::field::{Layout, norm};
use super::super::kernel::load;
use super::chunked::{Chunked, Slot};
use super::{Block, Stiffness};
use crate::body::lattice::LANES;

/// Upper over lower end of the damped part of the spectrum.
const SPECTRUM_RATIO: f64 = 15.0;
/// Margin on the estimated largest eigenvalue.
const SAFETY: f64 = 1.08;
/// Steps of the power iteration. The largest eigenvalue may be that of a few points at a rim, which show late among a million: after 12
/// steps it was found too small on some plates, smoothing made their motion larger, and a solve took 45 to 230 iterations instead of 10.
const POWER_STEPS: usize = 30;
/// Most pairs of components of a symmetric block.
const PAIRS: usize = 6;

/// Inverse diagonal blocks of some places side by side, by pairs c <= d of components.
type Inverses = [[f32; LANES]; PAIRS];
const NONE: Inverses = [[0.0; LANES]; PAIRS];

/// Inverse N x N diagonal blocks of an operator, and the spectrum that smoothing damps.
#[derive(Debug, Clone)]
pub struct Smoother<const N: usize> {
    layout: Layout,
    common: Inverses,
    own: Chunked<Inverses>,
    /// Largest eigenvalue of D⁻¹ A, with margin.
    top: f64,
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
    /// Smoother for an operator, and vectors.
    pub fn new(operator: &impl Stiffness<N>) -> (Self, Work) {
        let layout = *operator.layout();
        let [columns, rows] = layout.size();
        let find = |row: usize, chunk: usize| {
            let mut own = NONE;
            for column in chunk * LANES..((chunk + 1) * LANES).min(columns) {
                put(&mut own, column % LANES, &pseudo_inverse(&operator.diagonal([column, row])));
            }
            if own == NONE { Slot::Empty } else { Slot::Own(own) }
        };
        let (mut common, inside) = (NONE, operator.inside());
        if let Some(block) = &inside {
            let inverse = pseudo_inverse(block);
            (0..LANES).for_each(|lane| put(&mut common, lane, &inverse));
        }
        let is_common = |row: usize, chunk: usize| inside.is_some() && operator.is_common(row, chunk);
        let own = Chunked::new([columns.div_ceil(LANES), rows], is_common, find);
        let mut smoother = Smoother { layout, common, own, top: 1.0 };
        let zeros = || vec![0.0; layout.len()];
        let mut work = Work { r: zeros(), x: zeros(), d: zeros(), e: zeros() };
        smoother.estimate_top(operator, &mut work);
        (smoother, work)
    }

    /// Replaces the diagonal block of one place.
    pub fn set_block(&mut self, [column, row]: [usize; 2], block: &Block<N>) {
        let common = self.common;
        let own = self.own.own_mut(row, column / LANES, |is_common| if is_common { common } else { NONE });
        put(own, column % LANES, &pseudo_inverse(block));
    }

    /// d = b D⁻¹ r, x = d: the first step from rest.
    pub fn start(&self, b: f64, r: &[f32], d: &mut [f32], x: &mut [f32]) {
        let layout = &self.layout;
        layout.for_rows(
            layout.rows_per_task(),
            [d, x],
            #[inline(always)]
            |row, [d, x]: [&mut [f32]; 2]| {
                self.for_inverse_times(
                    row,
                    layout.padded_row(row, r),
                    #[inline(always)]
                    |start, sum| {
                        let scaled = sum.map(|sum| b as f32 * sum);
                        d[start..start + LANES].copy_from_slice(&scaled);
                        x[start..start + LANES].copy_from_slice(&scaled);
                    },
                );
            },
        );
    }

    /// One step; `d` is only made ready for the product.
    pub fn relax(&self, operator: &impl Stiffness<N>, step: Step, d: &mut [f32], r: &mut [f32], next: &mut [f32], x: &mut [f32]) {
        operator.prepare(d);
        let (d, layout) = (&*d, &self.layout);
        let (a, b, last) = (step.a as f32, step.b as f32, if step.takes_last { 1.0_f32 } else { 0.0 });
        layout.for_rows(
            layout.rows_per_task(),
            [r, next, x],
            #[inline(always)]
            |row, [r, next, x]: [&mut [f32]; 3]| {
                operator.subtract_row(row, d, r);
                let d = layout.padded_row(row, d);
                self.for_inverse_times(
                    row,
                    r,
                    #[inline(always)]
                    |start, sum| {
                        let (d, before) = (load::<f32, LANES>(d, start), load::<f32, LANES>(x, start));
                        // Whole registers: loops over the slices themselves are not turned into vector instructions.
                        let (mut step, mut sums) = ([0.0_f32; LANES], [0.0_f32; LANES]);
                        for lane in 0..LANES {
                            step[lane] = a.mul_add(d[lane], b * sum[lane]);
                            sums[lane] = before[lane] + last.mul_add(d[lane], step[lane]);
                        }
                        next[start..start + LANES].copy_from_slice(&step);
                        x[start..start + LANES].copy_from_slice(&sums);
                    },
                );
            },
        );
    }

    /// r -= A d.
    pub fn residual(&self, operator: &impl Stiffness<N>, d: &mut [f32], r: &mut [f32]) {
        operator.prepare(d);
        let d = &*d;
        self.layout.for_rows(
            self.layout.rows_per_task(),
            [r],
            #[inline(always)]
            |row, [r]: [&mut [f32]; 1]| operator.subtract_row(row, d, r),
        );
    }

    /// Gives D⁻¹ r of the chunks of a row that have places, component by component with where it begins in the padded row, as `r` is one;
    /// vectors are zero in the other chunks and stay so.
    #[inline(always)]
    fn for_inverse_times(&self, row: usize, r: &[f32], mut take: impl FnMut(usize, [f32; LANES])) {
        for chunk in 0..self.own.chunks {
            let inverse = match self.own.at(row, chunk) {
                Slot::Empty => continue,
                Slot::Common => &self.common,
                Slot::Own(own) => own,
            };
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
            // A loop: a closure of `for_each` need not be inlined, and is then without the wide instructions.
            for (c, sum) in sums.into_iter().enumerate() {
                take(start + c * self.layout.stride, sum);
            }
        }
    }

    /// Estimates the largest eigenvalue of D⁻¹ A by power iteration from a fixed start that holds all frequencies.
    fn estimate_top(&mut self, operator: &impl Stiffness<N>, work: &mut Work) {
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

/// Index of a pair of components of a symmetric block.
#[inline(always)]
const fn pair<const N: usize>(c: usize, d: usize) -> usize {
    let (low, high) = if c < d { (c, d) } else { (d, c) };
    low * N + high - low * (low + 1) / 2
}

/// Puts the inverse block of one place.
fn put<const N: usize>(inverses: &mut Inverses, lane: usize, inverse: &Block<N>) {
    for c in 0..N {
        for d in c..N {
            inverses[pair::<N>(c, d)][lane] = inverse[c][d] as f32;
        }
    }
}

/// Inverse of a symmetric positive semidefinite block on its range; a point without bonds, or one that hangs on a hinge,
/// has directions without stiffness: no correction is made along them.
fn pseudo_inverse<const N: usize>(block: &Block<N>) -> Block<N> {
    let matrix = SMatrix::<f64, N, N>::from_fn(|i, j| block[i][j]);
    let trace = matrix.trace();
    if trace <= 0.0 {
        return [[0.0; N]; N];
    }
    if let Some(inverse) = matrix.cholesky().map(|c| c.inverse())
        && inverse.iter().all(|v| v.is_finite() && v.abs() * trace < 1e9)
    {
        return std::array::from_fn(|i| std::array::from_fn(|j| inverse[(i, j)]));
    }
    let eigen = DMatrix::from_fn(N, N, |i, j| block[i][j]).symmetric_eigen();
    std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            (0..N)
                .filter(|&k| eigen.eigenvalues[k] > 1e-9 * trace)
                .map(|k| eigen.eigenvectors[(i, k)] * eigen.eigenvectors[(j, k)] / eigen.eigenvalues[k])
                .sum()
        })
    })
}
