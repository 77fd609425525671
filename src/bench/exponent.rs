//! How time grows with size.

use crate::calibration::line::line;

/// Exponent k of `time ~ size^k`: slope of the least squares line through the logarithms; NaN for fewer than two sizes or
/// values that are not positive.
#[must_use]
pub fn growth_exponent(sizes: &[f64], times: &[f64]) -> f64 {
    let log = |values: &[f64]| values.iter().map(|value| value.ln()).collect::<Vec<f64>>();
    line(&log(sizes), &log(times)).map_or(f64::NAN, |line| line.slope)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_power_is_found() {
        let sizes = [3e4, 1.2e5, 4.8e5, 1e6];
        let times = sizes.map(|size: f64| 2e-6 * size.powf(1.13));
        assert!((growth_exponent(&sizes, &times) - 1.13).abs() < 1e-12);
    }

    #[test]
    fn scatter_is_averaged() {
        // Times a factor 1.1 above, below, below and above the line: symmetric about the middle, so the slope stays.
        let sizes = [1.0, 10.0, 100.0, 1000.0];
        let times = [1.1, 10.0 / 1.1, 100.0 / 1.1, 1100.0];
        assert!((growth_exponent(&sizes, &times) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn what_has_no_exponent_is_not_a_number() {
        assert!(growth_exponent(&[5.0], &[1.0]).is_nan());
        assert!(growth_exponent(&[5.0, 5.0], &[1.0, 2.0]).is_nan());
        assert!(growth_exponent(&[1.0, 2.0], &[0.0, 1.0]).is_nan());
    }
}
