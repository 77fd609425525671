//! The forward model that a calibration fits: cycles against crack length for A = 1, at a given p.
//!
//! For linear elastic bonds and a fixed p the history of a run depends on A N alone (dλ/dN = -A ε^p), so one run at one
//! p serves every A, and a search needs runs over p only.

use std::fmt;

use crate::error::{Error, Result};
use crate::units::MM;

/// Slack of the ends of a run against readings, m.
const LENGTH_SLACK: f64 = 1e-9;

/// A curve for A = 1: (A x cycles, crack length in m), both never falling.
pub type UnitCurve = Vec<(f64, f64)>;

/// A model that gives cycles against crack length for A = 1.
///
/// An implementor supplies one whole run, from the initial crack length to at least the longest length to be fitted.
/// It must not assume an order of calls, nor that calls come one at a time.
pub trait ForwardModel: Sync {
    /// A true run at exponent p.
    fn run(&self, p: f64) -> Result<RecordedRun>;
}

/// One true run, with what is needed to estimate runs at other exponents.
pub struct RecordedRun {
    /// The curve for A = 1.
    pub curve: UnitCurve,
    /// Horizon that A belongs to, m.
    pub horizon: f64,
    /// Actual lattice spacing, m.
    pub spacing: f64,
    /// Growth below which the curve shows steps of the model, m: a spacing where bonds break one by one, none where K drives the tip.
    pub coarseness: f64,
    /// What the user should know about the run.
    pub warnings: Vec<String>,
    replay: Box<dyn Fn(f64) -> UnitCurve + Send + Sync>,
}

impl RecordedRun {
    /// A run with a cheap estimate of the same run at another p, computed from its recorded events without any solve.
    #[must_use]
    pub fn new(curve: UnitCurve, horizon: f64, spacing: f64, replay: impl Fn(f64) -> UnitCurve + Send + Sync + 'static) -> Self {
        RecordedRun { curve, horizon, spacing, coarseness: 0.0, warnings: Vec::new(), replay: Box::new(replay) }
    }

    /// Estimated curve for A = 1 at another exponent.
    #[must_use]
    pub fn replay(&self, p: f64) -> UnitCurve {
        (self.replay)(p)
    }
}

impl fmt::Debug for RecordedRun {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("RecordedRun").field("points", &self.curve.len()).field("horizon", &self.horizon).finish_non_exhaustive()
    }
}

/// A x cycles from the first of `lengths` to each of them, linear between the points of the curve.
pub fn cycles_since_first(curve: &[(f64, f64)], lengths: &[f64]) -> Result<Vec<f64>> {
    let at: Vec<f64> = lengths.iter().map(|&length| cycles_at(curve, length)).collect::<Result<_>>()?;
    let start = at.first().copied().unwrap_or(0.0);
    Ok(at.into_iter().map(|n| n - start).collect())
}

/// A x cycles at which the curve first reaches a length.
fn cycles_at(curve: &[(f64, f64)], length: f64) -> Result<f64> {
    let outside = |problem: String| Err(Error::Mechanics(problem));
    let (Some(first), Some(last)) = (curve.first(), curve.last()) else {
        return outside("the run gave no a-N curve".to_owned());
    };
    let mm = |length: f64| length / MM;
    if length <= first.1 {
        if length >= first.1 - LENGTH_SLACK {
            return Ok(first.0);
        }
        return outside(format!("the run starts at {:.4} mm, after the reading at {:.4} mm", mm(first.1), mm(length)));
    }
    let next = curve.partition_point(|point| point.1 < length);
    match curve.get(next) {
        None if length <= last.1 + LENGTH_SLACK => Ok(last.0),
        None => outside(format!("the run ends at {:.4} mm, before the reading at {:.4} mm", mm(last.1), mm(length))),
        Some(&(n, a)) => {
            let (n_before, a_before) = curve[next - 1]; // next > 0: the first point lies below `length`
            Ok(n_before + (n - n_before) * (length - a_before) / (a - a_before))
        }
    }
}
