//! From a document to results: one reader and one runner of whatever an input file asks for, used by the commands, by sweeps and by
//! the workers of a service.

pub mod factor_sweep;
mod factors;
pub mod sweep;
pub mod sweep_folder;
mod task;

pub use task::{Kind, Task, Wanted};

use std::path::Path;
use std::time::Instant;

use serde_json::{Map, Value, json};

use crate::calibration::calibrate::{Calibration, Fitted};
use crate::calibration::case::CalibrationCase;
use crate::calibration::population::plate::lot_of;
use crate::case::Case;
use crate::error::{Error, Result};
use crate::fracture::checkpoint::SceneCheckpoint;
use crate::fracture::{self, Fracture, Scene, SceneEnd, SceneObserver};
use crate::predict::checkpoint::Checkpoint;
use crate::predict::residual_strength::{check_strength, residual_strength};
use crate::predict::{Observer, Prediction, Silent, predict, resume};
use crate::report;
use crate::report::answers::{Answers, Asked};
use crate::report::band::Lives;
use crate::report::output::Share;
use crate::report::quality::Quality;
use crate::report::sweep::Plan;
use crate::report::units::show_folder;
use crate::sweep::fleet;
use crate::units::MM;
use sweep_folder::SweepFolder;

/// Receives progress and warnings of a run of whatever kind.
pub trait Watcher: Observer + SceneObserver {
    /// What the user should know of the run, as it comes up.
    fn warn(&self, _warning: &str) {}
}

impl Watcher for Silent {}

/// What came of a run.
#[derive(Debug, Default)]
pub struct Summary {
    /// Content of `result.json`, `fit.json` or `sweep.json`.
    pub result: Value,
    /// The part of it that a listing of runs shows, all that the user should know under `warnings`.
    pub figures: Value,
    /// Tables that were asked for on standard output.
    pub tables: String,
    /// The result in words.
    pub lines: Vec<String>,
    /// Why the run does not count, though its files are written.
    pub refusal: Option<Error>,
}

impl Summary {
    /// The summary of a run that counts.
    /// Errors: its refusal.
    pub fn counted(mut self) -> Result<Summary> {
        self.refusal.take().map_or(Ok(self), Err)
    }
}

/// Where an earlier run of a task stood.
#[derive(Debug)]
pub enum TaskCheckpoint {
    /// Of a run of cycles.
    Cycles(Box<Checkpoint>),
    /// Of a scene.
    Scene(Box<SceneCheckpoint>),
}

impl TaskCheckpoint {
    /// The checkpoint of a task from the bytes of its file.
    /// Errors: bytes that are no checkpoint, or one of another task.
    pub fn of(task: &Task, bytes: &[u8]) -> Result<TaskCheckpoint> {
        match task {
            Task::Scene(scene) => SceneCheckpoint::from_bytes(bytes)
                .and_then(|kept| kept.check(scene).map(|()| TaskCheckpoint::Scene(Box::new(kept)))),
            _ => Checkpoint::from_bytes(bytes)
                .and_then(|kept| kept.check(task.case()?).map(|()| TaskCheckpoint::Cycles(Box::new(kept)))),
        }
    }

    /// How far the run had come, in words.
    pub fn words(&self) -> String {
        match self {
            TaskCheckpoint::Cycles(kept) => {
                let progress = kept.progress();
                format!("N = {:.1}, a = {:.3} mm", progress.cycles, progress.crack_length / MM)
            }
            TaskCheckpoint::Scene(kept) => format!("step {}, {:.1} % done", kept.step(), 100.0 * kept.progress().share),
        }
    }
}

/// Runs a task, from a checkpoint of it if there is one, and writes all files of its results into an empty folder if one is given.
/// Errors: mechanics without a result, wrong input that shows only now, files that cannot be written.
pub fn run(task: &Task, from: Option<TaskCheckpoint>, folder: Option<&Path>, watcher: &dyn Watcher) -> Result<Summary> {
    match task {
        Task::Prediction { case, wanted } => {
            // A record that is damaged, and a factor that is none, should not cost a run either.
            let lot = lot_of(case)?;
            case.fleet.as_ref().map_or(Ok(()), |fleet| fleet::check(fleet, lot.as_ref().err()))?;
            wanted.inspection.map_or(Ok(()), |from| from.check())?;
            if wanted.strength {
                // A plate without known strength should not cost a run; K of its curve comes later.
                check_strength(case)?;
            }
            report::run::refuse_beforehand(case)?;
            let prediction = match from {
                Some(TaskCheckpoint::Cycles(checkpoint)) => resume(case, *checkpoint, watcher)?,
                _ => predict(case, watcher)?,
            };
            of_prediction(case, &prediction, wanted, folder, watcher)
        }
        Task::Scene(scene) => {
            let fracture = match from {
                Some(TaskCheckpoint::Scene(checkpoint)) => fracture::resume(scene, *checkpoint, watcher)?,
                _ => fracture::run(scene, watcher)?,
            };
            of_scene(scene, &fracture, folder, watcher)
        }
        Task::Fit(calibration) => of_fit(calibration, folder, watcher),
        Task::Factors { case, methods, on_nodes } => factors::run(case, methods, *on_nodes, folder, watcher),
        Task::Sweep { sweep, cases } => {
            let Some(folder) = folder else { return Err(Error::Mechanics(format!("{}: a sweep needs a folder", sweep.name))) };
            let begun = Instant::now();
            let read = sweep.document.folder.opened().so_far();
            let folder = SweepFolder::open(folder, Plan::new(sweep, cases), &read, Share::Alone)?;
            let threads = rayon::current_num_threads();
            sweep::run(&cases.iter().collect::<Vec<_>>(), &folder, threads, true, &|| ())?;
            sweep::collect(&folder, begun, watcher)
        }
    }
}

/// Judges a run of cycles and writes its files.
/// Errors: as [`report::run::judge`]; a damaged record; files that cannot be written.
pub fn of_prediction(
    case: &Case,
    prediction: &Prediction,
    wanted: &Wanted,
    folder: Option<&Path>,
    watcher: &dyn Watcher,
) -> Result<Summary> {
    use report::run;
    // What a check says in a line stands in the file at length.
    let told = run::told_by_checks(case, prediction);
    let warn = |warnings: &[String]| warnings.iter().filter(|line| !told.contains(line)).for_each(|line| watcher.warn(line));
    warn(&prediction.warnings);
    let judged = run::judge(case, prediction)?;
    warn(&judged);
    report::checks::lines(&report::checks::of_run(case, prediction)).iter().for_each(|line| watcher.warn(line));
    // If that fails, the run itself is written all the same.
    let strengths = wanted.strength.then(|| residual_strength(case, &prediction.curve)).transpose();
    let mut lives = Lives::of(case, prediction)?;
    let quality = Quality::of(case, prediction, [!wanted.no_estimate, wanted.cross_check]);
    let asked = wanted.readings.as_ref().map_or(Ok(()), |curve| lives.narrow(curve));
    let asked = asked.and_then(|()| wanted.inspection.map_or(Ok(()), |from| lives.inspect(from)));
    let answered = asked.and_then(|()| {
        Answers::of(case, prediction, &lives, Asked { detection: wanted.detection, sensitivities: wanted.sensitivities })
    });
    let (answers, asked) = match answered {
        Ok(answers) => (answers, Ok(())),
        Err(error) => (Answers::default(), Err(error)),
    };
    let mut result = match folder {
        Some(folder) => run::write(folder, case, prediction, (&lives, &quality, &answers))?,
        None => {
            let mut result = run::result(case, prediction);
            lives.add_to(&mut result);
            quality.add_to(&mut result);
            answers.add_to(&mut result);
            result
        }
    };
    if let (Some(folder), Ok(Some(strengths))) = (folder, &strengths) {
        run::write_strength(folder, case, strengths)?;
    }
    folder.map_or(Ok(()), |folder| show_folder(folder, &mut result))?;
    let refusal = run::refusal(case, prediction);
    let mut warnings: Vec<String> = refusal.iter().map(Error::to_string).collect();
    warnings.extend(result["warnings"].as_array().into_iter().flatten().filter_map(|warning| Some(warning.as_str()?.to_owned())));
    let new: Vec<String> = judged.into_iter().filter(|warning| !warnings.contains(warning)).collect();
    warnings.extend(new);
    let figures = run::FIGURES.iter().filter_map(|key| Some(((*key).to_owned(), result.get(*key)?.clone())));
    let mut figures: Map<String, Value> = figures.collect();
    figures.insert("warnings".to_owned(), json!(warnings));
    let mut lines = run::words(case, prediction, &lives, &quality);
    lines.extend(answers.words());
    let refusal = refusal.or(strengths.err()).or(asked.err());
    Ok(Summary { result, figures: figures.into(), lines, refusal, ..Summary::default() })
}

/// Writes the files of a scene that was run.
pub fn of_scene(scene: &Scene, fracture: &Fracture, folder: Option<&Path>, watcher: &dyn Watcher) -> Result<Summary> {
    fracture.warnings.iter().for_each(|warning| watcher.warn(warning));
    let mut result = report::fracture::result(scene, fracture);
    if let Some(folder) = folder {
        report::fracture::write(folder, scene, fracture, &result)?;
        show_folder(folder, &mut result)?;
    }
    let is_bad = matches!(fracture.end, SceneEnd::NoConvergence | SceneEnd::Unstable);
    let bad = || Error::Mechanics(format!("{}: {}: {}", scene.name, fracture.end, fracture.end.meaning()));
    let (figures, lines) = (result.clone(), report::fracture::words(scene, fracture));
    Ok(Summary { result, figures, lines, refusal: is_bad.then(bad), ..Summary::default() })
}

fn of_fit(calibration: &Calibration, folder: Option<&Path>, watcher: &dyn Watcher) -> Result<Summary> {
    let started = Instant::now();
    let fitted = calibration.fit(watcher)?;
    let wall_s = started.elapsed().as_secs_f64();
    fitted.warnings().iter().for_each(|warning| watcher.warn(warning));
    let result = fitted.report(wall_s);
    folder.map_or(Ok(()), |folder| report::fit::write(folder, &fitted, &result))?;
    let mut figures = result.clone();
    if let Fitted::Lives(CalibrationCase { case, .. }, _) = fitted {
        // What the law is of.
        figures["material"] = json!(case.material.name);
        figures["plane"] = json!(case.material.plane.name());
        figures["stress_ratio"] = json!(case.loading.ratio);
        figures["thickness_mm"] = json!(case.specimen.thickness / MM);
    }
    Ok(Summary { result, figures, lines: fitted.summary(wall_s), ..Summary::default() })
}
