//! A fit: all its files.

use std::fmt::Write as _;
use std::path::Path;

use serde_json::{Value, json};

use super::chart::LARGE;
use super::output::write_file;
use super::pictures::fit::{
    BAND_FILE, CURVES_FILE, FIT_FILE, FitTables, RATES_FITTED_FILE, READINGS_FILE, law_svg, rates_fitted,
};
use super::pictures::plate::Plate;
use super::units::show_folder;
use super::{provenance, test_record};
use perilife_base::error::{Error, Result};
use perilife_base::units::{MM, MPA_SQRT_M};
use perilife_calibration::calibrate::Fitted;
use perilife_calibration::case::CalibrationCase;
use perilife_calibration::fit::Fit;
use perilife_calibration::record::FitRecord;
use perilife_calibration::results::{fit_curves_csv, fitted_rates_csv, left_out, rates_csv, rates_taken_csv, readings_csv};
use perilife_growth::case::RECORD;

/// The law, for `fatigue.fitted`.
pub const LAW_FILE: &str = RECORD;
/// Table of the rates that a law was fitted to.
const RATES_FILE: &str = "rates.csv";
/// Growth rate over ΔK with the law.
const DA_DN_FILE: &str = "da_dn.svg";

/// A fit as its folder keeps it.
#[derive(Debug, Clone)]
pub struct Kept {
    /// What `fit.json` holds.
    pub record: FitRecord,
    /// The law and all tables, by the names of their files.
    pub tables: Vec<(&'static str, String)>,
}

impl Kept {
    /// Of a fit that took `wall_s` seconds.
    /// Errors: a law that has no form in TOML.
    pub fn of(fitted: &Fitted<'_>, wall_s: f64) -> Result<Self> {
        let unwritable =
            |error: toml::ser::Error| Error::file(Path::new(LAW_FILE), "cannot write", std::io::Error::other(error.to_string()));
        let law = fitted.record_text().map_err(unwritable)?;
        let mut record = fitted.record(wall_s);
        let tables = match fitted {
            Fitted::Lives(calibration, fit) => {
                let (delta_k, left_out) = (|length: f64| fit.delta_k(calibration, length), left_out(calibration, fit));
                let tables = vec![
                    (LAW_FILE, law),
                    (CURVES_FILE, fit_curves_csv(fit)),
                    (BAND_FILE, band(calibration, fit)),
                    (RATES_FILE, fitted_rates_csv(calibration, fit)),
                    (READINGS_FILE, readings_csv(calibration, &left_out, &delta_k)),
                ];
                let mut beside = json!({
                    "test": test_record::test(calibration),
                    "criteria": test_record::criteria(calibration, &left_out, &delta_k),
                    "plate": Plate::of(&calibration.case),
                });
                let listed: Vec<(&str, &str)> = tables.iter().map(|(name, text)| (*name, &**text)).collect();
                provenance::add(&mut beside, &calibration.case.provenance, &listed);
                if let FitRecord::Lives(lives) = &mut record {
                    lives.beside = beside;
                }
                tables
            }
            Fitted::Rates(case, fits) => {
                vec![(LAW_FILE, law), (RATES_FITTED_FILE, rates_csv(case, fits)), (RATES_FILE, rates_taken_csv(case))]
            }
        };
        Ok(Kept { record, tables })
    }

    /// Content of `fit.json`.
    pub fn json(&self) -> Value {
        json!(self.record)
    }

    /// A table by the name of its file.
    pub fn table(&self, name: &str) -> &str {
        self.tables.iter().find(|(known, _)| *known == name).map_or("", |(_, text)| text)
    }
}

/// Writes all files of a fit into `folder`.
pub fn write(folder: &Path, fitted: &Fitted<'_>, kept: &Kept) -> Result<()> {
    let put = |name: &str, text: &str| write_file(&folder.join(name), text.as_bytes());
    kept.tables.iter().try_for_each(|(name, text)| put(name, text))?;
    match (fitted, &kept.record) {
        (Fitted::Lives(calibration, fit), FitRecord::Lives(record)) => {
            provenance::write(folder, "calibrate", calibration.input.clone(), &calibration.case.provenance)?;
            write_tables(folder, calibration, fit)?;
            let tables = FitTables::read(record, [CURVES_FILE, BAND_FILE, READINGS_FILE].map(|name| kept.table(name)))?;
            put("fit.svg", &tables.lives_svg(LARGE))?;
            put(DA_DN_FILE, &tables.rates_svg(LARGE))?;
        }
        _ => put(DA_DN_FILE, &law_svg(&rates_fitted(kept.table(RATES_FITTED_FILE))?, LARGE))?,
    }
    let mut record = kept.json();
    put(FIT_FILE, &format!("{record:#}\n"))?;
    show_folder(folder, &mut record)
}

/// Standard errors from the middle of a 95 % band to its ends.
const BAND: f64 = 1.96;

/// `fit_band.csv`: the fitted curve of the record with the 95 % band that the standard errors of its constants leave it; not the
/// scatter of specimens.
///
/// The rate at the pivot and the exponent m have errors of their own, without correlation, which is what makes it the pivot. With
/// N(a) = ∫ da / rate, the relative error of N is s_N² = s_rate² + (s_m w)², w the mean of ln(ΔK/ΔK_pivot) over the cycles so far.
fn band(calibration: &CalibrationCase, fit: &Fit) -> String {
    let mut text = "crack_length_mm,cycles_fitted,cycles_low,cycles_high\n".to_owned();
    let (lengths, cycles) = (&fit.record.crack_length, &fit.record.cycles_fitted);
    let m_error = fit.paris.m_error.max(calibration.exponent.error);
    let mut weighted = 0.0;
    for (i, (&length, &n)) in lengths.iter().zip(cycles).enumerate() {
        if i > 0 {
            let delta_k = fit.delta_k(calibration, 0.5 * (length + lengths[i - 1])) * fit.record.load_factor[i] / MPA_SQRT_M;
            weighted += (n - cycles[i - 1]) * (delta_k / fit.paris.pivot).ln();
        }
        let w = if n > 0.0 { weighted / n } else { 0.0 };
        let factor = (BAND * fit.paris.rate_at_pivot_error.hypot(m_error * w)).exp();
        let _ = writeln!(text, "{:.12e},{n:.12e},{:.12e},{:.12e}", length / MM, n / factor, n * factor); // a String takes all
    }
    text
}

/// The same curves as Parquet beside their constants, and for several specimens quantiles of their cycles.
#[cfg(feature = "tables")]
fn write_tables(folder: &Path, calibration: &CalibrationCase, fit: &Fit) -> Result<()> {
    use crate::frames::{SHARES, cycle_quantiles, fit_curves, specimens};
    use perilife_calibration::results::curves_written;
    use perilife_calibration::search::FittedCurve;
    use perilife_tables::{csv, join_by_specimen, parquet};

    let curves: Vec<FittedCurve> = curves_written(fit).cloned().collect();
    let constants = specimens(&curves)?;
    let joined = join_by_specimen(&fit_curves(&curves)?, &constants)?;
    write_file(&folder.join("fit_curves.parquet"), &parquet(&joined)?)?;
    write_file(&folder.join("specimens.csv"), &csv(&constants)?)?;
    if calibration.curves.len() > 1 {
        let quantiles = cycle_quantiles(&calibration.curves, &fit.record.crack_length, &SHARES)?;
        write_file(&folder.join("quantiles.csv"), &csv(&quantiles)?)?;
    }
    Ok(())
}

#[cfg(not(feature = "tables"))]
fn write_tables(_folder: &Path, _calibration: &CalibrationCase, _fit: &Fit) -> Result<()> {
    Ok(())
}
