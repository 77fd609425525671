//! The files of a job, and the figures that its listing shows.

use std::io::{Cursor, Write as _};
use std::path::Path;
use std::time::Instant;

use serde_json::{Value, json};
use zip::write::SimpleFileOptions;

use super::watch::Watch;
use crate::calibration::calibrate::calibrate;
use crate::calibration::case::CalibrationCase;
use crate::calibration::laws::case::LawCase;
use crate::calibration::laws::results::report;
use crate::calibration::results::{FitReport, record};
use crate::case::Case;
use crate::error::{Error, Result};
use crate::predict::Prediction;
use crate::report::provenance::INPUTS;
use crate::report::run::PARAVIEW;
use crate::report::{fit, law_fit, run};
use crate::service::store::File;
use crate::units::MM;

/// Summary and files of a result.
pub type Results = (Value, Vec<File>);

/// Keys of `result.json` that a summary has.
const FIGURES: [&str; 14] = [
    "life_cycles",
    "life_is_lower_bound",
    "stop_reason",
    "stop_meaning",
    "crack_length_initial_mm",
    "crack_length_final_mm",
    "life_share_extrapolated",
    "refused",
    "points",
    "points_solved",
    "blocks",
    "solves",
    "wall_s",
    "memory_mb",
];

/// Judges a run and writes its files.
///
/// # Errors
/// As [`run::judge`] and [`run::write`].
pub fn of_run(case: &Case, prediction: &Prediction) -> Result<Results> {
    let folder = temporary()?;
    let judged = run::judge(case, prediction)?;
    let result = run::write(folder.path(), case, prediction)?;
    let mut summary: serde_json::Map<String, Value> =
        FIGURES.iter().filter_map(|key| Some(((*key).to_owned(), result.get(*key)?.clone()))).collect();
    let mut warnings: Vec<&str> = result["warnings"].as_array().into_iter().flatten().filter_map(Value::as_str).collect();
    let new: Vec<&str> = judged.iter().map(String::as_str).filter(|warning| !warnings.contains(warning)).collect();
    warnings.extend(new);
    if let Some(refusal) = result["refused"].as_str() {
        warnings.insert(0, refusal);
    }
    summary.insert("warnings".to_owned(), json!(warnings));
    Ok((Value::Object(summary), collected(folder.path())?))
}

/// Fits a calibration and writes its files.
///
/// # Errors
/// As [`calibrate`] and [`fit::write`].
pub fn of_fit(calibration: &CalibrationCase, watch: &Watch<'_>) -> Result<Results> {
    let folder = temporary()?;
    let started = Instant::now();
    let fitted = calibrate(calibration, watch)?;
    let report = FitReport::new(calibration, &fitted, started.elapsed().as_secs_f64());
    fit::write(folder.path(), calibration, &fitted, &report, &record(calibration, &fitted))?;
    let mut summary = json!(report);
    let warnings: Vec<&String> = calibration.warnings.iter().chain(&fitted.warnings).collect();
    let case = &calibration.case;
    if let Some(figures) = summary.as_object_mut() {
        figures.insert("warnings".to_owned(), json!(warnings));
        // What the law is of.
        figures.insert("material".to_owned(), json!(case.material.name));
        figures.insert("plane".to_owned(), json!(case.material.plane.name()));
        figures.insert("stress_ratio".to_owned(), json!(case.loading.ratio));
        figures.insert("thickness_mm".to_owned(), json!(case.specimen.thickness / MM));
    }
    Ok((summary, collected(folder.path())?))
}

/// Fits laws over K and writes their files.
///
/// # Errors
/// As [`LawCase::fit`] and [`law_fit::write`].
pub fn of_laws(case: &LawCase) -> Result<Results> {
    let folder = temporary()?;
    let started = Instant::now();
    let fits = case.fit()?;
    let report = report(case, &fits, started.elapsed().as_secs_f64());
    law_fit::write(folder.path(), case, &fits, &report)?;
    Ok((report, collected(folder.path())?))
}

fn temporary() -> Result<tempfile::TempDir> {
    tempfile::tempdir().map_err(|error| Error::file(&std::env::temp_dir(), "cannot create a folder in", error))
}

/// All files of a folder; those of ParaView and of inputs become an archive each.
fn collected(folder: &Path) -> Result<Vec<File>> {
    let mut files = Vec::new();
    for path in entries(folder)? {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if path.is_dir() {
            debug_assert!([PARAVIEW, INPUTS].contains(&&*name));
            files.push(File { name: format!("{name}.zip"), content: archive(&path)? });
        } else {
            files.push(File { name, content: read(&path)? });
        }
    }
    Ok(files)
}

fn archive(folder: &Path) -> Result<Vec<u8>> {
    let mut archive = zip::ZipWriter::new(Cursor::new(Vec::new()));
    // The fastest: a plate of numbers hardly packs better at ten times the cost.
    let packing = SimpleFileOptions::default().compression_level(Some(1));
    let failed = |error: &dyn std::fmt::Display| Error::file(folder, "cannot pack", std::io::Error::other(error.to_string()));
    for path in entries(folder)? {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        archive.start_file(name, packing).map_err(|error| failed(&error))?;
        archive.write_all(&read(&path)?).map_err(|error| failed(&error))?;
    }
    Ok(archive.finish().map_err(|error| failed(&error))?.into_inner())
}

fn entries(folder: &Path) -> Result<Vec<std::path::PathBuf>> {
    let cannot = |error| Error::file(folder, "cannot read the folder", error);
    let mut paths =
        std::fs::read_dir(folder).map_err(cannot)?.map(|entry| Ok(entry.map_err(cannot)?.path())).collect::<Result<Vec<_>>>()?;
    paths.sort();
    Ok(paths)
}

fn read(path: &Path) -> Result<Vec<u8>> {
    std::fs::read(path).map_err(|error| Error::file(path, "cannot read", error))
}
