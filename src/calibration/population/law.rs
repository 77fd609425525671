//! Reading intervals as the law of a lot sees them: means over their cycles.

use super::intervals::Interval;
use perilife_laws::curve::{CurveLaw, EFFECTS};

/// An interval as the law sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Row {
    /// Means of 1, x, φ_k over the interval, weighted with its cycles.
    pub design: [f64; EFFECTS],
    /// ln of the cycles by the law.
    pub log_cycles: f64,
    /// Share of the interval's cycles in a metre at its start and its end, 1/m.
    pub density: [f64; 2],
    /// Integral of the squared density, 1/m: one over the length where it is even.
    pub inverse_length: f64,
    /// Zone coordinate at both ends, m.
    pub zone: [f64; 2],
    /// Mean distance of ln ΔK below and above the calibrated range.
    pub beyond: [f64; 2],
    /// Share of the interval's cycles outside the calibrated range.
    pub outside: f64,
    /// Whether the interval starts with the reading that ended the one before it.
    pub follows: bool,
}

/// Rates of the tips of a crack at a place, m/cycle together, and their design, weighted with the rates.
fn of_tips(law: &CurveLaw, log_k: &[f64]) -> ([f64; EFFECTS], f64) {
    let (mut design, mut rate) = ([0.0; EFFECTS], 0.0);
    for &log_k in log_k.iter().filter(|log_k| log_k.is_finite()) {
        let here = law.design(log_k);
        let own = here.iter().zip(law.effects()).map(|(x, effect)| x * effect).sum::<f64>().exp();
        rate += own;
        design.iter_mut().zip(here).for_each(|(sum, x)| *sum += own * x);
    }
    (design.map(|sum| sum / rate), rate)
}

/// Intervals as the law sees them.
pub(super) fn rows(law: &CurveLaw, intervals: &[Interval]) -> Vec<Row> {
    let [low, high] = law.range.map(f64::ln);
    let mut end = f64::NAN;
    let row = |interval: &Interval| {
        let (mut design, mut cycles, mut squares) = ([0.0; EFFECTS], 0.0, 0.0);
        let (mut beyond, mut outside) = ([0.0; 2], 0.0);
        for (log_k, weight) in interval.places() {
            let (here, rate) = of_tips(law, log_k);
            let inverse = 1.0 / rate;
            cycles += weight * inverse;
            squares += weight * inverse * inverse;
            let distance = [low - log_k[0], log_k[0] - high].map(|distance| distance.max(0.0));
            beyond = [0, 1].map(|side| beyond[side] + weight * inverse * distance[side]);
            outside += if distance == [0.0; 2] { 0.0 } else { weight * inverse };
            for (sum, x) in design.iter_mut().zip(here) {
                *sum += weight * inverse * x;
            }
        }
        let follows = interval.from == end;
        end = interval.to;
        Row {
            design: design.map(|sum| sum / cycles),
            log_cycles: cycles.ln(),
            density: [0, 1].map(|side| 1.0 / (of_tips(law, &interval.ends[side]).1 * cycles)),
            inverse_length: squares / (cycles * cycles),
            zone: interval.zone,
            beyond: beyond.map(|sum| sum / cycles),
            outside: outside / cycles,
            follows,
        }
    };
    intervals.iter().map(row).collect()
}
