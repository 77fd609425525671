//! The marker of a folder of results: of which kind they are, and which files are theirs; and names that this program gives for a while.

use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use serde::{Deserialize, Serialize};

use perilife_base::input::Provenance;

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
    SweepCase,
    /// `perilife verify`.
    Verify,
    /// `perilife validate`.
    Validate,
    /// `perilife chart`.
    Chart,
    /// `perilife stability`.
    Stability,
}

impl RunKind {
    pub fn words(self) -> &'static str {
        match self {
            RunKind::Predict => "a prediction",
            RunKind::Fracture => "a fracture scene",
            RunKind::Sif => "stresses of a plate",
            RunKind::Calibrate => "a calibration",
            RunKind::Sweep => "a sweep",
            RunKind::SweepCase => "a case of a sweep",
            RunKind::Verify => "a verification",
            RunKind::Validate => "a validation",
            RunKind::Chart => "a speed-accuracy chart",
            RunKind::Stability => "a map of stability",
        }
    }
}

/// The input file of a run: where it is, and what it holds.
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

    /// Whether a run of one may take the place of that of the other: the same file, changed or not, or a copy of it.
    fn is_alike(&self, other: &InputOf) -> bool {
        self.file == other.file || self.sha256 == other.sha256
    }
}

/// Content of the marker.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Marker {
    /// What made the folder.
    pub kind: RunKind,
    /// The input that it was made of, where that was one file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub input: Option<InputOf>,
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
        Ok(Marker { kind, input: None, files })
    }

    /// The marker of a folder that will hold these; names of folders of other runs end in `/`.
    pub fn listing(kind: RunKind, files: &[&str]) -> Marker {
        Marker { kind, input: None, files: files.iter().map(|file| (*file).to_owned()).collect() }
    }

    /// The file of another input that a folder was made of.
    pub fn other_input(&self, input: Option<&InputOf>) -> Option<&str> {
        let (own, new) = self.input.as_ref().zip(input)?;
        (!own.is_alike(new)).then_some(&*own.file)
    }

    pub fn text(&self) -> String {
        let version = env!("CARGO_PKG_VERSION");
        let head =
            format!("# Made by perilife {version}. The next run of this kind replaces the files listed here, and no others.\n");
        // Names and text always have a form in TOML.
        head + &toml::to_string(self).unwrap_or_default()
    }

    /// Whether a path in the folder is the marker or listed.
    pub fn has(&self, path: &str) -> bool {
        path == MARKER || self.files.contains(path)
    }

    /// The first thing in `folder` that is not this run's, in the order of names; below folders of other runs their own markers count.
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
        gone(fs::remove_file(folder.join(MARKER)))
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

/// What a name begun is called until it is whole.
pub(super) const PARTIAL: &str = "partial";
/// What an earlier result is called while the new one takes its place.
pub(super) const OLD: &str = "old";
const LOCK: &str = "lock";

/// The lock file of a name.
pub(super) fn lock_of(target: &Path) -> PathBuf {
    parent_of(target).join(format!(".{}.{LOCK}", name_of(target)))
}

/// Whether a name is one of those that this program gives for a while.
pub fn is_temporary(name: &str) -> bool {
    let Some((stem, end)) = name.strip_prefix('.').and_then(|rest| rest.rsplit_once('.')) else { return false };
    !stem.is_empty() && (end == LOCK || end == PARTIAL) || stem_of(name).is_some()
}

/// Whether this is what a name begun ends with: number of the process, and a count.
fn is_number(end: &str) -> bool {
    let is_digits = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    end.strip_prefix('-').and_then(|rest| rest.split_once('-')).is_some_and(|(a, b)| is_digits(a) && is_digits(b))
}

/// A name beside `target` that nobody else uses: hidden, with process number and a count.
pub(super) fn temporary_beside(target: &Path, what: &str) -> PathBuf {
    static COUNT: AtomicU64 = AtomicU64::new(0);
    loop {
        let count = COUNT.fetch_add(1, Ordering::Relaxed);
        let name = format!(".{}.{what}-{}-{count}", name_of(target), std::process::id());
        let candidate = parent_of(target).join(name);
        if fs::symlink_metadata(&candidate).is_err() {
            return candidate;
        }
    }
}

/// A visible name beside `target` that nothing has.
pub(super) fn visible_beside(target: &Path) -> PathBuf {
    let name = |count: usize| if count == 1 { String::new() } else { format!("-{count}") };
    let candidate = |count: usize| parent_of(target).join(format!("{}.result{}", name_of(target), name(count)));
    // There are always free names.
    (1..).map(candidate).find(|path| fs::symlink_metadata(path).is_err()).unwrap_or_default()
}

/// The name that a temporary name stands for, and whether it is that of an earlier result.
pub(super) fn stem_of(name: &str) -> Option<(&str, bool)> {
    let (stem, end) = name.strip_prefix('.')?.rsplit_once('.')?;
    let is = |what: &str| end.strip_prefix(what).is_some_and(is_number);
    (!stem.is_empty() && (is(PARTIAL) || is(OLD))).then(|| (stem, is(OLD)))
}

pub(super) fn name_of(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// The folder a path stands in; the current one for a bare name.
pub(super) fn parent_of(path: &Path) -> PathBuf {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent.to_path_buf(),
        _ => PathBuf::from("."),
    }
}
