//! Time of a calibration.

use super::Bench;
use super::row::Row;
use super::variant::DEFAULT;
use crate::calibration::calibrate::calibrate;
use crate::calibration::case::CalibrationCase;
use crate::error::Result;
use crate::predict::Silent;
use crate::verify::measured::{CALIBRATION, READINGS, at_hand};

/// A and p fitted to the median of 34 panels of 2024-T3.
///
/// # Errors
/// As [`calibrate`].
pub fn median(bench: &mut Bench<'_>) -> Result<()> {
    let spacing = if bench.effort.quick { 3 } else { 1 };
    let text = CALIBRATION.replace("spacing_mm = 1.0", &format!("spacing_mm = {spacing}.0"));
    let calibration = CalibrationCase::from_text(&text, "al2024-t3", at_hand(READINGS))?;
    let about = format!("Virkler panel, 9 to 49.8 mm, {spacing} mm");
    let (_, fitted) = bench.time(|| calibrate(&calibration, &Silent))?;
    bench.push(Row::new("calibration", about, DEFAULT, "fit of A and p to the median of 34 panels", fitted));
    Ok(())
}
