//! K of two tips that come towards each other, from where a ring between them is too narrow until they meet.
//!
//! Between collinear cracks K of the inner tips rises as `1 / (√g ln(c/g))` with the gap g (limit of Willmore 1949), nearly a power of
//! it over the way that is left, so that ln K is continued as a straight line over ln g.

use serde::{Deserialize, Serialize};

/// Gap, in horizons, from which on K is not read any more. Against finite elements of three collinear cracks K is read within 1 % at
/// 1.7 horizons, 3 % high at 1.4 to 1, and 25 % low at 0.7.
pub(super) const GAP_HORIZONS: f64 = 1.6;
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
    /// Takes in the factors read at a gap to the tip ahead, m; gives those that the tip has.
    pub fn factors(&mut self, read: [f64; 2], gap: f64, horizon: f64) -> [f64; 2] {
        if gap > GAP_HORIZONS * horizon {
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
