//! What goes along with a run and is no mechanics: snapshots, checkpoints, the observer, the guard, the account at the end.

use std::sync::Arc;
use std::time::Instant;

use super::chain::Chain;
use super::checkpoint::{Checkpoint, KeptRun};
use super::retarded::{self, Recounted};
use super::snapshot::Snapshots;
use super::way::Way;
use super::{CrossCheck, CurvePoint, GoverningCrack, Prediction, Progress, RunFigures, StopReason, TipRecord};
use super::{laws, pin_arcs, plastic_zone, tip_factors};
use crate::case::{Case, Engine};
use crate::{CrackGrowth, plate};
use perilife_base::error::{Error, Result, fail_if};
use perilife_base::raster::{PointGrid, Snapshot};
use perilife_base::sealed::Kept;
use perilife_base::units::{MPA, MPA_SQRT_M};
use perilife_base::watch::{Silent, Watch};

/// Exponent from which small causes decide: an error of direction of a tenth of a degree has become some 10° at 2 e³.
const DECISIVE: f64 = 3.0;
/// |K_II| over K_I up to which a path counts as one in mode I.
const STRAIGHT: f64 = 0.05;
/// Share of the life, at its end, in which a path does not matter any more.
const END: f64 = 0.05;
/// Increments without growth of any tip at which a run ends; a tip grows by a spacing with ten to a hundred broken bonds.
pub const BLOCKS_WITHOUT_GROWTH: usize = 4096;

/// Receives progress; the engine itself never prints. Returning `false` asks the run to stop.
pub trait Observer: Sync {
    /// Called after every cycle block; by default the run goes on.
    fn block_done(&self, _progress: &Progress) -> bool {
        true
    }
    /// Whether the run may end after this block with the curve so far.
    fn is_enough(&self) -> bool {
        false
    }
    /// Where the run marks what it does before it has a first row to show, and where it looks whether it may go on; by default nowhere.
    fn watch(&self) -> Option<Arc<Watch>> {
        None
    }
    /// Called where the run could be taken up again ([`super::resume`]); `checkpoint` builds what that takes, so that nothing is
    /// built where nobody wants it. By default nobody does.
    ///
    /// These places depend on the case alone, not on time and not on what the observer does.
    fn may_keep(&self, _checkpoint: &dyn Fn() -> Checkpoint) {}
    /// Called where a run that is not taken up stands before its first increment, with where the tips are.
    fn begun(&self, _start: &Progress, _tips: &[TipRecord]) {}
    /// Called after every cycle block since N = 0, before [`Observer::block_done`], with where the tips are now.
    fn grown(&self, _tips: &[TipRecord]) {}
    /// Called with every snapshot.
    fn looked(&self, _snapshot: &Snapshot, _grid: &PointGrid) {}
}

impl Observer for Silent {}

/// A run at its start.
pub struct Record<'a> {
    started: Instant,
    /// The case with the spacing that its body has: whatever a run measures in spacings and horizons, it measures in these.
    case: Case,
    hash: [u8; 32],
    observer: &'a dyn Observer,
}

impl<'a> Record<'a> {
    /// The record of a run of a case.
    pub fn new(case: &Case, observer: &'a dyn Observer) -> Self {
        let hash = KeptRun::hash(case);
        let mut case = case.clone();
        if let Some(points) = case.model.points_mut() {
            points.spacing = points.fitting_spacing(&case.specimen);
        }
        Record { started: Instant::now(), case, hash, observer }
    }

    /// The case that its run is of: the one given, with the spacing that its body has.
    pub fn case(&self) -> &Case {
        &self.case
    }

    /// Advances a life step by step, from the start or from where an earlier run was, until there is a reason to stop.
    ///
    /// Mechanics that fail after the first row end the run as [`StopReason::NoConvergence`]: the rows so far stay, and the error is
    /// among the warnings.
    /// Errors: those of the first row; a run that was cancelled; wrong input that shows only on the way.
    pub fn follow(self, mut chain: Chain<'_>, from: Option<Checkpoint>) -> Result<Prediction> {
        let Record { started, case, hash, observer } = self;
        let (case, chain) = (&case, &mut chain);
        let mut way = Way::default();
        let (mut snapshots, earlier_s) = match from {
            Some(Checkpoint { wall_s, kept, .. }) => (kept.restore(chain)?, wall_s),
            None => {
                chain.open()?;
                observer.begun(&way.progress(case, chain), &chain.now().tips);
                (Snapshots::default(), 0.0)
            }
        };
        let mut guard = Guard::default();
        let mut failure = None;
        let stop = loop {
            laws::check_within(case, chain.now(), chain.stage.law())?;
            if let Some((snapshot, grid)) = snapshots.follow(chain) {
                observer.looked(snapshot, &grid);
            }
            if chain.stage.should_rebuild_solver() {
                let elapsed_s = earlier_s + started.elapsed().as_secs_f64();
                let progress = way.progress(case, chain);
                observer.may_keep(&|| Checkpoint::new(hash, elapsed_s, KeptRun::of(chain, &snapshots, &progress)));
                if chain.stage.rebuild_solver().is_err() {
                    break StopReason::NoConvergence;
                }
            }
            let before = chain.now().cycles;
            let reason = chain.step().or_else(|error| end_of_mechanics(error, &mut failure))?;
            let reason = reason.or(guard.check(before, chain.now())?);
            observer.grown(&chain.now().tips);
            let goes_on = observer.block_done(&way.progress(case, chain));
            if let Some(reason) = reason.or_else(|| observer.is_enough().then_some(StopReason::Stopped)) {
                break reason;
            }
            fail_if!(!goes_on, Error::Mechanics(format!("{}: the run was canceled", case.name)));
        };
        let stop =
            chain.stage.close(stop).or_else(|error| end_of_mechanics(error, &mut failure).map(|end| end.unwrap_or(stop)))?;
        snapshots.finish(chain);
        // The curve is handed over once; what growth knows of it is asked before.
        let of_growth = chain.warnings();
        let curve = chain.curve();
        let counted = chain.overload();
        let recounted = retarded::recount(case, &curve, stop, counted)?;
        let end = counted.is_none().then_some(stop);
        let of_zones = recounted.as_ref().and_then(|own| retarded::other_zones(case, &curve, own, end));
        // Rows of a front are retarded as they grow, and what they would take without is not known.
        let unretarded_cycles = recounted.as_ref().filter(|_| counted.is_none()).and(curve.last()).map(|row| row.cycles);
        let Recounted { curve, stop, warning } = match recounted {
            Some(recounted) => {
                snapshots.recount(&curve, &recounted.curve);
                recounted
            }
            None => Recounted { curve, stop, warning: None },
        };
        snapshots.keep_within(&curve);
        let wall_s = earlier_s + started.elapsed().as_secs_f64();
        let last = curve.last().map_or(0.0, |row| row.cycles);
        let governing = GoverningCrack::of(&case.specimen, &curve);
        let at = |total: f64| curve.iter().find(|row| row.crack_length >= total).map_or(total, |row| governing.length(row));
        let cross_check = chain.cross_check(last).map(|check| CrossCheck { crack_length: at(check.crack_length), ..check });
        let mut warnings = warnings(case, &*chain.stage, of_growth, &curve);
        warnings.extend(warning.into_iter().chain(of_zones).chain(failure));
        warnings.extend(chain.phase_one.iter().flat_map(|phase| phase.warnings(case)));
        Ok(Prediction {
            phase_one: chain.phase_one,
            stop,
            figures: RunFigures::of(chain, curve.len() - 1, wall_s),
            snapshots: snapshots.taken,
            grid: chain.stage.grid().unwrap_or_else(PointGrid::none),
            curve,
            cross_check,
            unretarded_cycles,
            warnings,
        })
    }
}

/// What an error of mechanics ends a run with; what it says is kept. Others are no matter of the mechanics.
fn end_of_mechanics(error: Error, failure: &mut Option<String>) -> Result<Option<StopReason>> {
    match error {
        Error::LossOfStiffness => Ok(Some(StopReason::Severed)),
        Error::Mechanics(problem) => {
            *failure = Some(format!("stopped: {problem}; reduce model.spacing_mm, or use another model.solver"));
            Ok(Some(StopReason::NoConvergence))
        }
        other => Err(other),
    }
}

/// What the user should know about a run.
fn warnings(case: &Case, growth: &dyn CrackGrowth, of_growth: Vec<String>, curve: &[CurvePoint]) -> Vec<String> {
    let mut warnings: Vec<String> = growth.body().and_then(|body| plate::warning(&body)).into_iter().collect();
    warnings.extend(of_growth);
    warnings.extend(growth.law().and_then(|law| laws::beyond_warning(case, law, curve)));
    warnings.extend(plastic_zone::plane_warning(case, curve));
    warnings.extend(unstable_path(curve));
    warnings.extend(pin_arcs::line(case));
    let is_on_points = case.engine() == Engine::Points;
    warnings.extend(curve.first().filter(|_| is_on_points).and_then(|row| tip_factors::beside_nodes(case, &row.tips)));
    warnings
}

/// What the user should know of tips whose straight path is unstable, with T where it has become so.
///
/// A crack in mode I with a positive T leaves its line (Cotterell and Rice 1980, Int. J. Fract. 16:155): an error of direction grows with
/// the way x as `exp(β² x)`, `β = 2√2 T/K_I`. Where T and K_I change, the exponent is `∫ 8 (T/K_I)² dx`.
fn unstable_path(curve: &[CurvePoint]) -> Option<String> {
    let tips = curve.first().map_or(0, |row| row.tips.len());
    let counts = (1.0 - END) * curve.last().map_or(0.0, |row| row.cycles);
    let unstable = |tip: usize| {
        let mut exponent = 0.0;
        curve.windows(2).take_while(|rows| rows[1].cycles <= counts).find_map(|rows| {
            let [before, now] = [&rows[0].tips[tip], &rows[1].tips[tip]];
            let ([k_i, k_ii], t_stress) = (now.factors?, now.t_stress?);
            if t_stress > 0.0 && k_i > 0.0 && k_ii.abs() < STRAIGHT * k_i {
                exponent += 8.0 * (t_stress / k_i).powi(2) * (now.growth - before.growth);
            }
            (exponent > DECISIVE).then_some((tip, k_i, t_stress))
        })
    };
    (0..tips).find_map(unstable).map(|(tip, k_i, t_stress)| {
        format!(
            "path: tip {tip} grows straight at T = {:.1} MPa and K_I = {:.2} MPa√m, where a straight path is unstable (T > 0): the crack may turn to \
             either side, in a test as well",
            t_stress / MPA,
            k_i / MPA_SQRT_M
        )
    })
}

/// What no run may do: count cycles that are no number, or go on for ever without growth.
#[derive(Debug, Default)]
pub struct Guard {
    /// Growth of all tips together at the last block that had some, m, and blocks since.
    grown: Option<f64>,
    idle: usize,
}

impl Guard {
    /// Takes in the row after a block; the reason to stop where no tip has grown for too long. Runs without tips have none to watch.
    /// Errors: [`Error::Mechanics`]: cycles or crack length that are no finite number, or cycles that fall.
    pub fn check(&mut self, before: f64, now: &CurvePoint) -> Result<Option<StopReason>> {
        for (what, value) in [("cycles", now.cycles), ("crack length", now.crack_length)] {
            if !value.is_finite() {
                let problem = format!("the {what} after a block came out as {value} (crack length {:.6e} m)", now.crack_length);
                return Err(Error::Mechanics(format!("{problem}; reduce model.spacing_mm, and report this case")));
            }
        }
        if now.cycles < before {
            let problem = format!("cycles fell from {before} to {}", now.cycles);
            return Err(Error::Mechanics(format!("{problem}; report this case")));
        }
        let grown = now.growth();
        self.idle = if now.tips.is_empty() || self.grown.is_none_or(|before| grown > before) { 0 } else { self.idle + 1 };
        self.grown = Some(self.grown.map_or(grown, |before| before.max(grown)));
        Ok((self.idle >= BLOCKS_WITHOUT_GROWTH).then_some(StopReason::NoGrowth))
    }
}
