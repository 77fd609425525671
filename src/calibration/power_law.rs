//! What is fitted: growth at `da/dN = A (ΔK / ΔK₀)^p` (Paris and Erdogan 1963) with a known ΔK(a), so that
//! `A N(a) = ∫ (ΔK₀ / ΔK)^p da`. Cycles are proportional to 1/A, so that only p takes a search.

use crate::calibration::model::cycles_since_first;
use crate::error::{Result, input};
use crate::units::MPA_SQRT_M;

/// Lengths at which ΔK is tabulated; Simpson's rule on them integrates the Virkler panel to 1e-9.
const INTERVALS: usize = 400;

/// Paris growth between two crack lengths. A is in m/cycle at ΔK₀ = 1 MPa√m.
#[derive(Debug, Clone, PartialEq)]
pub struct PowerLaw {
    lengths: Vec<f64>,
    /// ΔK in MPa√m at `lengths`.
    delta_k: Vec<f64>,
}

impl PowerLaw {
    /// Tabulates `delta_k` (Pa√m) between two lengths (m).
    ///
    /// # Errors
    /// A ΔK that is not above 0.
    pub fn new(from: f64, to: f64, delta_k: &dyn Fn(f64) -> f64) -> Result<Self> {
        let lengths: Vec<f64> = (0..=INTERVALS).map(|i| from + (to - from) * i as f64 / INTERVALS as f64).collect();
        let delta_k: Vec<f64> = lengths.iter().map(|&a| delta_k(a) / MPA_SQRT_M).collect();
        match delta_k.iter().position(|k| !(k.is_finite() && *k > 0.0)) {
            None => Ok(PowerLaw { lengths, delta_k }),
            Some(i) => Err(input(
                "measured.crack_length_mm",
                lengths[i] / crate::units::MM,
                "has no stress intensity range above 0 in the handbook formula of the specimen",
                "narrow the window to lengths the formula covers",
            )),
        }
    }

    /// A x cycles from the first of `lengths` (m) to each of them.
    ///
    /// # Errors
    /// A length outside the table.
    pub fn cycles(&self, p: f64, lengths: &[f64]) -> Result<Vec<f64>> {
        cycles_since_first(&self.integral(|k| k.powf(-p)), lengths)
    }

    /// Derivative of [`PowerLaw::cycles`] over p: `-∫ ln(ΔK / ΔK₀) (ΔK₀ / ΔK)^p da`.
    ///
    /// # Errors
    /// As [`PowerLaw::cycles`].
    pub fn cycles_per_p(&self, p: f64, lengths: &[f64]) -> Result<Vec<f64>> {
        cycles_since_first(&self.integral(|k| -k.ln() * k.powf(-p)), lengths)
    }

    /// Integral over the crack length of a function of ΔK in MPa√m, with the lengths to which it goes: Simpson's rule over pairs of
    /// intervals.
    fn integral(&self, of: impl Fn(f64) -> f64) -> Vec<(f64, f64)> {
        let values: Vec<f64> = self.delta_k.iter().map(|&k| of(k)).collect();
        let mut sum = 0.0;
        let mut curve = vec![(0.0, self.lengths[0])];
        for i in (2..self.lengths.len()).step_by(2) {
            let step = self.lengths[i] - self.lengths[i - 2];
            let whole = step / 6.0 * (values[i - 2] + 4.0 * values[i - 1] + values[i]);
            // Parabola through the three values, integrated over its first half.
            let half = step / 24.0 * (5.0 * values[i - 2] + 8.0 * values[i - 1] - values[i]);
            curve.push((sum + half, self.lengths[i - 1]));
            sum += whole;
            curve.push((sum, self.lengths[i]));
        }
        curve
    }
}
