//! The a-N curve of a run at chosen cycles.
//!
//! Between two rows cycles are a monotone cubic of crack length ([`Monotone`]): rows lie up to 1.5 horizons apart, and
//! on straight lines between them cycles were read up to 2.5 % short at a quarter of the growth. ΔK and da/dN are linear in crack length. First and last row are
//! kept exactly.

use super::curve::{Row, curve};
use perilife_base::error::{Result, input};
use perilife_base::monotone::Monotone;

/// Most rows; more is a slip of the pen.
pub const ROWS_MAX: u64 = 10_000_000;

/// Where a curve is wanted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Sampling {
    /// So many rows, at least 2, equally spaced in cycles from the first to the last.
    Points(u64),
    /// A row every so many cycles, and one at the end.
    EveryCycles(f64),
}

impl Sampling {
    /// Rows of a curve, which has at least one.
    /// Errors: a step that is not positive or asks for more than [`ROWS_MAX`] rows; `option` is what the caller calls it.
    pub fn of(self, curve: &[Row], option: &str) -> Result<Vec<Row>> {
        let (first, last) = (curve[0].cycles, curve[curve.len() - 1].cycles);
        let cycles = match self {
            Sampling::Points(_) if first == last => vec![first],
            Sampling::Points(count) => {
                let inner = (1..count - 1).map(|i| first + (last - first) * (i as f64 / (count - 1) as f64));
                std::iter::once(first).chain(inner).chain([last]).collect()
            }
            Sampling::EveryCycles(step) => every(first, last, step, option)?,
        };
        let table = cycles_over_length(curve);
        Ok(cycles.iter().map(|n| at(curve, &table, *n)).collect())
    }
}

/// `first`, then every `step` cycles, then `last`.
fn every(first: f64, last: f64, step: f64, option: &str) -> Result<Vec<f64>> {
    if !(step.is_finite() && step > 0.0) {
        return Err(input(option, step, "is not a positive number of cycles", "give for example 1000"));
    }
    let count = ((last - first) / step).floor();
    if count > ROWS_MAX as f64 {
        let problem = format!("gives {count:.0} rows, more than {ROWS_MAX}");
        return Err(input(option, step, problem, format!("give at least {:.3e}", (last - first) / ROWS_MAX as f64)));
    }
    let mut cycles: Vec<f64> = (0..=count as u64).map(|i| first + step * i as f64).filter(|n| *n < last).collect();
    cycles.push(last);
    Ok(cycles)
}

/// The curve (at least one row) at `cycles`, which lies within it. Where several rows share these cycles the last one counts; at the very
/// start the first one does, so that the curve begins at the initial crack length.
fn at(curve: &[Row], table: &Monotone, cycles: f64) -> Row {
    if cycles <= curve[0].cycles && curve[curve.len() - 1].cycles > curve[0].cycles {
        return curve[0];
    }
    let after = curve.partition_point(|row| row.cycles <= cycles);
    let from = curve[after.saturating_sub(1)];
    let Some(to) = curve.get(after) else { return from };
    let share = if cycles > from.cycles { table.fraction(after - 1, cycles) } else { 0.0 };
    // Written so that share 0 and 1 give the rows themselves and rounding cannot leave the interval.
    let between = |a: f64, b: f64| if share <= 0.0 { a } else { (a + share * (b - a)).clamp(a.min(b), a.max(b)) };
    Row {
        cycles,
        crack_length_mm: between(from.crack_length_mm, to.crack_length_mm),
        delta_k_mpa_sqrt_m: unknown_or(between, from.delta_k_mpa_sqrt_m, to.delta_k_mpa_sqrt_m),
        da_dn_mm_per_cycle: unknown_or(between, from.da_dn_mm_per_cycle, to.da_dn_mm_per_cycle),
    }
}

/// Cycles over crack length of a curve, mm.
pub fn cycles_over_length(rows: &[Row]) -> Monotone {
    Monotone::new(curve(rows).into_iter())
}

/// `clamp` refuses NaN bounds, so an unknown end makes the value unknown before it is asked.
fn unknown_or(between: impl Fn(f64, f64) -> f64, a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::NAN } else { between(a, b) }
}
