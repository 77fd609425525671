//! The NASGRO equation.

use std::f64::consts::PI;

use serde::Serialize;

use super::GrowthLaw;
use crate::units::MPA_SQRT_M;

/// `da/dN = C [(1-f)/(1-R) ΔK]^n (1 - ΔK_th/ΔK)^p / (1 - K_max/K_c)^q` (Forman and Mettu 1992, ASTM STP 1131:519), with the crack opening
/// of Newman 1984 (Int. J. Fract. 24:R131)
///
/// `f = K_op/K_max = max(R, A₀ + A₁ R + A₂ R² + A₃ R³)` for R ≥ 0 and `A₀ + A₁ R` below,
/// `A₀ = (0.825 - 0.34 α + 0.05 α²) cos(π S/2)^(1/α)`, `A₁ = (0.415 - 0.071 α) S`, `A₂ = 1 - A₀ - A₁ - A₃`, `A₃ = 2 A₀ + A₁ - 1`,
///
/// S being S_max over the flow stress, and the threshold of long cracks
/// `ΔK_th = ΔK₀ [(1-f) / ((1-A₀)(1-R))]^-(1 + C_th R)`, C_th having one value for R ≥ 0 and one below. ΔK = (1-R) K_max, also at R < 0, down to R = -2.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Nasgro {
    /// C as the rate at ΔK = 1 MPa√m, m/cycle.
    pub c: f64,
    /// Exponent n.
    pub n: f64,
    /// Exponent p of the threshold.
    pub p: f64,
    /// Exponent q of instability.
    pub q: f64,
    /// Constraint α: 1 in plane stress, 3 in plane strain.
    pub alpha: f64,
    /// S_max over the flow stress.
    pub stress_over_flow: f64,
    /// Threshold ΔK₀ at R = 0, Pa√m.
    pub threshold: f64,
    /// C_th for R below 0, and from 0 on.
    pub threshold_slopes: [f64; 2],
    /// K_c, Pa√m.
    pub k_c: f64,
}

/// Stress ratio below which the opening function was not derived.
pub const RATIO_MIN: f64 = -2.0;

impl Nasgro {
    /// f at a stress ratio, and A₀.
    pub fn opening(&self, ratio: f64) -> (f64, f64) {
        let Nasgro { alpha, stress_over_flow: s, .. } = *self;
        let a0 = (0.825 - 0.34 * alpha + 0.05 * alpha * alpha) * (0.5 * PI * s).cos().powf(1.0 / alpha);
        let a1 = (0.415 - 0.071 * alpha) * s;
        let a3 = 2.0 * a0 + a1 - 1.0;
        let a2 = 1.0 - a0 - a1 - a3;
        let f = if ratio >= 0.0 { (a0 + ratio * (a1 + ratio * (a2 + ratio * a3))).max(ratio) } else { a0 + a1 * ratio };
        (f, a0)
    }

    /// ΔK_th at a stress ratio, Pa√m.
    pub fn threshold_at(&self, ratio: f64) -> f64 {
        let (f, a0) = self.opening(ratio);
        let base = (1.0 - f) / ((1.0 - a0) * (1.0 - ratio));
        let [below, above] = self.threshold_slopes;
        self.threshold * base.powf(-(1.0 + if ratio < 0.0 { below } else { above } * ratio))
    }
}

impl GrowthLaw for Nasgro {
    fn rate(&self, k_max: f64, ratio: f64) -> f64 {
        let delta_k = (1.0 - ratio) * k_max;
        let threshold = self.threshold_at(ratio);
        if delta_k <= threshold || k_max <= 0.0 {
            return 0.0;
        }
        let left = 1.0 - k_max / self.k_c;
        if left <= 0.0 {
            return f64::INFINITY;
        }
        let (f, _) = self.opening(ratio);
        let effective = (1.0 - f) * k_max / MPA_SQRT_M;
        self.c * effective.powf(self.n) * (1.0 - threshold / delta_k).powf(self.p) / left.powf(self.q)
    }
}
