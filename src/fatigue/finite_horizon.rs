//! What the finite horizon does to the growth of short cracks.
//!
//! The strain ahead of a crack of length a is `K/√(2πr)` times a series in r/a, and a bond of the ageing zone feels it over a
//! horizon: short cracks grow too fast for their K. Measured on a middle-tension panel (W 152.4 mm, a 9 to 45 mm, spacing 1 mm,
//! p = 2.87) the rate over that of long cracks is 1.082, 1.054, 1.032, 1.019, 1.010 at δ/a = 0.29, 0.22, 0.18, 0.15, 0.13, which
//! is `(1 + (δ/a)²/3)^p`; the cyclic strain is divided by that bracket. Beyond δ/a = 0.3 the series was not followed by the
//! measured rates (spacing 2 mm, a 12 mm: 1.04), and the bracket stays.

crate::kinds! {
    /// Treatment of cracks that are short against the horizon.
    pub enum FiniteHorizon for "fatigue.finite_horizon" {
        Corrected = "corrected": "strain of ageing bonds divided by 1 + (horizon / crack length)²/3, at most 1.03",
        Ignored = "ignored": "strain as computed",
    }
}

/// Life for growth from a to 2a over that at a horizon of less than a/3, by crack length over horizon a/δ (middle tension,
/// W 48 mm, a 3, 4 and 5 mm, spacing 0.2 to 4 mm, p = 2.86, correction on). The single values scatter by 0.07 around it, since
/// half a spacing is much of such a crack; from 1.5 on they lie within 0.03 of 1.
const SHORT_LIFE: [(f64, f64); 6] = [(0.33, 0.44), (0.5, 0.60), (0.66, 0.74), (0.83, 0.88), (1.1, 0.96), (1.5, 1.0)];

/// Share by which the life of a crack of `length` is about too short for its horizon, from what was measured.
#[must_use]
pub fn life_shortfall(horizon: f64, length: f64) -> f64 {
    let ratio = length / horizon;
    let mut last = SHORT_LIFE[0];
    for next in SHORT_LIFE {
        if ratio <= next.0 {
            let share = if next.0 > last.0 { (ratio - last.0) / (next.0 - last.0) } else { 0.0 };
            return 1.0 - (last.1 + share * (next.1 - last.1));
        }
        last = next;
    }
    0.0
}

/// Largest horizon over crack length for which the measured rates follow the series.
const RATIO_MAX: f64 = 0.3;

impl FiniteHorizon {
    /// Factor on the strain of bonds around the tip of a crack of `length` (half length of one with two tips).
    #[must_use]
    pub fn strain_factor(self, horizon: f64, length: f64) -> f64 {
        match self {
            FiniteHorizon::Corrected => 1.0 / (1.0 + (horizon / length).min(RATIO_MAX).powi(2) / 3.0),
            FiniteHorizon::Ignored => 1.0,
        }
    }
}
