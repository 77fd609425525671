//! The fit of lives on one page: from measured curves and K of a growing crack to C and m of `da/dN = C ΔK^m` and how sure they are.
//!
//! Readings that do not belong are left out first ([`super::outliers`]). C and m are the best power law by lives; the law that is written is
//! the curve of the rates where they show a shape ([`super::population`]) and lives are no worse by it, at the level of lives.

use super::case::CalibrationCase;
use super::confidence::{Confidence, check_identified, confidence, end_of_range};
use super::criterion::{Criterion, misfit};
use super::exponent::DELTA_K_RATIO_MIN;
use super::lack_of_fit::{MisfitAtEnds, misfit_at_ends};
use super::outliers::{
    OutlierRun, StepRate, doubts_beside, left_out, long_step_rates, readings_apart, runs, step_rates, without,
};
use super::paris::{self, Paris};
use super::population::intervals::Specimen;
use super::population::{Population, fit as fit_population};
use super::power_law::PowerLaw;
use super::rates::{STEP_MIN, threshold};
use super::search::{Constants, FittedCurve, as_fitted, fit_all, fit_one, fitted_curve, is_at_end, own_law, picture};
use perilife_base::error::{Error, Result, input};
use perilife_base::units::{MM, MM_PER_CYCLE, MPA_SQRT_M};
use perilife_laws::STEADY_EXPONENTS;
use perilife_laws::curve::CurveLaw;
use perilife_measured::{LeaveOut, MeasuredCurve, first_of};

const DOUBTS_SHOWN: usize = 6;

#[derive(Clone, Copy)]
pub struct FitTask<'a> {
    /// Curves inside the fit window ([`perilife_measured::Measured::window`]).
    pub curves: &'a [MeasuredCurve],
    pub fixed_p: Option<f64>,
    pub criterion: Criterion,
    /// ΔK of the handbook (Pa√m) at a crack length (m).
    pub delta_k: &'a dyn Fn(f64) -> f64,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Fit {
    /// The curve that the constants are shown beside: the pointwise median of several specimens, or the only one.
    pub record: FittedCurve,
    pub specimens: Vec<FittedCurve>,
    pub confidence: Confidence,
    pub paris: Paris,
    /// The curve of the rates, where that is the law that is written.
    pub curve: Option<CurveLaw>,
    /// By how much the power law misses that curve's measured rates at the ends; `None` where it is the law itself.
    pub power_law_misfit: Option<MisfitAtEnds>,
    /// By how much the law misses the curve that it was fitted to at its first and last readings.
    pub misfit_at_ends: MisfitAtEnds,
    pub left_out: Vec<LeaveOut>,
    /// The bonds that A and p of the record are of; without them they are C (m/cycle, MPa√m) and m.
    pub bonds: Option<Bonds>,
    /// K along the crack's own path, where no handbook has it.
    pub own_path: Option<OwnPath>,
    /// Scatter of the specimens; `None` where their readings do not tell it.
    pub population: Option<Population>,
    pub warnings: Vec<String>,
}

/// Bonds of a horizon and an actual lattice spacing, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bonds {
    /// β of the record's exponent ([`perilife_growth::rate_constant`]).
    pub rate_constant: f64,
    pub horizon: f64,
    pub spacing: f64,
}

/// K along the path of a crack that no handbook has.
#[derive(Debug, Clone, PartialEq)]
pub struct OwnPath {
    pub factors: PowerLaw,
    /// How often it was computed: again where several tips share the growth by an exponent that is not known before.
    pub runs: usize,
}

/// Fits A and p to all readings of all specimens that belong, and again to each specimen.
/// Errors: readings outside the table of ΔK; [`Error::Mechanics`] where the smallest misfit lies at an end of the exponents searched, or
/// the readings do not tell p.
pub fn fit(task: &FitTask<'_>, law: &PowerLaw) -> Result<Fit> {
    let fixed_p = task.fixed_p.map(checked_p).transpose()?;
    let is_fitted = fixed_p.is_none();
    let strange = runs(&task.curves.iter().map(|curve| long_step_rates(curve, task.delta_k)).collect::<Vec<_>>());
    let mut warnings = remarks(task, &strange);
    let of_runs =
        |(curve, runs): (&MeasuredCurve, &Vec<OutlierRun>)| runs.iter().map(|run| left_out(curve, *run)).collect::<Vec<_>>();
    let left_out = task.curves.iter().zip(&strange).flat_map(of_runs).collect();
    let belonging: Vec<MeasuredCurve> = task.curves.iter().zip(&strange).map(|(curve, runs)| without(curve, runs)).collect();
    let task = &FitTask { curves: &belonging, ..*task };
    let constants = fit_all(task.curves, task.criterion, fixed_p, law)?;
    let specimens: Vec<FittedCurve> =
        task.curves.iter().map(|curve| fit_one(curve, task.criterion, fixed_p, law)).collect::<Result<_>>()?;
    let picture = match task.curves {
        [only] => only.clone(),
        curves => picture(curves, &specimens, constants, law)?,
    };
    let mut record = fitted_curve(&picture, constants, law)?;
    if is_fitted && is_at_end(record.constants.p) {
        return Err(Error::Mechanics(format!(
            "{}: {}; check the units of the readings and the load, narrow the window (measured.from_crack_length_mm and \
             to_crack_length_mm), or fix p by [fit] parameters = [\"a\"] and p = ...{}",
            record.name,
            end_of_range(record.constants.p),
            warnings.iter().map(|line| format!("\n  {line}")).collect::<String>()
        )));
    }
    if task.curves.len() > 1 {
        let at_ends = specimens.iter().filter(|curve| is_fitted && is_at_end(curve.constants.p));
        let lines = at_ends.map(|curve| format!("exponent: specimen {}: {}", curve.name, end_of_range(curve.constants.p)));
        warnings.extend(first_of(lines.collect()));
    }
    warnings.extend(task.curves.iter().find_map(|curve| short_steps_warning(&curve.crack_length)));

    let population = population(task, law, &mut warnings);
    let (confidence, paris) = assess(task, law, &picture, &record, population.as_ref())?;
    if is_fitted {
        check_identified(&record.name, &confidence, &paris)?;
    }
    let step_rates: Vec<Vec<StepRate>> = task.curves.iter().map(|curve| step_rates(curve, task.delta_k)).collect();
    let of_threshold = |(curve, rates): (&MeasuredCurve, &Vec<StepRate>)| {
        let (_, words) = threshold(rates.iter().map(|rate| (rate.log_k.exp(), rate.log_rate.exp() / MM_PER_CYCLE)))?;
        Some(format!("threshold: specimen {}: {words}", curve.specimen))
    };
    warnings.extend(first_of(task.curves.iter().zip(&step_rates).filter_map(of_threshold).collect()));
    let ratio = paris.delta_k_max / paris.delta_k_min;
    if is_fitted && ratio < DELTA_K_RATIO_MIN {
        warnings.push(format!(
            "exponent: m cannot be determined: ΔK varies only by a factor {ratio:.2} (need {DELTA_K_RATIO_MIN}); widen the window, or \
             fix p by [fit] record = \"fitted.toml\", or by parameters = [\"a\"] and p = ..."
        ));
    }
    let power = |delta_k: f64| constants.a * delta_k.powf(constants.p);
    let by = |rate: &dyn Fn(f64) -> f64| task.curves.iter().map(|curve| as_fitted(curve, rate, law)).collect::<Result<Vec<_>>>();
    let by_power = by(&power)?;
    let (mut curve, mut by_law) = (None, by_power.clone());
    if let Some(lot) = population.as_ref().filter(|lot| is_fitted && lot.law.shape.is_some()) {
        let (bent, rate) = (lot.life_law(), |delta_k: f64| lot.life_law().log_rate(delta_k * MPA_SQRT_M).exp());
        let by_curve = by(&rate)?;
        if life_misfit(task, &by_curve) <= life_misfit(task, &by_power) {
            (curve, by_law) = (Some(bent), by_curve);
            record.cycles_fitted = as_fitted(&picture, &rate, law)?.cycles;
        }
    }
    let misfit_of = |fitted: &[MeasuredCurve]| misfit_at_ends(task.curves, fitted, task.delta_k);
    Ok(Fit {
        specimens: if task.curves.len() == 1 { vec![record.clone()] } else { specimens },
        record,
        confidence,
        paris,
        misfit_at_ends: misfit_of(&by_law),
        power_law_misfit: curve.map(|_| misfit_of(&by_power)),
        curve,
        left_out,
        bonds: None,
        own_path: None,
        population,
        warnings,
    })
}

/// Sum over specimens of the squared misfit of their lives by a law, each at its own level.
fn life_misfit(task: &FitTask<'_>, by_law: &[MeasuredCurve]) -> f64 {
    let of =
        |(law, curve): (&MeasuredCurve, &MeasuredCurve)| misfit(task.criterion, &law.cycles, &curve.cycles_counted()).powi(2);
    by_law.iter().zip(task.curves).map(of).sum()
}

/// Law and scatter of the specimens; `None`, with a warning, where their readings do not tell it.
fn population(task: &FitTask<'_>, law: &PowerLaw, warnings: &mut Vec<String>) -> Option<Population> {
    let delta_k = |length: f64| law.tips(length).into_iter().map(|k| k * MPA_SQRT_M).collect();
    let specimens = task.curves.iter().map(|curve| Specimen::of_curve(curve, &delta_k)).collect::<Result<Vec<_>>>();
    match specimens.and_then(|specimens| fit_population(&specimens, task.fixed_p)) {
        Ok(population) => Some(population),
        Err(error) => {
            warnings.push(format!("scatter: none of lives: {error}"));
            None
        }
    }
}

/// How sure A and p are, and what they mean as C and m along a curve. Of several specimens their scatter says it.
fn assess(
    task: &FitTask<'_>,
    law: &PowerLaw,
    curve: &MeasuredCurve,
    record: &FittedCurve,
    population: Option<&Population>,
) -> Result<(Confidence, Paris)> {
    let is_fitted = task.fixed_p.is_none();
    let Constants { a, p } = record.constants;
    let own = own_law(law, curve);
    let per_p = |lengths: &[f64]| is_fitted.then(|| own.cycles_per_p(p, lengths)).transpose();
    let apart = readings_apart(&curve.crack_length, STEP_MIN);
    let lengths: Vec<f64> = apart.iter().map(|&i| curve.crack_length[i]).collect();
    let counted = curve.cycles_counted();
    let measured: Vec<f64> = apart.iter().map(|&i| counted[i]).collect();
    let (model, model_per_p) = (own.cycles(p, &lengths)?, per_p(&lengths)?);
    let mut confidence = confidence(task.criterion, &model, model_per_p.as_deref(), &measured, 1.0 / a);
    if let Some(population) = population.filter(|_| task.curves.len() > 1) {
        confidence.covariance = population.covariance_of_constants(is_fitted);
    }
    // Under changing loads an interval must not reach over two of them.
    let loads = curve.load_history();
    let lengths = match curve.is_plain() {
        true => paris::lengths(curve.crack_length[0], curve.crack_length.iter().copied().fold(0.0, f64::max)),
        false => loads.lengths.clone(),
    };
    let delta_k = |length: f64| (task.delta_k)(length) * loads.at(length);
    let (model, model_per_p) = (own.cycles(p, &lengths)?, per_p(&lengths)?);
    let mut paris = paris::equivalents(&lengths, &model, model_per_p.as_deref(), a, confidence.covariance, &delta_k)?;
    // Of several specimens each has been where its own load took it.
    if task.curves.len() > 1 {
        [paris.delta_k_min, paris.delta_k_max] = delta_k_range(task);
    }
    Ok((confidence, paris))
}

/// Smallest and largest ΔK, MPa√m, of the readings, each under its own load.
fn delta_k_range(task: &FitTask<'_>) -> [f64; 2] {
    let of_curve = |curve: &MeasuredCurve| -> Vec<f64> {
        let loads = curve.load_history();
        loads.lengths.iter().map(|&length| (task.delta_k)(length) * loads.at(length) / MPA_SQRT_M).collect()
    };
    let all = task.curves.iter().flat_map(of_curve);
    all.fold([f64::INFINITY, 0.0], |[low, high], k| [k.min(low), k.max(high)])
}

fn remarks(task: &FitTask<'_>, runs: &[Vec<OutlierRun>]) -> Vec<String> {
    let of_curve = |(curve, runs): (&MeasuredCurve, &Vec<OutlierRun>)| doubts_beside(curve, runs, task.delta_k);
    let mut lines: Vec<String> = task.curves.iter().zip(runs).flat_map(of_curve).collect();
    if lines.len() > DOUBTS_SHOWN {
        let more = lines.len() - DOUBTS_SHOWN;
        lines.truncate(DOUBTS_SHOWN);
        lines.push(format!("outliers: {more} more messages of this kind: `perilife rates` lists all"));
    }
    lines
}

fn checked_p(p: f64) -> Result<f64> {
    if STEADY_EXPONENTS.contains(&p) {
        return Ok(p);
    }
    let (low, high) = (STEADY_EXPONENTS.start(), STEADY_EXPONENTS.end());
    Err(input("fit.p", p, format!("is outside {low} to {high}"), "give the exponent of the growth law, usually 2 to 4"))
}

fn short_steps_warning(lengths: &[f64]) -> Option<String> {
    let short = lengths.windows(2).filter(|pair| pair[1] - pair[0] < STEP_MIN * (1.0 - 1e-9)).count();
    let (steps, least) = (lengths.len().saturating_sub(1), STEP_MIN / MM);
    let what = "such readings are merged for the error of the fit; read less often";
    (short > 0)
        .then(|| format!("readings: {short} of {steps} steps between them are under {least} mm (ASTM E647, 8.6.2): {what}"))
}

impl Fit {
    /// ΔK, Pa√m, at a crack length, m: of the handbook, or of the crack's own path.
    pub fn delta_k(&self, calibration: &CalibrationCase, length: f64) -> f64 {
        let own = || Some(self.own_path.as_ref()?.factors.delta_k(length, self.record.constants.p) * MPA_SQRT_M);
        calibration.delta_k(length).or_else(own).unwrap_or(f64::NAN)
    }

    /// Standard error of p; 0 where it was given.
    pub fn p_error(&self) -> f64 {
        self.confidence.covariance[1][1].max(0.0).sqrt()
    }

    /// The fit whose constants are C and m of the K that was fitted to: no line has to be drawn through rates.
    pub(super) fn of_power_law(mut self) -> Fit {
        self.paris = self.paris.of_power_law(self.record.constants, self.p_error());
        self
    }
}
