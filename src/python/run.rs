//! One run of whatever kind, kept so that its tables can be read and its files written later.

use std::path::{Path, PathBuf};

use perilife_base::error::input_missing;
use perilife_base::error::{Error, Result};
use perilife_base::input::Provenance;
use perilife_calibration::calibrate::{Calibration, Fitted};
use perilife_calibration::fit::Fit;
use perilife_calibration::laws::LawFits;
use perilife_growth::predict::{Prediction, predict};
use perilife_results::output::OutputFolder;
use perilife_results::run::{CRACK_PATH_FILE, RESIDUAL_STRENGTH_FILE};
use perilife_results::{csv, factors};
use perilife_runner::scenes::Fracture;
use perilife_runner::{Judged, Task};
use pyo3::prelude::*;

use crate::errors::raised;
use crate::watcher::Told;

/// A run that counts.
#[pyclass(frozen, module = "perilife._perilife")]
pub struct Run {
    task: Task,
    done: Done,
    read: Provenance,
    /// Content of `result.json` or `fit.json`.
    #[pyo3(get)]
    result: String,
    /// The result in words.
    #[pyo3(get)]
    lines: Vec<String>,
    /// What the user should know.
    #[pyo3(get)]
    warnings: Vec<String>,
}

/// What came of it.
enum Done {
    Cycles(Box<Prediction>, Box<Judged>),
    Scene(Box<Fracture>),
    Lives(Box<Fit>, perilife_results::fit::Kept),
    Rates(Box<LawFits>, perilife_results::fit::Kept),
    Factors,
}

impl Run {
    /// Runs a task.
    /// Errors: as [`perilife_runner::run`]; a run that does not count.
    pub fn of(task: Task, read: Provenance, told: &Told) -> Result<Self> {
        let of_input = task.warnings().to_vec();
        let (done, result, lines) = match &task {
            Task::Prediction { case, wanted } => {
                perilife_runner::check_wanted(case, wanted)?;
                let prediction = predict(case, told)?;
                let mut judged = Judged::of(case, &prediction, wanted, told)?;
                judged.take_refusal().map_or(Ok(()), Err)?;
                let (result, lines) = (judged.kept.result.to_string(), judged.words(case, &prediction));
                (Done::Cycles(Box::new(prediction), Box::new(judged)), result, lines)
            }
            Task::Scene(scene) => {
                let fracture = perilife_runner::scenes::run(scene, told)?;
                let summary = perilife_runner::of_scene(scene, &fracture, None, told)?.counted()?;
                (Done::Scene(Box::new(fracture)), summary.result.to_string(), summary.lines)
            }
            Task::Fit(calibration) => {
                let begun = std::time::Instant::now();
                let fitted = calibration.fit(told)?;
                let wall_s = begun.elapsed().as_secs_f64();
                fitted.warnings().iter().for_each(|warning| perilife_runner::Watcher::warn(told, warning));
                let kept = perilife_results::fit::Kept::of(&fitted, wall_s)?;
                let (result, lines) = (kept.json().to_string(), kept.record.words());
                let done = match fitted {
                    Fitted::Lives(_, fit) => Done::Lives(fit, kept),
                    Fitted::Rates(_, fits) => Done::Rates(Box::new(fits), kept),
                };
                (done, result, lines)
            }
            Task::Factors { .. } => {
                let summary = perilife_runner::run(&task, None, None, told)?.counted()?;
                let table = summary.tables.lines().map(str::to_owned);
                (Done::Factors, summary.result.to_string(), table.chain(summary.lines).collect())
            }
            Task::Sweep { .. } => return Err(input_missing("design", "asks for many cases", "run `perilife sweep`")),
        };
        let warnings = of_input.into_iter().chain(told.warnings()).collect();
        Ok(Run { task, done, read, result, lines, warnings })
    }

    /// Its tables by the names of their files.
    fn all_tables(&self) -> Result<Vec<(&'static str, String)>> {
        Ok(match (&self.done, &self.task) {
            (Done::Cycles(prediction, judged), Task::Prediction { case, .. }) => {
                let mut tables =
                    vec![(csv::A_N_FILE, judged.kept.a_n.clone()), (CRACK_PATH_FILE, judged.kept.crack_path.clone())];
                if factors::are_known(prediction) {
                    tables.push((factors::FACTORS_FILE, factors::factors(case, prediction)?));
                }
                tables.extend(judged.strength_table(case).map(|table| (RESIDUAL_STRENGTH_FILE, table)));
                tables
            }
            (Done::Scene(fracture), _) => perilife_runner::scene_results::tables(fracture).into(),
            (Done::Lives(_, kept) | Done::Rates(_, kept), _) => kept.tables.clone(),
            _ => Vec::new(),
        })
    }

    /// Writes all its files into an empty folder.
    fn write(&self, folder: &Path) -> Result<()> {
        match (&self.done, &self.task) {
            (Done::Cycles(prediction, judged), Task::Prediction { case, .. }) => judged.write(folder, case, prediction),
            (Done::Scene(fracture), Task::Scene(scene)) => {
                perilife_runner::of_scene(scene, fracture, Some(folder), &perilife_growth::predict::Silent).map(drop)
            }
            (Done::Lives(fit, kept), Task::Fit(Calibration::Lives(case))) => {
                perilife_results::fit::write(folder, &Fitted::Lives(case, fit.clone()), kept)
            }
            (Done::Rates(fits, kept), Task::Fit(Calibration::Rates(case))) => {
                perilife_results::fit::write(folder, &Fitted::Rates(case, (**fits).clone()), kept)
            }
            _ => Err(Error::Mechanics(format!("{}: factors of tips have no folder of results", self.task.name()))),
        }
    }
}

#[pymethods]
impl Run {
    /// Texts of its tables by the names of their files.
    fn tables(&self, py: Python<'_>) -> PyResult<Vec<(&'static str, String)>> {
        py.detach(|| self.all_tables()).map_err(raised)
    }

    /// Writes what its command writes into `--out`.
    fn save(&self, py: Python<'_>, folder: PathBuf) -> PyResult<()> {
        let save = || {
            let mut claimed = OutputFolder::claim(&folder, self.task.run_kind(), &self.read, self.task.room())?;
            claimed.fill(|path| self.write(path))?;
            claimed.finish().map(drop)
        };
        py.detach(save).map_err(raised)
    }
}
