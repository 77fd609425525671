//! What the fitted model means in the terms of a test report: C and m of `da/dN = C ΔK^m`, and the rate at the pivot.
//!
//! C and m are the straight line through log da/dN of the model over log ΔK of the handbook, in the fit window. Their
//! errors are almost perfectly correlated (−0.99), so neither means much alone. At the pivot ΔK the rate does not depend on
//! which of the many nearly equal pairs is taken: rate there and slope are uncorrelated.

use crate::search::Constants;
use perilife_base::error::{Error, Result};
use perilife_base::linear_fit::line;
use perilife_base::units::{MM_PER_CYCLE, MPA_SQRT_M};
use perilife_laws::growth_law::{Walker, doubt};
use perilife_laws::paris::ParisLaw;

/// Intervals of crack length for the straight line: on the Virkler window 1 mm, as long as a lattice spacing.
const INTERVALS: usize = 40;

/// In mm/cycle and MPa√m; the smallest and largest ΔK are those of the window.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Paris {
    pub c: f64,
    pub m: f64,
    pub m_error: f64,
    pub pivot: f64,
    pub rate_at_pivot: f64,
    pub rate_at_pivot_error: f64,
    pub delta_k_min: f64,
    pub delta_k_max: f64,
}

impl Paris {
    /// The same pivot and window for a law whose A and p are C and m themselves ([`crate::power_law`]).
    pub fn of_power_law(self, constants: Constants, m_error: f64) -> Self {
        let c = constants.a / MM_PER_CYCLE;
        Paris { c, m: constants.p, m_error, rate_at_pivot: c * self.pivot.powf(constants.p), ..self }
    }
}

const EXPONENTS: std::ops::RangeInclusive<f64> = 1.0..=10.0;

/// What is wrong with an exponent m for a metal.
pub fn doubt_of_exponent(m: f64) -> Option<String> {
    let (low, high) = (EXPONENTS.start(), EXPONENTS.end());
    let words = "check the units of crack length, cycles and load";
    (!EXPONENTS.contains(&m)).then(|| format!("m = {m:.3} is outside {low} to {high}, the range of metals: {words}"))
}

/// What is wrong with `da/dN = C ΔK^m` (mm/cycle, MPa√m) as the law of a metal: a unit that slipped shows here.
pub fn implausibility_of(c: f64, m: f64) -> Option<String> {
    let paris = ParisLaw { c: c * MM_PER_CYCLE, m };
    doubt_of_exponent(m).or_else(|| doubt(&Walker { paris, gamma: 1.0, threshold: 0.0 }, 0.0))
}

/// Equally spaced lengths of the window at which rates are taken.
pub fn lengths(from: f64, to: f64) -> Vec<f64> {
    (0..=INTERVALS).map(|i| from + (to - from) * i as f64 / INTERVALS as f64).collect()
}

/// Equivalents of a fit with A `a`, from A x cycles `model` at [`lengths`] and, unless p was fixed, its derivative over p.
///
/// `delta_k` gives ΔK in Pa√m at a crack length in m.
pub fn equivalents(
    lengths: &[f64],
    model: &[f64],
    model_per_p: Option<&[f64]>,
    a: f64,
    covariance: [[f64; 2]; 2],
    delta_k: &dyn Fn(f64) -> f64,
) -> Result<Paris> {
    let at = |length: f64| delta_k(length) / MPA_SQRT_M;
    let (mut log_k, mut log_rate, mut sensitivity, mut weight) = (vec![], vec![], vec![], vec![]);
    for i in 1..lengths.len() {
        let unit_cycles = model[i] - model[i - 1];
        if unit_cycles <= 0.0 {
            continue;
        }
        log_k.push(at(0.5 * (lengths[i] + lengths[i - 1])).ln());
        log_rate.push(((lengths[i] - lengths[i - 1]) * a / unit_cycles / MM_PER_CYCLE).ln());
        weight.push(unit_cycles);
        if let Some(slope) = model_per_p {
            // At fixed A: ∂ ln(da/dN) / ∂p = -∂ ln(Δn) / ∂p.
            sensitivity.push(-(slope[i] - slope[i - 1]) / unit_cycles);
        }
    }
    let Some(law) = line(&log_k, &log_rate) else {
        return Err(Error::Mechanics("the fitted run has no growth rates for a Paris line".to_owned()));
    };
    // m follows p: its slope over p is that of the sensitivities over ln ΔK.
    let m_per_p = line(&log_k, &sensitivity).map_or(0.0, |law| law.slope);
    let (log_pivot, error) = pivot(&log_k, &sensitivity, &weight, covariance);
    let ends = lengths.iter().map(|&length| at(length));
    let (low, high) = ends.fold((f64::INFINITY, 0.0_f64), |(low, high), k| (low.min(k), high.max(k)));
    Ok(Paris {
        c: law.intercept.exp(),
        m: law.slope,
        m_error: m_per_p.abs() * covariance[1][1].max(0.0).sqrt(),
        pivot: log_pivot.exp(),
        rate_at_pivot: law.at(log_pivot).exp(),
        rate_at_pivot_error: error,
        delta_k_min: low,
        delta_k_max: high,
    })
}

/// ln of the pivot and relative error of the rate there. `ln rate = ln A + s p + ...` with s nearly linear in ln ΔK; its
/// covariance with p vanishes where `s = -Cov(ln A, p) / Var(p)`. Where p was fixed, the mean ln ΔK over life.
fn pivot(log_k: &[f64], sensitivity: &[f64], weight: &[f64], covariance: [[f64; 2]; 2]) -> (f64, f64) {
    let [[a_a, a_p], [_, p_p]] = covariance;
    let free = line(log_k, sensitivity).filter(|law| law.slope.abs() > 1e-6 && p_p > 0.0);
    if let Some(law) = free {
        let log_pivot = (-a_p / p_p - law.intercept) / law.slope;
        return (log_pivot, (a_a - a_p * a_p / p_p).max(0.0).sqrt());
    }
    let whole: f64 = weight.iter().sum();
    (log_k.iter().zip(weight).map(|(k, w)| k * w).sum::<f64>() / whole, a_a.sqrt())
}
