//! A folder of results that stays between calls and is filled run by run: that of a sweep.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::folder::taken;
use super::leftovers::{self, PARTIAL, lock_of, parent_of, temporary_beside};
use super::lock::{Lock, Refused, Share};
use super::marker::{MARKER, Marker, RunKind};
use super::pending::Pending;
use super::place::folder_for;
use super::write_file;
use crate::error::{Error, Result};
use crate::input::Provenance;

/// The folder, locked while this lives.
#[derive(Debug)]
pub struct StandingFolder {
    target: PathBuf,
    _lock: Lock,
}

impl StandingFolder {
    /// Opens the folder of an earlier call, or makes one with `marker` and these files.
    pub fn open(path: &Path, marker: &Marker, read: &Provenance, share: Share, first: &[(&str, Vec<u8>)]) -> Result<Self> {
        let cannot = |error| Error::file(path, "cannot create the folder", error);
        let target = folder_for(path, marker.kind, read)?;
        fs::create_dir_all(parent_of(&target)).map_err(cannot)?;
        // Where the parent takes no new names the lock lies within.
        let lock = match Lock::take(&lock_of(&target), share) {
            Err(Refused::Impossible(_)) if target.is_dir() => Lock::take(&lock_of(&target.join("perilife")), share),
            lock => lock,
        };
        let lock = lock.map_err(|refused| match refused {
            Refused::Impossible(error) => cannot(error),
            Refused::Taken(holder) => taken("--out", path, &holder),
        })?;
        if share == Share::Alone {
            leftovers::remove_beside(&target, &lock);
        }
        if !target.join(MARKER).is_file() {
            begin(path, &target, marker, first)?;
        }
        // It may have changed while it was not locked.
        folder_for(path, marker.kind, read)?;
        Ok(StandingFolder { target, _lock: lock })
    }

    /// Takes part in a folder that is there.
    ///
    /// # Errors
    /// [`Error::Input`] if a process has it alone; [`Error::File`].
    pub fn join(path: &Path) -> Result<Self> {
        let cannot = |error| Error::file(path, "cannot use this folder", error);
        let target = fs::canonicalize(path).map_err(cannot)?;
        let lock = Lock::take(&lock_of(&target), Share::Parts).map_err(|refused| match refused {
            Refused::Impossible(error) => cannot(error),
            Refused::Taken(holder) => taken("DIR", path, &holder),
        })?;
        Ok(StandingFolder { target, _lock: lock })
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.target
    }
}

/// Makes the folder, whole from the first moment on.
fn begin(name: &Path, target: &Path, marker: &Marker, first: &[(&str, Vec<u8>)]) -> Result<()> {
    let cannot = |error| Error::file(name, "cannot create the folder", error);
    let fill = |folder: &Path| -> Result<()> {
        first.iter().try_for_each(|(file, content)| write_file(&folder.join(file), content))?;
        write_file(&folder.join(MARKER), marker.text().as_bytes())
    };
    if target.is_dir() {
        return fill(target);
    }
    let partial = temporary_beside(target, PARTIAL);
    let (_pending, ()) = Pending::tree_by(&partial, || fs::create_dir(&partial)).map_err(cannot)?;
    let done = fill(&partial).and_then(|()| match fs::rename(&partial, target) {
        // Another part was first.
        Err(error) if matches!(error.kind(), io::ErrorKind::DirectoryNotEmpty | io::ErrorKind::AlreadyExists) => Ok(()),
        renamed => renamed.map_err(cannot),
    });
    let _ = fs::remove_dir_all(&partial);
    done
}

/// The marker of a folder of this kind whose files are known by name; folders of other runs end in `/`.
impl Marker {
    /// Of a folder that will hold these.
    pub fn listing(kind: RunKind, files: &[&str]) -> Marker {
        Marker { kind, files: files.iter().map(|file| (*file).to_owned()).collect() }
    }
}
