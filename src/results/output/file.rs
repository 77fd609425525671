//! Single files: tables, drawings, checkpoints; each whole or absent, and never over what was read or what somebody else wrote.

use std::fs;
use std::io::{self, Read as _, Write as _};
use std::path::{Path, PathBuf};

use super::lock::{Lock, Share};
use super::marker::{PARTIAL, gone, temporary_beside, visible_beside};
use super::pending::{self, Pending};
use super::place::{resolved, was_read};
use perilife_base::error::{Error, Result, input};
use perilife_base::input::{Provenance, STREAM};
use perilife_base::units::us::{System, renamed};

/// Bytes by which a file shows what wrote it.
const HEAD: u64 = 1024;

/// What a command writes, and how it knows its own.
#[derive(Debug, Clone, Copy)]
pub struct Sort {
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
    /// Errors: [`Error::Input`] if it is a folder, a file that was read, one that this command did not write, or one that another
    /// process is at; [`Error::File`] if nothing can be written there.
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
            Ok(there) if was_read(&there, read) && !there.is_dir() => {
                return Err(input(sort.option, path.display(), "is a file that this command reads", "give another name"));
            }
            Ok(there) if !there.is_dir() => {}
            Err(_) if path.file_name().is_some() => {}
            _ => return Err(input(sort.option, path.display(), "is a folder", "give the name of a file")),
        }
        if !is_own(&target, sort)? {
            let problem = "is a file that this command did not write";
            return Err(input(sort.option, path.display(), problem, "give a new name, or remove it yourself"));
        }
        let lock = Lock::of(sort.option, path, "cannot write", &target, Share::Alone)?;
        claimed(Place::File { target, _lock: lock })
    }

    /// Whether it will be a file, of which something can be said on standard output.
    pub fn is_file(&self) -> bool {
        matches!(self.place, Place::File { .. })
    }

    /// Writes it whole or not at all.
    /// Errors: [`Error::File`] if it cannot be written; if somebody else's file has appeared there meanwhile, that stays, and the
    /// message says under what name this one stands.
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
            write_file(&other, bytes)?;
            let why = format!("something else has appeared there and stays; the result stands in {}", other.display());
            return Err(cannot(io::Error::other(why)));
        }
        write_whole(target, bytes, false).map_err(|error| self.named(error))
    }

    /// Writes it whole or not at all, again and again; it stays whole if the machine stops, and stays as it was if this fails.
    pub fn rewrite(&self, bytes: &[u8]) -> Result<()> {
        write_whole(self.own_target()?, bytes, true).map_err(|error| self.named(error))
    }

    /// Removes it, if it is there: what it was for is done.
    pub fn remove(self) -> Result<()> {
        gone(fs::remove_file(self.own_target()?)).map_err(|error| Error::file(&self.name, "cannot remove", error))
    }

    /// Its place, if nothing else has appeared there.
    fn own_target(&self) -> Result<&Path> {
        match &self.place {
            Place::File { target, .. } if is_own(target, self.sort)? => Ok(target),
            _ => Err(Error::file(&self.name, "cannot write", io::Error::other("something else has appeared there, and stays"))),
        }
    }

    /// The error with the name that the user gave.
    fn named(&self, error: Error) -> Error {
        match error {
            Error::File { action, source, .. } => Error::file(&self.name, action, source),
            other => other,
        }
    }
}

/// Whether nothing stands there, or nothing but what this command wrote.
fn is_own(target: &Path, sort: Sort) -> Result<bool> {
    let read = || -> io::Result<bool> {
        let mut head = Vec::new();
        fs::File::open(target)?.take(HEAD).read_to_end(&mut head)?;
        let bears = |head: &[u8]| head.windows(sort.sign.len()).any(|part| part == sort.sign);
        // The header of a table in US units is that of the same table.
        Ok(head.is_empty() || bears(&head) || bears(metric_header(&head).as_bytes()))
    };
    match read() {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(true),
        own => own.map_err(|error| Error::file(target, "cannot read", error)),
    }
}

/// The first line of a table, its columns in metric units.
fn metric_header(head: &[u8]) -> String {
    let text = String::from_utf8_lossy(head);
    let columns = text.lines().next().unwrap_or_default().split(',');
    let metric = |column: &str| renamed(column, System::Si).map_or_else(|| column.to_owned(), |new| new.name);
    columns.map(metric).collect::<Vec<_>>().join(",") + "\n"
}

/// Writes a single file whole or not at all: under a temporary name beside its place, then renamed; what stood there before stays if
/// that fails. For files of a folder in the making; what a user names is an [`OutputFile`].
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<()> {
    write_whole(path, bytes, false)
}

/// The same; `synced` has the bytes on the disk before the name stands for them.
fn write_whole(path: &Path, bytes: &[u8], synced: bool) -> Result<()> {
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
    let written = file.write_all(bytes).and_then(|()| if synced { file.sync_all() } else { Ok(()) });
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
