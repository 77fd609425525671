//! A folder of results in the place of an earlier one.

use std::fs;
use std::io;
use std::path::Path;

use super::leftovers::visible_beside;
use super::marker::{MARKER, Marker};

/// Renames `partial` to `target`, of whose earlier files none is left then. What appears there in the last moment stays.
///
/// # Errors
/// In words; an earlier result then stands as before.
pub(super) fn replace(partial: &Path, target: &Path, old: &Path) -> Result<(), String> {
    if fs::symlink_metadata(target).is_err() {
        return fs::rename(partial, target).map_err(|error| error.to_string());
    }
    fs::rename(target, old).map_err(|error| error.to_string())?;
    if let Err(error) = fs::rename(partial, target) {
        // The earlier result goes back; should that fail as well, it still stands under its temporary name.
        let _ = fs::rename(old, target);
        return Err(error.to_string());
    }
    if let Some(marker) = Marker::read(old) {
        let _ = marker.remove_from(old);
    }
    if fs::remove_dir(old).is_err() && old.exists() {
        let visible = visible_beside(target);
        let _ = fs::rename(old, &visible);
        tracing::warn!("what appeared in {} in the last moment stands in {}", target.display(), visible.display());
    }
    Ok(())
}

/// Moves all files of `partial` into `target`, in the place of those of the run before.
///
/// # Errors
/// A file that cannot be moved or removed; the marker then lists those of both runs.
pub(super) fn move_into(partial: &Path, target: &Path) -> io::Result<()> {
    let Some(new) = Marker::read(partial) else { return Err(io::Error::other("the marker cannot be read")) };
    let old = Marker::read(target).unwrap_or_else(|| Marker { files: Default::default(), ..new.clone() });
    let both = Marker { files: new.files.union(&old.files).cloned().collect(), ..new.clone() };
    fs::write(target.join(MARKER), both.text())?;
    Marker { files: old.files.difference(&new.files).cloned().collect(), ..old }.remove_files(target)?;
    for file in &new.files {
        let to = target.join(file);
        if let Some(folder) = to.parent() {
            fs::create_dir_all(folder)?;
        }
        fs::rename(partial.join(file), to)?;
    }
    fs::rename(partial.join(MARKER), target.join(MARKER))?;
    // Nothing but empty folders is left.
    let _ = fs::remove_dir_all(partial);
    Ok(())
}
