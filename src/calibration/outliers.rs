//! Readings that do not belong: growth far slower or faster than the rest of the same test at equal ΔK.
//!
//! A stalled start after a precrack at a higher load, an overload or a counter that jumped moves a line of least squares by more than its
//! error says. A repeated-median line, `m = med_i med_(j≠i) (y_j - y_i) / (x_j - x_i)` with y = ln da/dN over x = ln ΔK (Siegel 1982,
//! Biometrika 69:242), stays until half of the rates are wrong. Rates are those over growth of at least 0.25 mm, below which reading
//! errors show.
//!
//! And whether one power of ΔK can hold for all readings of a test whose loads the file does not give: a load that was stepped or shed,
//! or a counter that jumped, shows as two levels of rate at equal ΔK. Compared are one line `ln da/dN = ln C + m ln ΔK` and two with a
//! common m, the second beginning at the split that fits best: `F = (S₁ - S₂) / (S₂ / (n - 3))` with the sums of squares S of both (test
//! of nested models; Draper and Smith, Applied Regression Analysis, 1998).

use super::median::median;
use super::rates::STEP_MIN;
use perilife_base::units::round_off;
use perilife_base::units::{MM, MM_PER_CYCLE, MPA_SQRT_M};
use perilife_measured::MeasuredCurve;

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

impl RobustLine {
    /// The line of this slope through the middle of some rates.
    pub fn at_level_of(self, rates: &[StepRate]) -> RobustLine {
        let levels: Vec<f64> = rates.iter().map(|rate| rate.log_rate - self.m * rate.log_k).collect();
        RobustLine { intercept: median(&levels), ..self }
    }

    /// C in mm/cycle and MPa√m.
    pub fn c(&self) -> f64 {
        self.intercept.exp() / MM_PER_CYCLE
    }
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
    Some(RobustLine { intercept: f64::NAN, m }.at_level_of(&rates))
}

/// The line of several specimens: the median of their slopes, and of their levels at it.
pub fn robust_line_of_all(specimens: &[Vec<StepRate>]) -> Option<RobustLine> {
    let known: Vec<(&Vec<StepRate>, RobustLine)> =
        specimens.iter().filter_map(|rates| Some((rates, robust_line(rates)?))).collect();
    if known.is_empty() {
        return None;
    }
    let line = RobustLine { m: median(&known.iter().map(|(_, line)| line.m).collect::<Vec<_>>()), intercept: f64::NAN };
    let levels: Vec<f64> = known.iter().map(|(rates, _)| line.at_level_of(rates).intercept).collect();
    Some(RobustLine { intercept: median(&levels), ..line })
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

/// A curve with the growth of some runs left out.
pub fn without(curve: &MeasuredCurve, runs: &[Run]) -> MeasuredCurve {
    let mut left_out: Vec<bool> = (0..curve.cycles.len()).map(|step| !curve.counts(step)).collect();
    for run in runs {
        left_out[run.from + 1..=run.to].fill(true);
    }
    if runs.is_empty() { curve.clone() } else { MeasuredCurve { left_out, ..curve.clone() } }
}

/// What speaks against the readings of a curve: [`runs`] that do not belong, and a [shift of level](best_split).
pub fn doubts(curve: &MeasuredCurve, delta_k: &dyn Fn(f64) -> f64) -> Vec<String> {
    let rates = step_rates(curve, delta_k);
    let runs = robust_line(&rates).map_or_else(Vec::new, |line| runs(&rates, line));
    let shift = level_warning(curve, &rates, &runs);
    named(curve, &runs).into_iter().chain(shift).collect()
}

/// Warnings that name the runs of a curve by line, with the window that leaves them out.
fn named(curve: &MeasuredCurve, runs: &[Run]) -> Vec<String> {
    let mut lines: Vec<String> = runs.iter().take(RUNS_NAMED).map(|run| run_warning(curve, *run)).collect();
    if runs.len() > RUNS_NAMED {
        lines.push(format!("specimen {}: {} more runs of readings do not belong", curve.specimen, runs.len() - RUNS_NAMED));
    }
    lines
}

fn run_warning(curve: &MeasuredCurve, run: Run) -> String {
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

/// Fewest rates on each side.
const SIDE_MIN: usize = 3;

/// Two levels of rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LevelShift {
    /// First rate of the second level.
    pub rate: usize,
    /// How certain the second level is.
    pub f: f64,
    /// Its rate over that of the first, at equal ΔK.
    pub ratio: f64,
    /// The common exponent.
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
fn level_warning(curve: &MeasuredCurve, rates: &[StepRate], runs: &[Run]) -> Option<String> {
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
        "{}no one power of ΔK can hold for specimen {}: from {} mm on the rate is {:.2} times that before at equal ΔK (F = {:.0}, common m \
         {:.2}); if the load changed, give it for every reading (columns force_max_kn and force_min_kn), else leave the readings before or \
         after it out (measured.leave_out or the window of crack lengths)",
        place(curve, from, to),
        curve.specimen,
        round_off(curve.crack_length[from] / MM),
        shift.ratio,
        shift.f,
        shift.m
    ))
}
