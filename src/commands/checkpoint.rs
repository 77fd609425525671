//! The checkpoint of a run on disk: read when it begins, written now and then while it goes on, removed when it is done.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use super::console::{Console, RunProgress};
use super::signals;
use crate::case::Case;
use crate::error::{Error, Result, input};
use crate::fracture::checkpoint::{SIGN as SCENE_SIGN, SceneCheckpoint};
use crate::fracture::{self, Fracture, Scene, SceneObserver, SceneProgress};
use crate::input::Provenance;
use crate::predict::checkpoint::{Checkpoint, SIGN};
use crate::predict::{Observer, Prediction, Progress, predict, resume};
use crate::report::output::{Replaced, Sort};
use crate::units::MM;
use crate::watch::Watch;

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
    /// Time after which the run is asked to end, building the plate included; with a checkpoint the same command goes on later
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    pub time_limit: Option<f64>,
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
    pub fn run(&self, case: &Case, console: &Console) -> Result<(Prediction, Option<Replaced>)> {
        let progress = self.progress(&case.name, console);
        let Some(path) = &self.checkpoint else {
            return Ok((self.within_limit(&case.name, &progress, predict(case, &progress))?, None));
        };
        let of_case = |bytes: Vec<u8>| Checkpoint::from_bytes(&bytes).and_then(|kept| kept.check(case).map(|()| kept));
        let checkpoint = read(path)?.map(of_case).transpose().map_err(|error| error.in_file(path))?;
        let keeper = self.keeper((path, SIGN), progress, &case.provenance, console)?;
        let Some(checkpoint) = checkpoint else {
            return Ok((self.within_limit(&case.name, &keeper.progress, predict(case, &keeper))?, Some(keeper.file)));
        };
        let Progress { cycles, crack_length, .. } = checkpoint.progress();
        console.note(&format!(
            "{}: goes on from {}: N = {cycles:.1}, a = {:.3} mm",
            case.name,
            path.display(),
            crack_length / MM
        ));
        let done = resume(case, checkpoint, &keeper);
        Ok((self.within_limit(&case.name, &keeper.progress, done)?, Some(keeper.file)))
    }

    /// Runs a scene, from its checkpoint if there is one.
    ///
    /// # Errors
    /// As [`fracture::run`] and [`fracture::resume`]; a file that cannot be read, or is no checkpoint of this scene.
    pub fn run_scene(&self, scene: &Scene, console: &Console) -> Result<(Fracture, Option<Replaced>)> {
        let progress = self.progress(&scene.name, console);
        let Some(path) = &self.checkpoint else {
            return Ok((self.within_limit(&scene.name, &progress, fracture::run(scene, &progress))?, None));
        };
        let of_scene = |bytes: Vec<u8>| SceneCheckpoint::from_bytes(&bytes).and_then(|kept| kept.check(scene).map(|()| kept));
        let checkpoint = read(path)?.map(of_scene).transpose().map_err(|error| error.in_file(path))?;
        let keeper = self.keeper((path, SCENE_SIGN), progress, &scene.provenance, console)?;
        let Some(checkpoint) = checkpoint else {
            return Ok((self.within_limit(&scene.name, &keeper.progress, fracture::run(scene, &keeper))?, Some(keeper.file)));
        };
        let (step, share) = (checkpoint.step(), checkpoint.progress().share);
        console.note(&format!("{}: goes on from {}: step {step}, {:.1} % done", scene.name, path.display(), 100.0 * share));
        let done = fracture::resume(scene, checkpoint, &keeper);
        Ok((self.within_limit(&scene.name, &keeper.progress, done)?, Some(keeper.file)))
    }

    fn progress(&self, name: &str, console: &Console) -> RunProgress {
        // The parser let no other time through.
        let limit = self.time_limit.and_then(|seconds| Duration::try_from_secs_f64(seconds).ok());
        console.progress_within(name, limit)
    }

    /// What came of a run, with words for one whose time was over.
    fn within_limit<T>(&self, name: &str, progress: &RunProgress, done: Result<T>) -> Result<T> {
        if done.is_ok() || !progress.ran_out() {
            return done;
        }
        let way = match &self.checkpoint {
            Some(path) if path.is_file() => format!("the same command goes on from {}", path.display()),
            Some(path) => format!("the same command begins anew: {} was not written yet", path.display()),
            None => "give more, or keep the run with --checkpoint FILE".to_owned(),
        };
        let seconds = self.time_limit.unwrap_or_default();
        Err(Error::Mechanics(format!("{name}: the time limit of {seconds} s is over before the run is; {way}")))
    }

    /// Refuses a checkpoint below the folder of the results, which it would make one that holds something else.
    pub fn check_outside(&self, out: &Path) -> Result<()> {
        let Some(path) = &self.checkpoint else { return Ok(()) };
        let real = |path: &Path| std::path::absolute(fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf()));
        match (real(path), real(out)) {
            (Ok(file), Ok(folder)) if file.starts_with(&folder) => {
                let problem = format!("lies below --out = {}, which has nothing but results", out.display());
                Err(input("--checkpoint", path.display(), problem, "give a name beside it"))
            }
            _ => Ok(()),
        }
    }

    fn keeper<'a>(
        &self,
        (path, sign): (&Path, &'static [u8]),
        progress: RunProgress,
        read: &Provenance,
        console: &'a Console,
    ) -> Result<Keeper<'a>> {
        signals::go_on_from(path);
        Ok(Keeper {
            progress,
            console,
            file: Replaced::claim(path, Sort { option: "--checkpoint", sign }, read)?,
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

impl SceneObserver for Keeper<'_> {
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
