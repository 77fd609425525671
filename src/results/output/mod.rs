//! Output that is whole or absent, and touches nothing of anybody else: the one guard of whatever a command writes.
//!
//! A folder of results ([`OutputFolder`]) is made under a temporary name and published at the end. Its marker ([`Marker`], file
//! `.perilife`) says of which kind the run is and which files are its own; a later run of the same kind replaces those and refuses
//! to begin where there is anything else, an input of its own above all. The same is checked again at the end, of the folder as it is
//! then. A single file ([`OutputFile`]) replaces only one with the sign of the same command, and never one that was read. Who
//! writes takes a lock, so that two never write one place, and what a killed process left behind is recognized.

mod folder;
mod staging;

use std::collections::BTreeSet;
use std::fs;
use std::io::{self, Read as _, Write as _};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::output::staging::{Lock, Staging, names, resolved, visible_beside};
pub use folder::{LockedFolder, OutputFolder, Room};
use perilife_base::columns::Table;
use perilife_base::error::{Error, Result, input};
use perilife_base::input::{FileId, Provenance, STREAM};
use perilife_base::units::us::{System, renamed};
pub use staging::{MARKER, Share, fold_up, is_temporary};

/// Writes a table into a folder in the making, in the units that are shown.
pub fn write_table(folder: &Path, table: &Table) -> Result<()> {
    write_file(&folder.join(&table.file), table.csv().as_bytes())
}

/// Writes a result into a folder in the making, in the units that are shown.
pub fn write_json(folder: &Path, name: &str, result: &impl Serialize) -> Result<()> {
    write_file(&folder.join(name), format!("{:#}\n", super::format::written_result(&serde_json::json!(result))).as_bytes())
}

fn said(error: Error, more: &str) -> Error {
    match error {
        Error::Input(mut trouble) => {
            trouble.remedy = format!("{}; {more}", trouble.remedy);
            Error::Input(trouble)
        }
        Error::File { path, action, source } => {
            Error::File { path, action, source: std::io::Error::new(source.kind(), format!("{source}; {more}")) }
        }
        other => Error::Mechanics(format!("{other}; {more}")),
    }
}

const HEAD: u64 = 1024;

/// What a command writes, and how it recognizes its own.
#[derive(Debug, Clone, Copy)]
pub struct Sort {
    pub option: &'static str,
    /// Text near its beginning, and in no other file.
    pub sign: &'static [u8],
}

#[derive(Debug)]
pub struct OutputFile {
    /// As given by the user.
    name: PathBuf,
    sort: Sort,
    /// Its place; none of standard output, a device or a pipe, which are written to: renaming would put a file in their place.
    target: Option<(PathBuf, Lock)>,
}

impl OutputFile {
    /// Claims `path`, before anything is computed; `-` is standard output.
    /// Errors: [`Error::Input`] if it is a folder, a file that was read, one that this command did not write, or one that another
    /// process is at; [`Error::File`] if nothing can be written there.
    pub fn claim(path: &Path, sort: Sort, read: &Provenance) -> Result<OutputFile> {
        let claimed = |target| Ok(OutputFile { name: path.to_path_buf(), sort, target });
        // A pipe behind /dev/stdout has no path of its own.
        if path == Path::new(STREAM) || fs::metadata(path).is_ok_and(|there| !there.is_dir() && !there.is_file()) {
            return claimed(None);
        }
        let refuse = |problem: &str, remedy: &str| Err(input(sort.option, path.display(), problem, remedy));
        let target = resolved(path).map_err(|error| Error::file(path, "cannot write", error))?;
        let there = fs::metadata(&target).ok();
        if path.file_name().is_none() || there.as_ref().is_some_and(fs::Metadata::is_dir) {
            return refuse("is a folder", "give the name of a file");
        }
        if there.is_some_and(|there| read.files.iter().any(|file| file.id == Some(FileId::of(&there)))) {
            return refuse("is a file that this command reads", "give another name");
        }
        if !is_own(&target, sort)? {
            return refuse("is a file that this command did not write", "give a new name, or remove it yourself");
        }
        let lock = Lock::of(sort.option, path, "cannot write", &target, Share::Alone)?;
        claimed(Some((target, lock)))
    }

    /// Whether it will be a file, of which something can be said on standard output.
    pub fn is_file(&self) -> bool {
        self.target.is_some()
    }

    /// Writes it whole or not at all.
    /// Errors: [`Error::File`] if it cannot be written; if somebody else's file has appeared there meanwhile, that stays, and the
    /// message says under what name this one is.
    pub fn write(self, bytes: &[u8]) -> Result<()> {
        let done = match &self.target {
            None if self.name == Path::new(STREAM) => {
                let mut stdout = io::stdout().lock();
                match stdout.write_all(bytes).and_then(|()| stdout.flush()) {
                    Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
                    written => written,
                }
            }
            None => fs::write(&self.name, bytes),
            Some((target, _)) if target.is_dir() || !is_own(target, self.sort)? => {
                let other = visible_beside(target);
                write_file(&other, bytes)?;
                let why = format!("the target appeared meanwhile and was kept; the result is in {}", other.display());
                Err(io::Error::other(why))
            }
            Some((target, _)) => write_whole(target, bytes, false),
        };
        self.named("cannot write", done)
    }

    /// Writes it whole or not at all, again and again; it stays whole if the machine stops, and stays as it was if this fails.
    pub fn rewrite(&self, bytes: &[u8]) -> Result<()> {
        self.named("cannot write", write_whole(self.own_target()?, bytes, true))
    }

    /// Removes it, if it is there: what it was for is done.
    pub fn remove(self) -> Result<()> {
        match fs::remove_file(self.own_target()?) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
            removed => self.named("cannot remove", removed),
        }
    }

    /// Its place, if nothing else has appeared there.
    fn own_target(&self) -> Result<&Path> {
        match &self.target {
            Some((target, _)) if is_own(target, self.sort)? => Ok(target),
            _ => Err(Error::file(&self.name, "cannot write", io::Error::other("the target appeared meanwhile and was kept"))),
        }
    }

    fn named<T>(&self, action: &'static str, done: io::Result<T>) -> Result<T> {
        done.map_err(|error| Error::file(&self.name, action, error))
    }
}

/// Whether nothing is there, or nothing but what this command wrote.
fn is_own(target: &Path, sort: Sort) -> Result<bool> {
    let mut head = Vec::new();
    match fs::File::open(target).and_then(|file| file.take(HEAD).read_to_end(&mut head)) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(true),
        Err(error) => Err(Error::file(target, "cannot read", error)),
        Ok(_) => {
            let is_signed = |head: &[u8]| head.windows(sort.sign.len()).any(|part| part == sort.sign);
            // The header of a table in US units is that of the same table.
            Ok(head.is_empty() || is_signed(&head) || is_signed(metric_header(&head).as_bytes()))
        }
    }
}

/// The first line of a table, its columns in metric units.
fn metric_header(head: &[u8]) -> String {
    let text = String::from_utf8_lossy(head);
    let columns = text.lines().next().unwrap_or_default().split(',');
    let metric = |column: &str| renamed(column, System::Si).map_or_else(|| column.to_owned(), |new| new.name);
    columns.map(metric).collect::<Vec<_>>().join(",") + "\n"
}

/// Writes a single file whole or not at all; what was there before stays if that fails. For files of a folder in the making; what a user
/// names is an [`OutputFile`].
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<()> {
    if path.is_dir() || path.file_name().is_none() {
        return Err(input("--out", path.display(), "is a folder", "give the name of a file"));
    }
    write_whole(path, bytes, false).map_err(|error| Error::file(path, "cannot write", error))
}

/// Writes under a temporary name beside its place and publishes that; `synced` has the bytes on the disk before.
fn write_whole(path: &Path, bytes: &[u8], synced: bool) -> io::Result<()> {
    // A link keeps pointing where it points: the file behind it is replaced.
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
    if fs::metadata(&target).is_ok_and(|there| !there.is_file()) {
        return fs::write(path, bytes);
    }
    let (staging, mut file) = Staging::file_beside(&target)?;
    file.write_all(bytes)?;
    if synced {
        file.sync_all()?;
    }
    staging.publish(&target)
}

perilife_base::kinds! {
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
    pub fn of(read: &Provenance) -> Option<Self> {
        let first = read.files.first()?;
        let path = first.path.as_ref().and_then(|path| fs::canonicalize(path).ok());
        let file = path.map_or_else(|| first.name.clone(), |path| path.display().to_string());
        Some(InputOf { file, sha256: first.sha256() })
    }
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Marker {
    pub kind: RunKind,
    pub input: Option<InputOf>,
    /// Files by their path in the folder; a name that ends in `/` is a folder of other runs, each of which has a marker of its own.
    #[serde(default)]
    pub files: BTreeSet<String>,
}

impl Marker {
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
