//! Folders of results: that of a run, made beside its place and published when it is whole; that of a sweep, which stays between calls.

use std::path::{Path, PathBuf};
use std::{fs, io};

use super::staging::{Lock, MARKER, OLD, Share, Staging, all, parent_of, resolved, temporary_beside, visible_beside};
use super::{InputOf, Marker, RunKind, files_in, said, write_file};
use perilife_base::error::{Error, Result, input};
use perilife_base::input::{Provenance, STREAM};

const CANNOT_CREATE: &str = "cannot create the folder";

/// An output folder in the making, under a temporary name until [`OutputFolder::finish`]; dropped before that (an error, a panic) it leaves
/// nothing behind.
#[derive(Debug)]
pub struct OutputFolder {
    /// As given by the user.
    name: PathBuf,
    /// Without its files.
    marker: Marker,
    warning: Option<String>,
    // Goes before the folder that it is in.
    staging: Staging,
    place: LockedFolder,
}

/// A folder that is locked: nobody else writes there while this lives. That of a run in its place, or of a sweep, filled run by run.
#[derive(Debug)]
pub struct LockedFolder {
    target: PathBuf,
    // Its file may be in a new folder, which goes after it if nothing comes into it.
    _lock: Lock,
    _above: Vec<Staging>,
}

impl LockedFolder {
    /// Checks and locks the folder behind `path`, and makes what is above it.
    fn of(path: &Path, kind: RunKind, read: &Provenance, share: Share) -> Result<Self> {
        let target = folder_for(path, kind, read)?;
        let parent = parent_of(&target);
        let new: Vec<&Path> = parent.ancestors().take_while(|above| !above.as_os_str().is_empty() && !above.exists()).collect();
        let mut above: Vec<Staging> = new.into_iter().rev().map(Staging::above).collect();
        // The deepest goes first.
        above.reverse();
        fs::create_dir_all(&parent).map_err(|error| Error::file(path, CANNOT_CREATE, error))?;
        let lock = Lock::of("--out", path, CANNOT_CREATE, &target, share)?;
        // It may have changed while it was not locked.
        folder_for(path, kind, read)?;
        Ok(LockedFolder { target, _lock: lock, _above: above })
    }

    /// Opens the folder of an earlier call, or makes one with `marker` and these files.
    pub fn open(path: &Path, marker: &Marker, read: &Provenance, share: Share, first: &[(&str, Vec<u8>)]) -> Result<Self> {
        let folder = Self::of(path, marker.kind, read, share)?;
        let target = &folder.target;
        let fill = |folder: &Path| -> Result<()> {
            first.iter().try_for_each(|(file, content)| write_file(&folder.join(file), content))?;
            write_file(&folder.join(MARKER), marker.text().as_bytes())
        };
        if target.is_dir() && !target.join(MARKER).is_file() {
            fill(target)?;
        } else if !target.is_dir() {
            let cannot = |error| Error::file(path, CANNOT_CREATE, error);
            let staging = Staging::beside(target).map_err(cannot)?;
            fill(staging.path())?;
            match staging.publish(target) {
                // Another part was first.
                Err(error) if matches!(error.kind(), io::ErrorKind::DirectoryNotEmpty | io::ErrorKind::AlreadyExists) => {}
                published => published.map_err(cannot)?,
            }
        }
        Ok(folder)
    }

    pub fn join(path: &Path) -> Result<Self> {
        let action = "cannot use this folder";
        let target = fs::canonicalize(path).map_err(|error| Error::file(path, action, error))?;
        let lock = Lock::of("DIR", path, action, &target, Share::Parts)?;
        Ok(LockedFolder { target, _lock: lock, _above: Vec::new() })
    }

    pub fn path(&self) -> &Path {
        &self.target
    }

    /// Makes a folder of another run in it, by its name there, a part of this one.
    pub fn adopt(&self, run: &str) -> Result<()> {
        let Some(mut marker) = Marker::read(&self.target) else { return Ok(()) };
        marker.files.insert(format!("{run}/"));
        write_file(&self.target.join(MARKER), marker.text().as_bytes())
    }
}

impl OutputFolder {
    /// Claims `path` for a run that read nothing and writes little.
    pub fn create(path: &Path, kind: RunKind) -> Result<OutputFolder> {
        Self::claim(path, kind, &Provenance::default(), Room::default(), false)
    }

    /// Claims `path` for a run of this kind, before anything is computed. It may be new, empty, or the result of an earlier run of that
    /// kind, which stays until [`OutputFolder::finish`]; one of another input only by `force`. What killed processes left there goes.
    /// Errors: [`Error::Input`] if the path is a file, a mount point, has anything that this program did not make, results of another
    /// kind, of another input, or an input of this run, or if another process writes there; [`Error::File`] if it cannot be written
    /// or has no room.
    pub fn claim(path: &Path, kind: RunKind, read: &Provenance, wanted: Room, force: bool) -> Result<OutputFolder> {
        let marker = Marker { input: InputOf::of(read), ..Marker::listing(kind, &[]) };
        let place = LockedFolder::of(path, kind, read, Share::Alone)?;
        let earlier = Marker::read(&place.target).filter(|_| !force);
        if let Some(other) = earlier.as_ref().and_then(|earlier| earlier.other_input(marker.input.as_ref())) {
            let problem = format!("contains {} of another input, {other}", kind.meaning());
            return Err(input("--out", path.display(), problem, "give another folder, or --force to replace it"));
        }
        let cannot = |error| Error::file(path, CANNOT_CREATE, error);
        let staging = Staging::beside(&place.target).map_err(cannot)?;
        // Of a run that is killed the next one finds the marker.
        fs::write(staging.path().join(MARKER), marker.text()).map_err(cannot)?;
        let warning = room(path, &parent_of(&place.target), wanted)?;
        Ok(OutputFolder { name: path.to_path_buf(), marker, warning, staging, place })
    }

    pub fn path(&self) -> &Path {
        self.staging.path()
    }

    pub fn name(&self) -> &Path {
        &self.name
    }

    /// What the user should know of the place before the run.
    pub fn warning(&self) -> Option<&str> {
        self.warning.as_deref()
    }

    /// Writes these files by their names, and finishes.
    /// Errors: files that cannot be written.
    pub fn write(mut self, files: &[(&str, &str)]) -> Result<()> {
        self.fill(|path| files.iter().try_for_each(|(name, text)| write_file(&path.join(name), text.as_bytes())))?;
        self.finish().map(drop)
    }

    /// Has the files of the run written. If that fails, those that contain something stay under a visible name.
    pub fn fill<T>(&mut self, write: impl FnOnce(&Path) -> Result<T>) -> Result<T> {
        write(self.path()).map_err(|error| {
            let size = |file: &String| fs::metadata(self.path().join(file)).map_or(0, |there| there.len());
            if !files_in(self.path(), "").is_ok_and(|files| files.iter().any(|file| size(file) > 0)) {
                return error;
            }
            let place = self.show().map(|visible| format!("partial results are in {}", visible.display()));
            said(error, &place.unwrap_or_else(|reason| format!("partial results could not be saved: {reason}")))
        })
    }

    /// Publishes the folder; the files of an earlier run go, and nothing else.
    /// Errors: [`Error::File`] if it cannot be put there, or if something has appeared there meanwhile: that stays, and the
    /// results get a visible name, which the message says.
    pub fn finish(self) -> Result<LockedFolder> {
        let put = self.list().map_err(|error| error.to_string()).and_then(|()| self.put());
        if let Err(why) = put {
            let place = self.show().map(|visible| format!("results are in {}", visible.display()));
            let place = place.unwrap_or_else(|reason| format!("the results are lost: {reason}"));
            return Err(Error::file(&self.name, "cannot put the results in place", io::Error::other(format!("{why}; {place}"))));
        }
        Ok(self.place)
    }

    fn list(&self) -> io::Result<()> {
        let marker = Marker { files: files_in(self.path(), "")?, ..self.marker.clone() };
        fs::write(self.path().join(MARKER), marker.text())
    }

    /// Checks again what is at the target, on the folder as it is now, and takes its place, from which the files of an earlier run
    /// go. What appears there meanwhile stays.
    fn put(&self) -> std::result::Result<(), String> {
        let words = |error: io::Error| error.to_string();
        let target = &self.place.target;
        // The process ends before or after, not in between.
        let _held = all();
        if let Some((problem, _)) = occupied(target, self.marker.kind).map_err(words)? {
            return Err(format!("it {problem}, and that stays"));
        }
        if fs::symlink_metadata(target).is_err() {
            return fs::rename(self.path(), target).map_err(words);
        }
        let old = temporary_beside(target, OLD);
        fs::rename(target, &old).map_err(words)?;
        fs::rename(self.path(), target).map_err(|error| {
            // The earlier result goes back; should that fail as well, the next run finds it under its temporary name.
            let _ = fs::rename(&old, target);
            words(error)
        })?;
        let _ = Marker::read(&old).map(|marker| marker.remove_from(&old));
        if fs::remove_dir(&old).is_err() && old.exists() {
            let visible = visible_beside(target);
            let _ = fs::rename(&old, &visible);
            tracing::warn!("files that appeared in {} meanwhile were moved to {}", target.display(), visible.display());
        }
        Ok(())
    }

    /// Gives what was written a visible name.
    fn show(&self) -> io::Result<PathBuf> {
        let _ = self.list();
        let visible = visible_beside(&self.place.target);
        self.staging.publish(&visible)?;
        // As the user writes it, unless links lead elsewhere.
        let named = self.name.with_file_name(visible.file_name().unwrap_or_default());
        Ok(if named.exists() { named } else { visible })
    }
}

/// Bytes that a run will write, roughly.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Room {
    /// Its tables and figures, without which there is no result.
    pub tables: u64,
    pub all: u64,
}

/// The folder behind `path`, if a run of this kind may have it: new, empty, or that of an earlier run and nothing else in it.
fn folder_for(path: &Path, kind: RunKind, read: &Provenance) -> Result<PathBuf> {
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
fn occupied(target: &Path, kind: RunKind) -> io::Result<Option<(String, &'static str)>> {
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
fn room(name: &Path, folder: &Path, wanted: Room) -> Result<Option<String>> {
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
        format!("disk: {}: {free} are free there, and the run may write {all}: its tables come first", name.display())
    }))
}
