//! Fatigue laws that scatter: drawn from what a calibration says about specimens, or about its own errors.
//!
//! What is drawn is the growth rate R at the pivot ΔK and the exponent p: there both are nearly uncorrelated, while A and p alone
//! are correlated to -0.99. The constants follow from
//!
//! ```text
//! ln R = ln A + s p + const,   s = ∂ ln R / ∂p at fixed A and ΔK
//! ```
//!
//! For hand calculation (A is C, p is m) `s = ln ΔK` exactly. For bonds, steady growth `R = β A δ^(1-p/2) (ΔK/E')^p` gives
//! `s = ln(ΔK / (E' √δ)) + ∂ ln β / ∂p`, with the slope of ln β ([`rate_constant_slope`]); E' = E or E/(1-ν²).

use std::path::Path;
use std::str::FromStr;

use serde::Deserialize;

use super::design::Scatter;
use super::distribution::normal_quantile;
use crate::record::SpecimenRecord;
use perilife_base::error::{Error, Result, fail_if, input, input_missing};
use perilife_base::input::Folder;
use perilife_base::units::{MM, MM_PER_CYCLE, MPA_SQRT_M};
use perilife_growth::case::record::FittedRecord;
use perilife_growth::rate_constant::rate_constant_slope;
use perilife_points::bond_law::Kernel;

/// Fewest specimens whose covariance is taken for that of all.
pub const SPECIMENS_MIN: usize = 5;
/// Report of a calibration, beside its record.
pub const FIT_FILE: &str = "fit.json";

/// Keys of `fit.json` that are needed here.
#[derive(Debug, Clone, Deserialize)]
pub struct SpecimenFits {
    pub p: f64,
    pub specimens: Vec<SpecimenRecord>,
}

/// Normal distribution of (ln rate at the pivot, exponent) about a record.
#[derive(Debug, Clone, PartialEq)]
pub struct LawScatter {
    record: FittedRecord,
    /// Of ln(rate in mm/cycle) and of p.
    pub mean: [f64; 2],
    pub covariance: [[f64; 2]; 2],
}

impl LawScatter {
    /// Scatter from specimen to specimen: mean and covariance (over n - 1) of their own fits.
    pub fn of_specimens(record: FittedRecord, fits: &SpecimenFits) -> Result<Self> {
        let problem = || format!("differs from the exponent in fit.json, {}", record.p);
        let remedy = "keep fitted.toml and fit.json of one calibration together";
        fail_if!((fits.p / record.p - 1.0).abs() > 1e-9, input("p", fits.p, problem(), remedy));
        let n = fits.specimens.len();
        let problem = || format!("are too few for a scatter (need {SPECIMENS_MIN})");
        let remedy = "calibrate on more specimens, or use design.scatter = \"constants\"";
        fail_if!(n < SPECIMENS_MIN, input("specimens", format!("{n} specimens"), problem(), remedy));
        // In the unit of the specimens' own.
        let of_record = if record.a.is_finite() { record.a } else { record.paris_c_mm_per_cycle * MM_PER_CYCLE };
        let slope = slope(&record)?;
        let rate =
            |fit: &SpecimenRecord| record.rate_at_pivot_mm_per_cycle.ln() + (fit.a / of_record).ln() + slope * (fit.p - record.p);
        let pairs: Vec<[f64; 2]> = fits.specimens.iter().map(|fit| [rate(fit), fit.p]).collect();
        if pairs.iter().flatten().any(|value| !value.is_finite()) {
            return Err(input_missing("specimens", "contain an a or p that is not a number above zero", "calibrate again"));
        }
        let mean = [0, 1].map(|i| pairs.iter().map(|pair| pair[i]).sum::<f64>() / n as f64);
        let moment =
            |i: usize, j: usize| pairs.iter().map(|pair| (pair[i] - mean[i]) * (pair[j] - mean[j])).sum::<f64>() / (n - 1) as f64;
        let covariance = [[moment(0, 0), moment(0, 1)], [moment(1, 0), moment(1, 1)]];
        Ok(LawScatter { record, mean, covariance })
    }

    /// Uncertainty of the record itself: standard errors of the rate at the pivot and of the exponent, uncorrelated there.
    pub fn of_constants(record: FittedRecord) -> Result<Self> {
        let errors = [record.rate_at_pivot_relative_error, record.p_error];
        if !errors.iter().all(|error| error.is_finite() && *error >= 0.0) || errors == [0.0; 2] {
            let remedy = "use the record of a calibration with errors, or design.scatter = \"specimens\"";
            let key = "rate_at_pivot_relative_error";
            return Err(input(key, errors[0], "and p_error contain no errors to sample", remedy));
        }
        let mean = [record.rate_at_pivot_mm_per_cycle.ln(), record.p];
        let covariance = [[errors[0].powi(2), 0.0], [0.0, errors[1].powi(2)]];
        Ok(LawScatter { record, mean, covariance })
    }

    /// The law at two probabilities in (0, 1): that of the exponent, and that of the rate at the pivot given the exponent.
    pub fn draw(&self, [of_exponent, of_rate]: [f64; 2]) -> Result<FittedRecord> {
        let [[rate_rate, rate_p], [_, p_p]] = self.covariance;
        let z = normal_quantile(of_exponent);
        let p = self.mean[1] + p_p.max(0.0).sqrt() * z;
        // Of the rate, the part that goes with p, and the rest.
        let with_p = if p_p > 0.0 { rate_p / p_p.sqrt() } else { 0.0 };
        let rest = (rate_rate - with_p * with_p).max(0.0).sqrt();
        self.at(self.mean[0] + with_p * z + rest * normal_quantile(of_rate), p)
    }

    /// The record with this ln rate at the pivot (mm/cycle) and exponent. It is one law, so it has no errors.
    fn at(&self, ln_rate: f64, p: f64) -> Result<FittedRecord> {
        let record = &self.record;
        let by_hand = record.rate_constant.is_none();
        let (change, more) = (ln_rate - record.rate_at_pivot_mm_per_cycle.ln(), p - record.p);
        // m follows p as its error follows that of p; where there are none, as theory says: one to one.
        let has_errors = !by_hand && record.paris_m_error > 0.0 && record.p_error > 0.0;
        let m_per_p = if has_errors { record.paris_m_error / record.p_error } else { 1.0 };
        let m = record.paris_m + m_per_p * more;
        let of_drawn = |beta: f64| beta_slope(record).map(|slope| beta * (slope * more).exp());
        let rate_constant = record.rate_constant.map(of_drawn).transpose()?;
        Ok(FittedRecord {
            a: record.a * (change - slope(record)? * more).exp(),
            rate_constant,
            p,
            paris_c_mm_per_cycle: (ln_rate - m * record.pivot_delta_k_mpa_sqrt_m.ln()).exp(),
            paris_m: m,
            paris_m_error: 0.0,
            rate_at_pivot_mm_per_cycle: ln_rate.exp(),
            rate_at_pivot_relative_error: 0.0,
            p_error: 0.0,
            ..record.clone()
        })
    }
}

/// Reads the scatter of the record of a case; `fitted` is its file in `folder`.
pub fn read(record: FittedRecord, fitted: &str, folder: &Folder, scatter: Scatter) -> Result<LawScatter> {
    if scatter == Scatter::Constants {
        return LawScatter::of_constants(record).map_err(|error| error.in_file(&folder.path(fitted)));
    }
    let beside = Path::new(fitted).with_file_name(FIT_FILE).to_string_lossy().into_owned();
    let path = folder.path(&beside);
    let bytes = folder.read(&beside).map_err(|error| match error {
        Error::File { path, source, .. } => {
            let action = "cannot read the fits of the specimens (`perilife calibrate` writes fit.json with its record)";
            Error::file(&path, action, source)
        }
        other => other,
    })?;
    let fits: SpecimenFits = serde_json::from_slice(&bytes).map_err(|error| {
        let problem = format!("is not a calibration result: {error}");
        input_missing("file", problem, "calibrate again").in_file(&path)
    })?;
    LawScatter::of_specimens(record, &fits).map_err(|error| error.in_file(&path))
}

/// s = ∂ ln R / ∂p at fixed A and the pivot ΔK.
pub fn slope(record: &FittedRecord) -> Result<f64> {
    let pivot = record.pivot_delta_k_mpa_sqrt_m;
    if record.rate_constant.is_none() {
        return Ok(pivot.ln());
    }
    let modulus = record.plane_modulus()?;
    Ok((pivot * MPA_SQRT_M / (modulus * (record.horizon_mm * MM).sqrt())).ln() + beta_slope(record)?)
}

/// ∂ ln β / ∂p of the kernel of a record at its exponent.
fn beta_slope(record: &FittedRecord) -> Result<f64> {
    rate_constant_slope(Kernel::from_str(&record.kernel)?, record.p)
}
