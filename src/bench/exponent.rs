//! How time grows with size.

use crate::line::line;

/// Exponent k of `time ~ size^k`: slope of the least squares line through the logarithms; NaN for fewer than two sizes or
/// values that are not positive.
#[must_use]
pub fn growth_exponent(sizes: &[f64], times: &[f64]) -> f64 {
    let log = |values: &[f64]| values.iter().map(|value| value.ln()).collect::<Vec<f64>>();
    line(&log(sizes), &log(times)).map_or(f64::NAN, |line| line.slope)
}
