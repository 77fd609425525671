//! A calibration from its file to the fit: K(a) of a peridynamic run or of the handbook, and the law fitted to it.

use crate::calibration::bond_constants::in_terms_of_bonds;
use crate::calibration::case::CalibrationCase;
use crate::calibration::fit::{Fit, FitTask, fit};
use crate::calibration::paris;
use crate::calibration::power_law::PowerLaw;
use crate::case::Method;
use crate::error::{Result, input_missing};
use crate::predict::Observer;
use crate::predict::factor_curve::{EXPONENT_USUAL, FactorCurve};
use crate::units::MPA_SQRT_M;
use crate::watch;

/// Change of the exponent below which the path of several tips needs no other run.
const EXPONENT_SAME: f64 = 0.05;
/// Error of a block, percent, of a run whose K stands for a plate that no handbook has: what lies between its rows is interpolated. Curves
/// made with m = 3.4 on a lattice of ten spacings in the crack give 3.60 with the 0.2 of a life, 3.395 with 0.05 and 3.399 with 0.0125.
const STEP_ERROR_PERCENT: f64 = 0.05;
/// Most runs of a plate whose tips share the growth by the exponent that is sought.
const RUNS_MAX: usize = 4;

/// Fits the constants of a calibration: A and p of bonds, or (method `handbook`) C and m of hand calculation.
///
/// The path of a crack does not depend on C, and that of a single tip not on m either, so one run whose crack is driven by its tip serves
/// every C and m; A and p stand for them. Tips of unlike K share the growth by m: the run is repeated at the m that was fitted.
///
/// # Errors
/// Mechanics without a result, a window in which the handbook has no K, or a law that no metal has.
pub fn calibrate(calibration: &CalibrationCase, observer: &dyn Observer) -> Result<Fit> {
    let fit = watch::with(observer.watch(), || {
        let fit = fit_by_method(calibration, observer);
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

fn fit_by_method(calibration: &CalibrationCase, observer: &dyn Observer) -> Result<Fit> {
    let case = &calibration.case;
    let (from, to) = (case.specimen.crack_length, case.stop.crack_length);
    let Some(_) = calibration.delta_k(from) else { return fit_along_path(calibration, observer) };
    let delta_k = |length: f64| calibration.delta_k(length).unwrap_or(f64::NAN);
    let task = task(calibration, &delta_k);
    match case.model.method {
        Method::Peridynamics => {
            let factors = FactorCurve::of(case, observer)?;
            let of_field = |length: f64| case.loading.range_share() * factors.at(length);
            let fit = fit(&task, &PowerLaw::new(from, to, &of_field)?)?;
            of_bonds(fit, calibration, factors)
        }
        Method::ElementFreeGalerkin => {
            let factors = FactorCurve::of(case, observer)?;
            let of_nodes = |length: f64| case.loading.range_share() * factors.at(length);
            let mut fit = fit(&task, &PowerLaw::new(from, to, &of_nodes)?)?;
            fit.paris = fit.paris.of_power_law(fit.record.constants, fit.p_error());
            fit.warnings.extend(factors.warnings);
            Ok(fit)
        }
        Method::Handbook => {
            let mut fit = fit(&task, &PowerLaw::new(from, to, &delta_k)?)?;
            // The fitted constants are C and m themselves; no line has to be drawn through rates.
            fit.paris = fit.paris.of_power_law(fit.record.constants, fit.p_error());
            Ok(fit)
        }
    }
}

fn task<'a>(calibration: &'a CalibrationCase, delta_k: &'a dyn Fn(f64) -> f64) -> FitTask<'a> {
    FitTask { curves: &calibration.curves, fixed_p: calibration.exponent.fixed, criterion: calibration.criterion, delta_k }
}

/// The fit to K of the tips of a plate that no handbook has, along their own paths.
fn fit_along_path(calibration: &CalibrationCase, observer: &dyn Observer) -> Result<Fit> {
    let mut case = calibration.case.clone();
    case.fatigue.step_error_percent = case.fatigue.step_error_percent.min(STEP_ERROR_PERCENT);
    let mut m = calibration.exponent.fixed.unwrap_or(EXPONENT_USUAL);
    let mut run = 1;
    loop {
        let factors = FactorCurve::at_exponent(&case, m, observer)?;
        let share = case.loading.range_share();
        let of_tips = |length: f64| factors.of_tips(length).into_iter().map(|k| share * k).collect();
        let law = PowerLaw::of_tips(case.specimen.crack_length, case.stop.crack_length, &of_tips)?;
        let at_exponent = |m: f64| {
            let delta_k = |length: f64| law.delta_k(length, m) * MPA_SQRT_M;
            fit(&task(calibration, &delta_k), &law)
        };
        let mut fit = at_exponent(m)?;
        let fitted = fit.record.constants.p;
        if (fitted - m).abs() > EXPONENT_SAME && factors.depends_on_exponent() && run < RUNS_MAX {
            (m, run) = (fitted, run + 1);
            continue;
        }
        // ΔK that stands for all tips goes with the exponent.
        if fitted != m {
            fit = at_exponent(fitted)?;
        }
        fit.paris = fit.paris.of_power_law(fit.record.constants, fit.p_error());
        let reached = |fold: fn(f64, f64) -> f64, start: f64| {
            fit.record.crack_length.iter().map(|&length| law.largest_delta_k(length)).fold(start, fold)
        };
        (fit.paris.delta_k_min, fit.paris.delta_k_max) = (reached(f64::min, f64::INFINITY), reached(f64::max, 0.0));
        if (fitted - m).abs() > EXPONENT_SAME && factors.depends_on_exponent() {
            fit.warnings.push(format!("the path of the cracks is that of m = {m:.3}, and {fitted:.3} was fitted to it"));
        }
        (fit.evaluations, fit.own_factors) = (run, Some(law));
        return of_bonds(fit, calibration, factors);
    }
}

/// The fit in terms of A and p, where there are bonds.
fn of_bonds(mut fit: Fit, calibration: &CalibrationCase, factors: FactorCurve) -> Result<Fit> {
    if calibration.case.model.method == Method::Peridynamics {
        in_terms_of_bonds(&mut fit, &calibration.case, factors.figures.horizon)?;
    }
    fit.spacing = factors.figures.spacing;
    fit.warnings.extend(factors.warnings);
    Ok(fit)
}
