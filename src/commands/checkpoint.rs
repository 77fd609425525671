//! The checkpoint of a run on disk: read when it begins, written now and then while it goes on, removed when it is done.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use super::console::{Console, RunProgress};
use crate::case::Case;
use crate::error::{Error, Result};
use crate::fracture::checkpoint::SceneCheckpoint;
use crate::fracture::{self, Fracture, Scene, SceneObserver, SceneProgress};
use crate::predict::checkpoint::Checkpoint;
use crate::predict::{Observer, Prediction, Progress, predict, resume};
use crate::report::output::Replaced;
use crate::units::MM;

/// Time between two checkpoints over the time that writing one takes, at least: so they cost 5 % at most.
const OVER_COST: u32 = 20;

/// Options of a command that runs a case or a scene.
#[derive(Debug, Clone, Default, clap::Args)]
#[command(next_help_heading = "Going on after an interruption")]
pub struct Args {
    /// Keep the state of the run in this file, and go on from it if it is there; removed when the run is done
    #[arg(long, value_name = "FILE")]
    pub checkpoint: Option<PathBuf>,
    /// Least time between two writings; they wait for a place from which the run can go on
    #[arg(long, value_name = "SECONDS", default_value_t = 5.0, value_parser = seconds, requires = "checkpoint")]
    pub checkpoint_every: f64,
}

/// A time that is not negative.
fn seconds(text: &str) -> std::result::Result<f64, String> {
    let time = text.parse::<f64>().ok().filter(|time| Duration::try_from_secs_f64(*time).is_ok());
    time.ok_or_else(|| format!("`{text}` is no time in seconds, 0 or more"))
}

impl Args {
    /// Runs a case, from its checkpoint if there is one.
    ///
    /// # Errors
    /// As [`predict`] and [`resume`]; a file that cannot be read, or is no checkpoint of this case.
    pub fn run(&self, case: &Case, console: &Console) -> Result<Prediction> {
        let progress = console.progress(&case.name);
        let Some(path) = &self.checkpoint else { return predict(case, &progress) };
        let of_case = |bytes: Vec<u8>| Checkpoint::from_bytes(&bytes).and_then(|kept| kept.check(case).map(|()| kept));
        let checkpoint = read(path)?.map(of_case).transpose().map_err(|error| error.in_file(path))?;
        let keeper = self.keeper(path, progress, console)?;
        let Some(checkpoint) = checkpoint else { return predict(case, &keeper) };
        let Progress { cycles, crack_length, .. } = checkpoint.progress();
        console.note(&format!(
            "{}: goes on from {}: N = {cycles:.1}, a = {:.3} mm",
            case.name,
            path.display(),
            crack_length / MM
        ));
        resume(case, checkpoint, &keeper)
    }

    /// Runs a scene, from its checkpoint if there is one.
    ///
    /// # Errors
    /// As [`fracture::run`] and [`fracture::resume`]; a file that cannot be read, or is no checkpoint of this scene.
    pub fn run_scene(&self, scene: &Scene, console: &Console) -> Result<Fracture> {
        let progress = console.progress(&scene.name);
        let Some(path) = &self.checkpoint else { return fracture::run(scene, &progress) };
        let of_scene = |bytes: Vec<u8>| SceneCheckpoint::from_bytes(&bytes).and_then(|kept| kept.check(scene).map(|()| kept));
        let checkpoint = read(path)?.map(of_scene).transpose().map_err(|error| error.in_file(path))?;
        let keeper = self.keeper(path, progress, console)?;
        let Some(checkpoint) = checkpoint else { return fracture::run(scene, &keeper) };
        let (step, share) = (checkpoint.step(), checkpoint.progress().share);
        console.note(&format!("{}: goes on from {}: step {step}, {:.1} % done", scene.name, path.display(), 100.0 * share));
        fracture::resume(scene, checkpoint, &keeper)
    }

    fn keeper<'a>(&self, path: &Path, progress: RunProgress, console: &'a Console) -> Result<Keeper<'a>> {
        Ok(Keeper {
            progress,
            console,
            file: Replaced::claim(path)?,
            // The parser let no other time through.
            every: Duration::try_from_secs_f64(self.checkpoint_every).unwrap_or_default(),
            last: Mutex::new(Last { at: Instant::now(), cost: Duration::ZERO, has_failed: false }),
        })
    }
}

/// What stands in the file, if there is one.
fn read(path: &Path) -> Result<Option<Vec<u8>>> {
    match fs::read(path) {
        Ok(bytes) => Ok(Some(bytes)),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(Error::file(path, "cannot read", error)),
    }
}

/// Removes the file, if one was given, of a run that is done.
///
/// # Errors
/// [`Error::File`] if it is there and cannot be removed.
pub fn remove(checkpoint: Option<&Path>) -> Result<()> {
    let Some(path) = checkpoint else { return Ok(()) };
    match fs::remove_file(path) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => Err(Error::file(path, "cannot remove", error)),
        _ => Ok(()),
    }
}

/// Shows how far a run is, and keeps its state.
struct Keeper<'a> {
    progress: RunProgress,
    console: &'a Console,
    file: Replaced,
    every: Duration,
    last: Mutex<Last>,
}

/// The last writing.
struct Last {
    at: Instant,
    cost: Duration,
    has_failed: bool,
}

impl Observer for Keeper<'_> {
    fn block_done(&self, progress: &Progress) -> bool {
        self.progress.block_done(progress)
    }

    fn may_keep(&self, checkpoint: &dyn Fn() -> Checkpoint) {
        self.may_write(&|| checkpoint().to_bytes());
    }
}

impl SceneObserver for Keeper<'_> {
    fn step_done(&self, progress: &SceneProgress) -> bool {
        self.progress.step_done(progress)
    }

    fn may_keep(&self, checkpoint: &dyn Fn() -> SceneCheckpoint) {
        self.may_write(&|| checkpoint().to_bytes());
    }
}

impl Keeper<'_> {
    /// Writes the file if it is time.
    fn may_write(&self, bytes: &dyn Fn() -> Vec<u8>) {
        // Times are whole at any moment, even those of a thread that died.
        let mut last = self.last.lock().unwrap_or_else(PoisonError::into_inner);
        // Who asks for every checkpoint gets every one.
        let wait = if self.every.is_zero() { self.every } else { self.every.max(OVER_COST * last.cost) };
        if last.at.elapsed() < wait {
            return;
        }
        let begun = Instant::now();
        if let Err(error) = self.file.write(&bytes())
            && !std::mem::replace(&mut last.has_failed, true)
        {
            // A run that cannot be kept is still worth its end.
            self.console.warn(&format!("{error}: the run goes on, but cannot be taken up later"));
        }
        (last.at, last.cost) = (Instant::now(), begun.elapsed());
    }
}
