//! By how much a law misses the measured rates at both ends of its range: a power of ΔK through a bent curve lies above it at one end
//! and below it at the other, and the error of the fit does not say so. [`misfit_at_ends`] is what a life is off by that is spent there.
//!
//! Rates are sums: the cycles that the law takes for the growth of every specimen through that end, over those that were counted. Rates of
//! single readings would not do, since noise makes some of them negative, which have no logarithm.

use serde::{Deserialize, Serialize};

use crate::median::huber_mean;
use perilife_base::units::MPA_SQRT_M;
use perilife_measured::MeasuredCurve;

/// Share of the range of ln ΔK that is an end of it.
const END: f64 = 0.1;

/// Growth through an end of the readings that were fitted, against the law.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Misfit {
    /// ΔK at the reading where the end begins.
    pub delta_k_from_mpa_sqrt_m: f64,
    /// ΔK at the reading where it ends.
    pub delta_k_to_mpa_sqrt_m: f64,
    /// Reading intervals between them.
    pub intervals: usize,
    /// Cycles of the law over those that were counted, less one, in percent: positive where the crack grows faster than the law says, negative
    /// where it grows slower. A life that is spent there is computed too long by as much, or too short.
    pub rate_over_law_percent: f64,
}

/// Misfit at both ends, whatever its standard error; `None` without growth there.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct MisfitAtEnds {
    pub low: Option<Misfit>,
    pub high: Option<Misfit>,
}

const INTERVALS_MIN: usize = 2;

/// Misfit of the typical specimen at its first and last readings, those within a tenth of the range of ln ΔK, or two intervals: the mean over
/// specimens, each beside the same by the law. It is what a life is off by that is spent there.
pub fn misfit_at_ends(measured: &[MeasuredCurve], law: &[MeasuredCurve], delta_k: &dyn Fn(f64) -> f64) -> MisfitAtEnds {
    let of_specimen = |(measured, law): (&MeasuredCurve, &MeasuredCurve)| misfits(measured, law, delta_k);
    let all: Vec<[Option<Misfit>; 2]> = measured.iter().zip(law).map(of_specimen).collect();
    let typical = |end: usize| {
        let ends: Vec<Misfit> = all.iter().filter_map(|ends| ends[end]).collect();
        let misses: Vec<f64> = ends.iter().map(|end| (end.rate_over_law_percent / 100.0).ln_1p()).collect();
        let fold = |of: fn(&Misfit) -> f64, fold: fn(f64, f64) -> f64| ends.iter().map(of).reduce(fold);
        Some(Misfit {
            delta_k_from_mpa_sqrt_m: fold(|end| end.delta_k_from_mpa_sqrt_m, f64::min)?,
            delta_k_to_mpa_sqrt_m: fold(|end| end.delta_k_to_mpa_sqrt_m, f64::max)?,
            intervals: ends.iter().map(|end| end.intervals).sum(),
            rate_over_law_percent: 100.0 * huber_mean(&misses).exp_m1(),
        })
    };
    MisfitAtEnds { low: typical(0), high: typical(1) }
}

fn misfits(measured: &MeasuredCurve, law: &MeasuredCurve, delta_k: &dyn Fn(f64) -> f64) -> [Option<Misfit>; 2] {
    let log: Vec<f64> = (0..measured.cycles.len()).map(|reading| log_k(measured, reading, delta_k)).collect();
    let last = log.len() - 1; // a curve has five readings
    let width = END * (log[last] - log[0]).abs();
    let from_start = log.iter().take_while(|at| (*at - log[0]).abs() <= width).count() - 1;
    let from_end = log.iter().rev().take_while(|at| (*at - log[last]).abs() <= width).count() - 1;
    let end = |steps: std::ops::RangeInclusive<usize>| {
        let (from, to) = (steps.start() - 1, *steps.end());
        let counted: Vec<usize> = steps.filter(|&i| measured.counts(i)).collect();
        let [by_law, cycles] = [&law.cycles, &measured.cycles].map(|of| sum(of, counted.iter().copied()));
        (by_law > 0.0 && cycles > 0.0).then(|| Misfit {
            delta_k_from_mpa_sqrt_m: log[from].exp(),
            delta_k_to_mpa_sqrt_m: log[to].exp(),
            intervals: counted.len(),
            rate_over_law_percent: 100.0 * (by_law / cycles - 1.0),
        })
    };
    [end(1..=from_start.max(INTERVALS_MIN).min(last)), end(last + 1 - from_end.max(INTERVALS_MIN).min(last)..=last)]
}

impl MisfitAtEnds {
    /// The larger of both, percent.
    pub fn largest(&self) -> Option<f64> {
        let misfits = [self.low, self.high].into_iter().flatten().map(|end| end.rate_over_law_percent);
        misfits.max_by(|a, b| a.abs().total_cmp(&b.abs()))
    }

    pub fn words(&self) -> String {
        let end = |end: Misfit| {
            let size = end.rate_over_law_percent.abs();
            let (digits, sense) = (usize::from(size < 99.95), if end.rate_over_law_percent < 0.0 { "slower" } else { "faster" });
            let ends = [end.delta_k_from_mpa_sqrt_m, end.delta_k_to_mpa_sqrt_m];
            let [from, to] = ends.map(|k| format!("{k:.*}", 1 + usize::from(k < 9.995)));
            format!("{size:.digits$} % {sense} at {from} to {to}")
        };
        let ends: Vec<String> = [self.low, self.high].into_iter().flatten().map(end).collect();
        ends.join(", ").replacen("at", "at ΔK", 1)
    }
}

/// ln of ΔK at a reading, MPa√m.
fn log_k(curve: &MeasuredCurve, reading: usize, delta_k: &dyn Fn(f64) -> f64) -> f64 {
    let factor = curve.load_factor.get(reading).copied().unwrap_or(1.0);
    (delta_k(curve.crack_length[reading]) * factor / MPA_SQRT_M).ln()
}

/// Rise of a quantity over some steps, each named by the reading at its end.
fn sum(of: &[f64], steps: impl Iterator<Item = usize>) -> f64 {
    steps.map(|i| of[i] - of[i - 1]).sum()
}
