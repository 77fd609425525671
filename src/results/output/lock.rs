//! One writer at a time: a lock file beside what is written, which says who has it; and what processes left there that were killed.
//!
//! The lock is the system's, so that it ends with its process however that ends; the file is only where it is held.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Read, Write as _};
use std::path::{Path, PathBuf};

use super::marker::{MARKER, Marker, lock_of, name_of, parent_of, stem_of};
use super::pending::Pending;
use perilife_base::error::{Error, input};
use perilife_base::input::FileId;

/// A lock that was taken; given back when dropped.
#[derive(Debug)]
pub struct Lock {
    file: File,
    path: PathBuf,
    /// Whether the system keeps others out, which not every file system does.
    is_real: bool,
    _pending: Pending,
}

/// Why there is no lock.
enum Refused {
    /// Somebody else has it: who, in words.
    Taken(String),
    /// No lock file can be made there.
    Impossible(io::Error),
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
    pub(super) fn of(
        option: &str,
        name: &Path,
        action: &'static str,
        target: &Path,
        share: Share,
    ) -> perilife_base::error::Result<Lock> {
        let lock = Lock::take(&lock_of(target), share).map_err(|refused| match refused {
            Refused::Impossible(error) => Error::file(name, action, error),
            Refused::Taken(holder) => {
                let problem = format!("is in use by another run: {holder}");
                input(option, name.display(), problem, "wait for its end, or give another name")
            }
        })?;
        if share == Share::Alone {
            remove_beside(target, &lock);
        }
        Ok(lock)
    }

    /// Takes the lock file at `path`.
    fn take(path: &Path, share: Share) -> Result<Lock, Refused> {
        let (pending, (file, is_real)) = Pending::file_by(path, || Self::locked(path, share))?;
        Ok(Lock { file, path: path.to_path_buf(), is_real, _pending: pending })
    }

    /// The file, and whether the system locks it.
    fn locked(path: &Path, share: Share) -> Result<(File, bool), Refused> {
        loop {
            let opened = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(path);
            let mut file = opened.map_err(Refused::Impossible)?;
            let locked = if share == Share::Alone { file.try_lock() } else { file.try_lock_shared() };
            let is_real = locked.is_ok();
            match locked {
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => {
                    let mut holder = String::new();
                    let _ = file.read_to_string(&mut holder);
                    let holder = holder.trim();
                    let unnamed = "a process that has not said its name yet";
                    return Err(Refused::Taken(if holder.is_empty() { unnamed.to_owned() } else { holder.to_owned() }));
                }
                // A file system without locks: better a result than none.
                Err(TryLockError::Error(error)) => tracing::debug!("{}: no lock: {error}", path.display()),
            }
            // Whoever had it before may have removed the file after it was opened here.
            let is_that = |there: fs::Metadata| file.metadata().is_ok_and(|own| FileId::of(&own) == FileId::of(&there));
            if !fs::metadata(path).is_ok_and(is_that) {
                continue;
            }
            let named = file.set_len(0).and_then(|()| file.write_all(holder().as_bytes()));
            if let Err(error) = named {
                tracing::debug!("{}: cannot say who has the lock: {error}", path.display());
            }
            return Ok((file, is_real));
        }
    }

    /// Whether a lock file stands there whose holder is gone; it is removed then.
    fn is_given_up(path: &Path) -> bool {
        let is_free = File::open(path).is_ok_and(|file| file.try_lock().is_ok());
        is_free && Lock::take(path, Share::Alone).is_ok_and(|lock| lock.is_real)
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        // Removed while it is held, and only if nobody shares it.
        let _ = self.file.unlock();
        if self.file.try_lock().is_ok() {
            let _ = fs::remove_file(&self.path);
        }
    }
}

/// This process in words.
fn holder() -> String {
    let host = fs::read_to_string("/proc/sys/kernel/hostname").unwrap_or_default();
    let host = if host.trim().is_empty() { "this machine" } else { host.trim() };
    format!("process {} on {host}, since {}\n", std::process::id(), crate::time::now())
}

/// Removes what processes left beside `target` that were killed while they wrote it or something else there. An earlier result that one
/// of them had just moved aside goes back.
///
/// `lock` is that of `target`; other names count as left behind where the system gives their locks away. Where it knows no locks nothing
/// is removed.
fn remove_beside(target: &Path, lock: &Lock) {
    let parent = parent_of(target);
    let own = name_of(target);
    for entry in fs::read_dir(&parent).into_iter().flatten().flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        let Some((stem, is_old)) = stem_of(&name) else { continue };
        let of = parent.join(stem);
        let is_left = if stem == own { lock.is_real } else { Lock::is_given_up(&lock_of(&of)) };
        if is_left {
            remove(&entry.path(), is_old.then_some(&*of));
        }
    }
}

/// Removes one thing that was left; `place` is where it stood if it is an earlier result.
fn remove(path: &Path, place: Option<&Path>) {
    let marker = Marker::read(path);
    let is_folder = path.is_dir();
    let _ = match (place, marker) {
        (Some(place), Some(_)) if fs::symlink_metadata(place).is_err() => fs::rename(path, place),
        // What is not of that run stays.
        (Some(_), Some(marker)) => marker.remove_from(path).and_then(|()| fs::remove_dir(path)),
        (None, Some(_)) => fs::remove_dir_all(path),
        // Of an earlier version, whose marker lists nothing.
        (None, None) if path.join(MARKER).is_file() => fs::remove_dir_all(path),
        // Begun and no more, or not ours.
        (_, None) if is_folder => fs::remove_dir(path),
        (_, None) => fs::remove_file(path),
    };
}
