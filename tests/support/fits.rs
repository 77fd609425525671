//! `fit.json` of a fit, read back as it was written.

use perilife_calibration::case::CalibrationCase;
use perilife_calibration::fit::Fit;
use perilife_calibration::record::{FitRecord, LivesRecord};
use serde_json::{Value, json};

/// That of a fit to lives that took `wall_s` seconds.
pub fn report(calibration: &CalibrationCase, fit: &Fit, wall_s: f64) -> Value {
    read_back(&FitRecord::Lives(Box::new(LivesRecord::of(calibration, fit, wall_s))))
}

/// A record as it is written; read again it is the same.
pub fn read_back(record: &FitRecord) -> Value {
    let written = json!(record).to_string();
    let back: FitRecord = serde_json::from_str(&written).unwrap();
    assert_eq!(json!(back).to_string(), written);
    json!(back)
}
