//! THE MAIN PAGE: from a case to its a-N curve.
//!
//! Build the plate; until there is a reason to stop, let what drives the cracks act over a block of cycles: find equilibrium at
//! maximum load, grow the cracks, cut the bonds that this takes. What drives them ([`CrackGrowth`]) is K of their tips (driver
//! `tip_field`, the default), or bonds that age by their own strain (`bond_strain`), or K of a handbook, without any plate (method
//! `handbook`). Command, service and calibration all come through here.

pub mod bond_rate;
pub mod checkpoint;
pub mod factor_curve;
pub mod guard;
pub mod laws;
pub mod memory;
mod outcome;
pub mod plastic_zone;
pub mod residual_strength;
mod snapshot;

use std::time::Instant;

pub use outcome::{CrossCheck, CurvePoint, Observer, Prediction, Progress, RunFigures, Silent, Snapshot, StopReason, TipRecord};

pub use crate::growth::bond_strain::Recorder;
pub use crate::net::PointGrid;

use crate::case::{Case, Method};
use crate::error::{Error, Result};
use crate::fatigue::growth_law::GrowthLaw;
use crate::fatigue::{Driver, FatigueLaw};
use crate::growth::CrackGrowth;
use crate::growth::bond_strain::{BondStrain, Unrecorded};
use crate::growth::hand_calculation::HandCalculation;
use crate::growth::tip_field::TipField;
use checkpoint::Checkpoint;
use guard::Guard;
use snapshot::Album;

/// Predicts the a-N curve of a case.
///
/// # Errors
/// Wrong input that shows only now (spacing against plate, no fatigue law), or mechanics that fail before there is a curve.
pub fn predict(case: &Case, observer: &dyn Observer) -> Result<Prediction> {
    start(case, None, observer)
}

/// Goes on with a run of a case from a checkpoint of it; gives what [`predict`] gives, bit for bit, its wall time counted from the
/// start of the first run.
///
/// # Errors
/// As [`predict`]; [`Error::Input`] if the checkpoint is not one of this case.
pub fn resume(case: &Case, checkpoint: Checkpoint, observer: &dyn Observer) -> Result<Prediction> {
    checkpoint.check(case)?;
    start(case, Some(checkpoint), observer)
}

/// [`predict`] by bonds that age, with any law of bonds (given the body's horizon) and a recorder; what rate over K it stands for is
/// that of steady growth ([`bond_rate`]); K is not checked against that of
/// cleanly cut cracks, which takes an equilibrium of its own.
///
/// # Errors
/// As [`predict`].
pub fn run(
    case: &Case,
    law: impl FnOnce(f64) -> Result<FatigueLaw>,
    recorder: &mut dyn Recorder,
    observer: &dyn Observer,
) -> Result<Prediction> {
    let run = Run { is_checked: false, ..Run::of(case, None, observer) };
    let case = &fitted(case);
    let rates = |horizon| laws::rates_of_bonds(case, law(horizon)?);
    run.follow(case, &mut BondStrain::start(case, rates, recorder)?)
}

/// [`predict`] by the K of tips, with any law over K.
///
/// # Errors
/// As [`predict`].
pub fn run_by_tips(case: &Case, law: Box<dyn GrowthLaw>, observer: &dyn Observer) -> Result<Prediction> {
    let run = Run::of(case, None, observer);
    let case = &fitted(case);
    run.follow(case, &mut TipField::start(case, law)?)
}

/// A run by what its case asks to be driven by.
fn start(case: &Case, checkpoint: Option<Checkpoint>, observer: &dyn Observer) -> Result<Prediction> {
    let run = Run::of(case, checkpoint, observer);
    let case = &fitted(case);
    match (case.model.method, case.fatigue.driver) {
        (Method::Handbook, _) => run.follow(case, &mut HandCalculation::start(case, laws::growth_law(case)?)?),
        (Method::Peridynamics, Driver::TipField) => {
            // The law of bonds takes a run of its own ([`bond_rate`]).
            let (law, plate) = rayon::join(|| laws::growth_law(case), || TipField::plate(case));
            run.follow(case, &mut TipField::start_on(case, plate?, law?)?)
        }
        (Method::Peridynamics, Driver::BondStrain) => {
            let rates = |horizon| laws::bond_rates(case, horizon);
            run.follow(case, &mut BondStrain::start(case, rates, &mut Unrecorded)?)
        }
    }
}

/// The case with the spacing that its body has: whatever a run measures in spacings and horizons, it measures in these.
fn fitted(case: &Case) -> Case {
    let mut case = case.clone();
    case.model.spacing = case.model.fitting_spacing(&case.specimen);
    case
}

/// A run at its start.
struct Run<'a> {
    started: Instant,
    /// Hash of the case as it was given.
    hash: [u8; 32],
    checkpoint: Option<Checkpoint>,
    /// Whether its K is compared with an independent one.
    is_checked: bool,
    observer: &'a dyn Observer,
}

impl<'a> Run<'a> {
    fn of(case: &Case, checkpoint: Option<Checkpoint>, observer: &'a dyn Observer) -> Self {
        Run { started: Instant::now(), hash: checkpoint::hash(case), checkpoint, is_checked: true, observer }
    }

    /// Block after block, from the start or from where an earlier run stood, until there is a reason to stop.
    fn follow(self, case: &Case, growth: &mut dyn CrackGrowth) -> Result<Prediction> {
        let Run { started, hash, checkpoint, is_checked, observer } = self;
        let (mut album, earlier_s) = match checkpoint {
            Some(checkpoint) => checkpoint.restore(growth)?,
            None => growth.open().map(|()| (Album::default(), 0.0))?,
        };
        let mut guard = Guard::default();
        let stop = loop {
            laws::check_within(case, growth)?;
            album.follow(growth, observer)?;
            if growth.is_due() {
                let elapsed_s = earlier_s + started.elapsed().as_secs_f64();
                let progress = Progress::of(case, &growth.now());
                observer.may_keep(&|| Checkpoint::new(hash, growth.state(), &album, &progress, elapsed_s));
                if growth.begin_anew().is_err() {
                    break StopReason::NoConvergence;
                }
            }
            let before = growth.now().cycles_of_run;
            let reason = growth.advance()?;
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
        let stop = growth.close(stop)?;
        album.finish(growth)?;
        let (curve, zero) = growth.curve();
        album.count_from(zero, &curve);
        let wall_s = earlier_s + started.elapsed().as_secs_f64();
        let last = curve.last().map_or(0.0, |row| row.cycles);
        let cross_check = is_checked.then(|| growth.cross_check(last)).flatten();
        let mut warnings = warnings(case, growth, &curve);
        warnings.extend(cross_check.and_then(|check| check.warning()));
        Ok(Prediction {
            stop,
            figures: RunFigures::of(growth, curve.len() - 1, wall_s),
            snapshots: album.snapshots,
            grid: growth.plate().map_or_else(PointGrid::none, |plate| plate.grid()),
            curve,
            cross_check,
            warnings,
        })
    }
}

/// What the user should know about a run.
fn warnings(case: &Case, growth: &dyn CrackGrowth, curve: &[CurvePoint]) -> Vec<String> {
    let mut warnings = growth.plate().map_or_else(Vec::new, |plate| plate.warnings());
    warnings.extend(growth.warnings());
    warnings.extend(growth.law().and_then(|law| laws::beyond_warning(case, law, curve)));
    warnings.extend(plastic_zone::warnings(case, curve));
    warnings
}
