//! Where an output may be: links followed, nobody else's files touched, checked before anything is computed.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::marker::{MARKER, Marker, RunKind};
use super::staging::parent_of;
use perilife_base::error::{Error, Result, input};
use perilife_base::input::{Provenance, STREAM};

/// Bytes that a run will write, roughly.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Room {
    /// Its tables and figures, without which there is no result.
    pub tables: u64,
    pub all: u64,
}

/// A path with its links followed, also through one that points to nothing yet; of what is not there the part that is made absolute.
pub(super) fn resolved(path: &Path) -> io::Result<PathBuf> {
    let parent = parent_of(path);
    match fs::canonicalize(path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => match (fs::read_link(path), path.file_name()) {
            // The system has followed it, so that links end.
            (Ok(to), _) => resolved(&parent.join(to)),
            (Err(_), Some(name)) if parent != path => Ok(resolved(&parent)?.join(name)),
            // `a/..` below a folder that is to be made: as the system takes it.
            _ => Ok(path.to_path_buf()),
        },
        found => found,
    }
}

/// The folder behind `path`, if a run of this kind may have it: new, empty, or that of an earlier run and nothing else in it.
pub(super) fn folder_for(path: &Path, kind: RunKind, read: &Provenance) -> Result<PathBuf> {
    let refuse = |problem: &str, remedy: &str| Err(input("--out", path.display(), problem, remedy));
    let (a_folder, below) = ("give the name of a folder", "give a folder below it");
    if path == Path::new(STREAM) {
        return refuse("is standard output, and a run has many files", "give the name of a folder, or ./- for one of that name");
    }
    let target = resolved(path).map_err(|error| Error::file(path, "cannot use this folder", error))?;
    match () {
        () if path.as_os_str().is_empty() => return refuse("is empty", a_folder),
        () if target.exists() && !target.is_dir() => return refuse("is a file", a_folder),
        () if target.file_name().is_none() || std::env::current_dir().is_ok_and(|here| here.starts_with(&target)) => {
            return refuse("is the current folder or one above it", below);
        }
        () if target.is_dir() && is_mounted(&target) => return refuse("is a mount point, which no result can replace", below),
        () => {}
    }
    let is_below = |path: &&PathBuf| fs::canonicalize(path).is_ok_and(|real| real.starts_with(&target));
    if let Some(file) = read.files.iter().filter_map(|file| file.path.as_ref()).find(is_below) {
        let problem = format!("contains an input of this run, {}", file.display());
        return refuse(&problem, "give another folder for the results, or move the input out of it");
    }
    match occupied(&target, kind).map_err(|error| Error::file(path, "cannot read the folder", error))? {
        Some((problem, remedy)) => refuse(&problem, remedy),
        None => Ok(target),
    }
}

/// Why a folder must not be replaced by a run of this kind, and what to do.
pub(super) fn occupied(target: &Path, kind: RunKind) -> io::Result<Option<(String, &'static str)>> {
    let remove_it = "give a new or empty folder, or remove this one yourself";
    let earlier = Marker::read(target);
    if earlier.is_none() && target.join(MARKER).is_file() {
        return Ok(Some(("contains results whose marker is damaged or of another version".to_owned(), remove_it)));
    }
    if let Some(other) = earlier.as_ref().filter(|marker| marker.kind != kind) {
        let problem = format!("contains {}, which {} never replaces", other.kind.meaning(), kind.meaning());
        return Ok(Some((problem, remove_it)));
    }
    let remedy = if earlier.is_none() { remove_it } else { "give a new or empty folder, or move it out of this one" };
    let foreign = earlier.unwrap_or_else(|| Marker::listing(kind, &[])).first_foreign(target)?;
    let named = |path: PathBuf| format!("contains other files ({})", path.strip_prefix(target).unwrap_or(&path).display());
    Ok(foreign.map(|path| (named(path), remedy)))
}

/// Whether something is mounted at a folder, which can be filled but not replaced.
fn is_mounted(folder: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let device = |path: &Path| fs::metadata(path).map(|there| there.dev());
    let is_other = matches!((device(folder), device(&parent_of(folder))), (Ok(own), Ok(above)) if own != above);
    // A folder that is mounted from elsewhere on the same disk; spaces are written in octal.
    let mounts = fs::read_to_string("/proc/self/mountinfo").unwrap_or_default();
    let name = folder.to_string_lossy().replace('\\', "\\134").replace(' ', "\\040").replace('\t', "\\011");
    is_other || mounts.lines().any(|line| line.split(' ').nth(4) == Some(&*name))
}

/// Refuses a place without room for the tables of a run; what is to be said of one without room for all of it.
pub(super) fn room(name: &Path, folder: &Path, wanted: Room) -> Result<Option<String>> {
    // A file system that does not say is taken as large enough.
    let Ok(there) = rustix::fs::statvfs(folder) else { return Ok(None) };
    let free = there.f_bavail.saturating_mul(there.f_frsize);
    let words = |bytes: u64| format!("{:.1} MB", bytes as f64 / 1e6);
    if free < wanted.tables {
        let why = format!("{} are free there, and the tables of the run take about {}", words(free), words(wanted.tables));
        return Err(Error::file(name, "not enough disk space", io::Error::new(io::ErrorKind::StorageFull, why)));
    }
    Ok((free < wanted.all).then(|| {
        let [free, all] = [free, wanted.all].map(words);
        format!("{}: {free} are free there, and the run may write {all}: its tables come first", name.display())
    }))
}
