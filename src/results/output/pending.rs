//! What is in the making and has to go if the process is asked to end: partial folders and files, lock files, new folders above them.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// A thing that stands where it will not stay.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Thing {
    File(PathBuf),
    /// A folder with all in it.
    Tree(PathBuf),
    /// A folder, if it is empty by then.
    Empty(PathBuf),
}

static ALL: Mutex<Vec<(u64, Thing)>> = Mutex::new(Vec::new());

/// Keeps a thing on the list while it lives.
#[derive(Debug)]
pub struct Pending(u64);

impl Pending {
    /// A folder that is removed when the process is asked to end, if nothing is in it.
    pub(super) fn empty(path: &Path) -> Self {
        Self::add(&mut hold().0, Thing::Empty(path.to_path_buf()))
    }

    /// Makes a file and keeps it on the list, so that the process is folded up before or after, not in between.
    pub(super) fn file_by<T, E>(path: &Path, make: impl FnOnce() -> Result<T, E>) -> Result<(Self, T), E> {
        Self::by(Thing::File(path.to_path_buf()), make)
    }

    /// Likewise a folder with all that comes into it.
    pub(super) fn tree_by<T, E>(path: &Path, make: impl FnOnce() -> Result<T, E>) -> Result<(Self, T), E> {
        Self::by(Thing::Tree(path.to_path_buf()), make)
    }

    fn by<T, E>(thing: Thing, make: impl FnOnce() -> Result<T, E>) -> Result<(Self, T), E> {
        let mut all = hold().0;
        let made = make()?;
        Ok((Self::add(&mut all, thing), made))
    }

    fn add(all: &mut Vec<(u64, Thing)>, thing: Thing) -> Self {
        let number = all.last().map_or(0, |(last, _)| last + 1);
        all.push((number, thing));
        Pending(number)
    }
}

impl Drop for Pending {
    fn drop(&mut self) {
        hold().0.retain(|(number, _)| *number != self.0);
    }
}

/// Keeps the process from being folded up while a result is put in its place.
pub(super) fn hold() -> Held {
    // The list is whole at any moment, even that of a thread that died.
    Held(ALL.lock().unwrap_or_else(PoisonError::into_inner))
}

/// While it lives the process is not folded up.
pub(super) struct Held(MutexGuard<'static, Vec<(u64, Thing)>>);

/// Removes all that is in the making. The process has to end then: nothing can be put in its place any more.
pub fn fold_up() {
    let all = hold().0;
    // What was begun last goes first: what lies in a folder before the folder.
    for (_, thing) in all.iter().rev() {
        match thing {
            Thing::File(path) => drop(fs::remove_file(path)),
            Thing::Empty(path) => drop(fs::remove_dir(path)),
            // Another thread may still write into it.
            Thing::Tree(path) => {
                let _ = (0..20).any(|_| fs::remove_dir_all(path).is_ok() || !path.exists());
            }
        }
    }
    std::mem::forget(all);
}
