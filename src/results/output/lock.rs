//! One writer at a time: a lock file beside what is written, which says who has it; and what processes left there that were killed.
//!
//! The lock is the system's, so that it ends with its process however that ends; the file is only where it is taken.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Read, Write as _};
use std::path::Path;

use super::marker::Marker;
use super::staging::{MARKER, Staging, lock_of, name_of, parent_of, remove_all, stem_of};
use perilife_base::error::{Error, Result, input};
use perilife_base::input::FileId;

/// A lock that was taken; given back when dropped.
#[derive(Debug)]
pub(super) struct Lock {
    /// Whether the system keeps others out, which not every file system does.
    is_real: bool,
    // Removed before it is unlocked.
    beside: Staging,
    file: File,
}

/// Whether others may have it as well.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Share {
    Alone,
    /// Many, as parts of one sweep.
    Parts,
}

impl Lock {
    /// Locks `target`, which an option names as `name`; who has it alone removes what killed processes left beside it. `action` is what
    /// cannot be done where no lock file can be made.
    pub fn of(option: &str, name: &Path, action: &'static str, target: &Path, share: Share) -> Result<Lock> {
        let lock = Lock::take(&lock_of(target), share).map_err(|error| match error.kind() {
            io::ErrorKind::WouldBlock => {
                let problem = format!("is in use by another run: {error}");
                input(option, name.display(), problem, "wait for its end, or give another name")
            }
            _ => Error::file(name, action, error),
        })?;
        if share == Share::Alone {
            lock.remove_beside(target);
        }
        Ok(lock)
    }

    /// Takes the lock file at `path`.
    fn take(path: &Path, share: Share) -> io::Result<Lock> {
        let (beside, (file, is_real)) = Staging::made(path, |path| fs::remove_file(path), || locked(path, share))?;
        Ok(Lock { is_real, beside, file })
    }

    /// Removes what processes left beside `target` that were killed while they wrote it, and, where the system gives away the lock of
    /// another name, while they wrote that. Where it has no locks nothing is removed.
    fn remove_beside(&self, target: &Path) {
        let is_given_up = |lock: &Path| {
            let is_free = File::open(lock).is_ok_and(|file| file.try_lock().is_ok());
            is_free && Lock::take(lock, Share::Alone).is_ok_and(|lock| lock.is_real)
        };
        for entry in fs::read_dir(parent_of(target)).into_iter().flatten().flatten() {
            let name = entry.file_name().to_string_lossy().into_owned();
            let Some((stem, is_old)) = stem_of(&name) else { continue };
            let place = parent_of(target).join(stem);
            if if stem == name_of(target) { self.is_real } else { is_given_up(&lock_of(&place)) } {
                remove(&entry.path(), is_old.then_some(&*place));
            }
        }
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        // Removed while it is locked, and only if nobody shares it.
        let _ = self.file.unlock();
        if self.file.try_lock().is_err() {
            self.beside.leave();
        }
    }
}

/// The file, and whether the system locks it.
/// Errors: of the kind [`io::ErrorKind::WouldBlock`] with the words of who has it.
fn locked(path: &Path, share: Share) -> io::Result<(File, bool)> {
    loop {
        let mut file = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(path)?;
        let locked = if share == Share::Alone { file.try_lock() } else { file.try_lock_shared() };
        if let Err(TryLockError::WouldBlock) = locked {
            let mut holder = String::new();
            let _ = file.read_to_string(&mut holder);
            let holder = if holder.trim().is_empty() { "an unknown process" } else { holder.trim() };
            return Err(io::Error::new(io::ErrorKind::WouldBlock, holder));
        }
        // Whoever had it before may have removed the file after it was opened here.
        let is_that = |there: fs::Metadata| file.metadata().is_ok_and(|own| FileId::of(&own) == FileId::of(&there));
        if fs::metadata(path).is_ok_and(is_that) {
            // A file system without locks or room for a name: better a result than none.
            let _ = file.set_len(0).and_then(|()| file.write_all(holder().as_bytes()));
            return Ok((file, locked.is_ok()));
        }
    }
}

/// This process in words.
fn holder() -> String {
    let host = fs::read_to_string("/proc/sys/kernel/hostname").unwrap_or_default();
    let host = if host.trim().is_empty() { "this machine" } else { host.trim() };
    format!("process {} on {host}, since {}\n", std::process::id(), crate::time::now())
}

/// Removes one thing that was left; an earlier result that had just been moved aside goes back to its `place`.
fn remove(path: &Path, place: Option<&Path>) {
    let _ = match (place, Marker::read(path)) {
        (Some(place), Some(_)) if fs::symlink_metadata(place).is_err() => fs::rename(path, place),
        // What is not of that run stays.
        (Some(_), Some(marker)) => marker.remove_from(path).and_then(|()| fs::remove_dir(path)),
        (None, _) if path.join(MARKER).is_file() => remove_all(path),
        // Begun and no more, or not ours.
        _ if path.is_dir() => fs::remove_dir(path),
        _ => fs::remove_file(path),
    };
}
