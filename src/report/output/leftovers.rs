//! Temporary names, and what processes left under them that were killed.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use super::marker::{MARKER, Marker};

/// What a name begun is called until it is whole.
pub(super) const PARTIAL: &str = "partial";
/// What an earlier result is called while the new one takes its place.
pub(super) const OLD: &str = "old";
const LOCK: &str = "lock";

/// The lock file of a name.
#[must_use]
pub fn lock_of(target: &Path) -> PathBuf {
    parent_of(target).join(format!(".{}.{LOCK}", name_of(target)))
}

/// Whether a name is one of those that this program gives for a while.
#[must_use]
pub fn is_temporary(name: &str) -> bool {
    let Some((stem, end)) = name.strip_prefix('.').and_then(|rest| rest.rsplit_once('.')) else { return false };
    let is_numbered = |what: &str| end.strip_prefix(what).is_some_and(is_number);
    !stem.is_empty() && (end == LOCK || end == PARTIAL || is_numbered(PARTIAL) || is_numbered(OLD))
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

/// Removes what processes left behind that were killed while they wrote `target`; its lock is held, so none of them lives. An earlier
/// result that one of them had just moved aside goes back.
pub(super) fn remove_of(target: &Path) {
    let parent = parent_of(target);
    let [partial, old] = [PARTIAL, OLD].map(|what| format!(".{}.{what}", name_of(target)));
    for entry in fs::read_dir(&parent).into_iter().flatten().flatten() {
        let (name, path) = (entry.file_name().to_string_lossy().into_owned(), entry.path());
        let is_of = |what: &String| name.strip_prefix(&**what).is_some_and(is_number);
        let (is_folder, is_marked) = (path.is_dir(), path.join(MARKER).is_file());
        if !(is_of(&partial) || is_of(&old)) {
            continue;
        }
        if is_of(&old) && is_marked && fs::symlink_metadata(target).is_err() {
            let _ = fs::rename(&path, target);
        } else if is_folder && !is_marked {
            // Begun and no more, or not ours.
            let _ = fs::remove_dir(&path);
        } else if is_folder && is_of(&old) {
            // What is not of that run stays.
            let _ = Marker::read(&path).map(|marker| marker.remove_from(&path));
            let _ = fs::remove_dir(&path);
        } else if is_folder {
            let _ = fs::remove_dir_all(&path);
        } else {
            let _ = fs::remove_file(&path);
        }
    }
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
