//! Which estimate of A and p a record holds: least squares on lives, or the repeated median of rates where readings do not belong.
//!
//! Least squares predict lives best as long as all readings belong. Where some do not, both estimates are given, and the robust one is
//! written, since its error does not grow with theirs.

use crate::calibration::measured::MeasuredCurve;
use crate::calibration::outliers::{RobustLine, robust_line, runs, step_rates};
use crate::calibration::paris::Paris;
use crate::calibration::power_law::PowerLaw;
use crate::calibration::search::Constants;
use crate::case::record::Estimate;
use crate::fatigue::STEADY_EXPONENTS;
use crate::units::{MM_PER_CYCLE, MPA_SQRT_M};

/// Standard errors by which two estimates differ in earnest.
const ERRORS_APART: f64 = 2.0;

/// Smallest difference of exponents worth a word: computed curves have hardly any error.
const APART_MIN: f64 = 0.05;

/// C and m by the repeated median of rates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Robust {
    /// C in mm/cycle and MPa√m.
    pub c: f64,
    /// m.
    pub m: f64,
}

impl Robust {
    /// A line of rates in m/cycle.
    pub fn of(line: RobustLine) -> Self {
        Robust { c: line.intercept.exp() / MM_PER_CYCLE, m: line.m }
    }
}

/// A and p by the repeated median over ΔK of the law that is fitted; `None` where all readings belong, or the law has no such p.
/// `p` is the exponent of least squares, which several tips count together by.
pub(super) fn robust_constants(curve: &MeasuredCurve, law: &PowerLaw, p: f64) -> Option<Constants> {
    let rates = step_rates(curve, &|length| law.delta_k(length, p) * MPA_SQRT_M);
    let line = robust_line(&rates)?;
    let some = !runs(&rates, line).is_empty() && STEADY_EXPONENTS.contains(&line.m);
    some.then(|| Constants { a: line.intercept.exp(), p: line.m })
}

/// Whether exponents differ by more than the error of one explains.
pub(super) fn are_apart(robust: f64, least_squares: f64, error: f64) -> bool {
    (robust - least_squares).abs() > (ERRORS_APART * error).max(APART_MIN)
}

/// Both estimates in words, and which is written; `error` is that of m without the readings that do not belong.
pub(super) fn apart(least_squares: &Paris, error: f64, robust: &Robust, written: Estimate) -> String {
    format!(
        "least squares give m = {:.3}, C = {:.3e}, the repeated median of the rates m = {:.3}, C = {:.3e} (mm/cycle, MPa√m): they differ by \
         more than two standard errors of {error:.3}; written are the {} constants",
        least_squares.m,
        least_squares.c,
        robust.m,
        robust.c,
        match written {
            Estimate::LeastSquares => "least-squares",
            Estimate::Robust => "robust",
        }
    )
}
