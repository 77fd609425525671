//! Workers: threads that take jobs from the store one after the other and have each run in a process of its own, by the functions of
//! the commands.
//!
//! A job that wants more memory than it may have, or takes too long, ends alone; one that is cancelled ends at once, wherever it is.

pub mod child;
mod job;
mod process;

use std::fs::File;
use std::io::{BufWriter, Write as _};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

use job::work;
pub use process::look;
use tempfile::TempDir;
use tokio::runtime::Handle;
use tokio::sync::Notify;
use zip::write::SimpleFileOptions;

use super::store::{ResultFile, Store};
use perilife_base::error::{Error, Result};

#[derive(Debug, Clone)]
pub struct Settings {
    pub jobs: usize,
    pub threads: usize,
    /// Time without a sign of life after which a job is another worker's.
    pub lease: Duration,
    /// Least time between two checkpoints of a job.
    pub checkpoint_every: Duration,
    /// Claims without a checkpoint between them after which a job is given up.
    pub attempts: i64,
    /// Time after which a finished job is deleted, during which a service ran; `None` keeps it.
    pub keep: Option<Duration>,
    /// Memory that the process of a job may take, bytes.
    pub memory: u64,
    /// Computing time that a job may take, by all workers together.
    pub time: Duration,
    /// The program that takes the order of a job by its subcommand `job`.
    pub program: PathBuf,
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            jobs: std::thread::available_parallelism().map_or(1, usize::from),
            threads: 1,
            lease: Duration::from_secs(15),
            checkpoint_every: Duration::from_secs(3),
            attempts: 10,
            keep: None,
            memory: 4096 << 20,
            time: Duration::from_secs(24 * 3600),
            program: std::env::current_exe().unwrap_or_else(|_| PathBuf::from("perilife")),
        }
    }
}

/// Time between two looks for work that another machine may have submitted.
const LOOK_EVERY: Duration = Duration::from_millis(250);
/// Time before another try of a database that does not answer.
const TRY_EVERY: Duration = Duration::from_secs(1);
/// Time between two tidyings of the store.
const TIDY_EVERY: Duration = Duration::from_secs(60);

#[derive(Debug)]
struct Shared {
    store: Store,
    settings: Settings,
    /// Name of the process, unlike any other.
    name: String,
    wake: Arc<Notify>,
    stopping: AtomicBool,
    handle: Handle,
}

impl Shared {
    fn is_stopping(&self) -> bool {
        self.stopping.load(Ordering::Relaxed)
    }

    /// Waits, but not beyond the end of the process.
    async fn pause(&self, time: Duration) {
        if !self.is_stopping() {
            let _ = tokio::time::timeout(time, self.wake.notified()).await;
        }
    }
}

/// Running workers; stopped by [`Workers::stop`].
#[derive(Debug)]
pub struct Workers {
    shared: Arc<Shared>,
    threads: Vec<JoinHandle<()>>,
}

impl Workers {
    /// Starts them; `wake` tells of new jobs. Must be called within a runtime, on which their statements to the store run.
    pub fn start(store: Store, settings: Settings, wake: Arc<Notify>) -> std::io::Result<Workers> {
        remove_leftovers();
        let name = format!("{}/{}/{}", host(), std::process::id(), uuid::Uuid::now_v7());
        let handle = Handle::current();
        let shared = Arc::new(Shared { store, settings, name, wake, stopping: AtomicBool::new(false), handle });
        let mut threads = Vec::with_capacity(shared.settings.jobs);
        for number in 0..shared.settings.jobs {
            let shared = Arc::clone(&shared);
            threads.push(std::thread::Builder::new().name(format!("worker-{number}")).spawn(move || take_jobs(&shared))?);
        }
        shared.handle.spawn(tidy(Arc::clone(&shared)));
        Ok(Workers { shared, threads })
    }

    /// Asks for the end and waits for it: jobs end at once, and go on from their checkpoints elsewhere or later.
    pub async fn stop(self) {
        self.shared.stopping.store(true, Ordering::Relaxed);
        self.shared.wake.notify_waiters();
        let join = move || self.threads.into_iter().for_each(|thread| drop(thread.join()));
        let _ = tokio::task::spawn_blocking(join).await;
    }
}

/// What the name of the temporary folder of a job begins with.
const PREFIX: &str = "perilife-job-";

/// A temporary folder of a job, and the lock on it that says that somebody needs it.
fn job_folder() -> std::io::Result<(TempDir, File)> {
    loop {
        let folder = tempfile::Builder::new().prefix(PREFIX).tempdir()?;
        let lock = File::open(folder.path())?;
        lock.lock()?;
        // Another service that starts may have removed it before it was locked.
        if folder.path().exists() {
            return Ok((folder, lock));
        }
    }
}

/// Removes folders whose worker was killed together with its job.
fn remove_leftovers() {
    for path in entries(&std::env::temp_dir()).unwrap_or_default().into_iter().filter(|path| name_of(path).starts_with(PREFIX)) {
        let Ok(lock) = File::open(&path) else { continue };
        if lock.try_lock().is_ok() {
            let removed = std::fs::remove_dir_all(&path);
            tracing::info!("{}, whose worker is gone, is removed: {removed:?}", path.display());
        }
    }
}

/// What the machine calls itself.
fn host() -> String {
    let name = std::fs::read_to_string("/proc/sys/kernel/hostname").unwrap_or_default();
    if name.trim().is_empty() { "host".to_owned() } else { name.trim().to_owned() }
}

fn take_jobs(shared: &Arc<Shared>) {
    let lease_ms = milliseconds(shared.settings.lease);
    while !shared.is_stopping() {
        match shared.handle.block_on(shared.store.claim(&shared.name, shared.settings.jobs, lease_ms)) {
            Ok(Some(claim)) => {
                // There may be more where this came from.
                shared.wake.notify_one();
                if catch_unwind(AssertUnwindSafe(|| work(shared, &claim))).is_err() {
                    // Its time will run out, and it will be tried again, so many times; this worker goes on.
                    tracing::error!(job = claim.id, "a worker panicked over a job");
                }
            }
            Ok(None) => shared.handle.block_on(shared.pause(LOOK_EVERY)),
            Err(error) => {
                tracing::warn!("no job can be taken: {error}");
                shared.handle.block_on(shared.pause(TRY_EVERY));
            }
        }
    }
}

/// Deletes finished jobs when their time is over, and gives their space back.
async fn tidy(shared: Arc<Shared>) {
    let keep = shared.settings.keep;
    while !shared.is_stopping() {
        let tidied = async {
            if let Some(keep) = keep {
                let count = shared.store.expire(milliseconds(keep)).await?;
                if count > 0 {
                    tracing::info!(count, "finished jobs deleted: their time is over");
                }
            }
            shared.store.tidy().await
        };
        if let Err(error) = tidied.await {
            tracing::warn!("the store cannot be tidied: {error}");
        }
        tokio::time::sleep(keep.unwrap_or(TIDY_EVERY).clamp(TRY_EVERY, TIDY_EVERY)).await;
    }
}

fn milliseconds(time: Duration) -> i64 {
    i64::try_from(time.as_millis()).unwrap_or(i64::MAX)
}

/// Makes an archive of every folder within a folder of results.
fn packed(folder: &Path) -> Result<()> {
    for path in entries(folder)?.into_iter().filter(|path| path.is_dir()) {
        let archive = path.with_file_name(format!("{}.zip", name_of(&path)));
        pack(&path, &archive)?;
        std::fs::remove_dir_all(&path).map_err(|error| Error::file(&path, "cannot remove", error))?;
    }
    Ok(())
}

/// The files of a folder of results but for hidden ones, which are marks of the commands.
fn files(folder: &Path) -> Result<Vec<ResultFile>> {
    let files = entries(folder)?.into_iter().map(|path| ResultFile { name: name_of(&path), path });
    Ok(files.filter(|file| !file.name.starts_with('.')).collect())
}

fn bytes(folder: &Path) -> u64 {
    let within = |path: PathBuf| match std::fs::symlink_metadata(&path) {
        Ok(about) if about.is_dir() => bytes(&path),
        about => about.map_or(0, |about| about.len()),
    };
    entries(folder).unwrap_or_default().into_iter().map(within).sum()
}

fn pack(folder: &Path, archive: &Path) -> Result<()> {
    let failed = |error: &dyn std::fmt::Display| Error::file(folder, "cannot pack", std::io::Error::other(error.to_string()));
    let file = File::create(archive).map_err(|error| Error::file(archive, "cannot create", error))?;
    let mut packed = zip::ZipWriter::new(BufWriter::new(file));
    // The fastest: a plate of numbers hardly packs better at ten times the cost.
    let packing = SimpleFileOptions::default().compression_level(Some(1));
    let mut folders = vec![folder.to_path_buf()];
    while let Some(next) = folders.pop() {
        for path in entries(&next)? {
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            let name = path.strip_prefix(folder).unwrap_or(&path).to_string_lossy().into_owned();
            packed.start_file(name, packing).map_err(|error| failed(&error))?;
            let mut content = File::open(&path).map_err(|error| Error::file(&path, "cannot read", error))?;
            std::io::copy(&mut content, &mut packed).map_err(|error| failed(&error))?;
        }
    }
    packed.finish().map_err(|error| failed(&error))?.flush().map_err(|error| failed(&error))
}

fn name_of(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

fn entries(folder: &Path) -> Result<Vec<PathBuf>> {
    let cannot = |error| Error::file(folder, "cannot read the folder", error);
    let mut paths =
        std::fs::read_dir(folder).map_err(cannot)?.map(|entry| Ok(entry.map_err(cannot)?.path())).collect::<Result<Vec<_>>>()?;
    paths.sort();
    Ok(paths)
}
