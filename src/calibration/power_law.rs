//! The simplest forward model: Paris growth `da/dN = A (ΔK / ΔK₀)^p` with a known ΔK(a) (Paris and Erdogan 1963).
//!
//! A run costs microseconds. It gives the calibration its first guess of p, and its tests a model with a known answer.

use crate::calibration::model::{ForwardModel, RecordedRun, UnitCurve};
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

    /// Cycles for A = 1: ∫ da / ΔK^p by Simpson's rule over pairs of intervals.
    pub(super) fn curve(&self, p: f64) -> UnitCurve {
        let slowness: Vec<f64> = self.delta_k.iter().map(|k| k.powf(-p)).collect();
        let mut cycles = 0.0;
        let mut curve = vec![(0.0, self.lengths[0])];
        for i in (2..self.lengths.len()).step_by(2) {
            let step = self.lengths[i] - self.lengths[i - 2];
            let whole = step / 6.0 * (slowness[i - 2] + 4.0 * slowness[i - 1] + slowness[i]);
            // Parabola through the three values, integrated over its first half.
            let half = step / 24.0 * (5.0 * slowness[i - 2] + 8.0 * slowness[i - 1] - slowness[i]);
            curve.push((cycles + half, self.lengths[i - 1]));
            cycles += whole;
            curve.push((cycles, self.lengths[i]));
        }
        curve
    }
}

impl ForwardModel for PowerLaw {
    fn run(&self, p: f64) -> Result<RecordedRun> {
        let law = self.clone();
        Ok(RecordedRun::new(self.curve(p), f64::NAN, f64::NAN, move |p| law.curve(p)))
    }
}
