//! The calibration of the engine on the median panel of Virkler et al. (1979).

use std::path::Path;

use perilife::calibration::calibrate::calibrate;
use perilife::calibration::case::CalibrationCase;
use perilife::calibration::fit::Fit;
use perilife::measured::MeasuredCurve;
use perilife::predict::Silent;

pub fn calibration(set: &[String]) -> CalibrationCase {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("calibration/al2024-t3/case.toml");
    CalibrationCase::from_file(&file, set).unwrap()
}

pub fn fit_to(calibration: &CalibrationCase, curves: &[MeasuredCurve]) -> Fit {
    let mut calibration = calibration.clone();
    calibration.curves = curves.to_vec();
    calibrate(&calibration, &Silent).unwrap()
}

#[test]
fn the_median_panel_is_fitted_within_two_percent_of_life() {
    let calibration = calibration(&[]);
    let found = fit_to(&calibration, &calibration.curves);
    let life = found.record.life_fitted() / found.record.life_measured();
    println!(
        "p {:.4} ± {:.4}, rms {:.4}, life {life:.4}, m {:.4}",
        found.record.constants.p,
        found.p_error(),
        found.record.rms_life_error(),
        found.paris.m
    );
    assert!(found.record.rms_life_error() <= 0.02);
    assert!((life - 1.0).abs() <= 0.025);
    assert!((2.7..=3.3).contains(&found.paris.m));
    // The error of p by hand calculation on the same curve is about 0.1.
    assert!(found.p_error() < 0.2, "p ± {}", found.p_error());
}
