//! Readings that do not belong: growth far slower or faster than the rest of the same test at equal ΔK.
//!
//! A stalled start after a precrack at a higher load, an overload or a counter that jumped moves a law of least squares by more than its
//! error says. They are judged about a robust curve over ln ΔK, with a level for each specimen: the shape of [`CurveLaw`] with Tukey's weights
//! (Beaton and Tukey 1974, Technometrics 16:147), begun at the repeated-median line `m = med_i med_(j≠i) (y_j - y_i) / (x_j - x_i)` with
//! y = ln da/dN over x = ln ΔK (Siegel 1982, Biometrika 69:242), which stays until half of the rates are wrong. What does not belong to the line
//! does not bend the curve. A run seldom begins and ends at a reading: neighbours on its side that are off belong to it.
//!
//! And whether one power of ΔK can hold for all readings of a test whose loads the file does not give: a load that was stepped or shed,
//! or a counter that jumped, shows as two levels of rate at equal ΔK. Compared are one line `ln da/dN = ln C + m ln ΔK` and two with a
//! common m, the second beginning at the split that fits best: `F = (S₁ - S₂) / (S₂ / (n - 3))` with the sums of squares S of both (test
//! of nested models; Draper and Smith, Applied Regression Analysis, 1998).

use super::median::{NORMAL_MEDIAN, median};
use super::rates::STEP_MIN;
use nalgebra::{DMatrix, DVector};
use perilife_base::units::{MM, MPA_SQRT_M, round_off};

use super::population::intervals::INTERVALS_MAX;
use perilife_laws::curve::{CurveLaw, EFFECTS, KNOTS, ROUGHNESS};
use perilife_measured::{LeaveOut, MeasuredCurve};

/// Rates beyond this factor of the curve, or below its inverse, do not belong; on clean curves the smallest seen is 0.83.
pub const FACTOR: f64 = 3.0;
/// Standard deviations that they are off as well.
const DEVIATIONS: f64 = 5.0;
/// Standard deviations, and factor, by which neighbours of such rates are off that belong to their run.
const NEIGHBOURS: (f64, f64) = (3.0, 1.2);
/// Standard deviations from which on a rate has no weight (95 % efficiency).
const TUKEY: f64 = 4.685;
/// Smallest standard deviation: computed curves have none.
const DEVIATION_MIN: f64 = 0.01;
/// τ of the shape, as in [`super::population`], wide.
const SHAPE_DEVIATION: f64 = 0.3;
const STEPS: (usize, f64) = (40, 1e-6);
/// Fewest rates for a line that a few of them cannot move.
const RATES_MIN: usize = 6;
/// Rates that a line is drawn through at the most, evenly picked: slopes of all pairs are taken.
const RATES_MAX: usize = 2000;
const RUNS_NAMED: usize = 5;

/// Rate of growth from one reading to a later one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepRate {
    pub from: usize,
    pub to: usize,
    /// ln of ΔK in MPa√m at the mean length.
    pub log_k: f64,
    /// ln of da/dN in m/cycle.
    pub log_rate: f64,
}

/// Line `ln da/dN = intercept + m ln ΔK` in m/cycle and MPa√m.
#[derive(Debug, Clone, Copy, PartialEq)]
struct RobustLine {
    pub intercept: f64,
    pub m: f64,
}

impl RobustLine {
    /// The line of this slope through the middle of some rates.
    fn at_level_of(self, rates: &[StepRate]) -> RobustLine {
        let levels: Vec<f64> = rates.iter().map(|rate| rate.log_rate - self.m * rate.log_k).collect();
        RobustLine { intercept: median(&levels), ..self }
    }
}

/// Readings between which a crack grew too slowly or too fast.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OutlierRun {
    pub from: usize,
    pub to: usize,
    /// Rate over that of the curve, where it is farthest from it.
    pub factor: f64,
}

/// Readings at least so much growth (m) apart, the first among them.
pub fn readings_apart(lengths: &[f64], least: f64) -> Vec<usize> {
    let mut apart: Vec<usize> = Vec::new();
    for (i, &length) in lengths.iter().enumerate() {
        if apart.last().is_none_or(|&last| length >= lengths[last] + least * (1.0 - 1e-9)) {
            apart.push(i);
        }
    }
    apart
}

/// Rates over steps of at least [`STEP_MIN`]; `delta_k` is that of the case's load (Pa√m) at a length (m).
pub fn step_rates(curve: &MeasuredCurve, delta_k: &dyn Fn(f64) -> f64) -> Vec<StepRate> {
    rates_over(curve, STEP_MIN, delta_k)
}

/// The same over steps as long as those of [`super::population`].
pub fn long_step_rates(curve: &MeasuredCurve, delta_k: &dyn Fn(f64) -> f64) -> Vec<StepRate> {
    let end = curve.crack_length.iter().copied().fold(0.0, f64::max);
    rates_over(curve, STEP_MIN.max((end - curve.crack_length[0]) / INTERVALS_MAX as f64), delta_k)
}

fn rates_over(curve: &MeasuredCurve, least: f64, delta_k: &dyn Fn(f64) -> f64) -> Vec<StepRate> {
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
    readings_apart(&curve.crack_length, least).windows(2).filter_map(rate).collect()
}

/// The repeated-median line; `None` for fewer than six rates or rates at one ΔK. Of more than two thousand every second, third and so on
/// is taken.
fn robust_line(rates: &[StepRate]) -> Option<RobustLine> {
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
    Some(RobustLine { intercept: f64::NAN, m }.at_level_of(&rates))
}

/// The line of several specimens: the median of their slopes, and of their levels at it.
fn robust_line_of_all(specimens: &[Vec<StepRate>]) -> Option<RobustLine> {
    let known: Vec<(&Vec<StepRate>, RobustLine)> =
        specimens.iter().filter_map(|rates| Some((rates, robust_line(rates)?))).collect();
    if known.is_empty() {
        return None;
    }
    let line = RobustLine { m: median(&known.iter().map(|(_, line)| line.m).collect::<Vec<_>>()), intercept: f64::NAN };
    let levels: Vec<f64> = known.iter().map(|(rates, _)| line.at_level_of(rates).intercept).collect();
    Some(RobustLine { intercept: median(&levels), ..line })
}

/// ln of rates over those of a robust curve that all specimens share at levels of their own, and their standard deviation; `None` where there
/// are too few rates.
fn residuals(specimens: &[Vec<StepRate>]) -> Option<(Vec<Vec<f64>>, f64)> {
    let line = robust_line_of_all(specimens)?;
    let about_line = |rates: &Vec<StepRate>| -> Vec<f64> {
        let line = line.at_level_of(rates);
        rates.iter().map(|rate| rate.log_rate - line.intercept - line.m * rate.log_k).collect()
    };
    let of_line: Vec<Vec<f64>> = specimens.iter().map(about_line).collect();
    let all = || specimens.iter().flatten();
    let [low, high] = [f64::min, f64::max].map(|fold| all().map(|rate| rate.log_k).reduce(fold).unwrap_or(f64::NAN));
    let range = [low.exp(), high.exp()];
    let law = CurveLaw { pivot: (0.5 * (low + high)).exp(), level: 0.0, slope: 0.0, range, shape: Some([0.0; KNOTS]) };
    // One column for the level of every specimen, then x and the shape.
    let count = specimens.len() + EFFECTS - 1;
    let columns = |specimen: usize, log_k: f64| {
        let design = law.design(log_k);
        std::iter::once((specimen, 1.0)).chain((1..EFFECTS).map(move |i| (specimens.len() + i - 1, design[i])))
    };
    let mut now = of_line.clone();
    let mut deviation = deviation_of(&now);
    let held: Vec<Vec<bool>> = of_line.iter().map(|residuals| are_off(residuals, deviation)).collect();
    for _ in 0..STEPS.0 {
        let (mut normal, mut right) = (DMatrix::zeros(count, count), DVector::zeros(count));
        for (i, row) in ROUGHNESS.iter().enumerate() {
            for (j, value) in row.iter().enumerate() {
                normal[(specimens.len() + 1 + i, specimens.len() + 1 + j)] = value * (deviation / SHAPE_DEVIATION).powi(2);
            }
        }
        for (specimen, rates) in specimens.iter().enumerate() {
            normal[(specimen, specimen)] += 1e-9;
            for (k, rate) in rates.iter().enumerate().filter(|(k, _)| !held[specimen][*k]) {
                let weight = (1.0 - (now[specimen][k] / (TUKEY * deviation)).powi(2)).max(0.0).powi(2);
                for (i, x) in columns(specimen, rate.log_k) {
                    right[i] += weight * x * rate.log_rate;
                    columns(specimen, rate.log_k).for_each(|(j, y)| normal[(i, j)] += weight * x * y);
                }
            }
        }
        let found = normal.cholesky()?.solve(&right);
        let mut change = 0.0_f64;
        for (specimen, rates) in specimens.iter().enumerate() {
            for (rate, residual) in rates.iter().zip(&mut now[specimen]) {
                let next = rate.log_rate - columns(specimen, rate.log_k).map(|(i, x)| found[i] * x).sum::<f64>();
                change = change.max((next - *residual).abs());
                *residual = next;
            }
        }
        deviation = deviation_of(&now);
        if change < STEPS.1 {
            break;
        }
    }
    Some((now, deviation))
}

fn deviation_of(residuals: &[Vec<f64>]) -> f64 {
    let sizes: Vec<f64> = residuals.iter().flatten().map(|residual| residual.abs()).collect();
    (median(&sizes) / NORMAL_MEDIAN).max(DEVIATION_MIN)
}

/// Which residuals of a specimen do not belong, with those beside them.
fn are_off(residuals: &[f64], deviation: f64) -> Vec<bool> {
    let limit = FACTOR.ln().max(DEVIATIONS * deviation);
    let beside = NEIGHBOURS.1.ln().max(NEIGHBOURS.0 * deviation);
    let mut off: Vec<bool> = residuals.iter().map(|residual| residual.abs() > limit).collect();
    let goes_on =
        |off: &[bool], at: usize, from: usize| off[from] && residuals[at] * residuals[from] > 0.0 && residuals[at].abs() > beside;
    (1..off.len()).for_each(|i| off[i] = off[i] || goes_on(&off, i, i - 1));
    (0..off.len().saturating_sub(1)).rev().for_each(|i| off[i] = off[i] || goes_on(&off, i, i + 1));
    off
}

/// Runs of neighbouring rates of every specimen that do not belong to the curve of all.
pub fn runs(specimens: &[Vec<StepRate>]) -> Vec<Vec<OutlierRun>> {
    let Some((residuals, deviation)) = residuals(specimens) else { return vec![Vec::new(); specimens.len()] };
    let of_specimen = |(rates, residuals): (&Vec<StepRate>, &Vec<f64>)| {
        let mut runs: Vec<OutlierRun> = Vec::new();
        let off = are_off(residuals, deviation);
        for ((rate, residual), _) in rates.iter().zip(residuals).zip(off).filter(|(_, off)| *off) {
            let factor = residual.exp();
            match runs.last_mut() {
                Some(run) if run.to == rate.from && (run.factor > 1.0) == (factor > 1.0) => {
                    let farther = residual.abs() > run.factor.ln().abs();
                    *run = OutlierRun { to: rate.to, factor: if farther { factor } else { run.factor }, ..*run };
                }
                _ => runs.push(OutlierRun { from: rate.from, to: rate.to, factor }),
            }
        }
        runs
    };
    specimens.iter().zip(&residuals).map(of_specimen).collect()
}

/// A curve with the growth of some runs left out.
pub fn without(curve: &MeasuredCurve, runs: &[OutlierRun]) -> MeasuredCurve {
    let mut left_out: Vec<bool> = (0..curve.cycles.len()).map(|step| !curve.counts(step)).collect();
    for run in runs {
        left_out[run.from + 1..=run.to].fill(true);
    }
    if runs.is_empty() { curve.clone() } else { MeasuredCurve { left_out, ..curve.clone() } }
}

/// What speaks against the readings of a curve of its own: [`runs`] that do not belong, and a [shift of level](best_split).
pub fn doubts(curve: &MeasuredCurve, delta_k: &dyn Fn(f64) -> f64) -> Vec<String> {
    let runs = runs(&[long_step_rates(curve, delta_k)]);
    doubts_beside(curve, &runs[0], delta_k)
}

/// The same where the runs are known.
pub fn doubts_beside(curve: &MeasuredCurve, runs: &[OutlierRun], delta_k: &dyn Fn(f64) -> f64) -> Vec<String> {
    let shift = level_warning(curve, &step_rates(curve, delta_k), runs);
    named(curve, runs).into_iter().chain(shift).collect()
}

fn named(curve: &MeasuredCurve, runs: &[OutlierRun]) -> Vec<String> {
    let mut lines: Vec<String> = runs.iter().take(RUNS_NAMED).map(|run| run_warning(curve, *run)).collect();
    if runs.len() > RUNS_NAMED {
        lines.push(format!("outliers: specimen {}: {} more runs", curve.specimen, runs.len() - RUNS_NAMED));
    }
    lines
}

/// A run as what a fit leaves out.
pub fn left_out(curve: &MeasuredCurve, run: OutlierRun) -> LeaveOut {
    let cycles = |reading: usize| Some(curve.source.cycles_before + curve.cycles[reading]);
    LeaveOut {
        specimen: Some(curve.specimen.clone()),
        from_cycles: cycles(run.from),
        to_cycles: cycles(run.to),
        reason: format!("by the program: {:.2} times the rate of the other readings", run.factor),
        ..LeaveOut::default()
    }
}

fn run_warning(curve: &MeasuredCurve, run: OutlierRun) -> String {
    let OutlierRun { from, to, factor } = run;
    let window = left_out(curve, run);
    let [start, end] = [window.from_cycles, window.to_cycles].map(Option::unwrap_or_default);
    let [first, last] = [from, to].map(|reading| round_off(curve.crack_length[reading] / MM));
    format!(
        "outliers: {}from {first} to {last} mm specimen {} grew at {factor:.2} times the rate of its other readings at equal \
         ΔK; excluded from the fit; if the test explains it, set measured.leave_out = [{{ specimen = \"{}\", from_cycles = \
         {start}, to_cycles = {end}, reason = \"...\" }}]",
        place(curve, from, to),
        curve.specimen,
        curve.specimen.replace(['\\', '"'], "'"),
    )
}

fn place(curve: &MeasuredCurve, from: usize, to: usize) -> String {
    match curve.source.lines.len() {
        0 => String::new(),
        _ => format!("{}: lines {} to {}: ", curve.source.file.display(), curve.line(from), curve.line(to)),
    }
}

/// F above which two levels are certain. The split is chosen among many, so that ordinary tables of F do not hold; of 34 panels of one
/// alloy under constant load one reaches it.
pub const F_MAX: f64 = 60.0;
/// Smallest ratio of the levels worth a word: computed curves scatter so little that any bend is certain.
const RATIO_MIN: f64 = 1.1;
/// Share of rates that may be left to a warning of their own.
const FEW: f64 = 0.1;
const SIDE_MIN: usize = 3;

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LevelShift {
    /// First rate of the second level.
    pub rate: usize,
    /// How certain the second level is.
    pub f: f64,
    /// Its rate over that of the first, at equal ΔK.
    pub ratio: f64,
    pub m: f64,
}

/// Sums over rates that a common slope needs: their number, x, y, x², x y, y².
type Sums = [f64; 6];

fn plus(sums: Sums, x: f64, y: f64) -> Sums {
    let terms = [1.0, x, y, x * x, x * y, y * y];
    std::array::from_fn(|i| sums[i] + terms[i])
}

/// Sums of squares about the means: xx, xy, yy.
fn about_means([n, x, y, xx, xy, yy]: Sums) -> [f64; 3] {
    [xx - x * x / n, xy - x * y / n, yy - y * y / n]
}

/// The best split of the rates; `None` where there are too few.
pub fn best_split(rates: &[StepRate]) -> Option<LevelShift> {
    let count = rates.len();
    if count < 2 * SIDE_MIN + 2 {
        return None;
    }
    // About the means, so that sums of squares lose no digits.
    let mean = |of: fn(&StepRate) -> f64| rates.iter().map(of).sum::<f64>() / count as f64;
    let (mean_x, mean_y) = (mean(|rate| rate.log_k), mean(|rate| rate.log_rate));
    let points = || rates.iter().map(|rate| (rate.log_k - mean_x, rate.log_rate - mean_y));
    let all = points().fold(Sums::default(), |sums, (x, y)| plus(sums, x, y));
    let [xx, xy, yy] = about_means(all);
    let one_line = yy - xy * xy / xx;
    let (mut before, mut best): (Sums, Option<(f64, LevelShift)>) = (Sums::default(), None);
    for (i, (x, y)) in points().enumerate().take(count - SIDE_MIN) {
        before = plus(before, x, y);
        if i + 1 < SIDE_MIN {
            continue;
        }
        let after: Sums = std::array::from_fn(|i| all[i] - before[i]);
        let [first, second] = [before, after].map(about_means);
        let m = (first[1] + second[1]) / (first[0] + second[0]);
        let two_lines = (first[2] + second[2] - m * (first[1] + second[1])).max(yy * 1e-14);
        let f = (one_line - two_lines) / (two_lines / (count as f64 - 3.0));
        let step = |of: usize| after[of] / after[0] - before[of] / before[0];
        let ratio = (step(2) - m * step(1)).exp();
        if f.is_finite() && best.is_none_or(|(least, _)| two_lines < least) {
            best = Some((two_lines, LevelShift { rate: i + 1, f, ratio, m }));
        }
    }
    best.map(|(_, shift)| shift)
}

/// Where the rates of a curve have two levels, and not because of the few of them that `runs` names: those have their own warning.
fn level_warning(curve: &MeasuredCurve, rates: &[StepRate], runs: &[OutlierRun]) -> Option<String> {
    // Runs follow each other.
    let named = |rate: &StepRate| {
        let begun = runs.partition_point(|run| run.from <= rate.from);
        begun > 0 && rate.to <= runs[begun - 1].to
    };
    let rest: Vec<StepRate> = rates.iter().filter(|rate| !named(rate)).copied().collect();
    let few = (rates.len() - rest.len()) as f64 <= FEW * rates.len() as f64;
    let rates = if few { &rest } else { rates };
    let shift = best_split(rates)?;
    if shift.f <= F_MAX || shift.ratio.ln().abs() < RATIO_MIN.ln() {
        return None;
    }
    let StepRate { from, to, .. } = rates[shift.rate];
    Some(format!(
        "outliers: {}rate changes in specimen {}: above {} mm it is {:.2} times that before at equal ΔK (F = {:.0}, common m {:.2}); if \
         the load changed, give it for every reading (columns force_max_kn and force_min_kn), else exclude the readings \
         before or after it (measured.leave_out or the window of crack lengths)",
        place(curve, from, to),
        curve.specimen,
        round_off(curve.crack_length[from] / MM),
        shift.ratio,
        shift.f,
        shift.m
    ))
}
