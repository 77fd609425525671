//! What goes along with a run and is no mechanics: snapshots, checkpoints, the observer, the guard, the account at the end.

use std::sync::Arc;
use std::time::Instant;

use super::checkpoint::{self, Checkpoint};
use super::initiation::{PhaseOne, phase_one};
use super::retarded::{self, Recounted};
use super::snapshot::Snapshots;
use super::way::Way;
use super::{CrossCheck, CurvePoint, GoverningCrack, Prediction, Progress, RunFigures, StopReason, TipRecord};
use super::{laws, pin_arcs, plastic_zone, tip_factors};
use crate::case::{Case, Engine};
use crate::{CrackGrowth, GrowthStatus, plate};
use perilife_base::error::{Error, Result};
use perilife_base::raster::PointGrid;
use perilife_base::raster::Snapshot;
use perilife_base::units::{MPA, MPA_SQRT_M, round_off};
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
    /// Called after every cycle block.
    fn block_done(&self, progress: &Progress) -> bool;
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
    /// Called with every snapshot; its cycles count from the start of the run, which may be before N = 0.
    fn looked(&self, _snapshot: &Snapshot, _grid: &PointGrid) {}
}

impl Observer for Silent {
    fn block_done(&self, _progress: &Progress) -> bool {
        true
    }
}

/// A run at its start.
pub struct Record<'a> {
    started: Instant,
    /// The case with the spacing that its body has: whatever a run measures in spacings and horizons, it measures in these.
    case: Case,
    hash: [u8; 32],
    checkpoint: Option<Checkpoint>,
    phase_one: Option<PhaseOne>,
    observer: &'a dyn Observer,
}

impl<'a> Record<'a> {
    /// The record of a run of a case.
    pub fn new(case: &Case, observer: &'a dyn Observer) -> Self {
        let hash = checkpoint::hash(case);
        let mut case = case.clone();
        if let Some(points) = case.model.points_mut() {
            points.spacing = points.fitting_spacing(&case.specimen);
        }
        Record { started: Instant::now(), case, hash, checkpoint: None, phase_one: None, observer }
    }

    /// The case that its run is of: the one given, with the spacing that its body has.
    pub fn case(&self) -> &Case {
        &self.case
    }

    /// Counts phase I before the run, whose growth has the cycles that it leaves.
    /// Errors: as [`phase_one`].
    pub(super) fn after_phase_one(mut self) -> Result<Self> {
        self.phase_one = phase_one(&self.case)?;
        if self.ends_in_phase_one().is_none() {
            self.case.stop.cycles_max -= self.phase_one.and_then(|phase| phase.cycles).unwrap_or(0.0);
        }
        Ok(self)
    }

    /// Why the run ends before its cracks have formed.
    pub(super) fn ends_in_phase_one(&self) -> Option<StopReason> {
        match self.phase_one?.cycles {
            None => Some(StopReason::NothingAges),
            Some(cycles) if cycles >= self.case.stop.cycles_max => Some(StopReason::RunOut),
            Some(_) => None,
        }
    }

    /// Goes on from where an earlier run of the same case stood.
    pub(super) fn resumed_from(self, checkpoint: Checkpoint) -> Self {
        Record { checkpoint: Some(checkpoint), ..self }
    }

    /// Advances a run increment by increment, from the start or from where an earlier run stood, until there is a reason to stop.
    ///
    /// Mechanics that fail after the first row end the run as [`StopReason::NoConvergence`]: the rows so far stay, and the error is
    /// among the warnings.
    /// Errors: those of the first row; a run that was cancelled; wrong input that shows only on the way.
    pub fn follow<G: CrackGrowth>(
        self,
        growth: &mut G,
        mut increment: impl FnMut(&mut G) -> Result<Option<StopReason>>,
    ) -> Result<Prediction> {
        let ends_early = self.ends_in_phase_one();
        let Record { started, case, hash, checkpoint, phase_one, observer } = self;
        let case = &case;
        let is_new = checkpoint.is_none();
        let (mut snapshots, earlier_s) = match checkpoint {
            Some(checkpoint) => checkpoint.restore(growth)?,
            None => growth.open().map(|()| (Snapshots::default(), 0.0))?,
        };
        let mut guard = Guard::default();
        let mut failure = None;
        let mut way = Way::default();
        if is_new {
            observer.begun(&way.progress(case, growth), growth.now().tips);
        }
        let stop = loop {
            laws::check_within(case, growth)?;
            if let Some((snapshot, grid)) = snapshots.follow(growth) {
                observer.looked(snapshot, &grid);
            }
            if growth.should_rebuild_solver() {
                let elapsed_s = earlier_s + started.elapsed().as_secs_f64();
                let progress = way.progress(case, growth);
                observer.may_keep(&|| Checkpoint::new(hash, growth.state(), &snapshots, &progress, elapsed_s));
                if growth.rebuild_solver().is_err() {
                    break StopReason::NoConvergence;
                }
            }
            let before = growth.now().cycles;
            let reason = increment(growth).or_else(|error| end_of_mechanics(error, &mut failure))?;
            let now = growth.now();
            let reason = reason.or(guard.check(before, &now)?);
            observer.grown(now.tips);
            let goes_on = observer.block_done(&way.progress(case, growth));
            if let Some(reason) = reason.or_else(|| observer.is_enough().then_some(StopReason::Stopped)) {
                break reason;
            }
            if !goes_on {
                return Err(Error::Mechanics(format!("{}: the run was canceled", case.name)));
            }
        };
        let stop = growth.close(stop).or_else(|error| end_of_mechanics(error, &mut failure).map(|end| end.unwrap_or(stop)))?;
        snapshots.finish(growth);
        // The curve is handed over once; what growth knows of it is asked before.
        let of_growth = growth.warnings();
        let mut curve = growth.curve();
        let counted = growth.overload();
        let recounted = retarded::recount(case, &curve, stop, counted)?;
        let end = counted.is_none().then_some(stop);
        let of_zones = recounted.as_ref().and_then(|own| retarded::other_zones(case, &curve, own, end));
        // Rows of a front are retarded as they grow, and what they would take without is not known.
        let unretarded_cycles = recounted.as_ref().filter(|_| counted.is_none()).and(curve.last()).map(|row| row.cycles);
        let (stop, of_order) = match recounted {
            Some(Recounted { curve: new, stop, warning }) => {
                snapshots.recount(&curve, &new);
                curve = new;
                (stop, warning)
            }
            None => (stop, None),
        };
        if let Some(phase) = &phase_one {
            let before = curve.clone();
            phase.precede(&mut curve);
            if ends_early == Some(StopReason::RunOut) {
                curve.iter_mut().for_each(|row| row.cycles = case.stop.cycles_max);
            }
            snapshots.recount(&before, &curve);
        }
        snapshots.keep_within(&curve);
        let wall_s = earlier_s + started.elapsed().as_secs_f64();
        let last = curve.last().map_or(0.0, |row| row.cycles);
        let governing = GoverningCrack::of(&case.specimen, &curve);
        let at = |total: f64| curve.iter().find(|row| row.crack_length >= total).map_or(total, |row| governing.length(row));
        let cross_check = growth.cross_check(last).map(|check| CrossCheck { crack_length: at(check.crack_length), ..check });
        let mut warnings = warnings(case, growth, of_growth, &curve);
        warnings.extend(of_order.into_iter().chain(of_zones));
        warnings.extend(failure);
        warnings.extend(phase_one.zip(case.fatigue.initiation).into_iter().flat_map(|(phase, law)| phase.warnings(&law)));
        warnings.extend(phase_one.iter().flat_map(|phase| of_local_stress(case, phase)));
        Ok(Prediction {
            phase_one,
            stop,
            figures: RunFigures::of(growth, curve.len() - 1, wall_s),
            snapshots: snapshots.taken,
            grid: growth.grid().unwrap_or_else(PointGrid::none),
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

/// Warnings of the local stress that the S-N curve is applied to: its ratio, and yield.
fn of_local_stress(case: &Case, phase: &PhaseOne) -> Vec<String> {
    let ratio = round_off(case.loading.ratio);
    let mut words = vec![format!("initiation: S-N curve assumed valid at R = {ratio}")];
    let largest = phase.range / (1.0 - case.loading.ratio);
    if let Some(strength) = case.material.yield_strength.filter(|strength| largest > *strength) {
        words.push(format!(
            "initiation: elastic local stress {:.1} MPa exceeds the yield strength {:.1} MPa; an elastic S-N curve is not valid there: treat \
             the initiation life as a guess, or give the curve of tests at the same concentration and load",
            largest / MPA,
            strength / MPA
        ));
    }
    words
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
            "tip {tip} grows straight at T = {:.1} MPa and K_I = {:.2} MPa√m, where a straight path is unstable (T > 0): the crack may turn to \
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
    pub fn check(&mut self, before: f64, now: &GrowthStatus<'_>) -> Result<Option<StopReason>> {
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
