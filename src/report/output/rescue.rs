//! Another place for results that their own does not take.

use std::fs;
use std::path::{Path, PathBuf};

use super::leftovers::visible_beside;
use super::marker::{MARKER, Marker, RunKind};
use crate::error::Result;

/// Has a run written in the current folder, or in that for temporary files; where anything of it stands then.
pub(super) fn elsewhere<T>(kind: RunKind, target: &Path, write: &impl Fn(&Path) -> Result<T>) -> Option<PathBuf> {
    let name = target.file_name().unwrap_or_default();
    [std::env::current_dir().ok(), Some(std::env::temp_dir())].into_iter().flatten().find_map(|place| {
        let other = visible_beside(&place.join(name));
        fs::create_dir(&other).ok()?;
        // What it fails with here was said of its own place.
        let _ = write(&other);
        if !has_files(&other) {
            let _ = fs::remove_dir_all(&other);
            return None;
        }
        let _ = Marker::of(kind, &other).and_then(|marker| fs::write(other.join(MARKER), marker.text()));
        Some(other)
    })
}

/// Whether a folder of results has more than its marker: tables that hold something.
pub(super) fn has_files(folder: &Path) -> bool {
    let size = |file: &String| fs::metadata(folder.join(file)).map_or(0, |there| there.len());
    Marker::of(RunKind::Predict, folder).is_ok_and(|marker| marker.files.iter().any(|file| size(file) > 0))
}
