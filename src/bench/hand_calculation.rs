//! Prediction and fit by hand calculation.

use std::fmt::Write as _;

use super::row::{Asked, Row};
use super::scene::middle_tension;
use super::variant::DEFAULT;
use super::{Bench, Figure};
use crate::calibration::calibrate::calibrate;
use crate::calibration::case::CalibrationCase;
use crate::calibration::model::cycles_since_first;
use crate::error::Result;
use crate::predict::{Silent, predict};
use crate::units::MM;
use crate::verify::golden;
use crate::verify::measured::{CALIBRATION, at_hand};
use crate::verify::scene::{case, points};

const GROUP: &str = "hand_calculation";
/// Equal runs measured together, so that a clock tells their time.
const PREDICTIONS: usize = 200;
const FITS: usize = 10;
/// Milliseconds asked for a prediction and a fit.
const ASKED_MS: [f64; 2] = [1.0, 50.0];
/// Steps of the readings of a panel of Virkler, Hillberry and Goel (1979): (to, every), mm, from 9 mm on; 164 readings.
const STEPS_MM: [(f64, f64); 3] = [(36.2, 0.2), (44.2, 0.4), (49.8, 0.8)];

/// Prediction of the panel, and the fit of C and m to 164 readings of it.
///
/// # Errors
/// As [`predict`] and [`calibrate`].
pub fn all(bench: &mut Bench<'_>) -> Result<()> {
    let by_hand = middle_tension(bench.effort.quick).by_hand()?;
    let (_, timing) = bench.time(|| (0..PREDICTIONS).try_for_each(|_| predict(&by_hand, &Silent).map(drop)))?;
    let prediction = timing.of_one_in(PREDICTIONS);
    bench.push(Row::new(GROUP, "middle-tension panel", DEFAULT, "prediction by quadrature", prediction));

    let readings = readings()?;
    let text = CALIBRATION.replace("spacing_mm = 1.0", "method = \"handbook\"");
    let calibration = CalibrationCase::from_text(&text, "hand", at_hand(readings.as_bytes()))?;
    let (_, timing) = bench.time(|| (0..FITS).try_for_each(|_| calibrate(&calibration, &Silent).map(drop)))?;
    let fit = timing.of_one_in(FITS);
    let count = readings.lines().count() - 1;
    bench.push(Row::new(GROUP, "Virkler panel", "fit", &format!("C and m fitted to {count} readings"), fit));
    for (quantity, seconds, most) in [("prediction", prediction.wall_s, ASKED_MS[0]), ("fit", fit.wall_s, ASKED_MS[1])] {
        let asked = Some(Asked::AtMost(most));
        bench.figure(Figure { group: GROUP, quantity: quantity.to_owned(), value: 1e3 * seconds, unit: "ms", asked });
    }
    Ok(())
}

/// Readings as a panel would give them: hand calculation, one percent of scatter of the last digits laid over it.
pub fn readings() -> Result<String> {
    let run = predict(&case(golden::PANEL, &["stop.crack_length_mm=49.8"])?, &Silent)?;
    let lengths = lengths_mm();
    let cycles = cycles_since_first(&points(&run), &lengths.iter().map(|length| length * MM).collect::<Vec<f64>>())?;
    let mut text = "specimen,cycles,crack_length_mm\n".to_owned();
    let mut last = 0.0;
    for (i, (length, cycles)) in lengths.iter().zip(&cycles).enumerate() {
        let step = cycles - last;
        last = *cycles;
        // Never as much as a step, so that cycles rise; a fixed wave, so that every call fits the same.
        let read = if i == 0 { 0.0 } else { cycles + 0.3 * step * (1.7 * i as f64).sin() };
        let _ = writeln!(text, "panel,{read},{length:.1}"); // writing to a String cannot fail
    }
    Ok(text)
}

/// Crack lengths at which the readings are taken.
#[must_use]
pub fn lengths_mm() -> Vec<f64> {
    let mut lengths = vec![9.0];
    let mut from = 9.0;
    for (to, every) in STEPS_MM {
        let count = ((to - from) / every + 0.5) as usize;
        lengths.extend((1..=count).map(|i| from + i as f64 * every));
        from = to;
    }
    lengths
}
