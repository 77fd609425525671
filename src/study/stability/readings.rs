//! Readings that a law is fitted to: their noise and their number.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};

use super::{Run, SWEEP, Sweep};
use crate::cases::case;
use perilife_base::error::Result;
use perilife_base::input::Folder;
use perilife_base::monotone::Monotone;
use perilife_base::units::MM;
use perilife_calibration::calibrate::calibrate;
use perilife_calibration::case::CalibrationCase;
use perilife_growth::predict::predict;

/// Exponent that the readings were made with.
const M: f64 = 3.0;
/// First and last reading, mm.
const RANGE: [f64; 2] = [9.0, 40.0];
/// Series of noise over which the error is the root mean square.
const SERIES: u64 = 8;
/// Readings of a test.
const READINGS: f64 = 30.0;

/// Noise of a reading.
pub const NOISE: Sweep = Sweep {
    name: "reading_noise",
    about: "exponent fitted to 30 readings of a panel grown from 9 to 40 mm by quadrature with m = 3, plus normal noise; root mean square of 8 \
            series",
    parameter: "standard deviation of a reading",
    unit: "mm",
    values: &[0.001, 0.003, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0],
    usual: 0.001,
    bound_percent: 5.0,
    methods: &[("calibrate by handbook", |noise, run| exponent_error(noise, READINGS, run))],
    ..SWEEP
};

/// Number of readings.
pub const COUNT: Sweep = Sweep {
    name: "reading_count",
    about: "exponent fitted to readings with normal noise of 0.05 mm, of the same panel; root mean square of 8 series",
    parameter: "number of readings",
    unit: "",
    values: &[2.0, 3.0, 4.0, 5.0, 7.0, 10.0, 15.0, 20.0, 30.0, 50.0],
    usual: 30.0,
    is_continuous: false,
    methods: &[("calibrate by handbook", |count, run| exponent_error(0.05, count, run))],
    ..NOISE
};

/// The panel, which starts before its first reading, and its law.
const PANEL: &str = "[specimen]\nkind = \"middle_tension\"\nwidth_mm = 152.4\nlength_mm = 300.0\nthickness_mm = 2.54\n\
    crack_length_mm = 6.0\n[material]\nname = \"al2024-t3\"\n[loading]\nstress_range_mpa = 48.28\nstress_ratio = 0.2\n[model]\n\
    method = \"handbook\"\n";
const LAW: &str = "[fatigue]\nparis_c_mm_per_cycle = 5e-8\nparis_m = 3.0\n[stop]\ncrack_length_mm = 40.0\n";

fn exponent_error(noise: f64, count: f64, run: &Run) -> Result<f64> {
    let curve = predict(&case(&format!("{PANEL}{LAW}"), "")?, run)?.curve;
    let cycles = Monotone::new(curve.iter().map(|row| [row.crack_length / MM, row.cycles]));
    let mut squares = 0.0;
    for seed in 0..SERIES {
        let mut normal = Normal(ChaCha8Rng::seed_from_u64(seed));
        let mut text = "cycles,crack_length_mm\n".to_owned();
        for reading in 0..count as usize {
            let length = RANGE[0] + (RANGE[1] - RANGE[0]) * reading as f64 / (count - 1.0);
            text += &format!("{:.3},{:.6}\n", cycles.at(length), length + noise * normal.next());
        }
        let folder = Folder::at_hand([("readings.csv".to_owned(), text.into_bytes())]);
        let test = CalibrationCase::from_text(&format!("{PANEL}[measured]\nfiles = [\"readings.csv\"]\n"), "readings", folder)?;
        let fitted = calibrate(&test, run)?.record.constants.p;
        squares += (fitted / M - 1.0).powi(2);
    }
    Ok(100.0 * (squares / SERIES as f64).sqrt())
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
