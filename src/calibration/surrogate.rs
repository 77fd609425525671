//! Cycles of the model at given crack lengths as a smooth function of p, from the true runs at hand.
//!
//! `ln n(p)` at a fixed length is smooth and nearly straight in p (its slope is the mean of -ln ε, its curvature the
//! variance of ln ε over the life), so a parabola through a few true runs interpolates it better than a replay of one
//! run does, whose error grows with the distance in p: strains are those of another crack path in time. With a single run
//! there is only the replay of it.

use nalgebra::{DMatrix, DVector};

use crate::calibration::model::{RecordedRun, cycles_since_first};
use crate::error::Result;

/// Exponents closer than this count as one: bonds break one by one, so runs carry noise of about 0.1 % in cycles, and the
/// difference of two close runs would be mostly that.
const NODE_DISTANCE: f64 = 0.03;
/// Largest degree of the polynomial in p.
const DEGREE_MAX: usize = 2;

/// Step of the numerical derivative over p where there is only a replay.
const REPLAY_STEP: f64 = 0.02;

/// Interpolates n(p) at fixed lengths.
pub struct Surrogate<'a> {
    lengths: &'a [f64],
    /// Exponents of the runs, the newest first.
    p: Vec<f64>,
    /// ln n of each run (row) at each length (column); -∞ where n = 0, as at the first length.
    log_cycles: DMatrix<f64>,
    /// Degree of the polynomial that the exponents of the runs determine.
    degree: usize,
    /// The newest run, for replays while the runs determine a constant only.
    newest: &'a RecordedRun,
}

impl<'a> Surrogate<'a> {
    /// From true runs `(p, run)`, newest last (at least one), for readings at `lengths`.
    pub fn new(runs: &'a [(f64, RecordedRun)], lengths: &'a [f64]) -> Result<Self> {
        let p: Vec<f64> = runs.iter().rev().map(|(exponent, _)| *exponent).collect();
        let rows: Vec<Vec<f64>> =
            runs.iter().rev().map(|(_, run)| cycles_since_first(&run.curve, lengths)).collect::<Result<_>>()?;
        let log_cycles = DMatrix::from_fn(p.len(), lengths.len(), |row, column| rows[row][column].ln());
        let degree = (apart(&p) - 1).min(DEGREE_MAX);
        Ok(Surrogate { lengths, p, log_cycles, degree, newest: &runs[runs.len() - 1].1 })
    }

    /// A x cycles since the first length, at each length.
    pub fn cycles(&self, p: f64) -> Vec<f64> {
        if self.degree == 0 {
            if (p - self.p[0]).abs() < 1e-12 {
                return self.log_cycles.row(0).iter().map(|log| log.exp()).collect();
            }
            // A replay that cannot be read (it never should: same events, same lengths) makes this p infinitely bad.
            let replayed = cycles_since_first(&self.newest.replay(p), self.lengths);
            return replayed.unwrap_or_else(|_| vec![f64::NAN; self.lengths.len()]);
        }
        let weights = self.weights(p);
        (0..self.lengths.len()).map(|column| self.combine(&weights, column).exp()).collect()
    }

    /// ∂n/∂p at each length, A fixed at 1.
    pub fn cycles_per_p(&self, p: f64) -> Vec<f64> {
        let step = if self.degree == 0 { REPLAY_STEP } else { 1e-4 };
        let (below, above) = (self.cycles(p - step), self.cycles(p + step));
        above.iter().zip(below).map(|(above, below)| (above - below) / (2.0 * step)).collect()
    }

    /// Range of p that true runs cover.
    pub fn range(&self) -> (f64, f64) {
        self.p.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &p| (low.min(p), high.max(p)))
    }

    fn combine(&self, weights: &[f64], column: usize) -> f64 {
        let logs = self.log_cycles.column(column);
        if logs.iter().any(|log| *log == f64::NEG_INFINITY) {
            return f64::NEG_INFINITY;
        }
        weights.iter().zip(logs.iter()).map(|(weight, log)| weight * log).sum()
    }

    /// Weights of the runs at p: least squares of a line or parabola through all of them, which averages their noise.
    fn weights(&self, p: f64) -> Vec<f64> {
        let basis = |p: f64| DVector::from_fn(self.degree + 1, |power, _| (p - self.p[0]).powi(power as i32));
        let size = self.degree + 1;
        let normal = self.p.iter().fold(DMatrix::zeros(size, size), |sum, &p| sum + basis(p) * basis(p).transpose());
        // As many exponents apart as it has coefficients: the polynomial is determined, so the matrix has an inverse.
        let Some(inverse) = normal.try_inverse() else { return vec![f64::NAN; self.p.len()] };
        let at_p = inverse * basis(p);
        self.p.iter().map(|&p| basis(p).dot(&at_p)).collect()
    }
}

/// How many exponents lie apart from each other.
pub(super) fn apart(exponents: &[f64]) -> usize {
    let mut sorted = exponents.to_vec();
    sorted.sort_by(f64::total_cmp);
    let mut last = f64::NEG_INFINITY;
    let mut count = 0;
    for p in sorted {
        if p - last >= NODE_DISTANCE {
            (last, count) = (p, count + 1);
        }
    }
    count
}
