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
use crate::calibration::calibrate::Fitted;
use crate::calibration::case::CalibrationCase;
use crate::calibration::fit::Fit;
use crate::calibration::readings::readings_csv;
use crate::calibration::results::{fit_curves_csv, fitted_rates_csv, rates_csv, rates_taken_csv};
use crate::error::{Error, Result};
use crate::units::{MM, MPA_SQRT_M};

/// Table of the rates that a law was fitted to.
const RATES_FILE: &str = "rates.csv";
/// Growth rate over ΔK with the law.
const DA_DN_FILE: &str = "da_dn.svg";

/// Writes all files of a fit into `folder`; `report` is the content of `fit.json`.
pub fn write(folder: &Path, fitted: &Fitted<'_>, report: &Value) -> Result<()> {
    let unwritable = |error: toml::ser::Error| {
        Error::file(&folder.join("fitted.toml"), "cannot write", std::io::Error::other(error.to_string()))
    };
    let law = fitted.record_text().map_err(unwritable)?;
    let put = |name: &str, text: &str| write_file(&folder.join(name), text.as_bytes());
    let mut json = report.clone();
    match fitted {
        Fitted::Lives(calibration, fit) => {
            let (curves, band, rates) = (fit_curves_csv(fit), band(calibration, fit), fitted_rates_csv(calibration, fit));
            let provenance = &calibration.case.provenance;
            let delta_k = |length: f64| fit.delta_k(calibration, length);
            let readings = readings_csv(calibration, &delta_k);
            let tables = [
                ("fitted.toml", &*law),
                (CURVES_FILE, &*curves),
                (BAND_FILE, &*band),
                (RATES_FILE, &*rates),
                (READINGS_FILE, &*readings),
            ];
            if let Some(object) = json.as_object_mut() {
                object.insert("test".to_owned(), test_record::test(calibration));
                object.insert("criteria".to_owned(), test_record::criteria(calibration, &delta_k).into());
                object.insert("plate".to_owned(), json!(Plate::of(&calibration.case)));
            }
            provenance::add(&mut json, provenance, &tables);
            tables.iter().try_for_each(|(name, text)| put(name, text))?;
            provenance::write(folder, "calibrate", calibration.input.clone(), provenance)?;
            write_tables(folder, calibration, fit)?;
            let tables = FitTables::read(&json, [&curves, &band, &readings])?;
            put("fit.svg", &tables.lives_svg(LARGE))?;
            put(DA_DN_FILE, &tables.rates_svg(LARGE))?;
        }
        Fitted::Rates(case, fits) => {
            put("fitted.toml", &law)?;
            let rates = rates_csv(case, fits);
            put(RATES_FITTED_FILE, &rates)?;
            put(RATES_FILE, &rates_taken_csv(case))?;
            put(DA_DN_FILE, &law_svg(&rates_fitted(&rates)?, LARGE))?;
        }
    }
    put(FIT_FILE, &format!("{json:#}\n"))?;
    show_folder(folder, &mut json)
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
    use crate::calibration::frames::{SHARES, cycle_quantiles, fit_curves, specimens};
    use crate::calibration::results::curves_written;
    use crate::calibration::search::FittedCurve;
    use crate::tables::{csv, join_by_specimen, parquet};

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
