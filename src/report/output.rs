//! Output that is whole or absent: results are written beside their place and renamed at the end.
//!
//! A folder is replaced only if an earlier run of this program made it, which the marker file `.perilife` tells.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use crate::error::{Error, Result, input};

/// File that marks a folder as made by this program.
pub const MARKER: &str = ".perilife";

/// An output folder in the making. Until [`OutputFolder::finish`] it stands under a temporary name beside its place;
/// dropped before that (an error, a panic) it leaves nothing behind.
#[derive(Debug)]
pub struct OutputFolder {
    /// As given by the user.
    name: PathBuf,
    target: PathBuf,
    partial: PathBuf,
    /// Folders above the target that did not exist before, deepest first; removed again if nothing comes of the run.
    new_parents: Vec<PathBuf>,
    finished: bool,
}

impl OutputFolder {
    /// Claims `path` for a run. It may be new, empty, or the result of an earlier run, which stays until `finish`.
    ///
    /// # Errors
    /// [`Error::Input`] if the path is a file or holds anything this program did not make; [`Error::File`] if it cannot be written.
    pub fn create(path: &Path) -> Result<OutputFolder> {
        let target = replaceable(path)?;
        let parent = parent_of(&target);
        let new_parents: Vec<PathBuf> =
            parent.ancestors().take_while(|p| !p.as_os_str().is_empty() && !p.exists()).map(PathBuf::from).collect();
        // From here on the value itself tidies up, whatever fails.
        let partial = temporary_beside(&target, "partial");
        let folder = OutputFolder { name: path.to_path_buf(), target, partial, new_parents, finished: false };
        fs::create_dir_all(&parent).map_err(|e| Error::file(path, "cannot create the folder", e))?;
        fs::create_dir(&folder.partial).map_err(|e| Error::file(path, "cannot create the folder", e))?;
        let origin = format!("made by perilife {}; replaced by the next run that writes here\n", env!("CARGO_PKG_VERSION"));
        fs::write(folder.partial.join(MARKER), origin).map_err(|e| Error::file(path, "cannot write into the folder", e))?;
        Ok(folder)
    }

    /// Where to write until the folder is finished.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.partial
    }

    /// Where the results will stand, as the user named it.
    #[must_use]
    pub fn name(&self) -> &Path {
        &self.name
    }

    /// Puts the folder in its place; the results of an earlier run go.
    ///
    /// # Errors
    /// [`Error::File`] if it cannot be renamed; an earlier result then stands as before.
    pub fn finish(mut self) -> Result<()> {
        let cannot = |e| Error::file(&self.name, "cannot put the results in place", e);
        if self.target.exists() {
            let old = temporary_beside(&self.target, "old");
            fs::rename(&self.target, &old).map_err(cannot)?;
            if let Err(error) = fs::rename(&self.partial, &self.target) {
                // The earlier result goes back; should that fail as well, it still stands under its temporary name.
                let _ = fs::rename(&old, &self.target);
                return Err(cannot(error));
            }
            let _ = fs::remove_dir_all(&old);
        } else {
            fs::rename(&self.partial, &self.target).map_err(cannot)?;
        }
        self.finished = true;
        Ok(())
    }

    /// Puts the folder in its place if nothing stands there but perhaps an empty folder; whether it did. What another process put
    /// there in the same moment stays.
    ///
    /// # Errors
    /// [`Error::File`] if it cannot be renamed for another reason.
    pub fn finish_new(mut self) -> Result<bool> {
        match fs::rename(&self.partial, &self.target) {
            Ok(()) => self.finished = true,
            Err(error) if matches!(error.kind(), io::ErrorKind::DirectoryNotEmpty | io::ErrorKind::AlreadyExists) => {}
            Err(error) => return Err(Error::file(&self.name, "cannot put the results in place", error)),
        }
        Ok(self.finished)
    }
}

impl Drop for OutputFolder {
    fn drop(&mut self) {
        if self.finished {
            return;
        }
        let _ = fs::remove_dir_all(&self.partial);
        for parent in &self.new_parents {
            // Removes empty folders only, so nothing another program put there is lost.
            let _ = fs::remove_dir(parent);
        }
    }
}

/// Writes a single file whole or not at all: under a temporary name beside its place, then renamed.
///
/// # Errors
/// [`Error::File`] if it cannot be written; what stood there before then stays.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<()> {
    let cannot = |e| Error::file(path, "cannot write", e);
    // A device or pipe (/dev/stdout) is written to; renaming over it would put a file in its place.
    if let Ok(there) = fs::metadata(path)
        && !there.is_file()
        && !there.is_dir()
    {
        return fs::write(path, bytes).map_err(cannot);
    }
    if path.is_dir() || path.file_name().is_none() {
        return Err(input("--out", path.display(), "is a folder", "give the name of a file"));
    }
    // A link keeps pointing where it points: the file behind it is replaced.
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
    let partial = temporary_beside(&target, "partial");
    let done = fs::write(&partial, bytes).and_then(|()| fs::rename(&partial, &target));
    if done.is_err() {
        let _ = fs::remove_file(&partial);
    }
    done.map_err(cannot)
}

/// A file that is written again and again, whole every time, and stays whole if the machine stops.
#[derive(Debug)]
pub struct Replaced {
    path: PathBuf,
    partial: PathBuf,
}

impl Replaced {
    /// Claims `path`, which need not exist; what stands there stays until the first writing.
    ///
    /// # Errors
    /// [`Error::Input`] if it is a folder or a device; [`Error::File`] if nothing can be written beside it.
    pub fn claim(path: &Path) -> Result<Replaced> {
        if path.file_name().is_none() || fs::metadata(path).is_ok_and(|there| !there.is_file()) {
            return Err(input("--checkpoint", path.display(), "is no file", "give the name of a file"));
        }
        // A link keeps pointing where it points.
        let path = fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        // Always the same name: what a process that was killed left there is overwritten by the next.
        let partial = parent_of(&path).join(format!(".{name}.partial"));
        let file = Replaced { partial, path };
        let tried = fs::File::create(&file.partial).and_then(|_| fs::remove_file(&file.partial));
        tried.map_err(|e| Error::file(&file.path, "cannot write", e))?;
        Ok(file)
    }

    /// Writes it whole or not at all.
    ///
    /// # Errors
    /// [`Error::File`] if it cannot be written; what stood there before then stays.
    pub fn write(&self, bytes: &[u8]) -> Result<()> {
        let written = fs::File::create(&self.partial).and_then(|mut file| {
            file.write_all(bytes)?;
            // A name must not come to stand for content that is not on the disk yet.
            file.sync_all()
        });
        let done = written.and_then(|()| fs::rename(&self.partial, &self.path));
        if done.is_err() {
            let _ = fs::remove_file(&self.partial);
        }
        done.map_err(|e| Error::file(&self.path, "cannot write", e))
    }
}

/// The folder to write, if it may be written: new, empty or ours.
fn replaceable(path: &Path) -> Result<PathBuf> {
    let refuse = |problem: &str, remedy: &str| Err(input("--out", path.display(), problem, remedy));
    if path.as_os_str().is_empty() {
        return refuse("is empty", "give the name of a folder");
    }
    let target = match fs::canonicalize(path) {
        Ok(target) => target,
        Err(e) if e.kind() == io::ErrorKind::NotFound && path.file_name().is_some() => return Ok(path.to_path_buf()),
        Err(e) => return Err(Error::file(path, "cannot use this folder", e)),
    };
    if !target.is_dir() {
        return refuse("is a file", "give the name of a folder");
    }
    if target.file_name().is_none() || std::env::current_dir().is_ok_and(|here| here.starts_with(&target)) {
        return refuse("is the current folder or one above it", "give a folder below it");
    }
    let mut entries = fs::read_dir(&target).map_err(|e| Error::file(path, "cannot read the folder", e))?;
    if entries.next().is_some() && !target.join(MARKER).is_file() {
        return refuse("holds files that this program did not make", "give a new or empty folder, or remove this one yourself");
    }
    Ok(target)
}

/// A name beside `target` that nobody else uses: hidden, with process number and a count.
fn temporary_beside(target: &Path, what: &str) -> PathBuf {
    static COUNT: AtomicU64 = AtomicU64::new(0);
    let name = target.file_name().unwrap_or_default().to_string_lossy();
    loop {
        let count = COUNT.fetch_add(1, Ordering::Relaxed);
        let candidate = parent_of(target).join(format!(".{name}.{what}-{}-{count}", std::process::id()));
        if !candidate.exists() {
            return candidate;
        }
    }
}

/// The folder a path stands in; the current one for a bare name.
fn parent_of(path: &Path) -> PathBuf {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent.to_path_buf(),
        _ => PathBuf::from("."),
    }
}
