//! How well the curve determines ln A and p.
//!
//! A crack that runs slowly between two readings shifts all later cycles: errors of cumulated cycles are sums of errors
//! of the increments and strongly correlated. The usual `s² (JᵀJ)⁻¹` takes them as independent and is far too sure of itself.
//! So the least squares estimate on lives (best for life, see `criterion`) gets a sandwich covariance
//!
//! ```text
//! Cov = (JᵀWJ)⁻¹ JᵀW Σ WJ (JᵀWJ)⁻¹,   Σ = L diag(σ² ΔN_i²) Lᵀ
//! ```
//!
//! (White 1980; W weights the lives, L sums up the increments that each of them spans) with increments `ΔN_i` of the fit that
//! scatter independently by the same relative σ: the rms of the relative residual increments, each by its share of the life. Counted
//! alike, one odd reading in the last percent of a life would double the error of the whole fit.

use nalgebra::{Matrix2, Vector2};

use super::criterion::Criterion;
use super::paris::Paris;
use perilife_base::error::{Error, Result};
use perilife_laws::STEADY_EXPONENTS;

/// Covariance of (ln A, p) and the scatter it rests on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Confidence {
    /// Covariance of (ln A, p); with p fixed only the first entry is not 0.
    pub covariance: [[f64; 2]; 2],
    /// Relative scatter σ of the cycles between readings.
    pub increment_scatter: f64,
}

/// Covariance at a fit by a criterion: A x cycles `model` of the law at the measured lengths, their derivative over p (`None` where p was
/// fixed) and `measured` cycles, all counted from the first reading.
pub fn confidence(
    criterion: Criterion,
    model: &[f64],
    model_per_p: Option<&[f64]>,
    measured: &[f64],
    inverse_a: f64,
) -> Confidence {
    let increments: Vec<(f64, f64)> = model
        .windows(2)
        .zip(measured.windows(2))
        .map(|(n, measured)| ((n[1] - n[0]) * inverse_a, measured[1] - measured[0]))
        .collect();
    // Readings that noise puts in the wrong order have no fitted increment to compare with.
    let usable = || increments.iter().filter(|(fitted, _)| *fitted > 0.0);
    let parameters = if model_per_p.is_some() { 2 } else { 1 };
    let count = usable().count();
    let lost = count as f64 / count.saturating_sub(parameters).max(1) as f64;
    let all: f64 = usable().map(|(fitted, _)| fitted).sum();
    let variance = lost * usable().map(|(fitted, measured)| fitted * (measured / fitted - 1.0).powi(2)).sum::<f64>() / all;

    // N = n / A: ∂N/∂ln A = -N, ∂N/∂p = (∂n/∂p) / A.
    let jacobian = |(from, to): (usize, usize)| {
        let per_p = model_per_p.map_or(0.0, |slope| slope[to] - slope[from]);
        Vector2::new(-(model[to] - model[from]) * inverse_a, per_p * inverse_a)
    };
    let spans = criterion.spans(model.len());
    let mut normal = Matrix2::zeros();
    // Change from one increment to the next of the sum of weighted rows of J over the lives that span it.
    let mut change = vec![Vector2::zeros(); model.len()];
    for ((from, to), weight) in spans.into_iter().zip(criterion.weights(measured)) {
        let row = jacobian((from, to));
        normal += row * row.transpose() * weight;
        change[from] += row * weight;
        change[to] -= row * weight;
    }
    let inverse = match model_per_p {
        Some(_) => normal.try_inverse().unwrap_or_else(|| Matrix2::repeat(f64::NAN)),
        None => Matrix2::new(1.0 / normal[(0, 0)], 0.0, 0.0, 0.0),
    };
    // An increment moves every life that spans it: column i of Jᵀ W L.
    let mut meat = Matrix2::zeros();
    let mut spanning = Vector2::zeros();
    for (step, (fitted, _)) in change.iter().zip(&increments) {
        spanning += step;
        meat += spanning * spanning.transpose() * (variance * fitted * fitted);
    }
    let covariance = inverse * meat * inverse;
    Confidence {
        covariance: [[covariance[(0, 0)], covariance[(0, 1)]], [covariance[(1, 0)], covariance[(1, 1)]]],
        increment_scatter: variance.sqrt(),
    }
}

/// Below this ratio rates of every exponent are alike.
const DELTA_K_RATIO_NONE: f64 = 1.01;

/// Refuses a p that the readings do not identify: its error is that of a p of which only the ends of the search are known.
pub(super) fn check_identified(name: &str, confidence: &Confidence, paris: &Paris) -> Result<()> {
    let (low, high) = (STEADY_EXPONENTS.start(), STEADY_EXPONENTS.end());
    let (error, ratio) = (confidence.covariance[1][1].sqrt(), paris.delta_k_max / paris.delta_k_min);
    if error < (high - low) / 12.0_f64.sqrt() && ratio > DELTA_K_RATIO_NONE {
        return Ok(());
    }
    Err(Error::Mechanics(format!(
        "{name}: p cannot be determined: standard error {error:.2} in the search range {low} to {high}, ΔK varies by a factor \
         {ratio:.4}; widen the window (measured.from_crack_length_mm and to_crack_length_mm), or fix p by [fit] parameters = \
         [\"a\"] and p = ..."
    )))
}

/// What it means that a searched p is an end of its range.
pub(super) fn end_of_range(p: f64) -> String {
    let (low, high) = (STEADY_EXPONENTS.start(), STEADY_EXPONENTS.end());
    format!("best fit p = {p:.3}, at the limit of the search range {low} to {high}: the data do not follow a power law")
}
