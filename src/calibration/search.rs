//! Constants of one curve: p by Brent's method (1973) on the misfit, A by [`inverse_a`]; and curves of different loads as they would have
//! run under the load of the case, so that their median can be drawn; and of all readings of several specimens at once.

use std::borrow::Cow;

use argmin::core::{CostFunction, Executor, State};
use argmin::solver::brent::BrentOpt;

use super::criterion::{Criterion, inverse_a, misfit, rms_life_error};
use super::median::{Rising, common_lengths, median, pointwise_median_at};
use super::power_law::PowerLaw;
use perilife_base::error::{Error, Result};
use perilife_laws::STEADY_EXPONENTS;
use perilife_measured::{MeasuredCurve, READINGS_MIN};

/// Where the search ends, relative and absolute in p: a minimum is not known better than to the root of the round-off.
const TOLERANCE: f64 = 1e-8;
/// Distance from an end of [`STEADY_EXPONENTS`] at which the smallest misfit is taken to lie beyond it.
const AT_END: f64 = 1e-3;
/// Growth that all specimens have in common, over all of theirs, from which on a median of them is a picture of all.
const COMMON_SHARE: f64 = 0.8;

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Constants {
    /// A, 1/cycle.
    pub a: f64,
    pub p: f64,
}

/// Specimens of one law: each with its own loads and level, cycles counted from the first reading, all with one p.
struct Search<'a> {
    specimens: Vec<(Cow<'a, PowerLaw>, Vec<f64>, &'a [f64])>,
    criterion: Criterion,
    /// Power of the misfits whose mean is least: 2, of a specimen's own fit 1. Both have one minimum, which is found to 1e-8 only.
    power: i32,
}

impl<'a> Search<'a> {
    fn of(curves: &'a [MeasuredCurve], criterion: Criterion, law: &'a PowerLaw, power: i32) -> Self {
        let specimen = |curve: &'a MeasuredCurve| (own_law(law, curve), curve.cycles_counted(), &*curve.crack_length);
        Search { specimens: curves.iter().map(specimen).collect(), criterion, power }
    }

    /// The p within [`STEADY_EXPONENTS`] of the smallest misfit, and the median of the levels A at it.
    fn constants(self, fixed_p: Option<f64>) -> Result<Constants> {
        let level = |p: f64, (law, cycles, lengths): &(Cow<'_, PowerLaw>, Vec<f64>, &[f64])| {
            Ok((1.0 / inverse_a(self.criterion, &law.cycles(p, lengths)?, cycles)).ln())
        };
        let p = fixed_p.map_or_else(|| self.least(), Ok)?;
        let levels = self.specimens.iter().map(|specimen| level(p, specimen)).collect::<Result<Vec<f64>>>()?;
        Ok(Constants { a: median(&levels).exp(), p })
    }

    fn least(&self) -> Result<f64> {
        let solver = BrentOpt::new(*STEADY_EXPONENTS.start(), *STEADY_EXPONENTS.end()).set_tolerance(TOLERANCE, TOLERANCE);
        let outcome = Executor::new(self, solver).configure(|state| state.max_iters(200)).run();
        let failed = |reason: String| Error::Mechanics(format!("the search for p failed: {reason}"));
        let outcome = outcome.map_err(|error| error.downcast::<Error>().unwrap_or_else(|error| failed(error.to_string())))?;
        outcome.state().get_best_param().copied().ok_or_else(|| failed("no p was tried".to_owned()))
    }
}

impl CostFunction for &Search<'_> {
    type Param = f64;
    type Output = f64;

    /// Mean over specimens of a power of the misfit.
    fn cost(&self, p: &f64) -> std::result::Result<f64, argmin::core::Error> {
        let mut sum = 0.0;
        for (law, cycles, lengths) in &self.specimens {
            sum += misfit(self.criterion, &law.cycles(*p, lengths)?, cycles).powi(self.power);
        }
        Ok(sum / self.specimens.len() as f64)
    }
}

/// Whether a searched p is an end of [`STEADY_EXPONENTS`], so that the curve follows no such law.
pub fn is_at_end(p: f64) -> bool {
    p - STEADY_EXPONENTS.start() < AT_END || STEADY_EXPONENTS.end() - p < AT_END
}

/// A curve with its fit, cycles counted from the first reading.
#[derive(Debug, Clone, PartialEq)]
pub struct FittedCurve {
    pub name: String,
    pub constants: Constants,
    /// Crack lengths, m.
    pub crack_length: Vec<f64>,
    pub cycles_measured: Vec<f64>,
    pub cycles_fitted: Vec<f64>,
    /// Range of load of the growth up to each reading over that of the case.
    pub load_factor: Vec<f64>,
}

impl FittedCurve {
    pub fn life_measured(&self) -> f64 {
        self.cycles_measured.last().copied().unwrap_or(f64::NAN)
    }

    pub fn life_fitted(&self) -> f64 {
        self.cycles_fitted.last().copied().unwrap_or(f64::NAN)
    }

    /// Rms life error, see [`rms_life_error`].
    pub fn rms_life_error(&self) -> f64 {
        rms_life_error(&self.cycles_fitted, &self.cycles_measured)
    }
}

pub(super) fn own_law<'l>(law: &'l PowerLaw, curve: &MeasuredCurve) -> Cow<'l, PowerLaw> {
    if curve.is_plain() { Cow::Borrowed(law) } else { Cow::Owned(law.under(curve)) }
}

/// Constants of all readings of some specimens.
pub(super) fn fit_all(curves: &[MeasuredCurve], criterion: Criterion, fixed_p: Option<f64>, law: &PowerLaw) -> Result<Constants> {
    Search::of(curves, criterion, law, 2).constants(fixed_p)
}

pub(super) fn fit_one(curve: &MeasuredCurve, criterion: Criterion, fixed_p: Option<f64>, law: &PowerLaw) -> Result<FittedCurve> {
    fitted_curve(curve, Search::of(std::slice::from_ref(curve), criterion, law, 1).constants(fixed_p)?, law)
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

/// The curve as it would be by a rate, m/cycle, over ΔK, MPa√m.
pub(super) fn as_fitted(curve: &MeasuredCurve, rate: &dyn Fn(f64) -> f64, law: &PowerLaw) -> Result<MeasuredCurve> {
    Ok(MeasuredCurve { cycles: own_law(law, curve).cycles_by(rate, &curve.crack_length)?, ..curve.clone() })
}

/// Median of the specimens at the load of the case, for pictures and errors of life. Growth by a power p of ΔK takes `(ΔP / ΔP_case)^p` times
/// the cycles at that load; a step that is left out takes those of the specimen's own fit, and between two readings cycles follow the law.
/// Where the specimens have less in common than [`COMMON_SHARE`] of all their growth, their mean at the level of the law instead, growth by
/// growth.
pub(super) fn picture(
    curves: &[MeasuredCurve],
    own: &[FittedCurve],
    constants: Constants,
    law: &PowerLaw,
) -> Result<MeasuredCurve> {
    let p = constants.p;
    let reduced: Vec<MeasuredCurve> =
        curves.iter().zip(own).map(|(curve, own)| reduced(curve, own.constants, p, law)).collect::<Result<_>>()?;
    let ends = |curve: &MeasuredCurve| {
        let lengths = || curve.crack_length.iter().copied();
        [curve.crack_length[0], lengths().fold(0.0, f64::max)]
    };
    let fold = |of: fn(f64, f64) -> f64, end: usize| reduced.iter().map(|curve| ends(curve)[end]).reduce(of).unwrap_or(f64::NAN);
    let common = [fold(f64::max, 0), fold(f64::min, 1)];
    let all = [fold(f64::min, 0), fold(f64::max, 1)];
    if common[1] - common[0] >= COMMON_SHARE * (all[1] - all[0]) {
        let lengths = common_lengths(&reduced)?;
        let at: Vec<MeasuredCurve> = reduced.iter().map(|curve| read_at(curve, &lengths, p, law)).collect::<Result<_>>()?;
        return pointwise_median_at(&at, &lengths);
    }
    let count = reduced.iter().map(|curve| curve.cycles.len()).max().unwrap_or(READINGS_MIN).max(READINGS_MIN);
    let lengths: Vec<f64> = (0..count).map(|i| all[0] + (all[1] - all[0]) * i as f64 / (count - 1) as f64).collect();
    let model = law.cycles(p, &lengths)?;
    let mut cycles = vec![0.0];
    for i in 1..count {
        let (mut sum, mut of) = (0.0, 0.0);
        for curve in &reduced {
            let [from, to] = ends(curve);
            if lengths[i - 1] < from || lengths[i] > to {
                continue;
            }
            let level = fit_one(curve, Criterion::BothEnds, Some(p), law)?.constants.a;
            let at = read_at(curve, &lengths[i - 1..=i], p, law)?.cycles;
            (sum, of) = (sum + (at[1] - at[0]) * level / constants.a, of + 1.0);
        }
        // Between specimens nobody has read.
        let step = if of > 0.0 { sum / of } else { (model[i] - model[i - 1]) / constants.a };
        cycles.push(cycles[i - 1] + step);
    }
    Ok(MeasuredCurve::new("mean", cycles, lengths))
}

/// A curve at the load of the case read at some lengths within it: cycles between two readings by the law.
fn read_at(curve: &MeasuredCurve, lengths: &[f64], p: f64, law: &PowerLaw) -> Result<MeasuredCurve> {
    let rising = Rising::of(curve);
    let cycles = lengths.iter().map(|&length| {
        let Some([before, after]) = rising.around(length) else { return Ok(rising.cycles_at(length).unwrap_or(f64::NAN)) };
        let model = law.cycles(p, &[before.0, length, after.0])?;
        Ok(before.1 + (after.1 - before.1) * model[1] / model[2])
    });
    let cycles = cycles.collect::<Result<Vec<f64>>>()?;
    Ok(MeasuredCurve::new(curve.specimen.clone(), cycles, lengths.to_vec()))
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
