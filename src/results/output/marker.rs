//! The marker of a folder of results: of which kind they are, and which files are theirs.

use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::staging::{MARKER, is_temporary, names};
use perilife_base::input::Provenance;

perilife_base::kinds! {
    /// What made a folder.
    pub enum RunKind for "kind" {
        Predict = "predict": "a prediction",
        Fracture = "fracture": "a fracture scene",
        Sif = "sif": "stresses of a plate",
        Calibrate = "calibrate": "a calibration",
        Sweep = "sweep": "a sweep",
        SweepCase = "sweep_case": "a case of a sweep",
        Verify = "verify": "a verification",
        Validate = "validate": "a validation",
        Chart = "chart": "a speed-accuracy chart",
        Stability = "stability": "a map of stability",
    }
}

/// The input file of a run: where it is, and what it contains.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct InputOf {
    /// Absolute path; the name of a stream.
    pub file: String,
    pub sha256: String,
}

impl InputOf {
    /// Of the first file that was read.
    pub fn of(read: &Provenance) -> Option<Self> {
        let first = read.files.first()?;
        let path = first.path.as_ref().and_then(|path| fs::canonicalize(path).ok());
        let file = path.map_or_else(|| first.name.clone(), |path| path.display().to_string());
        Some(InputOf { file, sha256: first.sha256() })
    }
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Marker {
    /// What made the folder.
    pub kind: RunKind,
    /// The input that it was made of, where that was one file.
    pub input: Option<InputOf>,
    /// Files by their path in the folder; a name that ends in `/` is a folder of other runs, each of which has a marker of its own.
    #[serde(default)]
    pub files: BTreeSet<String>,
}

impl Marker {
    /// The marker of a folder; `None` where there is none, or one that cannot be read.
    pub fn read(folder: &Path) -> Option<Marker> {
        toml::from_str(&fs::read_to_string(folder.join(MARKER)).ok()?).ok()
    }

    /// The marker of a folder that will hold these; names of folders of other runs end in `/`.
    pub fn listing(kind: RunKind, files: &[&str]) -> Marker {
        Marker { kind, input: None, files: files.iter().map(|file| (*file).to_owned()).collect() }
    }

    /// The file of another input that a folder was made of: another file, changed or not, that is no copy of the first.
    pub fn other_input(&self, input: Option<&InputOf>) -> Option<&str> {
        let (own, new) = self.input.as_ref().zip(input)?;
        (own.file != new.file && own.sha256 != new.sha256).then_some(&*own.file)
    }

    pub fn text(&self) -> String {
        let version = env!("CARGO_PKG_VERSION");
        let head = format!("# Written by perilife {version}. The next run of this kind replaces only these files.\n");
        // Names and text always have a form in TOML.
        head + &toml::to_string(self).unwrap_or_default()
    }

    /// The first thing in `folder` that is not this run's, in the order of names.
    pub fn first_foreign(&self, folder: &Path) -> io::Result<Option<PathBuf>> {
        let mut first = None;
        self.walk(folder, "", &mut |path, is_own| {
            if !is_own {
                first.get_or_insert(path.to_path_buf());
            }
            Ok(())
        })?;
        Ok(first)
    }

    /// Removes the files of this run from a folder, and the folders that are empty then.
    pub fn remove_from(&self, folder: &Path) -> io::Result<()> {
        self.walk(folder, "", &mut |path, is_own| match fs::symlink_metadata(path) {
            Ok(there) if is_own && !there.is_dir() => fs::remove_file(path),
            Ok(_) if is_own => {
                // One that something else is in stays.
                let _ = fs::remove_dir(path);
                Ok(())
            }
            _ => Ok(()),
        })
    }

    /// Shows each thing in `folder`, what is in a folder before the folder, and whether it is of this run.
    fn walk(&self, folder: &Path, prefix: &str, see: &mut dyn FnMut(&Path, bool) -> io::Result<()>) -> io::Result<()> {
        for name in names(folder)? {
            let (path, own) = (folder.join(&name), format!("{prefix}{name}"));
            let within = format!("{own}/");
            let is_folder = fs::symlink_metadata(&path)?.is_dir();
            let is_own = if is_temporary(&name) {
                continue;
            } else if !is_folder {
                name == MARKER && prefix.is_empty() || self.files.contains(&own)
            } else if self.files.contains(&within) {
                walk_runs(&path, see)?;
                true
            } else if self.files.iter().any(|file| file.starts_with(&within)) {
                self.walk(&path, &within, see)?;
                true
            } else {
                false
            };
            see(&path, is_own)?;
        }
        Ok(())
    }
}

/// The same of a folder of runs: each run's own marker says what is its.
fn walk_runs(folder: &Path, see: &mut dyn FnMut(&Path, bool) -> io::Result<()>) -> io::Result<()> {
    if let Some(marker) = Marker::read(folder) {
        return marker.walk(folder, "", see);
    }
    for name in names(folder)?.into_iter().filter(|name| !is_temporary(name) && !name.ends_with(".log")) {
        let path = folder.join(&name);
        let is_folder = fs::symlink_metadata(&path)?.is_dir();
        if is_folder {
            walk_runs(&path, see)?;
        }
        see(&path, is_folder)?;
    }
    Ok(())
}

/// Files of a folder by their path in it, all but its marker.
pub(super) fn files_in(folder: &Path, prefix: &str) -> io::Result<BTreeSet<String>> {
    let mut files = BTreeSet::new();
    for name in names(folder)?.into_iter().filter(|name| name != MARKER) {
        let path = folder.join(&name);
        if path.is_dir() {
            files.append(&mut files_in(&path, &format!("{prefix}{name}/"))?);
        } else {
            files.insert(format!("{prefix}{name}"));
        }
    }
    Ok(files)
}
