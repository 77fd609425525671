//! One writer at a time: a lock file beside what is written, which says who has it.
//!
//! The lock is the system's, so that it ends with its process however that ends; the file is only where it is held.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Read, Write as _};
use std::path::{Path, PathBuf};

use super::pending::Pending;
use crate::input::FileId;

/// A lock that was taken; given back when dropped.
#[derive(Debug)]
pub struct Lock {
    file: File,
    path: PathBuf,
    is_real: bool,
    _pending: Pending,
}

/// Why there is no lock.
#[derive(Debug)]
pub enum Refused {
    /// Somebody else has it: who, in words.
    Taken(String),
    /// No lock file can be made there.
    Impossible(io::Error),
}

/// Whether others may have it as well.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Share {
    /// One alone.
    Alone,
    /// Many, as parts of one sweep.
    Parts,
}

impl Lock {
    /// Takes the lock file at `path`.
    pub fn take(path: &Path, share: Share) -> Result<Lock, Refused> {
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

    /// Whether the system keeps others out, which not every file system does.
    pub fn is_real(&self) -> bool {
        self.is_real
    }

    /// Whether a lock file stands there whose holder is gone; it is removed then.
    pub fn is_given_up(path: &Path) -> bool {
        let is_free = File::open(path).is_ok_and(|file| file.try_lock().is_ok());
        is_free && Lock::take(path, Share::Alone).is_ok_and(|lock| lock.is_real())
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
    format!("process {} on {host}, since {}\n", std::process::id(), crate::report::time::now())
}
