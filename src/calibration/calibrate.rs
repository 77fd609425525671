//! A calibration from its file to the fit: K(a) of one peridynamic run or of the handbook, and the law fitted to it.

use crate::calibration::bond_constants::in_terms_of_bonds;
use crate::calibration::case::CalibrationCase;
use crate::calibration::fit::{Fit, FitTask, fit};
use crate::calibration::paris;
use crate::calibration::power_law::PowerLaw;
use crate::case::Method;
use crate::error::{Result, input_missing};
use crate::predict::Observer;
use crate::predict::factor_curve::FactorCurve;
use crate::watch;

/// Fits the constants of a calibration: A and p of bonds, or (method `handbook`) C and m of hand calculation.
///
/// A standard specimen has one K(a) whatever its growth law, so one run whose crack is driven by its tip serves every C and m; A and p
/// stand for them.
///
/// # Errors
/// Mechanics without a result, a window in which the handbook has no K, or a law that no metal has.
pub fn calibrate(calibration: &CalibrationCase, observer: &dyn Observer) -> Result<Fit> {
    let delta_k = |length: f64| calibration.delta_k(length);
    let task = FitTask {
        curves: &calibration.curves,
        fixed_p: calibration.exponent.fixed,
        criterion: calibration.criterion,
        delta_k: &delta_k,
    };
    let fit = watch::with(observer.watch(), || {
        let fit = fit_by_method(calibration, &task, &delta_k, observer);
        watch::unless_cancelled(&calibration.case.name, fit)
    })?;
    match paris::doubt(fit.paris.c, fit.paris.m) {
        None => Ok(fit),
        Some(doubt) => {
            let doubts: String = fit.warnings.iter().map(|line| format!("\n  {line}")).collect();
            Err(input_missing("measured.files", format!("give a law that no metal has: {doubt}{doubts}"), ""))
        }
    }
}

fn fit_by_method(
    calibration: &CalibrationCase,
    task: &FitTask<'_>,
    delta_k: &dyn Fn(f64) -> f64,
    observer: &dyn Observer,
) -> Result<Fit> {
    let case = &calibration.case;
    let (from, to) = (case.specimen.crack_length, case.stop.crack_length);
    match case.model.method {
        Method::Peridynamics => {
            let factors = FactorCurve::of(case, observer)?;
            let of_field = |length: f64| case.loading.range_share() * factors.at(length);
            let mut fit = fit(task, &PowerLaw::new(from, to, &of_field)?)?;
            in_terms_of_bonds(&mut fit, case, factors.figures.horizon)?;
            fit.spacing = factors.figures.spacing;
            fit.warnings.extend(factors.warnings);
            Ok(fit)
        }
        Method::Handbook => {
            let mut fit = fit(task, &PowerLaw::new(from, to, delta_k)?)?;
            // The fitted constants are C and m themselves; no line has to be drawn through rates.
            fit.paris = fit.paris.of_power_law(fit.record.constants, fit.p_error());
            Ok(fit)
        }
    }
}
