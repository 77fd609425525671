//! K at the length that a line has, from K at the lengths at which the field of the tip stands.
//!
//! A crack cut into bonds reaches farther than its line or less far, by up to half a spacing and by another amount at every step, and
//! the field of its tip stands a fifth of a spacing ahead of that ([`crate::stress_intensity::ring`]). What is read belongs to that
//! length. It is brought to that of the line along the slope of ln K over that length, taken from the readings of the last horizons
//! of growth; at the start from the crack drawn back by half a horizon.

use serde::{Deserialize, Serialize};

/// Growth, in horizons, whose readings show how K changes.
const MEMORY_HORIZONS: f64 = 2.1;
/// Slope over that of a long crack far from everything, K ~ √a, at the most: a single odd reading is not followed farther.
const SLOPE_MOST: f64 = 12.0;

/// Spread of readings, in horizons, whose slope counts as much as that of a crack far from everything.
const PRIOR_HORIZONS: f64 = 0.1;

/// Readings of a tip.
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
