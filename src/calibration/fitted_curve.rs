//! One measured curve with the constants fitted to it.

use std::borrow::Cow;

use crate::calibration::criterion::Criterion;
use crate::calibration::measured::MeasuredCurve;
use crate::calibration::misfit::rms_life_error;
use crate::calibration::power_law::PowerLaw;
use crate::calibration::search::{Constants, Target, search, search_a};
use crate::error::Result;

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
    let target = Target { cycles: &cycles, lengths: &curve.crack_length, criterion };
    let own = own_law(law, curve);
    let constants = fixed_p.map_or_else(|| search(&own, target), |p| search_a(&own, target, p))?;
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
