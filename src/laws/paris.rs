//! Growth by hand calculation: `da/dN = C ΔK^m` (Paris and Erdogan 1963, J. Basic Eng. 85:528).

use super::FatigueLaw;
use perilife_base::units::MPA_SQRT_M;

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ParisLaw {
    /// C as the growth rate at ΔK = 1 MPa√m, m/cycle.
    pub c: f64,
    pub m: f64,
}

impl ParisLaw {
    /// da/dN, m/cycle, at ΔK in Pa√m.
    pub fn rate(&self, delta_k: f64) -> f64 {
        self.c * (delta_k / MPA_SQRT_M).powf(self.m)
    }

    /// C and m that a law of bonds stands for: `C = β A δ^(1-p/2) / E'^p`, m = p, with its rate constant β and the modulus E', Pa.
    pub fn of_bonds(law: &FatigueLaw, beta: f64, modulus: f64) -> Self {
        let FatigueLaw { a, p, horizon } = *law;
        ParisLaw { c: beta * a * horizon.powf(1.0 - 0.5 * p) * (MPA_SQRT_M / modulus).powf(p), m: p }
    }

    /// The law of bonds at a horizon, m, that stands for these C and m: the inverse of [`ParisLaw::of_bonds`].
    pub fn to_bonds(&self, beta: f64, modulus: f64, horizon: f64) -> FatigueLaw {
        let unit = FatigueLaw { a: 1.0, p: self.m, horizon };
        FatigueLaw { a: self.c / Self::of_bonds(&unit, beta, modulus).c, ..unit }
    }
}
