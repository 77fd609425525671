//! Single files: tables, drawings, checkpoints; each whole or absent, and never over what was read or what somebody else wrote.

use std::fs;
use std::io::{self, Read as _, Write as _};
use std::path::{Path, PathBuf};

use super::lock::{Lock, Share};
use super::staging::{Staging, resolved, visible_beside};
use perilife_base::error::{Error, Result, input};
use perilife_base::input::{FileId, Provenance, STREAM};
use perilife_base::units::us::{System, renamed};

/// Bytes by which a file shows what wrote it.
const HEAD: u64 = 1024;

/// What a command writes, and how it recognizes its own.
#[derive(Debug, Clone, Copy)]
pub struct Sort {
    pub option: &'static str,
    /// Text near its beginning, and in no other file.
    pub sign: &'static [u8],
}

/// A file that a command will write.
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

    /// The outcome with the name that the user gave.
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
