//! By how much a law misses the measured rates at both ends of its range: a power of ΔK through a bent curve lies above it at one end
//! and below it at the other, and the error of the fit does not say so.

use serde::Serialize;

use crate::calibration::median::median;
use crate::calibration::rates::polynomial7;
use crate::measured::MeasuredCurve;
use crate::units::MPA_SQRT_M;

/// Share of the range of ln ΔK that is an end of it.
const END: f64 = 0.05;

/// Fewest rates at an end.
const RATES_MIN: usize = 3;

/// One end of the range.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct EndMiss {
    /// Smallest ΔK of its rates.
    pub delta_k_from_mpa_sqrt_m: f64,
    /// Largest.
    pub delta_k_to_mpa_sqrt_m: f64,
    /// Seven-point rates there.
    pub rates: usize,
    /// Median of measured over fitted rate, less one, in percent: positive where cracks grow faster than the law says.
    pub rate_over_law_percent: f64,
}

/// Both ends of the range.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LackOfFit {
    /// Smallest ΔK.
    pub low: EndMiss,
    /// Largest ΔK.
    pub high: EndMiss,
}

/// Seven-point rates of all curves at the ends of their range against those of the same curves by the law, which have the same error of
/// the parabola; `None` for fewer than six rates. `delta_k` is that of the case's load (Pa√m) at a length (m).
pub fn lack_of_fit(measured: &[MeasuredCurve], fitted: &[MeasuredCurve], delta_k: &dyn Fn(f64) -> f64) -> Option<LackOfFit> {
    let mut misses: Vec<(f64, f64)> = Vec::new();
    for (measured, fitted) in measured.iter().zip(fitted) {
        for middle in 0..measured.cycles.len() {
            let (Some(point), Some(law)) = (polynomial7(measured, middle), polynomial7(fitted, middle)) else { continue };
            let k = delta_k(point.crack_length) * point.load_factor / MPA_SQRT_M;
            let miss = (point.rate / law.rate).ln();
            if k.is_finite() && miss.is_finite() {
                misses.push((k, miss));
            }
        }
    }
    misses.sort_by(|a, b| a.0.total_cmp(&b.0));
    if misses.len() < 2 * RATES_MIN {
        return None;
    }
    let (first, last) = (misses[0].0, misses[misses.len() - 1].0);
    let width = (last / first).powf(END);
    let low = misses.partition_point(|(k, _)| *k <= first * width).max(RATES_MIN);
    let high = misses.partition_point(|(k, _)| *k < last / width).min(misses.len() - RATES_MIN);
    let end = |of: &[(f64, f64)]| {
        let logs: Vec<f64> = of.iter().map(|(_, miss)| *miss).collect();
        EndMiss {
            delta_k_from_mpa_sqrt_m: of[0].0,
            delta_k_to_mpa_sqrt_m: of[of.len() - 1].0,
            rates: of.len(),
            rate_over_law_percent: 100.0 * median(&logs).exp_m1(),
        }
    };
    Some(LackOfFit { low: end(&misses[..low]), high: end(&misses[high..]) })
}

impl LackOfFit {
    /// Both ends in one line.
    pub fn words(&self) -> String {
        let end = |end: &EndMiss| {
            format!(
                "{:+.1} % at ΔK {:.2} to {:.2}",
                end.rate_over_law_percent, end.delta_k_from_mpa_sqrt_m, end.delta_k_to_mpa_sqrt_m
            )
        };
        format!("measured rate over law {}, {} MPa√m", end(&self.low), end(&self.high))
    }
}
