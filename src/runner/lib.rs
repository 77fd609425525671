//! From a document to results: one reader and one runner of whatever an input file asks for, used by the commands, by sweeps and by
//! the workers of a service.
//!
//! Knows: what a document asks for, how it is run, what it leaves; the list of all kinds; results of scenes.
//! Must not know: terminals, networks, how jobs are kept.
//!
//! Imports `results` and what it imports, and `scenes`; service, program and Python import it.

pub mod factors;
pub mod guide;
pub mod sweep;
pub mod scene_results;
pub mod catalogue;
pub mod check;
mod task;

pub use perilife_scenes as scenes;

pub use perilife_results::checks::Message;
pub use perilife_results::run::{Judged, Wanted};
pub use task::{Draft, Kind, Task, put_law};

use std::path::Path;
use std::time::Instant;

use serde_json::{Value, json};

use perilife_base::columns::Table;
use perilife_base::error::{Error, Result, input_missing};
use perilife_base::units::MM;
use perilife_calibration::calibrate::{Calibration, Fitted};
use perilife_calibration::case::CalibrationCase;
use perilife_calibration::fit::Fit;
use perilife_calibration::laws::LawFits;
use perilife_calibration::population::plate::lot_of;
use perilife_calibration::sweep::fleet;
use perilife_growth::case::Case;
use perilife_growth::predict::checkpoint::Checkpoint;
use perilife_growth::predict::residual_strength::check_strength;
use perilife_growth::predict::{Observer, Prediction, Silent, predict, resume};
use perilife_growth::stress_concentration::Stressed;
use perilife_results::output::Share;
use perilife_results::sweep::Plan;
use perilife_results::{fit, stresses};
use perilife_scenes::checkpoint::SceneCheckpoint;
use perilife_scenes::{Fracture, Scene, SceneEnd, SceneObserver};
use sweep::SweepFolder;

/// Receives progress and warnings of a run of whatever kind.
pub trait Watcher: Observer + SceneObserver {
    /// What the user should know of the run, as it comes up.
    fn warn(&self, _warning: &str) {}
}

impl Watcher for Silent {}

#[derive(Debug, Default)]
pub struct Summary {
    /// Content of `result.json`, `fit.json` or `sweep.json`.
    pub result: Value,
    /// The part of it that a listing of runs shows, all that the user should know under `warnings`.
    pub figures: Value,
    pub printed: String,
    /// The result in words, the answer first.
    pub lines: Vec<String>,
    pub details: Vec<String>,
    /// Checks that did not pass and warnings, the most severe first.
    pub messages: Vec<Message>,
    /// Why the run does not count, though its files are written.
    pub refusal: Option<Error>,
    done: Done,
}

#[derive(Debug, Default)]
enum Done {
    #[default]
    Nothing,
    Cycles(Box<Prediction>, Box<Judged>),
    Scene(Box<Fracture>, [(Table, String); 3]),
    Lives(Box<Fit>, fit::Kept),
    Rates(Box<LawFits>, fit::Kept),
    Stresses(Box<Stressed>),
}

impl Summary {
    pub fn of_words(lines: Vec<String>, details: Vec<String>, messages: Vec<Message>) -> Self {
        Summary { lines, details, messages, ..Summary::default() }
    }

    /// The summary of a valid run.
    /// Errors: its refusal.
    pub fn counted(mut self) -> Result<Summary> {
        self.refusal.take().map_or(Ok(self), Err)
    }

    /// Texts of its tables by the names of their files.
    /// Errors: a law whose rate is not known.
    pub fn tables(&self, task: &Task) -> Result<Vec<(String, String)>> {
        let texts = |tables: Vec<Table>| {
            tables.into_iter().map(|table| (table.file.display().to_string(), table.csv())).collect::<Vec<_>>()
        };
        Ok(match (&self.done, task) {
            (Done::Cycles(prediction, judged), Task::Prediction { case, .. }) => texts(judged.tables(case, prediction)?),
            (Done::Scene(_, tables), _) => {
                tables.iter().map(|(table, text)| (table.file.display().to_string(), text.clone())).collect()
            }
            (Done::Lives(_, kept) | Done::Rates(_, kept), _) => {
                kept.texts().map(|(name, text)| (name.display().to_string(), text.to_owned())).collect()
            }
            _ => Vec::new(),
        })
    }

    /// Writes all files of its results into an empty folder.
    /// Errors: files that cannot be written.
    pub fn write(&self, task: &Task, folder: &Path) -> Result<()> {
        match (&self.done, task) {
            (Done::Cycles(prediction, judged), Task::Prediction { case, .. }) => judged.write(folder, case, prediction),
            (Done::Scene(fracture, tables), Task::Scene(scene)) => {
                scene_results::write(folder, scene, (fracture, tables), &self.result)
            }
            (Done::Lives(found, kept), Task::Fit(Calibration::Lives(case))) => {
                fit::write(folder, &Fitted::Lives(case, found.clone()), kept)
            }
            (Done::Rates(found, kept), Task::Fit(Calibration::Rates(case))) => {
                fit::write(folder, &Fitted::Rates(case, (**found).clone()), kept)
            }
            (Done::Stresses(stressed), Task::Factors { case, .. }) => stresses::write(folder, case, stressed, &self.result),
            _ => Err(Error::Mechanics(format!("{}: K of tips has no results folder", task.name()))),
        }
    }
}

#[derive(Debug)]
pub enum TaskCheckpoint {
    Cycles(Box<Checkpoint>),
    Scene(Box<SceneCheckpoint>),
}

impl TaskCheckpoint {
    /// The checkpoint of a task from the bytes of its file.
    /// Errors: bytes that are no checkpoint, or one of another task.
    pub fn of(task: &Task, bytes: &[u8]) -> Result<TaskCheckpoint> {
        match task {
            Task::Scene(scene) => SceneCheckpoint::of(scene, bytes).map(|from| TaskCheckpoint::Scene(Box::new(from))),
            _ => Checkpoint::of(task.case()?, bytes).map(|from| TaskCheckpoint::Cycles(Box::new(from))),
        }
    }

    pub fn words(&self) -> String {
        match self {
            TaskCheckpoint::Cycles(from) => {
                let progress = from.kept.progress;
                format!("N = {:.1}, a = {:.3} mm", progress.cycles, progress.crack_length / MM)
            }
            TaskCheckpoint::Scene(from) => format!("step {}, {:.1} % done", from.kept.step(), 100.0 * from.kept.share),
        }
    }
}

/// Runs a task, from a checkpoint of it if there is one, and writes all files of its results into an empty folder if one is given.
/// Errors: mechanics without a result, wrong input that shows only now, files that cannot be written.
pub fn run(task: &Task, from: Option<TaskCheckpoint>, folder: Option<&Path>, watcher: &dyn Watcher) -> Result<Summary> {
    if let Task::Sweep { sweep, cases } = task {
        let Some(folder) = folder else { return Err(Error::Mechanics(format!("{}: a sweep needs a folder", sweep.name))) };
        let begun = Instant::now();
        let read = sweep.document.folder.opened().so_far();
        let folder = SweepFolder::open(folder, Plan::new(sweep, cases), &read, Share::Alone)?;
        let threads = rayon::current_num_threads();
        sweep::run(&cases.iter().collect::<Vec<_>>(), &folder, threads, true, &|| ())?;
        return sweep::collect(&folder, begun, watcher);
    }
    let summary = of(task, from, folder, watcher)?;
    folder.map_or(Ok(()), |folder| summary.write(task, folder))?;
    Ok(summary)
}

/// Runs a task, from a checkpoint of it if there is one; `folder` is where its files will be, if they will.
/// Errors: mechanics without a result, wrong input that shows only now.
pub fn of(task: &Task, from: Option<TaskCheckpoint>, folder: Option<&Path>, watcher: &dyn Watcher) -> Result<Summary> {
    match task {
        Task::Prediction { case, wanted } => {
            check_wanted(case, wanted)?;
            let prediction = match from {
                Some(TaskCheckpoint::Cycles(checkpoint)) => resume(case, *checkpoint, watcher)?,
                _ => predict(case, watcher)?,
            };
            of_prediction(case, prediction, wanted, watcher)
        }
        Task::Scene(scene) => {
            let fracture = match from {
                Some(TaskCheckpoint::Scene(checkpoint)) => perilife_scenes::resume(scene, *checkpoint, watcher)?,
                _ => perilife_scenes::run(scene, watcher)?,
            };
            Ok(of_scene(scene, fracture, watcher))
        }
        Task::Fit(calibration) => of_fit(calibration, watcher),
        Task::Factors { case, methods, on_nodes } => factors::of(case, methods, *on_nodes, folder),
        Task::Sweep { .. } => Err(input_missing("design", "has many cases", "run `perilife sweep`")),
    }
}

/// Refuses what a run would be refused for after it: what is wrong there should not cost a run.
/// Errors: a record that is damaged, a fleet in which nothing scatters, a factor that is none, a plate without known strength, a load
/// that breaks it at once.
pub fn check_wanted(case: &Case, wanted: &Wanted) -> Result<()> {
    let lot = lot_of(case)?;
    case.fleet.as_ref().map_or(Ok(()), |fleet| fleet::check(fleet, lot.as_ref().err()))?;
    wanted.inspection.map_or(Ok(()), |from| from.check())?;
    if wanted.strength {
        // K of its curve comes later.
        check_strength(case)?;
    }
    perilife_growth::predict::judgement::refuse_beforehand(case)
}

/// Judges a run of cycles.
/// Errors: as [`Judged::of`].
pub fn of_prediction(case: &Case, prediction: Prediction, wanted: &Wanted, watcher: &dyn Watcher) -> Result<Summary> {
    let by_run = || prediction.warnings.iter().for_each(|line| watcher.warn(line));
    let mut judged = Judged::of(case, &prediction, wanted).inspect_err(|_| by_run())?;
    let (lines, details, messages) = (judged.words(case, &prediction), judged.details(case, &prediction), judged.messages());
    let refusal = judged.take_refusal();
    let result = json!(judged.record);
    let figures = perilife_results::run::figures(&result);
    let done = Done::Cycles(Box::new(prediction), Box::new(judged));
    Ok(Summary { result, figures, lines, details, messages, refusal, done, ..Summary::default() })
}

pub fn of_scene(scene: &Scene, fracture: Fracture, watcher: &dyn Watcher) -> Summary {
    fracture.warnings.iter().for_each(|warning| watcher.warn(warning));
    let tables = scene_results::tables(&fracture);
    let result = json!(scene_results::record(scene, &fracture, &tables));
    let is_bad = matches!(fracture.end, SceneEnd::NoConvergence | SceneEnd::Unstable);
    let bad = || Error::Mechanics(format!("{}: {}: {}", scene.name, fracture.end, fracture.end.meaning()));
    let (figures, lines, refusal) = (result.clone(), scene_results::words(scene, &fracture), is_bad.then(bad));
    Summary { result, figures, lines, refusal, done: Done::Scene(Box::new(fracture), tables), ..Summary::default() }
}

fn of_fit(calibration: &Calibration, watcher: &dyn Watcher) -> Result<Summary> {
    let started = Instant::now();
    let fitted = calibration.fit(watcher)?;
    let wall_s = started.elapsed().as_secs_f64();
    let messages = fitted.warnings().iter().map(|line| Message::warning(line)).collect();
    let record = fitted.record(wall_s);
    let mut figures = json!(record);
    let kept = fit::Kept::of(&fitted, record)?;
    let (result, [lines, details]) = (kept.json(), kept.record.words());
    if let Fitted::Lives(CalibrationCase { case, .. }, _) = fitted {
        // What the law is of, and what its test notes for the report.
        figures["test"] = result["test"].clone();
        figures["plane"] = json!(case.material.plane.name());
        figures["thickness_mm"] = json!(case.specimen.thickness / MM);
    }
    let done = match fitted {
        Fitted::Lives(_, found) => Done::Lives(found, kept),
        Fitted::Rates(_, found) => Done::Rates(Box::new(found), kept),
    };
    Ok(Summary { result, figures, lines, details, messages, done, ..Summary::default() })
}
