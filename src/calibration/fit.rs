//! The calibration on one page: from measured curves and a forward model to A, p and how sure they are.

use crate::calibration::confidence::{Confidence, Lives, confidence};
use crate::calibration::criterion::Criterion;
use crate::calibration::measured::MeasuredCurve;
use crate::calibration::median::pointwise_median;
use crate::calibration::misfit::rms_life_error;
use crate::calibration::model::{ForwardModel, cycles_since_first};
use crate::calibration::paris::{self, Paris};
use crate::calibration::power_law::PowerLaw;
use crate::calibration::rates::STEP_MIN;
use crate::calibration::search::{
    Constants, Found, P_MAX, P_MIN, Runs, Target, first_exponents, search, search_a, search_each, search_each_a,
};
use crate::calibration::surrogate::Surrogate;
use crate::error::{Result, input};
use crate::units::MM;

/// Below this ratio of the largest to the smallest ΔK a curve does not say what p is.
pub const DELTA_K_RATIO_MIN: f64 = 2.0;

/// First guess of p where hand calculation gives none: the Paris exponent of most metals.
const P_START: f64 = 3.0;

/// What is fitted to what.
pub struct FitTask<'a> {
    /// Curves inside the fit window ([`crate::calibration::measured::Measured::window`]).
    pub curves: &'a [MeasuredCurve],
    /// p given by the user; `None` fits it.
    pub fixed_p: Option<f64>,
    /// Which lives count.
    pub criterion: Criterion,
    /// ΔK of the handbook (Pa√m) at a crack length (m).
    pub delta_k: &'a dyn Fn(f64) -> f64,
}

/// A curve with its fit, cycles counted from the first reading.
#[derive(Debug, Clone, PartialEq)]
pub struct FittedCurve {
    /// Name of the specimen.
    pub name: String,
    /// A and p.
    pub constants: Constants,
    /// Crack lengths, m.
    pub crack_length: Vec<f64>,
    /// Measured cycles.
    pub cycles_measured: Vec<f64>,
    /// Fitted cycles at the same lengths.
    pub cycles_fitted: Vec<f64>,
}

/// Result of a calibration.
#[derive(Debug, Clone, PartialEq)]
pub struct Fit {
    /// The curve of the record: the pointwise median of several specimens, or the only one.
    pub record: FittedCurve,
    /// Each specimen with its own fit.
    pub specimens: Vec<FittedCurve>,
    /// Covariance of the record's (ln A, p).
    pub confidence: Confidence,
    /// Paris equivalents of the record.
    pub paris: Paris,
    /// β of the record's exponent, where cracks grew by K ([`crate::predict::bond_rate`]).
    pub rate_constant: Option<f64>,
    /// Horizon that A belongs to, m.
    pub horizon: f64,
    /// Actual lattice spacing, m.
    pub spacing: f64,
    /// True runs of the model.
    pub evaluations: usize,
    /// What the user should know.
    pub warnings: Vec<String>,
}

/// Fits A and p to the pointwise median, and again to each specimen.
pub fn fit(task: &FitTask<'_>, model: &dyn ForwardModel) -> Result<Fit> {
    let mut median = pointwise_median(task.curves)?;
    median.cycles = since_first(&median);
    let target = target_of(&median, task.criterion);
    let found = match task.fixed_p {
        Some(p) => search_a(model, target, checked_p(p)?)?,
        None => search(model, target, first_exponents_of(task, target))?,
    };
    let Found { constants, mut runs, mut warnings } = found;
    let (_, last_run) = &runs[runs.len() - 1]; // a search makes at least one run
    let (horizon, spacing, coarseness) = (last_run.horizon, last_run.spacing, last_run.coarseness);
    warnings.extend(last_run.warnings.iter().cloned());
    let model_cycles = cycles_since_first(&last_run.curve, target.lengths)?;
    let record = fitted_curve(&median, constants, &model_cycles);
    let rate_lengths = paris::lengths(median.crack_length[0], longest(&median));
    let rate_cycles = cycles_since_first(&last_run.curve, &rate_lengths)?;

    let each = fit_each(task, model, constants, &mut runs)?;
    let slopes = |lengths: &[f64]| -> Result<Option<Vec<f64>>> {
        Ok(match task.fixed_p {
            Some(_) => None,
            None => Some(Surrogate::new(&runs, lengths)?.cycles_per_p(constants.p)),
        })
    };
    let apart = readings_apart(target.lengths, coarseness.max(STEP_MIN));
    warnings.extend(short_steps_warning(target.lengths));
    let pick = |values: &[f64]| apart.iter().map(|&i| values[i]).collect::<Vec<f64>>();
    let slopes_apart = slopes(target.lengths)?.map(|slopes| pick(&slopes));
    let confidence = confidence(
        task.criterion,
        &Lives { model: &pick(&model_cycles), model_per_p: slopes_apart.as_deref(), measured: &pick(target.cycles) },
        1.0 / constants.a,
    );
    let paris = paris::equivalents(
        &rate_lengths,
        &rate_cycles,
        slopes(&rate_lengths)?.as_deref(),
        constants.a,
        confidence.covariance,
        task.delta_k,
    )?;
    let ratio = paris.delta_k_max / paris.delta_k_min;
    if task.fixed_p.is_none() && ratio < DELTA_K_RATIO_MIN {
        warnings.push(format!(
            "p is not identified: the fit window spans only a factor {ratio:.2} in ΔK (at least {DELTA_K_RATIO_MIN} is needed); \
             widen the window, or fix p by [fit] record = \"fitted.toml\", or by parameters = [\"a\"] and p = ..."
        ));
    }
    Ok(Fit {
        record,
        specimens: each,
        confidence,
        paris,
        rate_constant: None,
        horizon,
        spacing,
        evaluations: runs.len(),
        warnings,
    })
}

/// Each specimen's own fit, reusing (and where needed adding to) the true runs; of a single specimen the record's.
fn fit_each(task: &FitTask<'_>, model: &dyn ForwardModel, record: Constants, runs: &mut Runs) -> Result<Vec<FittedCurve>> {
    let targets: Vec<(Vec<f64>, &MeasuredCurve)> = task.curves.iter().map(|curve| (since_first(curve), curve)).collect();
    let targets: Vec<Target<'_>> = targets
        .iter()
        .map(|(cycles, curve)| Target { cycles, lengths: &curve.crack_length, criterion: task.criterion })
        .collect();
    let constants = match (task.fixed_p, task.curves.len()) {
        (_, 1) => vec![record],
        (Some(_), _) => search_each_a(&targets, runs)?,
        (None, _) => search_each(model, &targets, runs)?,
    };
    let mut fits = Vec::with_capacity(constants.len());
    for (curve, constants) in task.curves.iter().zip(constants) {
        // The true run where this p has one, else what the true runs interpolate.
        let model_cycles = match runs.iter().find(|(p, _)| *p == constants.p) {
            Some((_, run)) => cycles_since_first(&run.curve, &curve.crack_length)?,
            None => Surrogate::new(runs, &curve.crack_length)?.cycles(constants.p),
        };
        fits.push(fitted_curve(curve, constants, &model_cycles));
    }
    Ok(fits)
}

/// Exponents of the first runs, for the median and the specimens behind it.
fn first_exponents_of(task: &FitTask<'_>, median: Target<'_>) -> Vec<f64> {
    let of_specimen = |curve: &MeasuredCurve| {
        let cycles = since_first(curve);
        start_of(Target { cycles: &cycles, lengths: &curve.crack_length, criterion: task.criterion }, task.delta_k)
    };
    let specimens: &[MeasuredCurve] = if task.curves.len() > 1 { task.curves } else { &[] };
    first_exponents(start_of(median, task.delta_k), specimens.iter().map(of_specimen))
}

/// First guess of p: the Paris exponent that hand calculation with the handbook's ΔK fits to the same curve.
fn start_of(target: Target<'_>, delta_k: &dyn Fn(f64) -> f64) -> f64 {
    let to = target.lengths.iter().copied().fold(0.0, f64::max);
    let by_hand = PowerLaw::new(target.lengths[0], to, delta_k).and_then(|law| search(&law, target, vec![P_START]));
    // A guess may fail: the search then starts from the usual exponent.
    by_hand.map_or(P_START, |found| found.constants.p)
}

fn checked_p(p: f64) -> Result<f64> {
    if (P_MIN..=P_MAX).contains(&p) {
        return Ok(p);
    }
    Err(input("fit.p", p, format!("is outside {P_MIN} to {P_MAX}"), "give the exponent of the growth law, usually 2 to 4"))
}

/// Readings at least `least` of growth apart, m, the first among them. Shorter increments say nothing about the scatter of growth: in
/// them the steps of the model and the reading error of the laboratory show.
fn readings_apart(lengths: &[f64], least: f64) -> Vec<usize> {
    let mut apart: Vec<usize> = Vec::new();
    for (i, &length) in lengths.iter().enumerate() {
        if apart.last().is_none_or(|&last| length >= lengths[last] + least * (1.0 - 1e-9)) {
            apart.push(i);
        }
    }
    apart
}

/// Readings nearer together than a laboratory reads.
fn short_steps_warning(lengths: &[f64]) -> Option<String> {
    let short = lengths.windows(2).filter(|pair| pair[1] - pair[0] < STEP_MIN * (1.0 - 1e-9)).count();
    (short > 0).then(|| {
        format!(
            "{short} of {} steps between readings are under {} mm (ASTM E647, 8.6.2): errors of the fit count such readings together \
             with the next; read less often",
            lengths.len() - 1,
            STEP_MIN / MM
        )
    })
}

fn since_first(curve: &MeasuredCurve) -> Vec<f64> {
    curve.cycles.iter().map(|n| n - curve.cycles[0]).collect()
}

fn target_of(curve: &MeasuredCurve, criterion: Criterion) -> Target<'_> {
    Target { cycles: &curve.cycles, lengths: &curve.crack_length, criterion }
}

fn longest(curve: &MeasuredCurve) -> f64 {
    curve.crack_length.iter().copied().fold(0.0, f64::max)
}

fn fitted_curve(curve: &MeasuredCurve, constants: Constants, model_cycles: &[f64]) -> FittedCurve {
    FittedCurve {
        name: curve.specimen.clone(),
        constants,
        crack_length: curve.crack_length.clone(),
        cycles_measured: since_first(curve),
        cycles_fitted: model_cycles.iter().map(|n| n / constants.a).collect(),
    }
}

impl Fit {
    /// Standard error of p; 0 where it was given.
    #[must_use]
    pub fn p_error(&self) -> f64 {
        self.confidence.covariance[1][1].max(0.0).sqrt()
    }
}

impl FittedCurve {
    /// Measured cycles at the last reading.
    #[must_use]
    pub fn life_measured(&self) -> f64 {
        self.cycles_measured.last().copied().unwrap_or(f64::NAN)
    }

    /// Fitted cycles at the length of the last reading.
    #[must_use]
    pub fn life_fitted(&self) -> f64 {
        self.cycles_fitted.last().copied().unwrap_or(f64::NAN)
    }

    /// Rms life error, see [`rms_life_error`].
    #[must_use]
    pub fn rms_life_error(&self) -> f64 {
        rms_life_error(&self.cycles_fitted, &self.cycles_measured)
    }
}
