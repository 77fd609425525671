//! Cycles of a model at the lengths at which a curve was read.

use crate::error::{Error, Result};
use crate::monotone::Monotone;
use crate::units::MM;

/// Slack of the ends of a run against readings, m.
const LENGTH_SLACK: f64 = 1e-9;

/// Cycles from the first of `lengths` (m) to each of them, linear between the points (cycles, crack length in m) of a dense table.
///
/// # Errors
/// A length that the table does not reach.
pub fn cycles_since_first(table: &[(f64, f64)], lengths: &[f64]) -> Result<Vec<f64>> {
    since_first(table, lengths, |before, share| {
        let [from, to] = [table[before].0, table[before + 1].0];
        from + share * (to - from)
    })
}

/// The same of the rows of a run, by a monotone cubic between them: they lie two to four millimetres apart, and on straight lines
/// cycles were up to 1 % off.
///
/// # Errors
/// A length that the run does not reach.
pub fn cycles_of_run(rows: &[(f64, f64)], lengths: &[f64]) -> Result<Vec<f64>> {
    let table = Monotone::new(rows.iter().map(|(cycles, length)| [*length, *cycles]));
    since_first(rows, lengths, |before, share| table.between(before, share))
}

fn since_first(curve: &[(f64, f64)], lengths: &[f64], between: impl Fn(usize, f64) -> f64) -> Result<Vec<f64>> {
    let at: Vec<f64> = lengths.iter().map(|&length| cycles_at(curve, &between, length)).collect::<Result<_>>()?;
    let start = at.first().copied().unwrap_or(0.0);
    Ok(at.into_iter().map(|n| n - start).collect())
}

/// Cycles at which the curve first reaches a length.
fn cycles_at(curve: &[(f64, f64)], between: impl Fn(usize, f64) -> f64, length: f64) -> Result<f64> {
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
            Ok(between(next - 1, (length - from) / (to - from)))
        }
    }
}
