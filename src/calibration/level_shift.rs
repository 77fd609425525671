//! Whether one power of ΔK can hold for all readings of a test whose loads the file does not give.
//!
//! A load that was stepped or shed, or a counter that jumped, shows as two levels of rate at equal ΔK. Compared are one line
//! `ln da/dN = ln C + m ln ΔK` and two with a common m, the second beginning at the split that fits best:
//! `F = (S₁ - S₂) / (S₂ / (n - 3))` with the sums of squares S of both (test of nested models; Draper and Smith, Applied Regression Analysis, 1998).

use crate::calibration::measured::{MeasuredCurve, round_off};
use crate::calibration::outliers::{Run, StepRate, place};
use crate::units::MM;

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

/// Sums over rates that a common slope needs.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    n: f64,
    x: f64,
    y: f64,
    xx: f64,
    xy: f64,
    yy: f64,
}

impl Sums {
    fn add(self, x: f64, y: f64) -> Self {
        Sums { n: self.n + 1.0, x: self.x + x, y: self.y + y, xx: self.xx + x * x, xy: self.xy + x * y, yy: self.yy + y * y }
    }

    fn less(self, other: Sums) -> Self {
        Sums {
            n: self.n - other.n,
            x: self.x - other.x,
            y: self.y - other.y,
            xx: self.xx - other.xx,
            xy: self.xy - other.xy,
            yy: self.yy - other.yy,
        }
    }

    /// Sums of squares about the means: xx, xy, yy.
    fn about_means(self) -> [f64; 3] {
        [self.xx - self.x * self.x / self.n, self.xy - self.x * self.y / self.n, self.yy - self.y * self.y / self.n]
    }
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
    let all = points().fold(Sums::default(), |sums, (x, y)| sums.add(x, y));
    let [xx, xy, yy] = all.about_means();
    let one_line = yy - xy * xy / xx;
    let (mut before, mut best): (Sums, Option<(f64, LevelShift)>) = (Sums::default(), None);
    for (i, (x, y)) in points().enumerate().take(count - SIDE_MIN) {
        before = before.add(x, y);
        if i + 1 < SIDE_MIN {
            continue;
        }
        let after = all.less(before);
        let [first, second] = [before.about_means(), after.about_means()];
        let m = (first[1] + second[1]) / (first[0] + second[0]);
        let two_lines = (first[2] + second[2] - m * (first[1] + second[1])).max(yy * 1e-14);
        let f = (one_line - two_lines) / (two_lines / (count as f64 - 3.0));
        let ratio = ((after.y / after.n - before.y / before.n) - m * (after.x / after.n - before.x / before.n)).exp();
        if f.is_finite() && best.is_none_or(|(least, _)| two_lines < least) {
            best = Some((two_lines, LevelShift { rate: i + 1, f, ratio, m }));
        }
    }
    best.map(|(_, shift)| shift)
}

/// Where the rates of a curve have two levels, and not because of the few of them that `runs` names: those have their own warning.
pub fn warning(curve: &MeasuredCurve, rates: &[StepRate], runs: &[Run]) -> Option<String> {
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
