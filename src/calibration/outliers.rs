//! Readings that do not belong: growth far slower or faster than the rest of the same test at equal ΔK.
//!
//! A stalled start after a precrack at a higher load, an overload or a counter that jumped moves a line of least squares by more than its
//! error says. A repeated-median line, `m = med_i med_(j≠i) (y_j - y_i) / (x_j - x_i)` with y = ln da/dN over x = ln ΔK (Siegel 1982,
//! Biometrika 69:242), stays until half of the rates are wrong. Rates are those over growth of at least 0.25 mm, below which reading
//! errors show.

use crate::calibration::level_shift;
use crate::calibration::measured::{MeasuredCurve, round_off};
use crate::calibration::median::median;
use crate::calibration::rates::STEP_MIN;
use crate::units::{MM, MPA_SQRT_M};

/// Rates beyond this factor of the line, or below its inverse, do not belong; on clean curves the smallest seen is 0.83.
pub const FACTOR: f64 = 3.0;

/// Fewest rates for a line that a few of them cannot move.
const RATES_MIN: usize = 6;

/// Rates that a line is drawn through at the most, evenly picked: slopes of all pairs are taken.
const RATES_MAX: usize = 2000;

/// Runs of readings that a message names.
const RUNS_NAMED: usize = 5;

/// Rate of growth from one reading to a later one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepRate {
    /// First reading.
    pub from: usize,
    /// Last reading.
    pub to: usize,
    /// ln of ΔK in MPa√m at the mean length.
    pub log_k: f64,
    /// ln of da/dN in m/cycle.
    pub log_rate: f64,
}

/// Line `ln da/dN = intercept + m ln ΔK` in m/cycle and MPa√m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RobustLine {
    /// ln of the rate at 1 MPa√m.
    pub intercept: f64,
    /// Slope.
    pub m: f64,
}

/// Readings between which a crack grew too slowly or too fast.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Run {
    /// First reading.
    pub from: usize,
    /// Last reading.
    pub to: usize,
    /// Rate over that of the line, where it is farthest from it.
    pub factor: f64,
}

/// Readings at least [`STEP_MIN`] of growth apart, the first among them.
pub fn readings_apart(lengths: &[f64]) -> Vec<usize> {
    let mut apart: Vec<usize> = Vec::new();
    for (i, &length) in lengths.iter().enumerate() {
        if apart.last().is_none_or(|&last| length >= lengths[last] + STEP_MIN * (1.0 - 1e-9)) {
            apart.push(i);
        }
    }
    apart
}

/// Rates over steps of at least [`STEP_MIN`]; `delta_k` is that of the case's load (Pa√m) at a length (m).
pub fn step_rates(curve: &MeasuredCurve, delta_k: &dyn Fn(f64) -> f64) -> Vec<StepRate> {
    let factors = curve.step_factors();
    let rate = |pair: &[usize]| {
        let (from, to) = (pair[0], pair[1]);
        let (growth, cycles) = (curve.crack_length[to] - curve.crack_length[from], curve.cycles[to] - curve.cycles[from]);
        let inner = &factors[from + 1..=to];
        let factor = inner.iter().map(|(start, end)| 0.5 * (start + end)).sum::<f64>() / inner.len() as f64;
        let k = delta_k(curve.crack_length[from] + 0.5 * growth) * factor / MPA_SQRT_M;
        let usable = (from + 1..=to).all(|step| curve.counts(step)) && k > 0.0 && cycles > 0.0;
        usable.then(|| StepRate { from, to, log_k: k.ln(), log_rate: (growth / cycles).ln() })
    };
    readings_apart(&curve.crack_length).windows(2).filter_map(rate).collect()
}

/// The repeated-median line; `None` for fewer than six rates or rates at one ΔK. Of more than two thousand every second, third and so on
/// is taken.
pub fn robust_line(rates: &[StepRate]) -> Option<RobustLine> {
    if rates.len() < RATES_MIN {
        return None;
    }
    let rates: Vec<StepRate> = rates.iter().copied().step_by(rates.len().div_ceil(RATES_MAX)).collect();
    let slope = |one: &StepRate| {
        let others = rates.iter().filter(|other| other.log_k != one.log_k);
        let slopes: Vec<f64> = others.map(|other| (other.log_rate - one.log_rate) / (other.log_k - one.log_k)).collect();
        (!slopes.is_empty()).then(|| median(&slopes))
    };
    let slopes: Vec<f64> = rates.iter().filter_map(slope).collect();
    let m = if slopes.is_empty() { return None } else { median(&slopes) };
    let levels: Vec<f64> = rates.iter().map(|rate| rate.log_rate - m * rate.log_k).collect();
    Some(RobustLine { intercept: median(&levels), m })
}

/// Runs of neighbouring rates that do not belong to the line.
pub fn runs(rates: &[StepRate], line: RobustLine) -> Vec<Run> {
    let mut runs: Vec<Run> = Vec::new();
    for rate in rates {
        let factor = (rate.log_rate - line.intercept - line.m * rate.log_k).exp();
        if (1.0 / FACTOR..=FACTOR).contains(&factor) {
            continue;
        }
        match runs.last_mut() {
            Some(run) if run.to == rate.from && (run.factor > 1.0) == (factor > 1.0) => {
                let farther = factor.ln().abs() > run.factor.ln().abs();
                *run = Run { to: rate.to, factor: if farther { factor } else { run.factor }, ..*run };
            }
            _ => runs.push(Run { from: rate.from, to: rate.to, factor }),
        }
    }
    runs
}

impl MeasuredCurve {
    /// The curve with the growth of some runs left out.
    pub fn without(&self, runs: &[Run]) -> MeasuredCurve {
        let mut left_out: Vec<bool> = (0..self.cycles.len()).map(|step| !self.counts(step)).collect();
        for run in runs {
            left_out[run.from + 1..=run.to].fill(true);
        }
        if runs.is_empty() { self.clone() } else { MeasuredCurve { left_out, ..self.clone() } }
    }
}

/// What speaks against the readings of a curve: [`runs`] that do not belong, and a [shift of level](level_shift).
pub fn doubts(curve: &MeasuredCurve, delta_k: &dyn Fn(f64) -> f64) -> Vec<String> {
    let rates = step_rates(curve, delta_k);
    let runs = robust_line(&rates).map_or_else(Vec::new, |line| runs(&rates, line));
    let shift = level_shift::warning(curve, &rates, &runs);
    named(curve, &runs).into_iter().chain(shift).collect()
}

/// Warnings that name the runs of a curve by line, with the window that leaves them out.
fn named(curve: &MeasuredCurve, runs: &[Run]) -> Vec<String> {
    let mut lines: Vec<String> = runs.iter().take(RUNS_NAMED).map(|run| warning(curve, *run)).collect();
    if runs.len() > RUNS_NAMED {
        lines.push(format!("specimen {}: {} more runs of readings do not belong", curve.specimen, runs.len() - RUNS_NAMED));
    }
    lines
}

fn warning(curve: &MeasuredCurve, run: Run) -> String {
    let Run { from, to, factor } = run;
    let [start, end] = [from, to].map(|reading| round_off(curve.source.cycles_before + curve.cycles[reading]));
    let [first, last] = [from, to].map(|reading| round_off(curve.crack_length[reading] / MM));
    format!(
        "{}readings do not belong: from {first} to {last} mm the crack of specimen {} grew at {factor:.2} times the rate of its other \
         readings at equal ΔK; if the test explains it, leave them out by measured.leave_out = [{{ specimen = \"{}\", from_cycles = \
         {start}, to_cycles = {end}, reason = \"...\" }}]",
        place(curve, from, to),
        curve.specimen,
        curve.specimen.replace(['\\', '"'], "'"),
    )
}

/// File and lines of readings, to go in front of a message.
pub(crate) fn place(curve: &MeasuredCurve, from: usize, to: usize) -> String {
    match curve.source.lines.len() {
        0 => String::new(),
        _ => format!("{}: lines {} to {}: ", curve.source.file.display(), curve.line(from), curve.line(to)),
    }
}
