//! Chebyshev smoothing with the inverse diagonal blocks (Adams, Brezina, Hu, Tuminaro 2003, J. Comput. Phys. 188:593).

use super::super::field::Layout;

/// Upper over lower end of the damped part of the spectrum.
const SPECTRUM_RATIO: f64 = 12.0;
/// Margin on the estimated largest eigenvalue.
const SAFETY: f64 = 1.08;
/// Steps of the power iteration.
const POWER_STEPS: usize = 12;

/// Inverse N x N diagonal blocks of an operator, and the spectrum that smoothing damps.
#[derive(Debug, Clone)]
pub struct Smoother<const N: usize> {
    layout: Layout,
    /// For each component pair c <= d: values over places of the padded lattice (plain place index).
    inverse: Vec<f64>,
    /// Largest eigenvalue of D⁻¹ A, with margin.
    pub top: f64,
}

impl<const N: usize> Smoother<N> {
    /// Pairs c <= d of a symmetric block.
    const PAIRS: usize = N * (N + 1) / 2;

    /// Smoother from the diagonal blocks of `(column, row, block)`.
    pub fn new(layout: Layout, blocks: impl Iterator<Item = (usize, usize, [[f64; N]; N])>) -> Self {
        let places = layout.rows * layout.stride;
        let mut smoother = Smoother { layout, inverse: vec![0.0; Self::PAIRS * places], top: 1.0 };
        for (column, row, block) in blocks {
            smoother.set_block(column, row, &block);
        }
        smoother
    }

    /// Replaces the diagonal block of one place.
    pub fn set_block(&mut self, column: usize, row: usize, block: &[[f64; N]; N]) {
        let inverse = pseudo_inverse(block);
        let place = (row + self.layout.padding) * self.layout.stride + column + self.layout.padding;
        let places = self.layout.rows * self.layout.stride;
        let mut pair = 0;
        for (c, row) in inverse.iter().enumerate() {
            for value in &row[c..] {
                self.inverse[pair * places + place] = *value;
                pair += 1;
            }
        }
    }

    /// d = a d + b D⁻¹ r and x += d, over all places.
    pub fn step(&self, a: f64, b: f64, r: &[f64], d: &mut [f64], x: &mut [f64]) {
        use rayon::prelude::*;
        let (row_len, stride) = (self.layout.row_len(), self.layout.stride);
        let places = self.layout.rows * stride;
        let rows_per_task = if self.layout.rows * stride > 4000 { 16 } else { self.layout.rows };
        let chunk = row_len * rows_per_task;
        let whole = self.layout.rows * row_len;
        d[..whole]
            .par_chunks_mut(chunk)
            .zip(x[..whole].par_chunks_mut(chunk))
            .zip(r[..whole].par_chunks(chunk))
            .enumerate()
            .for_each(|(task, ((d, x), r))| {
                for (i, ((d, x), r)) in d.chunks_mut(row_len).zip(x.chunks_mut(row_len)).zip(r.chunks(row_len)).enumerate() {
                    let row = task * rows_per_task + i;
                    let inverse = |pair: usize| &self.inverse[pair * places + row * stride..pair * places + (row + 1) * stride];
                    if N == 2 {
                        let (d0, d1) = d.split_at_mut(stride);
                        let (xx, xy, yy) = (inverse(0), inverse(1), inverse(2));
                        for p in 0..stride {
                            let (r0, r1) = (r[p], r[stride + p]);
                            d0[p] = a * d0[p] + b * (xx[p] * r0 + xy[p] * r1);
                            d1[p] = a * d1[p] + b * (xy[p] * r0 + yy[p] * r1);
                        }
                    } else {
                        let (d0, rest) = d.split_at_mut(stride);
                        let (d1, d2) = rest.split_at_mut(stride);
                        let (xx, xy, xz) = (inverse(0), inverse(1), inverse(2));
                        let (yy, yz, zz) = (inverse(3), inverse(4), inverse(5));
                        let (ra, rb, rc) = (&r[..stride], &r[stride..2 * stride], &r[2 * stride..3 * stride]);
                        for p in 0..stride {
                            let (r0, r1, r2) = (ra[p], rb[p], rc[p]);
                            d0[p] = a * d0[p] + b * (xx[p] * r0 + xy[p] * r1 + xz[p] * r2);
                            d1[p] = a * d1[p] + b * (xy[p] * r0 + yy[p] * r1 + yz[p] * r2);
                            d2[p] = a * d2[p] + b * (xz[p] * r0 + yz[p] * r1 + zz[p] * r2);
                        }
                    }
                    for (x, d) in x.iter_mut().zip(d.iter()) {
                        *x += d;
                    }
                }
            });
    }

    /// Estimates the largest eigenvalue of D⁻¹ A by power iteration from a fixed start that holds all frequencies.
    pub fn estimate_top(&mut self, apply: impl Fn(&mut [f64], &mut [f64])) {
        let mut v = self.layout.zeros();
        // A fixed pseudo-random start: reproducible, with weight on every mode.
        let mut seed = 0x9E37_79B9_7F4A_7C15_u64;
        for value in &mut v {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            *value = (seed >> 40) as f64 / (1_u64 << 24) as f64 - 0.5;
        }
        let (mut av, mut d) = (self.layout.zeros(), self.layout.zeros());
        // Places without material have zero blocks: the first product clears them.
        self.step(0.0, 1.0, &v.clone(), &mut d, &mut av);
        std::mem::swap(&mut v, &mut d);
        let mut top = 1.0;
        for _ in 0..POWER_STEPS {
            let norm = v.iter().map(|x| x * x).sum::<f64>().sqrt();
            if norm == 0.0 {
                break;
            }
            v.iter_mut().for_each(|x| *x /= norm);
            av.fill(0.0);
            apply(&mut v, &mut av);
            let mut unused = vec![0.0; av.len()];
            d.fill(0.0);
            self.step(0.0, 1.0, &av, &mut d, &mut unused);
            top = d.iter().map(|x| x * x).sum::<f64>().sqrt();
            std::mem::swap(&mut v, &mut d);
        }
        self.top = SAFETY * top;
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

/// Inverse of a symmetric positive semidefinite block on its range; a point without bonds, or one that hangs on a hinge,
/// has directions without stiffness: no correction is made along them.
fn pseudo_inverse<const N: usize>(block: &[[f64; N]; N]) -> [[f64; N]; N] {
    let matrix = nalgebra::DMatrix::from_fn(N, N, |i, j| block[i][j]);
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
