//! What goes along with a run and is no mechanics: snapshots, checkpoints, the observer, the guard, the account at the end.

use std::time::Instant;

use super::checkpoint::{self, Checkpoint};
use super::guard::Guard;
use super::snapshot::Snapshots;
use super::{CurvePoint, Observer, Prediction, Progress, RunFigures, StopReason, laws, path_stability, plastic_zone};
use crate::case::Case;
use crate::error::{Error, Result};
use crate::growth::CrackGrowth;
use crate::levels::PointGrid;

/// A run at its start.
pub struct Record<'a> {
    started: Instant,
    /// The case with the spacing that its body has: whatever a run measures in spacings and horizons, it measures in these.
    case: Case,
    /// Hash of the case as it was given.
    hash: [u8; 32],
    checkpoint: Option<Checkpoint>,
    is_checked: bool,
    observer: &'a dyn Observer,
}

impl<'a> Record<'a> {
    /// The record of a run of a case.
    pub fn new(case: &Case, observer: &'a dyn Observer) -> Self {
        let hash = checkpoint::hash(case);
        let mut case = case.clone();
        case.model.spacing = case.model.fitting_spacing(&case.specimen);
        Record { started: Instant::now(), case, hash, checkpoint: None, is_checked: true, observer }
    }

    /// The case that its run is of: the one given, with the spacing that its body has.
    pub fn case(&self) -> &Case {
        &self.case
    }

    /// Goes on from where an earlier run of the same case stood.
    pub(super) fn resumed_from(self, checkpoint: Checkpoint) -> Self {
        Record { checkpoint: Some(checkpoint), ..self }
    }

    /// Does not compare K with an independent one, which for fatigue bonds takes an equilibrium of its own.
    pub fn unchecked(self) -> Self {
        Record { is_checked: false, ..self }
    }

    /// Advances a run increment by increment, from the start or from where an earlier run stood, until there is a reason to stop.
    ///
    /// Mechanics that fail after the first row end the run as [`StopReason::NoConvergence`]: the rows so far stay, and the error is
    /// among the warnings.
    ///
    /// # Errors
    /// Those of the first row; a run that was cancelled; wrong input that shows only on the way.
    pub fn follow<G: CrackGrowth>(
        self,
        growth: &mut G,
        mut increment: impl FnMut(&mut G) -> Result<Option<StopReason>>,
    ) -> Result<Prediction> {
        let Record { started, case, hash, checkpoint, is_checked, observer } = self;
        let case = &case;
        let (mut snapshots, earlier_s) = match checkpoint {
            Some(checkpoint) => checkpoint.restore(growth)?,
            None => growth.open().map(|()| (Snapshots::default(), 0.0))?,
        };
        let mut guard = Guard::default();
        let mut failure = None;
        let stop = loop {
            laws::check_within(case, growth)?;
            snapshots.follow(growth, observer);
            if growth.should_rebuild_solver() {
                let elapsed_s = earlier_s + started.elapsed().as_secs_f64();
                let progress = Progress::of(case, &growth.now());
                observer.may_keep(&|| Checkpoint::new(hash, growth.state(), &snapshots, &progress, elapsed_s));
                if growth.rebuild_solver().is_err() {
                    break StopReason::NoConvergence;
                }
            }
            let before = growth.now().cycles_of_run;
            let reason = increment(growth).or_else(|error| end_of_mechanics(error, &mut failure))?;
            let now = growth.now();
            let reason = reason.or(guard.check(before, &now)?);
            if now.is_counting {
                observer.grown(now.tips);
            }
            let goes_on = observer.block_done(&Progress::of(case, &now));
            if let Some(reason) = reason {
                break reason;
            }
            if !goes_on {
                return Err(Error::Mechanics(format!("{}: the run was cancelled", case.name)));
            }
        };
        let stop = growth.close(stop).or_else(|error| end_of_mechanics(error, &mut failure).map(|end| end.unwrap_or(stop)))?;
        snapshots.finish(growth);
        // The curve is handed over once; what growth knows of it is asked before.
        let of_growth = growth.warnings();
        let (curve, zero) = growth.curve();
        snapshots.count_from(zero, &curve);
        let wall_s = earlier_s + started.elapsed().as_secs_f64();
        let last = curve.last().map_or(0.0, |row| row.cycles);
        let cross_check = is_checked.then(|| growth.cross_check(last)).flatten();
        let mut warnings = warnings(case, growth, of_growth, &curve);
        warnings.extend(cross_check.and_then(|check| check.warning()));
        warnings.extend(failure);
        Ok(Prediction {
            stop,
            figures: RunFigures::of(growth, curve.len() - 1, wall_s),
            snapshots: snapshots.taken,
            grid: growth.grid().unwrap_or_else(PointGrid::none),
            curve,
            cross_check,
            warnings,
        })
    }
}

/// What an error of mechanics ends a run with; what it says is kept. Others are no matter of the mechanics.
fn end_of_mechanics(error: Error, failure: &mut Option<String>) -> Result<Option<StopReason>> {
    match error {
        Error::LossOfStiffness => Ok(Some(StopReason::Severed)),
        Error::Mechanics(problem) => {
            *failure =
                Some(format!("the run ends here, since {problem}; give a smaller model.spacing_mm, or another model.solver"));
            Ok(Some(StopReason::NoConvergence))
        }
        other => Err(other),
    }
}

/// What the user should know about a run.
fn warnings(case: &Case, growth: &dyn CrackGrowth, of_growth: Vec<String>, curve: &[CurvePoint]) -> Vec<String> {
    let mut warnings = growth.plate().map_or_else(Vec::new, |plate| plate.warnings());
    warnings.extend(of_growth);
    warnings.extend(growth.law().and_then(|law| laws::beyond_warning(case, law, curve)));
    warnings.extend(plastic_zone::warnings(case, curve));
    warnings.extend(path_stability::warning(curve));
    warnings
}
