//! Whether readings tell the exponent at all, and what it means where they do not.

use crate::calibration::confidence::Confidence;
use crate::calibration::paris::Paris;
use crate::error::{Error, Result};
use crate::fatigue::STEADY_EXPONENTS;

/// Below this ratio rates of every exponent are alike.
const DELTA_K_RATIO_NONE: f64 = 1.01;

/// Refuses a p that the readings do not tell at all: its error is that of a p of which only the ends of the search are known.
pub(super) fn check_told(name: &str, confidence: &Confidence, paris: &Paris) -> Result<()> {
    let (low, high) = (STEADY_EXPONENTS.start(), STEADY_EXPONENTS.end());
    let (error, ratio) = (confidence.covariance[1][1].sqrt(), paris.delta_k_max / paris.delta_k_min);
    if error < (high - low) / 12.0_f64.sqrt() && ratio > DELTA_K_RATIO_NONE {
        return Ok(());
    }
    Err(Error::Mechanics(format!(
        "{name}: the misfit has no smallest value that tells p: its standard error is {error:.2} where {low} to {high} are searched, and ΔK \
         varies by a factor {ratio:.4}; widen the window (measured.from_crack_length_mm and to_crack_length_mm), or fix p by [fit] \
         parameters = [\"a\"] and p = ..."
    )))
}

/// What it means that a searched p is an end of its range.
pub(super) fn at_end(p: f64) -> String {
    let (low, high) = (STEADY_EXPONENTS.start(), STEADY_EXPONENTS.end());
    format!(
        "the misfit is smallest at p = {p:.3}, an end of the range searched, {low} to {high}: the curve does not follow the law"
    )
}
