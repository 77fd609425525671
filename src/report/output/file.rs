//! Single files: tables, drawings, checkpoints; each whole or absent, and never over what was read or what somebody else wrote.

use std::fs;
use std::io::{self, Read as _, Write as _};
use std::path::{Path, PathBuf};

use super::folder::taken;
use super::leftovers::{self, PARTIAL, lock_of, parent_of, temporary_beside, visible_beside};
use super::lock::{Lock, Refused, Share};
use super::pending::{self, Pending};
use super::place::{resolved, was_read};
use crate::error::{Error, Result, input};
use crate::input::{Provenance, STREAM};

/// Bytes by which a file shows what wrote it.
const HEAD: u64 = 1024;

/// What a command writes, and how it knows its own.
#[derive(Debug, Clone, Copy)]
pub struct Sort {
    /// The option that names the file.
    pub option: &'static str,
    /// What stands near its beginning, and in no other file.
    pub sign: &'static [u8],
}

/// A file that a command will write.
#[derive(Debug)]
pub struct OutputFile {
    /// As given by the user.
    name: PathBuf,
    sort: Sort,
    place: Place,
}

#[derive(Debug)]
enum Place {
    Stdout,
    /// A device or pipe is written to; renaming over it would put a file in its place.
    Device,
    File {
        target: PathBuf,
        _lock: Lock,
    },
}

impl OutputFile {
    /// Claims `path`, before anything is computed; `-` is standard output.
    ///
    /// # Errors
    /// [`Error::Input`] if it is a folder, a file that was read, one that this command did not write, or one that another process is
    /// at; [`Error::File`] if nothing can be written there.
    pub fn claim(path: &Path, sort: Sort, read: &Provenance) -> Result<OutputFile> {
        let claimed = |place| Ok(OutputFile { name: path.to_path_buf(), sort, place });
        if path == Path::new(STREAM) {
            return claimed(Place::Stdout);
        }
        // A pipe behind /dev/stdout has no path of its own.
        if fs::metadata(path).is_ok_and(|there| !there.is_dir() && !there.is_file()) {
            return claimed(Place::Device);
        }
        let target = resolved(path).map_err(|error| Error::file(path, "cannot write", error))?;
        match fs::metadata(&target) {
            Ok(there) if there.is_dir() => return Err(is_folder(sort, path)),
            Ok(there) if was_read(&there, read) => return Err(is_read(sort, path)),
            Err(_) if path.file_name().is_none() => return Err(is_folder(sort, path)),
            _ => {}
        }
        if !is_own(&target, sort)? {
            let problem = "is a file that this command did not write";
            return Err(input(sort.option, path.display(), problem, "give a new name, or remove it yourself"));
        }
        let lock = lock(sort, path, &target)?;
        leftovers::remove_beside(&target, &lock);
        claimed(Place::File { target, _lock: lock })
    }

    /// Whether it will be a file, of which something can be said on standard output.
    pub fn is_file(&self) -> bool {
        matches!(self.place, Place::File { .. })
    }

    /// Writes it whole or not at all.
    ///
    /// # Errors
    /// [`Error::File`] if it cannot be written; if somebody else's file has appeared there meanwhile, that stays, and the message says
    /// under what name this one stands.
    pub fn write(self, bytes: &[u8]) -> Result<()> {
        let cannot = |error| Error::file(&self.name, "cannot write", error);
        let target = match &self.place {
            Place::Stdout => {
                let mut stdout = io::stdout().lock();
                return match stdout.write_all(bytes).and_then(|()| stdout.flush()) {
                    Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(cannot(error)),
                    _ => Ok(()),
                };
            }
            Place::Device => return fs::write(&self.name, bytes).map_err(cannot),
            Place::File { target, .. } => target,
        };
        if target.is_dir() || !is_own(target, self.sort)? {
            let other = visible_beside(target);
            super::write_file(&other, bytes)?;
            let why = format!("something else has appeared there and stays; the result stands in {}", other.display());
            return Err(cannot(io::Error::other(why)));
        }
        super::write_file(target, bytes).map_err(|error| match error {
            Error::File { source, .. } => cannot(source),
            other => other,
        })
    }
}

fn is_folder(sort: Sort, path: &Path) -> Error {
    input(sort.option, path.display(), "is a folder", "give the name of a file")
}

fn is_read(sort: Sort, path: &Path) -> Error {
    input(sort.option, path.display(), "is a file that this command reads", "give another name")
}

fn lock(sort: Sort, path: &Path, target: &Path) -> Result<Lock> {
    Lock::take(&lock_of(target), Share::Alone).map_err(|refused| match refused {
        Refused::Impossible(error) => Error::file(path, "cannot write", error),
        Refused::Taken(holder) => taken(sort.option, path, &holder),
    })
}

/// Whether nothing stands there, or nothing but what this command wrote.
fn is_own(target: &Path, sort: Sort) -> Result<bool> {
    let read = || -> io::Result<bool> {
        let mut head = Vec::new();
        fs::File::open(target)?.take(HEAD).read_to_end(&mut head)?;
        Ok(head.is_empty() || head.windows(sort.sign.len()).any(|part| part == sort.sign))
    };
    match read() {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(true),
        own => own.map_err(|error| Error::file(target, "cannot read", error)),
    }
}

/// Writes a single file whole or not at all: under a temporary name beside its place, then renamed. For files of a folder in the
/// making; what a user names is an [`OutputFile`].
///
/// # Errors
/// [`Error::File`] if it cannot be written; what stood there before then stays.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<()> {
    let cannot = |e| Error::file(path, "cannot write", e);
    if path.is_dir() || path.file_name().is_none() {
        return Err(input("--out", path.display(), "is a folder", "give the name of a file"));
    }
    // A link keeps pointing where it points: the file behind it is replaced.
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
    if fs::metadata(&target).is_ok_and(|there| !there.is_file()) {
        return fs::write(path, bytes).map_err(cannot);
    }
    let partial = temporary_beside(&target, PARTIAL);
    let (pending, mut file) = Pending::file_by(&partial, || fs::File::create(&partial)).map_err(cannot)?;
    let written = file.write_all(bytes);
    drop(file);
    let held = pending::hold();
    let done = written.and_then(|()| fs::rename(&partial, &target));
    drop(held);
    drop(pending);
    if done.is_err() {
        let _ = fs::remove_file(&partial);
    }
    done.map_err(cannot)
}

/// A file that is written again and again, whole every time, and stays whole if the machine stops.
#[derive(Debug)]
pub struct Replaced {
    name: PathBuf,
    path: PathBuf,
    partial: PathBuf,
    sort: Sort,
    _pending: Pending,
    _lock: Lock,
}

impl Replaced {
    /// Claims `path`, which need not exist; what stands there stays until the first writing.
    ///
    /// # Errors
    /// As [`OutputFile::claim`]; [`Error::Input`] if it is a device.
    pub fn claim(path: &Path, sort: Sort, read: &Provenance) -> Result<Replaced> {
        let claimed = OutputFile::claim(path, sort, read)?;
        let Place::File { target, _lock } = claimed.place else {
            return Err(input(sort.option, path.display(), "is no file", "give the name of a file"));
        };
        let name = target.file_name().unwrap_or_default().to_string_lossy();
        // Always the same name: what a process that was killed left there is overwritten by the next.
        let partial = parent_of(&target).join(format!(".{name}.{PARTIAL}"));
        let tried = fs::File::create(&partial).and_then(|_| fs::remove_file(&partial));
        tried.map_err(|e| Error::file(path, "cannot write", e))?;
        let _pending = Pending::file(&partial);
        Ok(Replaced { name: path.to_path_buf(), path: target, partial, sort, _pending, _lock })
    }

    /// Writes it whole or not at all.
    ///
    /// # Errors
    /// [`Error::File`] if it cannot be written, or something else has appeared there; what stood there before then stays.
    pub fn write(&self, bytes: &[u8]) -> Result<()> {
        self.check_own()?;
        let written = fs::File::create(&self.partial).and_then(|mut file| {
            file.write_all(bytes)?;
            // A name must not come to stand for content that is not on the disk yet.
            file.sync_all()
        });
        let held = pending::hold();
        let done = written.and_then(|()| fs::rename(&self.partial, &self.path));
        drop(held);
        if done.is_err() {
            let _ = fs::remove_file(&self.partial);
        }
        done.map_err(|e| Error::file(&self.name, "cannot write", e))
    }

    fn check_own(&self) -> Result<()> {
        if is_own(&self.path, self.sort)? {
            return Ok(());
        }
        Err(Error::file(&self.name, "cannot write", io::Error::other("something else has appeared there, and stays")))
    }

    /// Removes it, if it is there: what it was for is done.
    ///
    /// # Errors
    /// [`Error::File`] if it cannot be removed; what is not this command's stays.
    pub fn remove(self) -> Result<()> {
        self.check_own()?;
        super::marker::gone(fs::remove_file(&self.path)).map_err(|error| Error::file(&self.name, "cannot remove", error))
    }
}
