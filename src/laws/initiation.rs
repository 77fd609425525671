//! Phase I: cycles until a crack has formed at a rim, by an S-N law of the local stress there.
//!
//! `N_I = N_D (Δσ_D/Δσ)^k` (Basquin 1910), Δσ = (1 - R) σ_max the range of the elastic stress along the rim where it is largest, with its concentration
//! but without the crack. So the law is one of local stresses at the stress ratio of the case: of smooth specimens, or of notched ones with
//! their own concentration multiplied in. No crack forms at a range up to `limit_mpa`. What "has formed" means is the
//! length that the cracks of the case have from their rims, which the S-N tests have to share.

use perilife_base::keys::{number, stress};

pub const KEY: &str = "fatigue.initiation";

perilife_base::keys! {
    /// An S-N law of local stress, the keys of `[fatigue.initiation]`.
    #[derive(Debug, Clone, Copy, PartialEq)]
    pub struct SnLaw {
        /// Range Δσ_D of a point of the line, Pa.
        range: f64 = stress("range_mpa", "Range Δσ_D: local stress range at one point of the S-N line");
        /// Cycles N_D of that point.
        cycles: f64 = number("cycles", "Cycles N_D: at the same point", "a number of cycles", 1.0, 1e12);
        /// Slope k of log N over -log Δσ.
        slope: f64 = number("slope", "Slope k: of log N over −log Δσ", "a slope", 0.5, 50.0);
        /// Range up to which no crack forms, Pa; 0 without one.
        limit: f64 = stress("limit_mpa", "Fatigue limit: local stress range without initiation"), or "none" 0.0;
    }
}

impl SnLaw {
    /// Cycles N_I at a range, Pa; `None` where no crack forms.
    pub fn cycles_at(&self, range: f64) -> Option<f64> {
        (range > self.limit).then(|| self.cycles * (self.range / range).powf(self.slope))
    }
}
