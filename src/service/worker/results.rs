//! The files of a job, written into the folder of its process, and the figures that its listing shows.

use std::fs::File;
use std::io::{BufWriter, Write as _};
use std::path::{Path, PathBuf};
use std::time::Instant;

use serde_json::{Value, json};
use zip::write::SimpleFileOptions;

use super::telling::Teller;
use crate::calibration::calibrate::{Calibration, Fitted};
use crate::case::Case;
use crate::error::{Error, Result};
use crate::fracture::{Scene, SceneEnd};
use crate::predict::Prediction;
use crate::report::{fit, fracture, run};
use crate::service::store::ResultFile;
use crate::units::MM;

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
pub fn of_run(folder: &Path, case: &Case, prediction: &Prediction) -> Result<Value> {
    let judged = run::judge(case, prediction)?;
    let result = run::write(folder, case, prediction)?;
    let mut summary: serde_json::Map<String, Value> =
        FIGURES.iter().filter_map(|key| Some(((*key).to_owned(), result.get(*key)?.clone()))).collect();
    let mut warnings: Vec<&str> = result["warnings"].as_array().into_iter().flatten().filter_map(Value::as_str).collect();
    let new: Vec<&str> = judged.iter().map(String::as_str).filter(|warning| !warnings.contains(warning)).collect();
    warnings.extend(new);
    if let Some(refusal) = result["refused"].as_str() {
        warnings.insert(0, refusal);
    }
    summary.insert("warnings".to_owned(), json!(warnings));
    packed(folder)?;
    Ok(Value::Object(summary))
}

/// Fits a calibration and writes its files.
pub fn of_fit(folder: &Path, calibration: &Calibration, teller: &Teller<'_>) -> Result<Value> {
    let started = Instant::now();
    let fitted = calibration.fit(teller)?;
    let mut summary = fitted.report(started.elapsed().as_secs_f64());
    fit::write(folder, &fitted, &summary)?;
    if let (Fitted::Lives(calibration, _), Some(figures)) = (&fitted, summary.as_object_mut()) {
        // What the law is of.
        let case = &calibration.case;
        figures.insert("material".to_owned(), json!(case.material.name));
        figures.insert("plane".to_owned(), json!(case.material.plane.name()));
        figures.insert("stress_ratio".to_owned(), json!(case.loading.ratio));
        figures.insert("thickness_mm".to_owned(), json!(case.specimen.thickness / MM));
    }
    packed(folder)?;
    Ok(summary)
}

/// Runs a scene and writes its files.
///
/// # Errors
/// As [`crate::fracture::run`] and [`fracture::write`]; a scene without convergence or that blew up.
pub fn of_scene(folder: &Path, scene: &Scene, teller: &Teller<'_>) -> Result<Value> {
    let ran = crate::fracture::run(scene, teller)?;
    if matches!(ran.end, SceneEnd::NoConvergence | SceneEnd::Unstable) {
        return Err(Error::Mechanics(format!("{}: {}: {}", scene.name, ran.end, ran.end.meaning())));
    }
    let result = fracture::result(scene, &ran);
    fracture::write(folder, scene, &ran, &result)?;
    packed(folder)?;
    Ok(result)
}

/// Makes an archive of every folder within a folder of results.
///
/// # Errors
/// [`Error::File`] if it cannot be read or written.
pub fn packed(folder: &Path) -> Result<()> {
    for path in entries(folder)?.into_iter().filter(|path| path.is_dir()) {
        let archive = path.with_file_name(format!("{}.zip", name_of(&path)));
        pack(&path, &archive)?;
        std::fs::remove_dir_all(&path).map_err(|error| Error::file(&path, "cannot remove", error))?;
    }
    Ok(())
}

/// The files of a folder of results but for hidden ones, which are marks of the commands.
///
/// # Errors
/// [`Error::File`] if it cannot be read.
pub fn files(folder: &Path) -> Result<Vec<ResultFile>> {
    let files = entries(folder)?.into_iter().map(|path| ResultFile { name: name_of(&path), path });
    Ok(files.filter(|file| !file.name.starts_with('.')).collect())
}

/// Bytes of all files below a folder.
pub fn bytes(folder: &Path) -> u64 {
    let within = |path: PathBuf| match std::fs::symlink_metadata(&path) {
        Ok(about) if about.is_dir() => bytes(&path),
        about => about.map_or(0, |about| about.len()),
    };
    entries(folder).unwrap_or_default().into_iter().map(within).sum()
}

fn pack(folder: &Path, archive: &Path) -> Result<()> {
    let failed = |error: &dyn std::fmt::Display| Error::file(folder, "cannot pack", std::io::Error::other(error.to_string()));
    let file = File::create(archive).map_err(|error| Error::file(archive, "cannot create", error))?;
    let mut packed = zip::ZipWriter::new(BufWriter::new(file));
    // The fastest: a plate of numbers hardly packs better at ten times the cost.
    let packing = SimpleFileOptions::default().compression_level(Some(1));
    let mut folders = vec![folder.to_path_buf()];
    while let Some(next) = folders.pop() {
        for path in entries(&next)? {
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            let name = path.strip_prefix(folder).unwrap_or(&path).to_string_lossy().into_owned();
            packed.start_file(name, packing).map_err(|error| failed(&error))?;
            let mut content = File::open(&path).map_err(|error| Error::file(&path, "cannot read", error))?;
            std::io::copy(&mut content, &mut packed).map_err(|error| failed(&error))?;
        }
    }
    packed.finish().map_err(|error| failed(&error))?.flush().map_err(|error| failed(&error))
}

fn name_of(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

fn entries(folder: &Path) -> Result<Vec<PathBuf>> {
    let cannot = |error| Error::file(folder, "cannot read the folder", error);
    let mut paths =
        std::fs::read_dir(folder).map_err(cannot)?.map(|entry| Ok(entry.map_err(cannot)?.path())).collect::<Result<Vec<_>>>()?;
    paths.sort();
    Ok(paths)
}
