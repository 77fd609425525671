//! A fit: all its files.

use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::chart::LARGE;
use super::output::{Room, write_file, write_json};
use super::pictures::fit::{BAND_FILE, FIT_FILE, FitTables, law_svg};
use super::pictures::plate::Plate;
use super::provenance::{self, MadeBy};
use super::test_record::{self, Criterion, TestRecord};
use perilife_base::columns::Table;
use perilife_base::error::{Error, Result};
use perilife_base::units::{MM, MPA_SQRT_M};
use perilife_calibration::calibrate::Fitted;
use perilife_calibration::case::CalibrationCase;
use perilife_calibration::fit::Fit;
use perilife_calibration::readings::readings;
use perilife_calibration::record::FitRecord;
use perilife_calibration::results::{fit_curves, fitted_rates, left_out, rates_beside_law, rates_taken};
use perilife_growth::case::RECORD;

/// The law, for `fatigue.fitted`.
pub const LAW_FILE: &str = RECORD;
/// Bytes that a fit will write, roughly.
pub const ROOM: Room = Room { tables: 64_000, all: 1_000_000 };
/// Growth rate over ΔK with the law.
const DA_DN_FILE: &str = "da_dn.svg";

/// What `fit.json` has of the test beside its fit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct OfTest {
    pub test: TestRecord,
    pub criteria: Vec<Criterion>,
    pub plate: Plate,
    #[serde(flatten)]
    pub made_by: MadeBy,
}

/// A fit as its folder keeps it.
#[derive(Debug, Clone)]
pub struct Kept {
    /// What `fit.json` holds.
    pub record: FitRecord,
    /// The law, for `fatigue.fitted`.
    law: String,
    tables: Vec<(Table, String)>,
}

impl Kept {
    /// Of a fit and its record.
    /// Errors: a law that has no form in TOML.
    pub fn of(fitted: &Fitted<'_>, mut record: FitRecord) -> Result<Self> {
        let unwritable =
            |error: toml::ser::Error| Error::file(Path::new(LAW_FILE), "cannot write", std::io::Error::other(error.to_string()));
        let law = fitted.record_text().map_err(unwritable)?;
        let tables = match fitted {
            Fitted::Lives(calibration, fit) => {
                let (delta_k, left_out) = (|length: f64| fit.delta_k(calibration, length), left_out(calibration, fit));
                let tables = [
                    fit_curves(fit),
                    band(calibration, fit),
                    fitted_rates(calibration, fit),
                    readings(calibration, &left_out, &delta_k),
                ]
                .map(Table::with_text)
                .to_vec();
                let texts = tables.iter().map(|(table, text)| (&*table.file, &**text));
                let texts = std::iter::once((Path::new(LAW_FILE), &*law)).chain(texts);
                let beside = OfTest {
                    test: test_record::test(calibration),
                    criteria: test_record::criteria(calibration, &left_out, &delta_k),
                    plate: Plate::of(&calibration.case),
                    made_by: MadeBy::of(&calibration.case.provenance, texts),
                };
                if let FitRecord::Lives(lives) = &mut record {
                    // Figures and text have a form in JSON.
                    lives.beside = serde_json::to_value(beside).unwrap_or_default();
                }
                tables
            }
            Fitted::Rates(case, fits) => [rates_beside_law(case, fits), rates_taken(case)].map(Table::with_text).to_vec(),
        };
        Ok(Kept { record, law, tables })
    }

    /// Content of `fit.json`.
    pub fn json(&self) -> Value {
        serde_json::to_value(&self.record).unwrap_or_default()
    }

    /// Texts of the law and all tables by the names of their files.
    pub fn texts(&self) -> impl Iterator<Item = (&Path, &str)> {
        let law = (Path::new(LAW_FILE), &*self.law);
        std::iter::once(law).chain(self.tables.iter().map(|(table, text)| (&*table.file, &**text)))
    }
}

/// Writes all files of a fit into `folder`.
pub fn write(folder: &Path, fitted: &Fitted<'_>, kept: &Kept) -> Result<()> {
    let put = |name: &Path, text: &str| write_file(&folder.join(name), text.as_bytes());
    kept.texts().try_for_each(|(name, text)| put(name, text))?;
    let draw = |name: &str, svg: String| put(Path::new(name), &svg);
    match (fitted, &kept.record, &*kept.tables) {
        (Fitted::Lives(calibration, fit), FitRecord::Lives(record), [(curves, _), (band, _), _, (readings, _)]) => {
            provenance::write(folder, "calibrate", calibration.input.clone(), &calibration.case.provenance)?;
            write_tables(folder, calibration, fit)?;
            let tables = FitTables::of(record, [curves, band, readings])?;
            draw("fit.svg", tables.lives_svg(LARGE))?;
            draw(DA_DN_FILE, tables.rates_svg(LARGE))?;
        }
        (_, _, tables) => draw(DA_DN_FILE, law_svg(&tables[0].0.records()?, LARGE))?,
    }
    write_json(folder, FIT_FILE, &kept.record)
}

/// Standard errors from the middle of a 95 % band to its ends.
const BAND: f64 = 1.96;

/// `fit_band.csv`: the fitted curve of the record with the 95 % band that the standard errors of its constants leave it; not the
/// scatter of specimens.
///
/// The rate at the pivot and the exponent m have errors of their own, without correlation, which is what makes it the pivot. With
/// N(a) = ∫ da / rate, the relative error of N is s_N² = s_rate² + (s_m w)², w the mean of ln(ΔK/ΔK_pivot) over the cycles so far.
fn band(calibration: &CalibrationCase, fit: &Fit) -> Table {
    let (lengths, cycles) = (&fit.record.crack_length, &fit.record.cycles_fitted);
    let m_error = fit.paris.m_error.max(calibration.exponent.error);
    let mut weighted = 0.0;
    let mut factor = |i: usize| {
        if i > 0 {
            let delta_k = fit.delta_k(calibration, 0.5 * (lengths[i] + lengths[i - 1])) * fit.record.load_factor[i] / MPA_SQRT_M;
            weighted += (cycles[i] - cycles[i - 1]) * (delta_k / fit.paris.pivot).ln();
        }
        let w = if cycles[i] > 0.0 { weighted / cycles[i] } else { 0.0 };
        (BAND * fit.paris.rate_at_pivot_error.hypot(m_error * w)).exp()
    };
    let factors: Vec<f64> = (0..lengths.len()).map(&mut factor).collect();
    Table::new(BAND_FILE)
        .numbers("crack_length_mm", lengths.iter().map(|length| length / MM))
        .numbers("cycles_fitted", cycles.iter().copied())
        .numbers("cycles_low", cycles.iter().zip(&factors).map(|(n, factor)| n / factor))
        .numbers("cycles_high", cycles.iter().zip(&factors).map(|(n, factor)| n * factor))
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
