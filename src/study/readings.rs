//! Readings and laws that are fitted to them: rates, the fit to a measured panel, exponents from noisy readings.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};

use super::cases::case;
use super::figures::Figures;
use super::subject::Watcher;
use perilife_base::error::{Error, Result};
use perilife_base::input::Folder;
use perilife_base::monotone::Monotone;
use perilife_base::units::{MM, MM_PER_CYCLE};
use perilife_calibration::calibrate::calibrate;
use perilife_calibration::case::CalibrationCase;
use perilife_calibration::median::cycles_at;
use perilife_calibration::rates::{RateMethod, rates};
use perilife_calibration::results::record;
use perilife_growth::case::Case;
use perilife_growth::predict::{Silent, StopReason, predict};
use perilife_measured::MeasuredCurve;

/// Rate at a crack length, mm, of readings in lines of cycles and crack length in mm; whether the length of its step is flagged, 0 or 1.
pub fn rates_of_readings(text: &str, method: RateMethod, length: f64) -> Result<Figures> {
    let number = |field: &str| field.trim().parse::<f64>().map_err(|_| Error::Mechanics(format!("no such reading: {field}")));
    let rows = text.lines().filter_map(|line| line.split_once(',')).map(|(n, a)| Ok((number(n)?, number(a)? * MM)));
    let (cycles, lengths) = rows.collect::<Result<Vec<_>>>()?.into_iter().unzip();
    let points = rates(&MeasuredCurve::new("readings", cycles, lengths), method);
    let point = points.iter().find(|point| (point.crack_length / MM - length).abs() < 1e-3);
    let rate = point.map_or(f64::NAN, |point| point.rate / MM_PER_CYCLE);
    Ok(vec![("rate", rate), ("is_flagged", f64::from(point.is_some_and(|point| point.flags.short_step)))])
}

/// Calibration of 2024-T3, and the median of 34 panels that it is fitted to (Virkler, Hillberry and Goel 1979).
const CALIBRATION: &str = include_str!("../../calibration/al2024-t3/case.toml");
const READINGS: &[u8] = include_bytes!("../../calibration/al2024-t3/measured/virkler_median.csv");

/// That fit: its life beside the measured one, cycles that remain from 20, 30 and 35 mm, C and m; and lives with the fitted law of a specimen
/// that nobody tested, by hand calculation with C and m, as anybody would, and by peridynamics.
pub fn fit(text: &str) -> Result<Figures> {
    let readings = Folder::at_hand([("measured/virkler_median.csv".to_owned(), READINGS.to_vec())]);
    let calibration = CalibrationCase::from_text(CALIBRATION, "al2024-t3", readings)?;
    let fit = calibrate(&calibration, &Silent)?;
    let found = &fit.record;
    let remaining = |cycles: &[f64], from: f64| {
        let curve = MeasuredCurve::new(found.name.clone(), cycles.to_vec(), found.crack_length.clone());
        cycles_at(&curve, from * MM).map_or(f64::NAN, |n| curve.life() - n)
    };
    let [fitted, measured] = [&found.cycles_fitted, &found.cycles_measured];
    let mut figures = vec![
        ("life_fitted", found.life_fitted()),
        ("life_measured", found.life_measured()),
        ("fitted_from_20", remaining(fitted, 20.0)),
        ("fitted_from_30", remaining(fitted, 30.0)),
        ("fitted_from_35", remaining(fitted, 35.0)),
        ("measured_from_20", remaining(measured, 20.0)),
        ("measured_from_30", remaining(measured, 30.0)),
        ("measured_from_35", remaining(measured, 35.0)),
        ("c", fit.paris.c),
        ("m", fit.paris.m),
    ];
    for (name, method) in [("by_hand", "handbook"), ("on_points", "peridynamics")] {
        if text.is_empty() {
            continue;
        }
        let text = format!("model = {{ method = '{method}', spacing_mm = 1.0 }}\n{text}");
        let case = Case::from_toml_with_law(&text, "verification", Folder::none(), record(&calibration, &fit))?;
        let run = predict(&case, &Silent)?;
        if run.stop != StopReason::CrackLengthReached {
            return Err(Error::Mechanics(format!("{}: stopped by {}", case.name, run.stop)));
        }
        figures.push((name, run.life_cycles()));
    }
    Ok(figures)
}

/// Exponent that noisy readings were made with.
const M: f64 = 3.0;
/// First and last of them, mm.
const RANGE: [f64; 2] = [9.0, 40.0];
/// Series of noise over which the error is the root mean square.
const SERIES: u64 = 8;

/// Root mean square error of the exponent fitted to so many readings with normal noise, mm, of a panel that the law of `text` has grown.
pub fn exponent_error(text: &str, noise: f64, count: f64, observer: &dyn Watcher) -> Result<Figures> {
    let (panel, _) = text.split_once("[fatigue]").unwrap_or((text, ""));
    let curve = predict(&case(text, "")?, observer)?.curve;
    let cycles = Monotone::new(curve.iter().map(|row| [row.crack_length / MM, row.cycles]));
    let mut squares = 0.0;
    for seed in 0..SERIES {
        let mut normal = Normal(ChaCha8Rng::seed_from_u64(seed));
        let mut table = "cycles,crack_length_mm\n".to_owned();
        for reading in 0..count as usize {
            let length = RANGE[0] + (RANGE[1] - RANGE[0]) * reading as f64 / (count - 1.0);
            table += &format!("{:.3},{:.6}\n", cycles.at(length), length + noise * normal.next());
        }
        let folder = Folder::at_hand([("readings.csv".to_owned(), table.into_bytes())]);
        let test = CalibrationCase::from_text(&format!("{panel}[measured]\nfiles = [\"readings.csv\"]\n"), "readings", folder)?;
        let fitted = calibrate(&test, observer)?.record.constants.p;
        squares += (fitted / M - 1.0).powi(2);
    }
    Ok(vec![("error", 100.0 * (squares / SERIES as f64).sqrt())])
}

/// Standard normal numbers by the transform of Box and Muller.
struct Normal(ChaCha8Rng);

impl Normal {
    fn next(&mut self) -> f64 {
        let mut uniform = || (self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
        let (u, v) = (1.0 - uniform(), uniform());
        (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos()
    }
}
