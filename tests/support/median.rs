//! Pointwise medians of measured curves, and the panel of a well-known one.

use perilife_base::error::Result;
use perilife_base::input::Folder;
use perilife_calibration::median::{common_lengths, pointwise_median_at};
use perilife_growth::case::Case;
use perilife_measured::MeasuredCurve;

/// Pointwise median at the common lengths; of one curve, the curve itself.
pub fn pointwise_median(curves: &[MeasuredCurve]) -> Result<MeasuredCurve> {
    match curves {
        [only] => Ok(only.clone()),
        _ => pointwise_median_at(curves, &common_lengths(curves)?),
    }
}

/// The panel of Virkler et al. (1979) under its load.
pub fn virkler_panel() -> Case {
    let text = "specimen = { kind = \"middle_tension\", width_mm = 152.4, length_mm = 300.0, thickness_mm = 2.54, crack_length_mm = 9.0 }
        material = { youngs_modulus_gpa = 71.0, poisson_ratio = 0.33, yield_strength_mpa = 345.0 }
        loading = { stress_max_mpa = 60.35, stress_ratio = 0.2 }
        model = { method = \"handbook\" }
        fatigue = { paris_c_mm_per_cycle = 1e-8, paris_m = 3.0 }";
    Case::from_toml(text, "panel", Folder::none(), &[]).unwrap()
}
