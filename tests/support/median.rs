//! Pointwise medians of measured curves.

use perilife_base::error::Result;
use perilife_calibration::median::{common_lengths, pointwise_median_at};
use perilife_measured::MeasuredCurve;

/// Pointwise median at the common lengths; of one curve, the curve itself.
pub fn pointwise_median(curves: &[MeasuredCurve]) -> Result<MeasuredCurve> {
    match curves {
        [only] => Ok(only.clone()),
        _ => pointwise_median_at(curves, &common_lengths(curves)?),
    }
}
