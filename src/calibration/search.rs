//! Search for p, by Brent's method (1973) on the misfit. A needs none ([`inverse_a`]).

use argmin::core::{CostFunction, Executor, State};
use argmin::solver::brent::BrentOpt;

use crate::calibration::criterion::Criterion;
use crate::calibration::misfit::{inverse_a, misfit};
use crate::calibration::power_law::PowerLaw;
use crate::error::{Error, Result};
use crate::fatigue::STEADY_EXPONENTS;

/// Where the search ends, relative and absolute in p: a minimum is not known better than to the root of the round-off.
const TOLERANCE: [f64; 2] = [1e-8, 1e-8];
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

/// Cycles of a curve at its lengths, both counted from the first reading.
#[derive(Debug, Clone, Copy)]
pub struct Target<'a> {
    /// Cycles since the first reading.
    pub cycles: &'a [f64],
    /// Crack lengths, m.
    pub lengths: &'a [f64],
    /// Which lives count.
    pub criterion: Criterion,
}

/// Fits p, within [`STEADY_EXPONENTS`], and A to one curve.
///
/// # Errors
/// Readings outside the table of ΔK.
pub fn search(law: &PowerLaw, target: Target<'_>) -> Result<Constants> {
    let solver = BrentOpt::new(*STEADY_EXPONENTS.start(), *STEADY_EXPONENTS.end()).set_tolerance(TOLERANCE[0], TOLERANCE[1]);
    let outcome = Executor::new(Misfit { law, target }, solver).configure(|state| state.max_iters(200)).run();
    let failed = |reason: String| Error::Mechanics(format!("the search for p failed: {reason}"));
    let outcome = outcome.map_err(|error| error.downcast::<Error>().unwrap_or_else(|error| failed(error.to_string())))?;
    let p = outcome.state().get_best_param().copied().ok_or_else(|| failed("no p was tried".to_owned()))?;
    search_a(law, target, p)
}

/// Fits A alone at a given p.
pub fn search_a(law: &PowerLaw, target: Target<'_>, p: f64) -> Result<Constants> {
    let model = law.cycles(p, target.lengths)?;
    Ok(Constants { a: 1.0 / inverse_a(target.criterion, &model, target.cycles), p })
}

/// Whether a searched p is an end of [`STEADY_EXPONENTS`], so that the curve follows no such law.
pub fn is_at_end(p: f64) -> bool {
    p - STEADY_EXPONENTS.start() < AT_END || STEADY_EXPONENTS.end() - p < AT_END
}

/// Misfit as argmin sees it.
struct Misfit<'a> {
    law: &'a PowerLaw,
    target: Target<'a>,
}

impl CostFunction for Misfit<'_> {
    type Param = f64;
    type Output = f64;

    fn cost(&self, p: &f64) -> std::result::Result<f64, argmin::core::Error> {
        let Target { cycles, lengths, criterion } = self.target;
        Ok(misfit(criterion, &self.law.cycles(*p, lengths)?, cycles))
    }
}
