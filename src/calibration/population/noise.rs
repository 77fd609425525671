//! What is left of the logarithm of a rate: one autocorrelated process along the crack, white noise, and errors of the readings.
//!
//! `cov(e) = s² R + w² / h + r² B Bᵀ`. R averages exp(-|u - v| / ℓ) over two intervals of the zone coordinate
//! `u = ∫ (ΔK / 10 MPa√m)⁻² da`: the length of the process grows with the crack-tip zone. B is the difference of the errors of the two
//! readings over the growth, so that neighbours correlate negatively and no error is left in a life.

use nalgebra::DMatrix;
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

    /// Covariance of intervals in order, its lower half.
    pub(super) fn covariance(&self, rows: &[IntervalRow]) -> DMatrix<f64> {
        let n = rows.len();
        let mut lower = DMatrix::zeros(n, n);
        // From one later interval to the next the exponential falls by one factor, whatever the interval it is correlated with.
        let g: Vec<f64> = rows.iter().map(|row| averaged((row.zone[1] - row.zone[0]) / self.length)).collect();
        let step: Vec<f64> = rows.windows(2).map(|pair| (-(pair[1].zone[0] - pair[0].zone[0]) / self.length).exp()).collect();
        for j in 0..n {
            lower[(j, j)] =
                self.variance(&rows[j]) + self.reading.powi(2) * (rows[j].density[0].powi(2) + rows[j].density[1].powi(2));
            let Some(next) = rows.get(j + 1) else { break };
            let mut decay = (-(next.zone[0] - rows[j].zone[1]).max(0.0) / self.length).exp() * g[j] * self.scatter * self.scatter;
            for l in j + 1..n {
                lower[(l, j)] = decay * g[l];
                decay *= step.get(l).copied().unwrap_or(0.0);
            }
            if next.follows {
                lower[(j + 1, j)] -= self.reading * self.reading * rows[j].density[1] * next.density[0];
            }
        }
        lower
    }
}
