//! Where an output may stand: links followed, nobody else's files touched, tried before anything is computed.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::marker::{MARKER, Marker, RunKind, parent_of};
use perilife_base::error::{Error, Result, input};
use perilife_base::input::{FileId, Provenance};

/// Bytes that a run will write, roughly.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Room {
    /// Its tables and figures, without which there is no result.
    pub tables: u64,
    pub all: u64,
}

/// A path with its links followed, also through one that points to nothing yet.
pub(super) fn resolved(path: &Path) -> io::Result<PathBuf> {
    let mut path = path.to_path_buf();
    // As many as the system follows.
    for _ in 0..40 {
        match fs::canonicalize(&path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => match fs::read_link(&path) {
                Ok(to) => path = parent_of(&path).join(to),
                Err(_) => return Ok(below_what_is_there(&path)),
            },
            found => return found,
        }
    }
    fs::canonicalize(&path)
}

/// A path that is not there with the part of it that is there made absolute.
fn below_what_is_there(path: &Path) -> PathBuf {
    let parent = parent_of(path);
    let Some(name) = path.file_name() else { return path.to_path_buf() };
    match fs::canonicalize(&parent) {
        Ok(parent) => parent.join(name),
        // `a/../b` below a folder that is to be made: as the system takes it.
        Err(_) if parent.file_name().is_some() && parent != path => below_what_is_there(&parent).join(name),
        Err(_) => path.to_path_buf(),
    }
}

/// The folder behind `path`, if a run of this kind may have it: new, empty, or that of an earlier run and nothing else in it.
pub(super) fn folder_for(path: &Path, kind: RunKind, read: &Provenance) -> Result<PathBuf> {
    let refuse = |problem: &str, remedy: &str| Err(input("--out", path.display(), problem, remedy));
    if path.as_os_str().is_empty() {
        return refuse("is empty", "give the name of a folder");
    }
    if path == Path::new(perilife_base::input::STREAM) {
        return refuse("is standard output, and a run has many files", "give the name of a folder, or ./- for one of that name");
    }
    let target = resolved(path).map_err(|e| Error::file(path, "cannot use this folder", e))?;
    if target.exists() && !target.is_dir() {
        return refuse("is a file", "give the name of a folder");
    }
    if target.file_name().is_none() || std::env::current_dir().is_ok_and(|here| here.starts_with(&target)) {
        return refuse("is the current folder or one above it", "give a folder below it");
    }
    if target.is_dir() && is_mounted(&target) {
        return refuse("is a mount point, which results that are whole cannot replace", "give a folder below it");
    }
    let is_below = |path: &&PathBuf| fs::canonicalize(path).is_ok_and(|real| real.starts_with(&target));
    if let Some(file) = read.files.iter().filter_map(|file| file.path.as_ref()).find(is_below) {
        let problem = format!("holds an input of this run, {}", file.display());
        return refuse(&problem, "give another folder for the results, or move the input out of it");
    }
    match occupied(&target, kind).map_err(|e| Error::file(path, "cannot read the folder", e))? {
        Some((problem, remedy)) => refuse(&problem, remedy),
        None => Ok(target),
    }
}

/// Why a folder must not be replaced by a run of this kind, and what to do.
pub(super) fn occupied(target: &Path, kind: RunKind) -> io::Result<Option<(String, &'static str)>> {
    const ELSEWHERE: &str = "give a new or empty folder, or remove this one yourself";
    const MOVE_IT: &str = "give a new or empty folder, or move it out of this one";
    let Some(marker) = Marker::read(target) else {
        let problem = if target.join(MARKER).is_file() {
            "holds results whose files no list names, of another version of this program or damaged".to_owned()
        } else {
            let Some(first) = Marker::listing(kind, &[]).first_foreign(target)? else { return Ok(None) };
            format!("holds files that this program did not make, {} for one", name_in(target, &first))
        };
        return Ok(Some((problem, ELSEWHERE)));
    };
    if marker.kind != kind {
        let problem = format!("holds {}, which {} does not replace", marker.kind.words(), kind.words());
        return Ok(Some((problem, ELSEWHERE)));
    }
    let foreign = marker.first_foreign(target)?;
    Ok(foreign.map(|path| (format!("holds {}, which this program did not make", name_in(target, &path)), MOVE_IT)))
}

fn name_in(folder: &Path, path: &Path) -> String {
    path.strip_prefix(folder).unwrap_or(path).display().to_string()
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
    // A file system that does not tell is taken as large enough.
    let Ok(there) = rustix::fs::statvfs(folder) else { return Ok(None) };
    let free = there.f_bavail.saturating_mul(there.f_frsize);
    let words = |bytes: u64| format!("{:.1} MB", bytes as f64 / 1e6);
    if free < wanted.tables {
        let why = format!("{} are free there, and the tables of the run take about {}", words(free), words(wanted.tables));
        return Err(Error::file(name, "has too little room", io::Error::new(io::ErrorKind::StorageFull, why)));
    }
    Ok((free < wanted.all).then(|| {
        let [free, all] = [free, wanted.all].map(words);
        format!("{}: {free} are free there, and the run may write {all}: its tables come first", name.display())
    }))
}

/// Whether a file was read, by whatever name.
pub(super) fn was_read(there: &fs::Metadata, read: &Provenance) -> bool {
    read.files.iter().any(|file| file.id == Some(FileId::of(there)))
}
