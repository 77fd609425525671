//! A calibration from its file to the fit: of lives, by K(a) of a peridynamic run, of nodes or of the handbook; or of rates by laws over K.

use super::case::CalibrationCase;
use super::fit::{Bonds, Fit, FitTask, OwnPath, fit};
use super::laws::LawFits;
use super::laws::case::{LawCase, is_law_fit};
use super::paris;
use super::power_law::PowerLaw;
use super::record::{FitRecord, LivesRecord, RatesRecord};
use super::results;
use super::search::Constants;
use perilife_base::error::{Result, input_missing};
use perilife_base::input::Document;
use perilife_base::units::{MM, MPA_SQRT_M, round_off};
use perilife_base::watch;
use perilife_growth::case::{Case, Model};
use perilife_growth::predict::factor_curve::{EXPONENT_USUAL, FactorCurve};
use perilife_growth::predict::{Observer, RunFigures};
use perilife_growth::rate_constant::{rate_constant, rate_constant_slope};
use perilife_laws::paris::ParisLaw;
use perilife_measured::{MeasuredCurve, ratio_warnings};

/// Change of the exponent below which the path of several tips needs no other run.
const EXPONENT_SAME: f64 = 0.05;
/// Error of a block, percent, of a run whose K stands for a plate that no handbook has: what lies between its rows is interpolated. Curves
/// made with m = 3.4 on a lattice of ten spacings in the crack give 3.60 with the 0.2 of a life, 3.395 with 0.05 and 3.399 with 0.0125.
const STEP_ERROR_PERCENT: f64 = 0.05;
/// Most runs of a plate whose tips share the growth by the exponent that is sought.
const RUNS_MAX: usize = 4;
/// Relative difference between lengths that are equal but for round-off.
const SAME_LENGTH: f64 = 1e-9;

/// A checked calibration file.
#[derive(Debug, Clone)]
pub enum Calibration {
    Lives(Box<CalibrationCase>),
    Rates(Box<LawCase>),
}

pub enum Fitted<'c> {
    Lives(&'c CalibrationCase, Box<Fit>),
    Rates(&'c LawCase, LawFits),
}

impl Calibration {
    /// Reads the file and all that it names.
    pub fn from_document(document: &Document) -> Result<Self> {
        if document.table.contains_key("output") {
            return Err(document.locate(input_missing("output", "applies only to a case or scene", "remove the section")));
        }
        if is_law_fit(&document.table) {
            return LawCase::from_document(document).map(|case| Calibration::Rates(Box::new(case)));
        }
        let mut case = CalibrationCase::from_document(document.clone())?;
        case.warnings.extend(ratio_warnings(&case.read, &case.case.loading));
        Ok(Calibration::Lives(Box::new(case)))
    }

    pub fn name(&self) -> &str {
        match self {
            Calibration::Lives(calibration) => &calibration.case.name,
            Calibration::Rates(case) => &case.name,
        }
    }

    pub fn warnings(&self) -> &[String] {
        match self {
            Calibration::Lives(calibration) => &calibration.warnings,
            Calibration::Rates(case) => &case.warnings,
        }
    }

    pub fn fit(&self, observer: &dyn Observer) -> Result<Fitted<'_>> {
        Ok(match self {
            Calibration::Lives(calibration) => Fitted::Lives(calibration, Box::new(calibrate(calibration, observer)?)),
            Calibration::Rates(case) => Fitted::Rates(case, case.fit()?),
        })
    }
}

impl Fitted<'_> {
    pub fn warnings(&self) -> &[String] {
        match self {
            Fitted::Lives(_, fit) => &fit.warnings,
            Fitted::Rates(_, fits) => &fits.warnings,
        }
    }

    /// What it found, in `wall_s` seconds.
    pub fn record(&self, wall_s: f64) -> FitRecord {
        match self {
            Fitted::Lives(calibration, fit) => FitRecord::Lives(Box::new(LivesRecord::of(calibration, fit, wall_s))),
            Fitted::Rates(case, fits) => FitRecord::Rates(Box::new(RatesRecord::of(case, fits, wall_s))),
        }
    }

    /// `fitted.toml`.
    pub fn record_text(&self) -> std::result::Result<String, toml::ser::Error> {
        match self {
            Fitted::Lives(calibration, fit) => toml::to_string(&results::record(calibration, fit)),
            Fitted::Rates(case, fits) => toml::to_string(&results::law_record(case, fits)),
        }
    }
}

/// Fits the constants of a calibration: A and p of bonds, or (method `handbook`) C and m of hand calculation.
///
/// The path of a crack does not depend on C, and that of a single tip not on m either, so one run whose crack is driven by its tip serves
/// every C and m; A and p stand for them. Tips of unlike K share the growth by m: the run is repeated at the m that was fitted.
/// Errors: mechanics without a result, a window in which the handbook has no K, or a law that no metal has.
pub fn calibrate(calibration: &CalibrationCase, observer: &dyn Observer) -> Result<Fit> {
    let fit = watch::with(observer.watch(), || {
        let fit = fit_by_method(calibration, observer);
        watch::unless_cancelled(&calibration.case.name, fit)
    })?;
    match paris::implausibility_of(fit.paris.c, fit.paris.m) {
        None => Ok(fit),
        Some(doubt) => {
            let doubts: String = fit.warnings.iter().map(|line| format!("\n  {line}")).collect();
            Err(input_missing("measured.files", format!("implausible growth law: {doubt}{doubts}"), ""))
        }
    }
}

fn fit_by_method(calibration: &CalibrationCase, observer: &dyn Observer) -> Result<Fit> {
    let case = &calibration.case;
    let (from, to) = (case.specimen.crack_length, case.stop.crack_length);
    let Some(_) = calibration.delta_k(from) else { return fit_along_path(calibration, observer) };
    let delta_k = |length: f64| calibration.delta_k(length).unwrap_or(f64::NAN);
    let task = task(calibration, &delta_k);
    if matches!(case.model, Model::Handbook(_)) {
        let law = PowerLaw::new(from, to, &delta_k)?;
        let fit = fit(&task, &law)?.of_power_law();
        return if case.chosen.is_some() { in_terms_of_bonds(fit, case, usual_bonds(case)) } else { Ok(fit) };
    }
    let factors = FactorCurve::of(case, observer)?;
    let of_run = |length: f64| case.loading.range_share() * factors.at(length);
    let law = PowerLaw::new(from, to, &of_run)?;
    let fit = fit(&task, &law)?;
    match case.model {
        Model::Points(_) => of_run_on_plate(fit, case, factors),
        _ => of_run_on_plate(fit.of_power_law(), case, factors),
    }
}

fn task<'a>(calibration: &'a CalibrationCase, delta_k: &'a dyn Fn(f64) -> f64) -> FitTask<'a> {
    FitTask { curves: &calibration.curves, fixed_p: calibration.exponent.fixed, criterion: calibration.criterion, delta_k }
}

/// Refuses readings that begin before the governing crack does: they are of another one.
fn check_crack(calibration: &CalibrationCase, start: f64) -> Result<()> {
    let is_before = |curve: &&MeasuredCurve| curve.crack_length[0] < start * (1.0 - SAME_LENGTH);
    let Some(curve) = calibration.curves.iter().find(is_before) else { return Ok(()) };
    let [first, start] = [curve.crack_length[0], start].map(|length| round_off(length / MM));
    let problem =
        format!("has a first reading of {first} mm for {}; the governing crack is {start} mm long initially", curve.specimen);
    Err(input_missing("measured.files", problem, "give the readings of the governing crack, over all its tips"))
}

/// The fit to K of the tips of a plate that no handbook has, along their own paths.
fn fit_along_path(calibration: &CalibrationCase, observer: &dyn Observer) -> Result<Fit> {
    let mut case = calibration.case.clone();
    case.fatigue.step_error_percent = case.fatigue.step_error_percent.min(STEP_ERROR_PERCENT);
    let mut m = calibration.exponent.fixed.unwrap_or(EXPONENT_USUAL);
    let mut run = 1;
    loop {
        let factors = FactorCurve::at_exponent(&case, m, observer)?;
        check_crack(calibration, factors.start())?;
        let share = case.loading.range_share();
        let of_tips = |length: f64| factors.of_tips(length).into_iter().map(|k| share * k).collect();
        let law = PowerLaw::of_tips(factors.start(), case.stop.crack_length, &of_tips)?;
        let at_exponent = |m: f64| {
            let delta_k = |length: f64| law.delta_k(length, m) * MPA_SQRT_M;
            fit(&task(calibration, &delta_k), &law)
        };
        let mut fit = at_exponent(m)?;
        let fitted = fit.record.constants.p;
        let has_other_path = (fitted - m).abs() > EXPONENT_SAME && factors.depends_on_exponent;
        if has_other_path && run < RUNS_MAX {
            (m, run) = (fitted, run + 1);
            continue;
        }
        // ΔK that stands for all tips goes with the exponent.
        if fitted != m {
            fit = at_exponent(fitted)?;
        }
        let mut fit = fit.of_power_law();
        let reached = |fold: fn(f64, f64) -> f64, start: f64| {
            fit.record.crack_length.iter().map(|&length| law.largest_delta_k(length)).fold(start, fold)
        };
        (fit.paris.delta_k_min, fit.paris.delta_k_max) = (reached(f64::min, f64::INFINITY), reached(f64::max, 0.0));
        if has_other_path {
            fit.warnings.push(format!("path: crack paths computed with m = {m:.3}; fitted m = {fitted:.3}"));
        }
        let own_path = Some(OwnPath { factors: law, runs: run });
        return of_run_on_plate(Fit { own_path, ..fit }, &calibration.case, factors);
    }
}

/// A fit to K of a run, in terms of A and p where the plate has bonds.
fn of_run_on_plate(mut fit: Fit, case: &Case, factors: FactorCurve) -> Result<Fit> {
    let RunFigures { horizon, spacing, .. } = factors.figures;
    if matches!(case.model, Model::Points(_)) {
        fit = in_terms_of_bonds(fit, case, [horizon, spacing])?;
    } else if case.chosen.is_some() {
        fit = in_terms_of_bonds(fit, case, usual_bonds(case))?;
    }
    fit.warnings.extend(factors.warnings);
    Ok(fit)
}

/// Horizon and spacing of the bonds that a plate would have, m: those that A stands for where the program fitted to K without bonds.
fn usual_bonds(case: &Case) -> [f64; 2] {
    let points = case.points();
    let spacing = points.fitting_spacing(&case.specimen);
    [points.horizon_ratio * spacing, spacing]
}

/// A fit of C and m on the plate of a run as one of A and p, which are what they stand for ([`ParisLaw::to_bonds`]).
pub fn in_terms_of_bonds(mut fit: Fit, case: &Case, [horizon, spacing]: [f64; 2]) -> Result<Fit> {
    let (kernel, modulus) = (case.points().bond_law.kernel, case.material.plane_modulus());
    let p = fit.record.constants.p;
    let bonds = |Constants { a, p }: Constants| -> Result<Constants> {
        let law = ParisLaw { c: a, m: p }.to_bonds(rate_constant(kernel, p)?, modulus, horizon);
        Ok(Constants { a: law.a, p: law.p })
    };
    // ln A = ln C + g(m): its slope over m turns the covariance of (ln C, m) into that of (ln A, p).
    let slope = -rate_constant_slope(kernel, p)? - (MPA_SQRT_M / (modulus * horizon.sqrt())).ln();
    let [[c_c, c_m], [_, m_m]] = fit.confidence.covariance;
    let a_p = c_m + slope * m_m;
    fit.confidence.covariance = [[c_c + 2.0 * slope * c_m + slope * slope * m_m, a_p], [a_p, m_m]];
    for curve in fit.specimens.iter_mut().chain([&mut fit.record]) {
        curve.constants = bonds(curve.constants)?;
    }
    let bonds = Bonds { rate_constant: rate_constant(kernel, p)?, horizon, spacing };
    Ok(Fit { bonds: Some(bonds), ..fit })
}
