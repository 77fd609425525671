//! K of a short kink (Amestoy and Leblond 1992, Int. J. Solids Struct. 29:465).
//!
//! A crack with K_I, K_II and T that has kinked by θ and grown by s since has at its new tip, with m = θ/π,
//!
//! `K_I' = F₁₁(m) K_I + F₁₂(m) K_II + G₁(m) T √s + O(s)`,
//!
//! counter-clockwise θ and K_II as in [`perilife_points::stress_intensity`]. K before the kink in the direction of the largest circumferential
//! stress is none of it (5 % below F₁₂ K_II in pure sliding), and bonds show the kink only once it is as long as the core of the
//! tip. The term of order s is taken as that of a crack that grows straight, `√(1 + s/a)`.

use serde::{Deserialize, Serialize};

use super::steering::kink_angle;
use perilife_base::quadrature::integrate;

/// K of a short kink at the least, over that of none.
const SHARE_LEAST: f64 = 0.5;

#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Kink {
    /// K_I of the infinitesimal kink, Pa√m.
    factor: f64,
    /// G₁ T, Pa.
    slope: f64,
    /// Growth of the tip at which it began, m.
    growth: f64,
}

impl Kink {
    /// The kink that a tip with these factors (Pa√m), T (Pa) and growth begins; `None` where it would not open.
    pub fn new(factors: [f64; 2], t_stress: f64, growth: f64) -> Option<Self> {
        let [k_i, k_ii] = [factors[0].max(0.0), factors[1]];
        let [f11, f12, g1] = coefficients(kink_angle([k_i, k_ii]));
        let factor = f11 * k_i + f12 * k_ii;
        (factor > 0.0).then_some(Kink { factor, slope: g1 * t_stress, growth })
    }

    /// K after so much growth of the tip, of a crack that was `length` long at the start, Pa√m; `None` where the kink is not shorter
    /// than `short` any more, m.
    pub fn factor(&self, growth: f64, length: f64, short: f64) -> Option<f64> {
        let way = growth - self.growth;
        let is_short = way > 0.0 && way < short;
        is_short.then(|| self.opening(way.sqrt()) * (1.0 + way / (length + self.growth)).sqrt())
    }

    /// K of the root of its length, Pa√m.
    pub fn opening(&self, root: f64) -> f64 {
        (self.factor + self.slope * root).max(SHARE_LEAST * self.factor)
    }
}

/// Cycles of the first step of a kink, its rate at the start and at the end of it, m/cycle, and K there, Pa√m: K is linear in the root of the
/// length, and the rate a power p of K,
/// `∫ ds/r = (2 s/r₀) ∫ x (1 + q x)^-p dx`, x from 0 to 1, q = K₁/K₀ - 1.
pub fn cycles(grown: f64, [rate, rate_then]: [f64; 2], [factor, factor_then]: [f64; 2]) -> f64 {
    let (gain, ratio) = ((rate_then / rate).ln(), factor_then / factor);
    let (q, p) = (ratio - 1.0, gain / ratio.ln());
    let is_power = ratio.is_finite() && ratio > 0.0 && p.is_finite() && q.abs() > 1e-3;
    let mean = if is_power {
        2.0 * integrate(|x| x * (1.0 + q * x).powf(-p), 0.0, 1.0, 1e-10).value
    } else {
        1.0 - 2.0 / 3.0 * gain.clamp(-0.75, 0.75)
    };
    grown / rate * mean
}

/// F₁₁, F₁₂ and G₁ of a kink by θ, rad, up to m¹⁰ and m¹¹.
pub fn coefficients(theta: f64) -> [f64; 3] {
    let pi = std::f64::consts::PI;
    let m = theta / pi;
    let q = m * m;
    let power = |n: i32| pi.powi(n);
    let f11 = 1.0 - 3.0 * power(2) / 8.0 * q
        + (power(2) - 5.0 * power(4) / 128.0) * q.powi(2)
        + (power(2) / 9.0 - 11.0 * power(4) / 72.0 + 119.0 * power(6) / 15360.0) * q.powi(3)
        + 5.07790 * q.powi(4)
        - 2.88312 * q.powi(5);
    let f12 = m
        * (-1.5 * pi
            + (10.0 * pi / 3.0 + power(3) / 16.0) * q
            + (-2.0 * pi - 133.0 * power(3) / 180.0 + 59.0 * power(5) / 1280.0) * q.powi(2)
            + 12.313906 * q.powi(3)
            - 7.32433 * q.powi(4)
            + 1.5793 * q.powi(5));
    let g1 =
        (2.0 * pi).powf(1.5) * q - 47.933390 * q.powi(2) + 63.665987 * q.powi(3) - 50.70880 * q.powi(4) + 26.66807 * q.powi(5);
    [f11, f12, g1]
}
