//! The marker of a folder of results: of which kind they are, and which files are theirs.

use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::leftovers::is_temporary;

/// File that marks a folder as made by this program.
pub const MARKER: &str = ".perilife";

/// What made a folder.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RunKind {
    /// `perilife predict`.
    Predict,
    /// `perilife fracture`.
    Fracture,
    /// `perilife sif`.
    Sif,
    /// `perilife calibrate`.
    Calibrate,
    /// `perilife sweep`.
    Sweep,
    /// A case of a sweep.
    SweepCase,
    /// `perilife verify`.
    Verify,
    /// `perilife chart`.
    Chart,
    /// `perilife stability`.
    Stability,
}

impl RunKind {
    /// In words.
    pub fn words(self) -> &'static str {
        match self {
            RunKind::Predict => "a prediction",
            RunKind::Fracture => "a fracture scene",
            RunKind::Sif => "stresses of a plate",
            RunKind::Calibrate => "a calibration",
            RunKind::Sweep => "a sweep",
            RunKind::SweepCase => "a case of a sweep",
            RunKind::Verify => "a verification",
            RunKind::Chart => "a speed-accuracy chart",
            RunKind::Stability => "a map of stability",
        }
    }
}

/// Content of the marker.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Marker {
    /// What made the folder.
    pub kind: RunKind,
    /// Files by their path in the folder; a name that ends in `/` is a folder of other runs, each of which has a marker of its own.
    #[serde(default)]
    pub files: BTreeSet<String>,
}

impl Marker {
    /// The marker of a folder; `None` where there is none, or one that lists no files.
    pub fn read(folder: &Path) -> Option<Marker> {
        toml::from_str(&fs::read_to_string(folder.join(MARKER)).ok()?).ok()
    }

    /// A marker that lists all that a folder holds now.
    pub fn of(kind: RunKind, folder: &Path) -> io::Result<Marker> {
        let mut files = BTreeSet::new();
        list(folder, "", &mut files)?;
        Ok(Marker { kind, files })
    }

    /// As it is written.
    ///
    /// # Panics
    /// Never: names and text always have a form in TOML.
    pub fn text(&self) -> String {
        let version = env!("CARGO_PKG_VERSION");
        let head =
            format!("# Made by perilife {version}. The next run of this kind replaces the files listed here, and no others.\n");
        head + &toml::to_string(self).unwrap_or_default()
    }

    /// Whether a path in the folder is the marker or listed.
    pub fn has(&self, path: &str) -> bool {
        path == MARKER || self.files.contains(path)
    }

    /// The first thing in `folder` that is not this run's, in the order of names; below folders of other runs their own markers count.
    ///
    /// # Errors
    /// A folder that cannot be read.
    pub fn first_foreign(&self, folder: &Path) -> io::Result<Option<PathBuf>> {
        self.foreign_below(folder, "")
    }

    fn foreign_below(&self, folder: &Path, prefix: &str) -> io::Result<Option<PathBuf>> {
        for name in names(folder)? {
            let (path, own) = (folder.join(&name), format!("{prefix}{name}"));
            let as_folder = format!("{own}/");
            let is_folder = fs::symlink_metadata(&path)?.is_dir();
            let foreign = if is_temporary(&name) || !is_folder && self.has(&own) {
                None
            } else if is_folder && self.files.contains(&as_folder) {
                foreign_in_runs(&path)?
            } else if is_folder && self.files.iter().any(|file| file.starts_with(&as_folder)) {
                self.foreign_below(&path, &as_folder)?
            } else {
                Some(path)
            };
            if foreign.is_some() {
                return Ok(foreign);
            }
        }
        Ok(None)
    }

    /// Removes the files of this run from a folder, and the folders that are empty then.
    pub fn remove_from(&self, folder: &Path) -> io::Result<()> {
        self.remove_files(folder)?;
        gone(fs::remove_file(folder.join(MARKER)))
    }

    /// The same, but for the marker itself.
    pub(super) fn remove_files(&self, folder: &Path) -> io::Result<()> {
        for file in &self.files {
            let path = folder.join(file);
            if file.ends_with('/') {
                remove_runs(&path)?;
            } else {
                gone(fs::remove_file(&path))?;
            }
            let above = Path::new(file).ancestors().skip(1).take_while(|above| !above.as_os_str().is_empty());
            // What holds something else stays.
            above.for_each(|above| drop(fs::remove_dir(folder.join(above))));
        }
        Ok(())
    }
}

/// The same for a folder of runs: each run's own marker says what is its.
fn foreign_in_runs(folder: &Path) -> io::Result<Option<PathBuf>> {
    if let Some(marker) = Marker::read(folder) {
        return marker.first_foreign(folder);
    }
    for name in names(folder)? {
        let path = folder.join(&name);
        let foreign = match () {
            () if is_temporary(&name) || name.ends_with(".log") => None,
            () if path.is_dir() => foreign_in_runs(&path)?,
            () => Some(path),
        };
        if foreign.is_some() {
            return Ok(foreign);
        }
    }
    Ok(None)
}

fn remove_runs(folder: &Path) -> io::Result<()> {
    match Marker::read(folder) {
        Some(marker) => marker.remove_from(folder)?,
        None if folder.is_dir() => {
            for name in names(folder)? {
                remove_runs(&folder.join(name))?;
            }
        }
        None => {}
    }
    let _ = fs::remove_dir(folder);
    Ok(())
}

/// A file that was not there is as good as removed.
pub(super) fn gone(removed: io::Result<()>) -> io::Result<()> {
    match removed {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}

/// Names in a folder, sorted; none of one that is not there.
fn names(folder: &Path) -> io::Result<Vec<String>> {
    let entries = match fs::read_dir(folder) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
        entries => entries?,
    };
    let mut names: Vec<String> =
        entries.map(|entry| Ok(entry?.file_name().to_string_lossy().into_owned())).collect::<io::Result<_>>()?;
    names.sort();
    Ok(names)
}

fn list(folder: &Path, prefix: &str, files: &mut BTreeSet<String>) -> io::Result<()> {
    for name in names(folder)?.into_iter().filter(|name| name != MARKER) {
        let path = folder.join(&name);
        if path.is_dir() {
            list(&path, &format!("{prefix}{name}/"), files)?;
        } else {
            files.insert(format!("{prefix}{name}"));
        }
    }
    Ok(())
}
