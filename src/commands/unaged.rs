//! The plate of a case or calibration file, for commands that ask nothing of its fatigue law.

use std::path::Path;

use crate::calibration::case::remove_law;
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
    let mut document = Document::read(path, overrides)?;
    document.table.remove("measured");
    document.table.remove("fit");
    remove_law(&mut document.table);
    Case::without_growth(document.table.clone(), &document.name, &document.folder).map_err(|error| document.locate(error))
}
