//! Curves of different loads as they would have run under the load of the case, so that their median can be taken.
//!
//! Growth by a power p of ΔK takes `(ΔP / ΔP_case)^p` times the cycles at the load of the case; a step that is left out takes those of
//! the specimen's own fit. p is that of the median itself, which a few rounds find.

use crate::calibration::criterion::Criterion;
use crate::calibration::fitted_curve::fit_one;
use crate::calibration::measured::MeasuredCurve;
use crate::calibration::median::{median, pointwise_median};
use crate::calibration::power_law::PowerLaw;
use crate::calibration::search::Constants;
use crate::error::{Error, Result};

/// Rounds in which p of the median settles; each brings it a factor of some ten nearer.
const ROUNDS_MAX: usize = 50;

/// Where it is settled.
const SETTLED: f64 = 1e-7;

/// The curves at the load of the case.
///
/// # Errors
/// As the fits of the curves; [`Error::Mechanics`] where p does not settle.
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
