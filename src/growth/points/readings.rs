//! What readings of K tell where it cannot be read.
//!
//! K at the length that a line has, from K at the lengths at which the field of the tip stands.
//!
//! A crack cut into bonds reaches farther than its line or less far, by up to half a spacing and by another amount at every step, and
//! the field of its tip stands a fifth of a spacing ahead of that ([`perilife_points::stress_intensity::ring`]). What is read belongs to that
//! length. It is brought to that of the line along the slope of ln K over that length, taken from the readings of the last horizons
//! of growth; at the start from the crack drawn back by half a horizon.
//!
//! K of two tips that come towards each other, from where a ring between them is too narrow until they meet. Between collinear cracks K
//! of the inner tips rises as `1 / (√g ln(c/g))` with the gap g (limit of Willmore 1949), nearly a power of it over the way that is left,
//! so that ln K is continued as a straight line over ln g.

use serde::{Deserialize, Serialize};

/// Growth, in horizons, whose readings show how K changes.
const MEMORY_HORIZONS: f64 = 2.1;
/// Slope over that of a long crack far from everything, K ~ √a, at the most: a single odd reading is not followed farther.
const SLOPE_MOST: f64 = 12.0;

/// Spread of readings, in horizons, whose slope counts as much as that of a crack far from everything.
const PRIOR_HORIZONS: f64 = 0.1;

/// K_II where the field of a tip stands in mode II.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct Sliding {
    /// How far ahead of the end of its line the crack is that has it, m.
    pub(super) offset: f64,
    /// Pa√m.
    pub(super) factor: f64,
    /// The same at the end of the line.
    pub(super) at_line: f64,
}

/// What is kept of the readings of a tip.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(super) struct Memory {
    pub(super) readings: Readings,
    /// Of K_II, of a tip of both modes before it grows.
    pub(super) sliding_readings: Readings,
    pub(super) coalescence: Coalescence,
    /// Of the last reading, of a tip of both modes.
    pub(super) sliding: Option<Sliding>,
}

impl Memory {
    /// K_II of a tip of both modes that has not grown over what is read where its field stands in mode II, `offset` ahead of its line,
    /// for a crack of this `length` shorter `by` so much, m. The core of a nonlocal crack reaches a fifth of a horizon farther in mode II
    /// than in mode I.
    pub(super) fn sliding_ratio(&self, k_ii: f64, offset: f64, [by, length]: [f64; 2], horizon: f64) -> f64 {
        let mut readings = self.sliding_readings.clone();
        readings.take(k_ii.abs(), 0.0, offset, None, horizon);
        readings.ratio(by, length, horizon)
    }
}

/// Readings of K of a tip.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Readings {
    /// Growth at which the field stands, and ln K.
    taken: Vec<[f64; 2]>,
}

impl Readings {
    /// Takes in K of a tip that has grown by `growth` and whose field stands `length_offset` ahead; what was read before a corner tells
    /// nothing about the crack after it.
    pub fn take(&mut self, k: f64, growth: f64, length_offset: f64, corner: Option<f64>, horizon: f64) {
        if k > 0.0 {
            self.taken.push([growth + length_offset, k.ln()]);
        }
        let oldest = corner.map_or(f64::NEG_INFINITY, |corner| corner + 0.1 * horizon).max(growth - MEMORY_HORIZONS * horizon);
        self.taken.retain(|reading| reading[0] > oldest);
    }

    /// K at `length_offset` less length over that of a crack that is `length` long, m.
    pub fn ratio(&self, length_offset: f64, length: f64, horizon: f64) -> f64 {
        let usual = 0.5 / length;
        let count = self.taken.len() as f64;
        let [x, y] = [0, 1].map(|i| self.taken.iter().map(|reading| reading[i]).sum::<f64>() / count.max(1.0));
        let product = |i: usize| self.taken.iter().map(|r| (r[0] - x) * (r[i] - [x, y][i])).sum::<f64>();
        // As if the slope of a crack far from everything had been read too: the scatter of a few readings close together is none.
        let prior = (PRIOR_HORIZONS * horizon).powi(2);
        let slope = (product(1) + prior * usual) / (product(0) + prior);
        (-slope.clamp(-SLOPE_MOST * usual, SLOPE_MOST * usual) * length_offset).exp()
    }
}

/// Gap, in horizons, over whose readings the power is taken.
const SEEN_HORIZONS: f64 = 4.0;
/// Bounds of the power, and what is taken where too few readings tell: finite elements of three collinear cracks have 0.25 to 0.32 at
/// gaps of 0.6 to 4 mm.
const POWER: [f64; 2] = [0.0, 0.5];
const POWER_USUAL: f64 = 0.3;
/// Spread of ln g below which readings tell no power.
const SPREAD_LEAST: f64 = 0.1;

/// Readings of a tip that comes towards another.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Coalescence {
    /// ln g, K_I and K_II.
    seen: Vec<[f64; 3]>,
}

impl Coalescence {
    /// Takes in the factors read at a gap to the tip ahead, m; gives those that the tip has. From the gap `unread` on, m, they are not
    /// those that were read.
    pub fn factors(&mut self, read: [f64; 2], gap: f64, [unread, horizon]: [f64; 2]) -> [f64; 2] {
        if gap > unread {
            if gap < SEEN_HORIZONS * horizon {
                self.seen.push([gap.ln(), read[0], read[1]]);
            }
            return read;
        }
        let Some(&[last, k_i, k_ii]) = self.seen.last() else { return read };
        let share = (self.power() * (last - gap.ln())).exp();
        [share * k_i, share * k_ii]
    }

    /// The power of 1/g that K_I rises with.
    fn power(&self) -> f64 {
        let count = self.seen.len() as f64;
        let log = |seen: &[f64; 3]| seen[1].max(f64::MIN_POSITIVE).ln();
        let [x, y] = [self.seen.iter().map(|s| s[0]).sum::<f64>() / count, self.seen.iter().map(log).sum::<f64>() / count];
        let spread: f64 = self.seen.iter().map(|s| (s[0] - x).powi(2)).sum();
        if spread < SPREAD_LEAST * SPREAD_LEAST {
            return POWER_USUAL;
        }
        let slope = self.seen.iter().map(|s| (s[0] - x) * (log(s) - y)).sum::<f64>() / spread;
        (-slope).clamp(POWER[0], POWER[1])
    }
}
