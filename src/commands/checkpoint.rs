//! The checkpoint of a run on disk: read when it begins, written now and then while it goes on, removed when it is done.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use super::console::{Console, RunProgress};
use crate::case::Case;
use crate::error::{Error, Result};
use crate::predict::checkpoint::Checkpoint;
use crate::predict::{Observer, Prediction, Progress, predict, resume};
use crate::report::output::Replaced;
use crate::units::MM;

/// Time between two checkpoints over the time that writing one takes, at least: so they cost 5 % at most.
const OVER_COST: u32 = 20;

/// Options of a command that runs a case.
#[derive(Debug, Clone, Default, clap::Args)]
#[command(next_help_heading = "Going on after an interruption")]
pub struct Args {
    /// Keep the state of the run in this file, and go on from it if it is there; removed when the run is done
    #[arg(long, value_name = "FILE")]
    pub checkpoint: Option<PathBuf>,
    /// Least time between two writings; they wait for a moment at which the solver begins anew
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
        let checkpoint = read(path, case).map_err(|error| error.in_file(path))?;
        let keeper = Keeper {
            progress,
            console,
            file: Replaced::claim(path)?,
            // The parser let no other time through.
            every: Duration::try_from_secs_f64(self.checkpoint_every).unwrap_or_default(),
            last: Mutex::new(Last { at: Instant::now(), cost: Duration::ZERO, has_failed: false }),
        };
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
}

/// The checkpoint of a case, if there is one.
fn read(path: &Path, case: &Case) -> Result<Option<Checkpoint>> {
    let bytes = match fs::read(path) {
        Ok(bytes) => bytes,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(Error::file(path, "cannot read", error)),
    };
    let checkpoint = Checkpoint::from_bytes(&bytes)?;
    checkpoint.check(case)?;
    Ok(Some(checkpoint))
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
        // Times are whole at any moment, even those of a thread that died.
        let mut last = self.last.lock().unwrap_or_else(PoisonError::into_inner);
        // Who asks for every checkpoint gets every one.
        let wait = if self.every.is_zero() { self.every } else { self.every.max(OVER_COST * last.cost) };
        if last.at.elapsed() < wait {
            return;
        }
        let begun = Instant::now();
        if let Err(error) = self.file.write(&checkpoint().to_bytes())
            && !std::mem::replace(&mut last.has_failed, true)
        {
            // A run that cannot be kept is still worth its end.
            self.console.warn(&format!("{error}: the run goes on, but cannot be taken up later"));
        }
        (last.at, last.cost) = (Instant::now(), begun.elapsed());
    }
}
