//! What is in the making: hidden files and folders beside their place, lock files, new folders above them. They go when they are dropped
//! or the process is asked to end, unless they were published before.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// How a thing is removed: a file, a tree, or a folder if it is empty.
type Remove = fn(&Path) -> io::Result<()>;

/// File that marks a folder as made by this program.
pub const MARKER: &str = ".perilife";

static ALL: Mutex<Vec<(PathBuf, Remove)>> = Mutex::new(Vec::new());

/// A thing in the making.
#[derive(Debug)]
pub(super) struct Staging {
    path: PathBuf,
    remove: Remove,
}

impl Staging {
    /// A folder in the making beside `target`.
    pub fn beside(target: &Path) -> io::Result<Self> {
        let path = temporary_beside(target, PARTIAL);
        Ok(Self::made(&path, remove_all, || fs::create_dir(&path))?.0)
    }

    /// A file in the making beside `target`.
    pub fn file_beside(target: &Path) -> io::Result<(Self, File)> {
        let path = temporary_beside(target, PARTIAL);
        Self::made(&path, |path| fs::remove_file(path), || File::create(&path))
    }

    /// A folder that is to be made and stays if something comes into it.
    pub fn above(path: &Path) -> Self {
        all().push((path.to_path_buf(), |path| fs::remove_dir(path)));
        Staging { path: path.to_path_buf(), remove: |path| fs::remove_dir(path) }
    }

    /// Makes a thing and lists it, so that the process ends before or after, not in between.
    pub fn made<T>(path: &Path, remove: Remove, make: impl FnOnce() -> io::Result<T>) -> io::Result<(Self, T)> {
        let mut all = all();
        let made = make()?;
        all.push((path.to_path_buf(), remove));
        Ok((Staging { path: path.to_path_buf(), remove }, made))
    }

    pub fn path(&self) -> &Path {
        &self.path
    }

    pub fn publish(&self, place: &Path) -> io::Result<()> {
        let _held = all();
        fs::rename(&self.path, place)
    }

    /// Leaves it where it is.
    pub fn leave(&mut self) {
        self.remove = |_| Ok(());
    }
}

impl Drop for Staging {
    fn drop(&mut self) {
        let mut all = all();
        if let Some(index) = all.iter().rposition(|(path, _)| *path == self.path) {
            all.remove(index);
        }
        // Of what was published nothing is left under this name, and a folder that holds something stays.
        let _ = (self.remove)(&self.path);
    }
}

/// All that is in the making. While it is held, the process does not end by a signal.
pub(super) fn all() -> MutexGuard<'static, Vec<(PathBuf, Remove)>> {
    // The list is whole at any time, even that of a thread that died.
    ALL.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes all that is in the making. The process has to end then: nothing can be published any more.
pub fn fold_up() {
    let all = all();
    // Last begun first: what lies in a folder before the folder. Another thread may still write into one.
    for (path, remove) in all.iter().rev() {
        let _ = (0..20).any(|_| remove(path).is_ok() || !path.exists());
    }
    std::mem::forget(all);
}

/// What a name begun is called until it is whole.
const PARTIAL: &str = "partial";
/// What an earlier result is called while the new one takes its place.
pub(super) const OLD: &str = "old";
const LOCK: &str = "lock";

/// The lock file of a name.
pub(super) fn lock_of(target: &Path) -> PathBuf {
    parent_of(target).join(format!(".{}.{LOCK}", name_of(target)))
}

/// Whether a name is one of those that this program gives for a while.
pub fn is_temporary(name: &str) -> bool {
    let Some((stem, end)) = name.strip_prefix('.').and_then(|rest| rest.rsplit_once('.')) else { return false };
    !stem.is_empty() && (end == LOCK || end == PARTIAL) || stem_of(name).is_some()
}

/// The name that a temporary name was made for, and whether it is that of an earlier result.
pub(super) fn stem_of(name: &str) -> Option<(&str, bool)> {
    let (stem, end) = name.strip_prefix('.')?.rsplit_once('.')?;
    // Number of the process and a count.
    let is_digits = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    let is = |what: &str| {
        let numbers = end.strip_prefix(what).and_then(|rest| rest.strip_prefix('-')?.split_once('-'));
        numbers.is_some_and(|(process, count)| is_digits(process) && is_digits(count))
    };
    (!stem.is_empty() && (is(PARTIAL) || is(OLD))).then(|| (stem, is(OLD)))
}

/// A name beside `target` that nobody else uses: hidden, with process number and a count.
pub(super) fn temporary_beside(target: &Path, what: &str) -> PathBuf {
    static COUNT: AtomicU64 = AtomicU64::new(0);
    let count = std::iter::repeat_with(|| COUNT.fetch_add(1, Ordering::Relaxed));
    free(count.map(|count| parent_of(target).join(format!(".{}.{what}-{}-{count}", name_of(target), std::process::id()))))
}

/// A visible name beside `target` that nothing has.
pub(super) fn visible_beside(target: &Path) -> PathBuf {
    let name = |count: usize| if count == 1 { String::new() } else { format!("-{count}") };
    free((1..).map(|count| parent_of(target).join(format!("{}.result{}", name_of(target), name(count)))))
}

fn free(mut names: impl Iterator<Item = PathBuf>) -> PathBuf {
    // There are always free names.
    names.find(|path| fs::symlink_metadata(path).is_err()).unwrap_or_default()
}

pub(super) fn name_of(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// The folder that a path is in; the current one for a bare name.
pub(super) fn parent_of(path: &Path) -> PathBuf {
    path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new(".")).to_path_buf()
}

/// Removes a folder with all in it, its marker last: if the process is killed on the way, the next run recognizes the rest.
pub(super) fn remove_all(folder: &Path) -> io::Result<()> {
    for path in names(folder)?.into_iter().map(|name| folder.join(name)) {
        if fs::symlink_metadata(&path)?.is_dir() { fs::remove_dir_all(path)? } else { fs::remove_file(path)? }
    }
    fs::remove_dir(folder)
}

/// Names in a folder, sorted, that of the marker last: what is removed on the way stays known to the end. None of a folder that is not
/// there.
pub(super) fn names(folder: &Path) -> io::Result<Vec<String>> {
    let entries = match fs::read_dir(folder) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
        entries => entries?,
    };
    let mut names: Vec<String> =
        entries.map(|entry| Ok(entry?.file_name().to_string_lossy().into_owned())).collect::<io::Result<_>>()?;
    names.sort_by(|a, b| (a == MARKER, a).cmp(&(b == MARKER, b)));
    Ok(names)
}

/// A path with its links followed, also through one that points to nothing yet; of what is not there the part that is made absolute.
pub(super) fn resolved(path: &Path) -> io::Result<PathBuf> {
    let parent = parent_of(path);
    match fs::canonicalize(path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => match (fs::read_link(path), path.file_name()) {
            // The system has followed it, so that links end.
            (Ok(to), _) => resolved(&parent.join(to)),
            (Err(_), Some(name)) if parent != path => Ok(resolved(&parent)?.join(name)),
            // `a/..` below a folder that is to be made: as the system takes it.
            _ => Ok(path.to_path_buf()),
        },
        found => found,
    }
}
