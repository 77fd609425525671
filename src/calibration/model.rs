//! Cycles of a model at the lengths at which a curve was read.

use crate::error::{Error, Result};
use crate::monotone::Monotone;
use crate::units::MM;

/// Slack of the ends of a run against readings, m.
const LENGTH_SLACK: f64 = 1e-9;

/// Cycles from the first of `lengths` (m) to each of them, by a monotone cubic between the points (cycles, crack length in m) of a
/// curve: on straight lines between the rows of a run, two to four millimetres apart, cycles were up to 1 % off.
///
/// # Errors
/// A length that the curve does not reach.
pub fn cycles_since_first(curve: &[(f64, f64)], lengths: &[f64]) -> Result<Vec<f64>> {
    let table = Monotone::new(curve.iter().map(|(cycles, length)| [*length, *cycles]));
    let at: Vec<f64> = lengths.iter().map(|&length| cycles_at(curve, &table, length)).collect::<Result<_>>()?;
    let start = at.first().copied().unwrap_or(0.0);
    Ok(at.into_iter().map(|n| n - start).collect())
}

/// Cycles at which the curve first reaches a length.
fn cycles_at(curve: &[(f64, f64)], table: &Monotone, length: f64) -> Result<f64> {
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
        Some(&(_, to)) => {
            let from = curve[next - 1].1; // next > 0: the first point lies below `length`
            Ok(table.between(next - 1, (length - from) / (to - from)))
        }
    }
}
