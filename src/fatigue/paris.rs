//! Growth by hand calculation: `da/dN = C ΔK^m` (Paris and Erdogan 1963, J. Basic Eng. 85:528).

use crate::units::MPA_SQRT_M;

/// Constants of the Paris law.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ParisLaw {
    /// C as the growth rate at ΔK = 1 MPa√m, m/cycle.
    pub c: f64,
    /// Exponent m.
    pub m: f64,
}

impl ParisLaw {
    /// da/dN, m/cycle, at ΔK in Pa√m.
    #[must_use]
    pub fn rate(&self, delta_k: f64) -> f64 {
        self.c * (delta_k / MPA_SQRT_M).powf(self.m)
    }
}
