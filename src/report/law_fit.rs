//! A fit of laws over K: all its files.

use std::path::Path;

use serde_json::Value;

use super::chart::{self, Mark, Series};
use super::output::write_file;
use crate::calibration::laws::LawFits;
use crate::calibration::laws::case::LawCase;
use crate::calibration::laws::results::{rates_csv, record};
use crate::error::{Error, Result};
use crate::units::{MM_PER_CYCLE, MPA_SQRT_M};

/// Most stress ratios that a picture tells apart.
const RATIOS_DRAWN: usize = 6;

/// Writes all files of a fit into `folder`; `report` is the content of `fit.json`.
pub fn write(folder: &Path, case: &LawCase, fits: &LawFits, report: &Value) -> Result<()> {
    let unwritable = |error: toml::ser::Error| {
        Error::file(&folder.join("fitted.toml"), "cannot write", std::io::Error::other(error.to_string()))
    };
    let law = toml::to_string(&record(case, fits)).map_err(unwritable)?;
    write_file(&folder.join("fit.json"), format!("{report:#}\n").as_bytes())?;
    write_file(&folder.join("fitted.toml"), law.as_bytes())?;
    write_file(&folder.join("fit_rates.csv"), rates_csv(case, fits).as_bytes())?;
    let title = format!("{}: {}", case.name, fits.law().kind);
    chart::growth_rate(&folder.join("fit_rates.svg"), &title, &series(case, fits))
}

/// Measured rates of every stress ratio, and those of the law at the same rows.
fn series(case: &LawCase, fits: &LawFits) -> Vec<Series> {
    let ratios = case.ratios();
    if ratios.len() > RATIOS_DRAWN {
        return pair("all stress ratios", case, fits, &|_| true);
    }
    ratios.iter().flat_map(|ratio| pair(&format!("R = {ratio}"), case, fits, &|of| (of - ratio).abs() < 0.0051)).collect()
}

fn pair(name: &str, case: &LawCase, fits: &LawFits, is_of: &dyn Fn(f64) -> bool) -> Vec<Series> {
    let rows = || case.rows.iter().zip(&fits.law().residuals).filter(|(row, _)| is_of(row.ratio));
    let point = |(row, share): (&crate::calibration::laws::rows::RateRow, f64)| {
        (row.delta_k / MPA_SQRT_M, row.rate / MM_PER_CYCLE * share)
    };
    let mut law: Vec<(f64, f64)> = rows().map(|(row, residual)| point((row, (-residual).exp()))).collect();
    law.sort_by(|a, b| a.0.total_cmp(&b.0));
    vec![
        Series { name: name.to_owned(), points: rows().map(|(row, _)| point((row, 1.0))).collect(), mark: Mark::Circles },
        Series { name: format!("{}, {name}", fits.law().kind), points: law, mark: Mark::Line },
    ]
}
