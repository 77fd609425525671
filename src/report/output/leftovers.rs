//! Temporary names, and what processes left under them that were killed.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use super::lock::Lock;
use super::marker::{MARKER, Marker};

/// What a name begun is called until it is whole.
pub(super) const PARTIAL: &str = "partial";
/// What an earlier result is called while the new one takes its place.
pub(super) const OLD: &str = "old";
const LOCK: &str = "lock";

/// The lock file of a name.
pub fn lock_of(target: &Path) -> PathBuf {
    parent_of(target).join(format!(".{}.{LOCK}", name_of(target)))
}

/// Whether a name is one of those that this program gives for a while.
pub fn is_temporary(name: &str) -> bool {
    let Some((stem, end)) = name.strip_prefix('.').and_then(|rest| rest.rsplit_once('.')) else { return false };
    !stem.is_empty() && (end == LOCK || end == PARTIAL) || stem_of(name).is_some()
}

/// Whether this is what a name begun ends with: number of the process, and a count.
fn is_number(end: &str) -> bool {
    let is_digits = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    end.strip_prefix('-').and_then(|rest| rest.split_once('-')).is_some_and(|(a, b)| is_digits(a) && is_digits(b))
}

/// A name beside `target` that nobody else uses: hidden, with process number and a count.
pub(super) fn temporary_beside(target: &Path, what: &str) -> PathBuf {
    static COUNT: AtomicU64 = AtomicU64::new(0);
    loop {
        let count = COUNT.fetch_add(1, Ordering::Relaxed);
        let name = format!(".{}.{what}-{}-{count}", name_of(target), std::process::id());
        let candidate = parent_of(target).join(name);
        if fs::symlink_metadata(&candidate).is_err() {
            return candidate;
        }
    }
}

/// A visible name beside `target` that nothing has.
pub(super) fn visible_beside(target: &Path) -> PathBuf {
    let name = |count: usize| if count == 1 { String::new() } else { format!("-{count}") };
    let candidate = |count: usize| parent_of(target).join(format!("{}.result{}", name_of(target), name(count)));
    // There are always free names.
    (1..).map(candidate).find(|path| fs::symlink_metadata(path).is_err()).unwrap_or_default()
}

/// Removes what processes left beside `target` that were killed while they wrote it or something else there. An earlier result that one
/// of them had just moved aside goes back.
///
/// `lock` is that of `target`; other names count as left behind where the system gives their locks away. Where it knows no locks nothing
/// is removed.
pub(super) fn remove_beside(target: &Path, lock: &Lock) {
    let parent = parent_of(target);
    let own = name_of(target);
    for entry in fs::read_dir(&parent).into_iter().flatten().flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        let Some((stem, is_old)) = stem_of(&name) else { continue };
        let of = parent.join(stem);
        let is_left = if stem == own { lock.is_real() } else { Lock::is_given_up(&lock_of(&of)) };
        if is_left {
            remove(&entry.path(), is_old.then_some(&*of));
        }
    }
}

/// The name that a temporary name stands for, and whether it is that of an earlier result.
fn stem_of(name: &str) -> Option<(&str, bool)> {
    let (stem, end) = name.strip_prefix('.')?.rsplit_once('.')?;
    let is = |what: &str| end.strip_prefix(what).is_some_and(is_number);
    (!stem.is_empty() && (is(PARTIAL) || is(OLD))).then(|| (stem, is(OLD)))
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

fn name_of(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// The folder a path stands in; the current one for a bare name.
pub(super) fn parent_of(path: &Path) -> PathBuf {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent.to_path_buf(),
        _ => PathBuf::from("."),
    }
}
