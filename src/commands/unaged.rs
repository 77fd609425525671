//! The plate of a case or calibration file, for commands that ask nothing of its fatigue law.

use std::path::Path;

use crate::case::Case;
use crate::error::Result;
use crate::input::Document;

/// Specimen, material, load and model of a file; a fitted record that does not exist yet is no obstacle.
pub(super) fn case_without_law(path: &Path, overrides: &[String]) -> Result<Case> {
    let case = plate_without_law(path, overrides)?;
    case.specimen.check_growth().map_err(|error| error.in_file(path))?;
    Ok(case)
}

/// The same of a plate that need not have a crack.
pub(super) fn plate_without_law(path: &Path, overrides: &[String]) -> Result<Case> {
    Case::plate_of(&Document::read(path, overrides)?)
}
