//! A calibration from its file to the fit, by the model that `model.method` names.

use crate::calibration::case::CalibrationCase;
use crate::calibration::field_model::{FieldModel, in_terms_of_bonds};
use crate::calibration::finished::FinishedRuns;
use crate::calibration::fit::{Fit, FitTask, fit};
use crate::calibration::model::ForwardModel;
use crate::calibration::pd_model::{KeepRuns, PdModel};
use crate::calibration::power_law::PowerLaw;
use crate::case::Method;
use crate::error::Result;
use crate::fatigue::GrowthRate;
use crate::predict::Observer;
use crate::predict::bond_rate::ReferenceModel;

/// Fits the constants of a calibration: A and p of bonds, or (method `handbook`) C and m of hand calculation.
///
/// # Errors
/// Mechanics without a result, or a window in which the handbook has no K.
pub fn calibrate(calibration: &CalibrationCase, observer: &dyn Observer) -> Result<Fit> {
    calibrate_from(calibration, FinishedRuns::default(), &|_| {}, observer)
}

/// [`calibrate`] with runs that an earlier one finished before it was broken off; `keep` is told of them and of every new one.
/// The fit is the same.
///
/// # Errors
/// As [`calibrate`]; runs of another calibration.
pub fn calibrate_from(
    calibration: &CalibrationCase,
    finished: FinishedRuns,
    keep: KeepRuns<'_>,
    observer: &dyn Observer,
) -> Result<Fit> {
    let delta_k = |length: f64| calibration.delta_k(length);
    let finished = finished.checked(calibration)?;
    let task = FitTask {
        curves: &calibration.curves,
        fixed_p: calibration.exponent.fixed,
        criterion: calibration.criterion,
        delta_k: &delta_k,
    };
    let fit_with = |model: &dyn ForwardModel| fit(&task, model);
    let case = &calibration.case;
    match case.model.method {
        Method::Peridynamics if case.is_driven_by_tips() => {
            let mut fit = fit_with(&FieldModel::new(case, observer)?)?;
            in_terms_of_bonds(&mut fit, case)?;
            Ok(fit)
        }
        Method::Peridynamics => {
            let mut fit = fit_with(&PdModel::with_finished(case, finished, keep, observer)?)?;
            if case.fatigue.growth_rate == GrowthRate::StressIntensity {
                fit.rate_constant = Some(ReferenceModel::of(&case.model).rate_constant(fit.record.constants.p)?);
            }
            Ok(fit)
        }
        Method::Handbook => {
            let mut fit = fit_with(&PowerLaw::new(case.specimen.crack_length, case.stop.crack_length, &delta_k)?)?;
            // The fitted constants are C and m themselves; no line has to be drawn through rates.
            fit.paris = fit.paris.of_power_law(fit.record.constants, fit.p_error());
            Ok(fit)
        }
    }
}
