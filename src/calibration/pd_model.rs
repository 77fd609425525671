//! The peridynamic engine as forward model of a calibration, with replays of what it did.

use std::sync::{Arc, Mutex, PoisonError};

use super::finished::{FinishedRun, FinishedRuns};
use super::model::{ForwardModel, RecordedRun};
use super::recording::Recording;
use crate::case::Case;
use crate::error::{Error, Result};
use crate::fatigue::FatigueLaw;
use crate::predict::{CurvePoint, Observer, StopReason, run};

/// Takes the finished runs of a calibration to where they are kept.
pub type KeepRuns<'a> = &'a (dyn Fn(&FinishedRuns) + Sync);

/// Runs a case with A = 1 and any p.
pub struct PdModel<'a> {
    case: Case,
    runs: Mutex<Runs>,
    keep: KeepRuns<'a>,
    observer: &'a dyn Observer,
}

/// Runs that have ended, and the exponents of those that were asked for.
#[derive(Default)]
struct Runs {
    finished: FinishedRuns,
    asked: Vec<f64>,
}

impl<'a> PdModel<'a> {
    /// Forward model of a calibration case, reporting to an observer.
    ///
    /// # Errors
    /// None yet: the body is built anew by every run.
    pub fn new(case: &Case, observer: &'a dyn Observer) -> Result<Self> {
        Self::with_finished(case, FinishedRuns::default(), &|_| {}, observer)
    }

    /// The same where some runs are `finished` already, which are not made again; `keep` is told of every new one.
    ///
    /// # Errors
    /// As [`PdModel::new`].
    pub fn with_finished(case: &Case, finished: FinishedRuns, keep: KeepRuns<'a>, observer: &'a dyn Observer) -> Result<Self> {
        let mut case = case.clone();
        // With A = 1 cycles are counted in units of 1/A: a limit on cycles would mean nothing.
        case.stop.cycles_max = f64::INFINITY;
        let runs = Mutex::new(Runs { finished, asked: Vec::new() });
        Ok(PdModel { case, runs, keep, observer })
    }

    fn run_anew(&self, p: f64) -> Result<FinishedRun> {
        let mut recording = Recording::default();
        let done = run(&self.case, |horizon| Ok(FatigueLaw { a: 1.0, p, horizon }), &mut recording, self.observer)?;
        if matches!(done.stop, StopReason::NoConvergence | StopReason::NoGrowth) {
            return Err(Error::Mechanics(format!(
                "{}: {} ({}), at a crack length of {:.3} mm",
                self.case.name,
                done.stop.meaning(),
                done.stop,
                done.crack_length_final() / crate::units::MM
            )));
        }
        if done.stop == StopReason::LeftRefinement {
            return Err(Error::Mechanics(format!(
                "{}: the crack left the finest level of points at a length of {:.3} mm; give refinement.regions that hold its way up \
                 to the last reading and four horizons on",
                self.case.name,
                done.crack_length_final() / crate::units::MM
            )));
        }
        Ok(FinishedRun {
            p,
            curve: done.curve.iter().map(|CurvePoint { cycles, crack_length, .. }| (*cycles, *crack_length)).collect(),
            end: done.crack_length_final(),
            horizon: done.figures.horizon,
            spacing: done.figures.spacing,
            warnings: done.warnings,
            recording: Arc::new(recording),
        })
    }
}

impl ForwardModel for PdModel<'_> {
    fn run(&self, p: f64) -> Result<RecordedRun> {
        // Runs are put in whole.
        let runs = || self.runs.lock().unwrap_or_else(PoisonError::into_inner);
        let known = {
            let mut runs = runs();
            runs.asked.push(p);
            runs.finished.at(p).cloned()
        };
        let run = match known {
            Some(run) => run,
            None => {
                let run = self.run_anew(p)?;
                let Runs { finished, asked } = &mut *runs();
                finished.add(run.clone(), asked);
                (self.keep)(finished);
                run
            }
        };
        Ok(recorded(run))
    }
}

fn recorded(run: FinishedRun) -> RecordedRun {
    let FinishedRun { curve, end, horizon, spacing, warnings, recording, .. } = run;
    let replay = move |p: f64| recording.replay(p, end, spacing);
    let mut recorded = RecordedRun::new(curve, horizon, spacing, replay);
    recorded.coarseness = spacing;
    recorded.warnings = warnings;
    recorded
}
