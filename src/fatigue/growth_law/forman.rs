//! Forman's law.

use serde::Serialize;

use super::GrowthLaw;
use crate::units::MPA_SQRT_M;

/// `da/dN = C ΔK^m / ((1-R) K_c - ΔK)`: Paris growth that becomes unstable at K_max = K_c (Forman, Kearney and Engle 1967, J. Basic
/// Eng. 89:459). Compression does not count.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Forman {
    /// C, m/cycle (MPa√m)^(1-m).
    pub c: f64,
    /// Exponent m.
    pub m: f64,
    /// K_c, Pa√m.
    pub k_c: f64,
}

impl GrowthLaw for Forman {
    fn rate(&self, k_max: f64, ratio: f64) -> f64 {
        let range = 1.0 - ratio.max(0.0);
        let left = range * (self.k_c - k_max) / MPA_SQRT_M;
        if left <= 0.0 { f64::INFINITY } else { self.c * (range * k_max / MPA_SQRT_M).powf(self.m) / left }
    }
}
