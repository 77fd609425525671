//! Phase I: cycles until a crack has formed at a rim, by an S-N law of the local stress there.
//!
//! `N_I = N_D (Δσ_D/Δσ)^k` (Basquin 1910), Δσ = (1 - R) σ_max the range of the elastic stress along the rim where it is largest, with its concentration
//! but without the crack. So the law is one of local stresses at the stress ratio of the case: of smooth specimens, or of notched ones with
//! their own concentration multiplied in. No crack forms at a range up to `limit_mpa`. What "has formed" means is the
//! length that the cracks of the case have from their rims, which the S-N tests have to share.

use serde::Deserialize;
use toml::Value;

use perilife_base::error::Result;
use perilife_base::input::{STRESS, number, slice};

/// Key of a case.
pub const KEY: &str = "fatigue.initiation";

/// Keys of `[fatigue.initiation]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Input {
    range_mpa: f64,
    cycles: f64,
    slope: f64,
    limit_mpa: Option<f64>,
}

/// An S-N law of local stress.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SnLaw {
    /// Range Δσ_D of a point of the line, Pa.
    pub range: f64,
    /// Cycles N_D of that point.
    pub cycles: f64,
    /// Slope k of log N over -log Δσ.
    pub slope: f64,
    /// Range up to which no crack forms, Pa; 0 without one.
    pub limit: f64,
}

impl SnLaw {
    /// Reads `[fatigue.initiation]`.
    /// Errors: a key that is missing or beyond reason.
    pub fn read(value: &Value) -> Result<Self> {
        let input: Input = slice(value, KEY)?;
        Ok(SnLaw {
            range: STRESS.read("fatigue.initiation.range_mpa", input.range_mpa)?,
            cycles: number("a number of cycles", 1.0, 1e12).read("fatigue.initiation.cycles", input.cycles)?,
            slope: number("a slope", 0.5, 50.0).read("fatigue.initiation.slope", input.slope)?,
            limit: STRESS.read_optional("fatigue.initiation.limit_mpa", input.limit_mpa)?.unwrap_or(0.0),
        })
    }

    /// Cycles N_I at a range, Pa; `None` where no crack forms.
    pub fn cycles_at(&self, range: f64) -> Option<f64> {
        (range > self.limit).then(|| self.cycles * (self.range / range).powf(self.slope))
    }
}
