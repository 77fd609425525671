//! What is left of the logarithm of a rate: one autocorrelated process along the crack, white noise, and errors of the readings.
//!
//! `cov(e) = s² R + w² / h + r² B Bᵀ`. R averages exp(-|u - v| / ℓ) over two intervals of the zone coordinate
//! `u = ∫ (ΔK / 10 MPa√m)⁻² da`: the length of the process grows with the crack-tip zone. B is the difference of the errors of the two
//! readings over the growth, so that neighbours correlate negatively and no error is left in a life.

use serde::{Deserialize, Serialize};

use super::intervals::IntervalRow;

/// Noise of ln da/dN along one crack.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Noise {
    /// s: standard deviation of the autocorrelated process.
    pub scatter: f64,
    /// ℓ: its length at ΔK = 10 MPa√m, m.
    pub length: f64,
    /// w: white noise, √m: its standard deviation over a growth h is w / √h.
    pub white: f64,
    /// r: standard deviation of the error of a reading, m.
    pub reading: f64,
}

/// `g = (1 - e^-q) / q` of an interval of q lengths of the process.
fn averaged(q: f64) -> f64 {
    if q < 1e-8 { 1.0 } else { -(-q).exp_m1() / q }
}

impl Noise {
    /// Variance of an interval without errors of reading.
    pub(super) fn variance(&self, row: &IntervalRow) -> f64 {
        let q = (row.zone[1] - row.zone[0]) / self.length;
        // 2 (1 - g) / q loses all digits of a short interval: its series.
        let within = if q < 1e-3 { 1.0 - q / 3.0 + q * q / 12.0 } else { 2.0 / q * (1.0 - averaged(q)) };
        self.scatter * self.scatter * within + self.white * self.white * row.inverse_length
    }

    /// Variance that the errors of both readings add.
    pub(super) fn reading_variance(&self, row: &IntervalRow) -> f64 {
        self.reading * self.reading * (row.density[0].powi(2) + row.density[1].powi(2))
    }

    /// Covariance of intervals in order, its lower half by rows.
    pub(super) fn covariance(&self, rows: &[IntervalRow]) -> Vec<f64> {
        let n = rows.len();
        let mut lower = vec![0.0; n * n];
        // From one later interval to the next the exponential falls by one factor, whatever the interval it is correlated with.
        let g: Vec<f64> = rows.iter().map(|row| averaged((row.zone[1] - row.zone[0]) / self.length)).collect();
        let step: Vec<f64> = rows.windows(2).map(|pair| (-(pair[1].zone[0] - pair[0].zone[0]) / self.length).exp()).collect();
        for j in 0..n {
            lower[j * n + j] = self.variance(&rows[j]) + self.reading_variance(&rows[j]);
            let Some(next) = rows.get(j + 1) else { break };
            let mut decay = (-(next.zone[0] - rows[j].zone[1]).max(0.0) / self.length).exp() * g[j] * self.scatter * self.scatter;
            for l in j + 1..n {
                lower[l * n + j] = decay * g[l];
                decay *= step.get(l).copied().unwrap_or(0.0);
            }
            if next.follows {
                lower[(j + 1) * n + j] -= self.reading * self.reading * rows[j].density[1] * next.density[0];
            }
        }
        lower
    }
}

/// Cholesky factor of a matrix whose lower half is given by rows, in its place; `None` where it is not positive definite.
pub(super) fn cholesky(lower: &mut [f64], n: usize) -> Option<()> {
    for i in 0..n {
        let (above, rest) = lower.split_at_mut(i * n);
        let row = &mut rest[..n];
        for j in 0..i {
            let factor = &above[j * n..=j * n + j];
            row[j] = (row[j] - dot(&row[..j], &factor[..j])) / factor[j];
        }
        let pivot = row[i] - dot(&row[..i], &row[..i]);
        if pivot.is_nan() || pivot <= 0.0 {
            return None;
        }
        row[i] = pivot.sqrt();
    }
    Some(())
}

/// Scalar product in four sums, which do not wait for each other.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 4];
    let (a4, b4) = (a.chunks_exact(4), b.chunks_exact(4));
    let rest: f64 = a4.remainder().iter().zip(b4.remainder()).map(|(x, y)| x * y).sum();
    for (x, y) in a4.zip(b4) {
        for i in 0..4 {
            sums[i] += x[i] * y[i];
        }
    }
    sums[0] + sums[1] + (sums[2] + sums[3]) + rest
}

/// Solves `L X = B` for a factor L, B having `columns` columns by rows.
pub(super) fn whiten(factor: &[f64], n: usize, right: &mut [f64], columns: usize) {
    for i in 0..n {
        let (above, rest) = right.split_at_mut(i * columns);
        let row = &mut rest[..columns];
        for j in 0..i {
            let l = factor[i * n + j];
            for (x, known) in row.iter_mut().zip(&above[j * columns..(j + 1) * columns]) {
                *x -= l * known;
            }
        }
        let inverse = 1.0 / factor[i * n + i];
        row.iter_mut().for_each(|x| *x *= inverse);
    }
}
