//! Constants of one curve: p by Brent's method (1973) on the misfit, A by [`inverse_a`]; and curves of different loads as they would have
//! run under the load of the case, so that their median can be taken.

use std::borrow::Cow;

use argmin::core::{CostFunction, Executor, State};
use argmin::solver::brent::BrentOpt;

use super::criterion::{Criterion, inverse_a, misfit, rms_life_error};
use super::median::{median, pointwise_median};
use super::power_law::PowerLaw;
use crate::error::{Error, Result};
use crate::fatigue::STEADY_EXPONENTS;
use crate::measured::MeasuredCurve;

/// Where the search ends, relative and absolute in p: a minimum is not known better than to the root of the round-off.
const TOLERANCE: f64 = 1e-8;
/// Distance from an end of [`STEADY_EXPONENTS`] at which the smallest misfit is taken to lie beyond it.
const AT_END: f64 = 1e-3;

/// A and p of one curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Constants {
    /// A, 1/cycle.
    pub a: f64,
    /// Exponent p.
    pub p: f64,
}

/// A curve, cycles counted from the first reading, beside the law that is fitted to it.
#[derive(Clone, Copy)]
struct Search<'a> {
    law: &'a PowerLaw,
    cycles: &'a [f64],
    lengths: &'a [f64],
    criterion: Criterion,
}

impl CostFunction for Search<'_> {
    type Param = f64;
    type Output = f64;

    fn cost(&self, p: &f64) -> std::result::Result<f64, argmin::core::Error> {
        Ok(misfit(self.criterion, &self.law.cycles(*p, self.lengths)?, self.cycles))
    }
}

impl Search<'_> {
    /// A at a given p.
    fn constants(&self, p: f64) -> Result<Constants> {
        let model = self.law.cycles(p, self.lengths)?;
        Ok(Constants { a: 1.0 / inverse_a(self.criterion, &model, self.cycles), p })
    }

    /// A and p of the smallest misfit, p within [`STEADY_EXPONENTS`].
    fn smallest(self) -> Result<Constants> {
        let solver = BrentOpt::new(*STEADY_EXPONENTS.start(), *STEADY_EXPONENTS.end()).set_tolerance(TOLERANCE, TOLERANCE);
        let outcome = Executor::new(self, solver).configure(|state| state.max_iters(200)).run();
        let failed = |reason: String| Error::Mechanics(format!("the search for p failed: {reason}"));
        let outcome = outcome.map_err(|error| error.downcast::<Error>().unwrap_or_else(|error| failed(error.to_string())))?;
        let p = outcome.state().get_best_param().copied().ok_or_else(|| failed("no p was tried".to_owned()))?;
        self.constants(p)
    }
}

/// Whether a searched p is an end of [`STEADY_EXPONENTS`], so that the curve follows no such law.
pub fn is_at_end(p: f64) -> bool {
    p - STEADY_EXPONENTS.start() < AT_END || STEADY_EXPONENTS.end() - p < AT_END
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
    /// Range of load of the growth up to each reading over that of the case.
    pub load_factor: Vec<f64>,
}

impl FittedCurve {
    /// Measured cycles at the last reading.
    pub fn life_measured(&self) -> f64 {
        self.cycles_measured.last().copied().unwrap_or(f64::NAN)
    }

    /// Fitted cycles at the length of the last reading.
    pub fn life_fitted(&self) -> f64 {
        self.cycles_fitted.last().copied().unwrap_or(f64::NAN)
    }

    /// Rms life error, see [`rms_life_error`].
    pub fn rms_life_error(&self) -> f64 {
        rms_life_error(&self.cycles_fitted, &self.cycles_measured)
    }
}

/// The law under the loads of a curve.
pub(super) fn own_law<'l>(law: &'l PowerLaw, curve: &MeasuredCurve) -> Cow<'l, PowerLaw> {
    if curve.is_plain() { Cow::Borrowed(law) } else { Cow::Owned(law.under(curve)) }
}

/// Fits one curve: A and p, or A at a fixed p.
pub(super) fn fit_one(curve: &MeasuredCurve, criterion: Criterion, fixed_p: Option<f64>, law: &PowerLaw) -> Result<FittedCurve> {
    let cycles = curve.cycles_counted();
    let own = own_law(law, curve);
    let search = Search { law: &own, cycles: &cycles, lengths: &curve.crack_length, criterion };
    let constants = fixed_p.map_or_else(|| search.smallest(), |p| search.constants(p))?;
    fitted_curve(curve, constants, law)
}

pub(super) fn fitted_curve(curve: &MeasuredCurve, constants: Constants, law: &PowerLaw) -> Result<FittedCurve> {
    let model = own_law(law, curve).cycles(constants.p, &curve.crack_length)?;
    Ok(FittedCurve {
        name: curve.specimen.clone(),
        constants,
        crack_length: curve.crack_length.clone(),
        cycles_fitted: model.iter().map(|n| n / constants.a).collect(),
        cycles_measured: curve.cycles_counted(),
        load_factor: curve.step_factors().into_iter().map(|(start, end)| 0.5 * (start + end)).collect(),
    })
}

/// The curve as the law would have it.
pub(super) fn as_fitted(curve: &MeasuredCurve, Constants { a, p }: Constants, law: &PowerLaw) -> Result<MeasuredCurve> {
    let cycles = own_law(law, curve).cycles(p, &curve.crack_length)?;
    Ok(MeasuredCurve { cycles: cycles.into_iter().map(|n| n / a).collect(), ..curve.clone() })
}

/// Rounds in which p of the median settles; each brings it a factor of some ten nearer.
const ROUNDS_MAX: usize = 50;

/// Where it is settled.
const SETTLED: f64 = 1e-7;

/// The curves at the load of the case. Growth by a power p of ΔK takes `(ΔP / ΔP_case)^p` times the cycles at that load; a step that is left
/// out takes those of the specimen's own fit. p is that of the median itself, which a few rounds find.
/// Errors: as the fits of the curves; [`Error::Mechanics`] where p does not settle.
pub(super) fn at_case_load(
    curves: &[MeasuredCurve],
    criterion: Criterion,
    fixed_p: Option<f64>,
    law: &PowerLaw,
) -> Result<Vec<MeasuredCurve>> {
    let own: Vec<Constants> =
        curves.iter().map(|curve| Ok(fit_one(curve, criterion, fixed_p, law)?.constants)).collect::<Result<_>>()?;
    let mut p = fixed_p.unwrap_or_else(|| median(&own.iter().map(|constants| constants.p).collect::<Vec<f64>>()));
    for _ in 0..ROUNDS_MAX {
        let reduced: Vec<MeasuredCurve> =
            curves.iter().zip(&own).map(|(curve, own)| reduced(curve, *own, p, law)).collect::<Result<_>>()?;
        let next = fit_one(&pointwise_median(&reduced)?, criterion, fixed_p, law)?.constants.p;
        if (next - p).abs() < SETTLED {
            return Ok(reduced);
        }
        p = next;
    }
    Err(Error::Mechanics("the exponent of specimens of different loads does not settle: calibrate them one by one".to_owned()))
}

fn reduced(curve: &MeasuredCurve, own: Constants, p: f64, law: &PowerLaw) -> Result<MeasuredCurve> {
    if curve.is_plain() {
        return Ok(curve.clone());
    }
    let lengths = &curve.crack_length;
    let (at_case, as_run, by_own_fit) =
        (law.cycles(p, lengths)?, law.under(curve).cycles(p, lengths)?, law.cycles(own.p, lengths)?);
    let mut cycles = vec![0.0; lengths.len()];
    for i in 1..lengths.len() {
        let step = |of: &[f64]| of[i] - of[i - 1];
        let measured = step(&curve.cycles);
        let taken = match (curve.counts(i), step(&as_run) > 0.0) {
            (false, _) => step(&by_own_fit).max(0.0) / own.a,
            (true, true) => measured * step(&at_case) / step(&as_run),
            (true, false) => measured,
        };
        cycles[i] = cycles[i - 1] + taken;
    }
    Ok(MeasuredCurve { cycles, load_factor: Vec::new(), left_out: Vec::new(), ..curve.clone() })
}
