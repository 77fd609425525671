//! What is in the making: hidden files and folders beside their place, lock files, new folders above them. They go when they are dropped
//! or the process is asked to end, unless they were published before.
//!
//! A lock keeps a place for one writer at a time. It is that of the system, so that it ends with its process however that ends; its file says
//! who has it. Who takes it removes what killed processes left.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Read, Write as _};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use super::Marker;
use perilife_base::error::{Error, Result, input};
use perilife_base::input::FileId;

/// How a thing is removed: a file, a tree, or a folder if it is empty.
type Remove = fn(&Path) -> io::Result<()>;

/// File that marks a folder as made by this program.
pub const MARKER: &str = ".perilife";

static ALL: Mutex<Vec<(PathBuf, Remove)>> = Mutex::new(Vec::new());

#[derive(Debug)]
pub(super) struct Staging {
    path: PathBuf,
    remove: Remove,
}

impl Staging {
    pub fn beside(target: &Path) -> io::Result<Self> {
        let path = temporary_beside(target, PARTIAL);
        Ok(Self::made(&path, remove_all, || fs::create_dir(&path))?.0)
    }

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

    fn take(path: &Path, share: Share) -> io::Result<Lock> {
        let mut waited = 0;
        loop {
            match Staging::made(path, |path| fs::remove_file(path), || locked(path, share)) {
                // Who leaves has it alone for a moment, to remove its file.
                Err(error) if error.kind() == io::ErrorKind::WouldBlock && waited < LEAVING_MS => {
                    std::thread::sleep(Duration::from_millis(1));
                    waited += 1;
                }
                made => return made.map(|(beside, (file, is_real))| Lock { is_real, beside, file }),
            }
        }
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

/// Time that a lock is waited for, ms: no run ends within it, but a holder that leaves has gone.
const LEAVING_MS: u32 = 50;

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

fn holder() -> String {
    let host = fs::read_to_string("/proc/sys/kernel/hostname").unwrap_or_default();
    let host = if host.trim().is_empty() { "this machine" } else { host.trim() };
    format!("process {} on {host}, since {}\n", std::process::id(), crate::format::now())
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
