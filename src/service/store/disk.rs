//! The disk of the database: how much is free, a reserve that is given up so that deletions have room, and whether the file that was
//! opened is still the one of its name.

use std::fs::{self, OpenOptions};
use std::io;
use std::os::unix::fs::{MetadataExt, OpenOptionsExt};
use std::path::{Path, PathBuf};

use rustix::fs::{FallocateFlags, fallocate};

/// Bytes that must be free on every disk that is written to.
const FREE_BYTES: u64 = 64 << 20;
/// Bytes of the reserve.
const RESERVE: u64 = 4 << 20;

/// Bytes that are free where a folder is; `None` where it is not there.
pub fn free_bytes(folder: &Path) -> Option<u64> {
    let about = rustix::fs::statvfs(folder).ok()?;
    Some(about.f_bavail.saturating_mul(about.f_frsize))
}

/// Bytes that must be free where a folder is, and those of a reserve there: less on a disk that has not as much in all.
pub fn needed_bytes(folder: &Path) -> [u64; 2] {
    let all = rustix::fs::statvfs(folder).map_or(u64::MAX, |about| about.f_blocks.saturating_mul(about.f_frsize));
    if all > FREE_BYTES { [FREE_BYTES, RESERVE] } else { [all / 4, all / 8] }
}

/// The file of a SQLite database.
#[derive(Debug, Clone)]
pub struct DatabaseFile {
    path: PathBuf,
    /// Device and number, by which it is known whatever its name.
    identity: Option<(u64, u64)>,
}

impl DatabaseFile {
    /// The file of a URL, `sqlite://FILE`; `None` of another.
    pub fn of(url: &str) -> Option<DatabaseFile> {
        let path = url.strip_prefix("sqlite://")?.split('?').next()?;
        let path = PathBuf::from(percent_encoding::percent_decode_str(path).decode_utf8_lossy().into_owned());
        let identity = identity(&path);
        Some(DatabaseFile { path, identity })
    }

    pub fn folder(&self) -> PathBuf {
        self.path.parent().map(Path::to_path_buf).unwrap_or_default()
    }

    /// Refuses to write to a file that nobody finds again.
    pub fn check(&self) -> io::Result<()> {
        if identity(&self.path) == self.identity {
            return Ok(());
        }
        Err(io::Error::new(io::ErrorKind::NotFound, format!("{} was removed or replaced", self.path.display())))
    }

    /// Lays the reserve where there is plenty of room. On disks that cannot there is none.
    pub fn lay_reserve(&self) {
        let [needed, reserve] = needed_bytes(&self.folder());
        if free_bytes(&self.folder()).is_none_or(|free| free < needed + reserve) {
            return;
        }
        let file = OpenOptions::new().write(true).create_new(true).mode(0o600).open(self.path.with_extension("reserve"));
        if file.is_ok_and(|file| fallocate(&file, FallocateFlags::empty(), 0, reserve).is_err()) {
            let _ = fs::remove_file(self.path.with_extension("reserve"));
        }
    }

    /// Whether its disk has less room than a reserve.
    pub fn is_disk_full(&self) -> bool {
        free_bytes(&self.folder()).is_some_and(|free| free < needed_bytes(&self.folder())[1])
    }

    /// Gives the reserve up on a full disk; whether that made room.
    pub fn give_reserve_up(&self) -> bool {
        self.is_disk_full() && fs::remove_file(self.path.with_extension("reserve")).is_ok()
    }
}

fn identity(path: &Path) -> Option<(u64, u64)> {
    fs::metadata(path).ok().map(|about| (about.dev(), about.ino()))
}
