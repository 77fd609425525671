//! The law that all specimens of a lot share: `ln da/dN = b₀ + m x + Σ c_k φ_k(x)`, `x = ln(ΔK / pivot)`.
//!
//! The chord b₀ + m x goes through both ends of the calibrated range; hats φ_k on inner knots even in ln ΔK give the law its shape over it.

use serde::{Deserialize, Serialize};

use super::intervals::Interval;

/// Inner knots of the shape.
pub const KNOTS: usize = 4;
/// Fixed effects: b₀, m, c_k.
pub const EFFECTS: usize = 2 + KNOTS;

/// Growth law of a lot.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct MeanLaw {
    /// ΔK at which x = 0, Pa√m.
    pub pivot: f64,
    /// b₀: ln of the rate (m/cycle) of the chord at the pivot.
    pub level: f64,
    /// m of the chord, from one end of the range to the other.
    pub slope: f64,
    /// Calibrated ΔK, Pa√m.
    pub range: [f64; 2],
    /// c_k; `None` where the data cannot carry a shape.
    pub shape: Option<[f64; KNOTS]>,
}

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

impl MeanLaw {
    /// Largest over smallest calibrated ΔK.
    pub fn range_ratio(&self) -> f64 {
        self.range[1] / self.range[0]
    }

    /// Spacing of the knots in ln ΔK.
    pub fn knot_spacing(&self) -> f64 {
        self.range_ratio().ln() / (KNOTS + 1) as f64
    }

    /// ΔK of the knots, Pa√m.
    pub fn knots(&self) -> [f64; KNOTS] {
        std::array::from_fn(|k| self.range[0] * (self.knot_spacing() * (k + 1) as f64).exp())
    }

    /// ln of the rate (m/cycle) at a ΔK (Pa√m).
    pub fn log_rate(&self, delta_k: f64) -> f64 {
        self.at(delta_k.ln())
    }

    /// Root mean square over the range of the local slope less m.
    pub fn slope_deviation(&self) -> f64 {
        let Some(c) = self.shape else { return 0.0 };
        let values: Vec<f64> = std::iter::once(0.0).chain(c).chain([0.0]).collect();
        let squares: f64 = values.windows(2).map(|pair| (pair[1] - pair[0]).powi(2)).sum();
        (squares / (KNOTS + 1) as f64).sqrt() / self.knot_spacing()
    }

    fn at(&self, log_k: f64) -> f64 {
        let (design, effects) = (self.design(log_k), self.effects());
        design.iter().zip(effects).map(|(x, effect)| x * effect).sum()
    }

    pub(super) fn effects(&self) -> [f64; EFFECTS] {
        let c = self.shape.unwrap_or_default();
        std::array::from_fn(|i| [self.level, self.slope].get(i).copied().unwrap_or_else(|| c[i - 2]))
    }

    /// The law with other fixed effects.
    pub(super) fn with(&self, effects: [f64; EFFECTS]) -> MeanLaw {
        let shape = self.shape.map(|_| std::array::from_fn(|k| effects[2 + k]));
        MeanLaw { level: effects[0], slope: effects[1], shape, ..*self }
    }

    /// 1, x, φ_k at ln ΔK.
    fn design(&self, log_k: f64) -> [f64; EFFECTS] {
        let mut design = [0.0; EFFECTS];
        (design[0], design[1]) = (1.0, log_k - self.pivot.ln());
        if self.shape.is_some() {
            let place = (log_k - self.range[0].ln()) / self.knot_spacing();
            for (k, hat) in design[2..].iter_mut().enumerate() {
                *hat = (1.0 - (place - (k + 1) as f64).abs()).max(0.0);
            }
        }
        design
    }

    /// Intervals as the law sees them.
    pub(super) fn rows(&self, intervals: &[Interval]) -> Vec<Row> {
        let effects = self.effects();
        let [low, high] = self.range.map(f64::ln);
        let mut end = f64::NAN;
        let row = |interval: &Interval| {
            let (mut design, mut cycles, mut squares) = ([0.0; EFFECTS], 0.0, 0.0);
            let (mut beyond, mut outside) = ([0.0; 2], 0.0);
            for &(log_k, weight) in &interval.points {
                let here = self.design(log_k);
                let log_rate: f64 = here.iter().zip(effects).map(|(x, effect)| x * effect).sum();
                let inverse = (-log_rate).exp();
                cycles += weight * inverse;
                squares += weight * inverse * inverse;
                let distance = [low - log_k, log_k - high].map(|distance| distance.max(0.0));
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
                density: interval.ends.map(|log_k| (-self.at(log_k)).exp() / cycles),
                inverse_length: squares / (cycles * cycles),
                zone: interval.zone,
                beyond: beyond.map(|sum| sum / cycles),
                outside: outside / cycles,
                follows,
            }
        };
        intervals.iter().map(row).collect()
    }
}
