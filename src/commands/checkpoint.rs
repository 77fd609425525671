//! The checkpoint of a run on disk: read when it begins, written now and then while it goes on, removed when it is done.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use super::console::{Console, RunProgress};
use super::signals;
use perilife_base::error::{Error, Result, fail_if, input};
use perilife_base::input::{Document, Provenance};
use perilife_base::watch::Watch;
use perilife_growth::predict::checkpoint::{Checkpoint, SIGN};
use perilife_growth::predict::{Observer, Progress};
use perilife_results::output::{OutputFile, OutputFolder, Sort};
use perilife_runner::scenes::checkpoint::{SIGN as SCENE_SIGN, SceneCheckpoint};
use perilife_runner::scenes::{SceneObserver, SceneProgress};
use perilife_runner::{Summary, Task, TaskCheckpoint, Watcher};

/// Time between two checkpoints over the time that writing one takes, at least: so they cost 5 % at most.
const OVER_COST: u32 = 20;

/// Options of a command that runs a case or a scene.
#[derive(Debug, Clone, Default, clap::Args)]
#[command(next_help_heading = "Checkpoint and resume")]
pub struct Args {
    /// Save state to FILE, resume from it if present; deleted at the end
    #[arg(long, value_name = "FILE")]
    pub checkpoint: Option<PathBuf>,
    /// Minimum time between checkpoints, s
    #[arg(long, value_name = "SECONDS", default_value_t = 5.0, value_parser = seconds, requires = "checkpoint")]
    pub checkpoint_every: f64,
    /// Replace the results of another input in DIR
    #[arg(long, help_heading = "Output")]
    pub force: bool,
    /// Stop after this time, s; resume with --checkpoint
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    pub time_limit: Option<f64>,
}

fn seconds(text: &str) -> std::result::Result<f64, String> {
    let time = text.parse::<f64>().ok().filter(|time| Duration::try_from_secs_f64(*time).is_ok());
    time.ok_or_else(|| format!("`{text}` is not a time in seconds, 0 or more"))
}

impl Args {
    /// Runs the task of a document into the folder `out`, from its checkpoint if there is one; also gives the file of the checkpoint, to
    /// be removed when the run is valid.
    pub fn run(&self, task: &Task, document: &Document, out: &Path, console: &Console) -> Result<(Summary, Option<OutputFile>)> {
        // Before anything is laid out or written.
        super::within_machine(task, document)?;
        // Claimed first: a folder that cannot be written should not cost a run.
        self.check_outside(out)?;
        let read = document.folder.opened().so_far();
        let folder = OutputFolder::claim(out, task.run_kind(), &read, task.room(), self.force)?;
        let mut checkpoint = None;
        let summary = console.keep(folder, task.warnings(), |folder| {
            let run = self
                .run_kept(task, &read, folder, console)
                .inspect_err(|_| task.case().iter().for_each(|case| console.warn_all(&case.warnings)));
            let (summary, kept) = run.map_err(|error| document.locate(error))?;
            checkpoint = kept;
            Ok(summary)
        })?;
        Ok((summary, checkpoint))
    }

    fn run_kept(
        &self,
        task: &Task,
        read: &Provenance,
        folder: &Path,
        console: &Console,
    ) -> Result<(Summary, Option<OutputFile>)> {
        // The parser let no other time through.
        let limit = self.time_limit.and_then(|seconds| Duration::try_from_secs_f64(seconds).ok());
        let (name, progress) = (task.name(), console.progress_within(task.name(), limit));
        let Some(path) = &self.checkpoint else {
            let done = perilife_runner::run(task, None, Some(folder), &progress);
            return Ok((self.within_limit(name, &progress, done)?, None));
        };
        let from = match fs::read(path) {
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => None,
            read => Some(read.map_err(|error| Error::file(path, "cannot read", error))?),
        };
        let from = from.map(|bytes| TaskCheckpoint::of(task, &bytes)).transpose().map_err(|error| error.in_file(path))?;
        let keeper = self.keeper(task, read, path, progress)?;
        if let Some(from) = &from {
            console.note(&format!("{name}: resuming from {}: {}", path.display(), from.words()));
        }
        let done = perilife_runner::run(task, from, Some(folder), &keeper);
        Ok((self.within_limit(name, &keeper.progress, done)?, Some(keeper.file)))
    }

    /// What came of a run, with words for one whose time was over.
    fn within_limit(&self, name: &str, progress: &RunProgress, done: Result<Summary>) -> Result<Summary> {
        if !matches!(done, Err(Error::Mechanics(_))) || !progress.ran_out() {
            return done;
        }
        let way = match &self.checkpoint {
            Some(path) => way_on(path),
            None => "increase --time-limit, or use --checkpoint FILE".to_owned(),
        };
        let seconds = self.time_limit.unwrap_or_default();
        Err(Error::Mechanics(format!("{name}: stopped at the time limit of {seconds} s; {way}")))
    }

    /// Refuses a checkpoint below the folder of the results, which it would make one that holds something else.
    fn check_outside(&self, out: &Path) -> Result<()> {
        let Some(path) = &self.checkpoint else { return Ok(()) };
        let real = |path: &Path| std::path::absolute(fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf()));
        match (real(path), real(out)) {
            (Ok(file), Ok(folder)) if file.starts_with(&folder) => {
                let problem = format!("is inside --out = {}", out.display());
                Err(input("--checkpoint", path.display(), problem, "choose a file outside it"))
            }
            _ => Ok(()),
        }
    }

    fn keeper(&self, task: &Task, read: &Provenance, path: &Path, progress: RunProgress) -> Result<Keeper> {
        let file = path.to_path_buf();
        signals::go_on_by(move || way_on(&file));
        let sign = if matches!(task, Task::Scene(_)) { SCENE_SIGN } else { SIGN };
        let file = OutputFile::claim(path, Sort { option: "--checkpoint", sign }, read)?;
        fail_if!(!file.is_file(), input("--checkpoint", path.display(), "is not a file", "give the name of a file"));
        // The parser let no other time through.
        let every = Duration::try_from_secs_f64(self.checkpoint_every).unwrap_or_default();
        let last = Mutex::new(Last { at: Instant::now(), cost: Duration::ZERO, has_failed: false });
        Ok(Keeper { progress, file, every, last })
    }
}

fn way_on(path: &Path) -> String {
    match path.is_file() {
        true => format!("run the same command to resume from {}", path.display()),
        false => format!("no checkpoint yet ({}); run the same command to start over", path.display()),
    }
}

/// Shows how far a run is, and keeps its state.
struct Keeper {
    progress: RunProgress,
    file: OutputFile,
    every: Duration,
    last: Mutex<Last>,
}

struct Last {
    at: Instant,
    cost: Duration,
    has_failed: bool,
}

impl Observer for Keeper {
    fn watch(&self) -> Option<Arc<Watch>> {
        Observer::watch(&self.progress)
    }

    fn block_done(&self, progress: &Progress) -> bool {
        self.progress.block_done(progress)
    }

    fn may_keep(&self, checkpoint: &dyn Fn() -> Checkpoint) {
        self.may_write(&|| checkpoint().to_bytes());
    }
}

impl SceneObserver for Keeper {
    fn watch(&self) -> Option<Arc<Watch>> {
        SceneObserver::watch(&self.progress)
    }

    fn step_done(&self, progress: &SceneProgress) -> bool {
        self.progress.step_done(progress)
    }

    fn may_keep(&self, checkpoint: &dyn Fn() -> SceneCheckpoint) {
        self.may_write(&|| checkpoint().to_bytes());
    }
}

impl Watcher for Keeper {
    fn warn(&self, warning: &str) {
        self.progress.warn(warning);
    }
}

impl Keeper {
    fn may_write(&self, bytes: &dyn Fn() -> Vec<u8>) {
        // Times are whole at any moment, even those of a thread that died.
        let mut last = self.last.lock().unwrap_or_else(PoisonError::into_inner);
        // Who asks for every checkpoint gets every one.
        let wait = if self.every.is_zero() { self.every } else { self.every.max(OVER_COST * last.cost) };
        if last.at.elapsed() < wait {
            return;
        }
        let begun = Instant::now();
        if let Err(error) = self.file.rewrite(&bytes())
            && !std::mem::replace(&mut last.has_failed, true)
        {
            // A run that cannot be kept is still worth its end.
            self.warn(&format!("checkpoint: {error}: running on without checkpoints"));
        }
        (last.at, last.cost) = (Instant::now(), begun.elapsed());
    }
}
