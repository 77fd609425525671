//! Physical quantities of input files: unit, range of reason, conversion to SI.

use crate::error::{Result, fail_if, input};
use crate::units::{GPA, MM, MPA, MPA_SQRT_M};

/// A kind of number in an input file.
///
/// The bounds are wide: they keep out what is certainly a slip (1e308, a negative thickness, a NaN), so that nothing
/// overflows later; they do not judge engineering sense.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quantity {
    /// What it is, with its article: "a length".
    pub what: &'static str,
    /// Unit as in the key, may be empty.
    pub unit: &'static str,
    pub low: f64,
    pub high: f64,
    /// SI units in one of that unit.
    pub si: f64,
}

/// A size: width, crack length, thickness, diameter.
pub const LENGTH: Quantity = Quantity { what: "a length", unit: "mm", low: 1e-3, high: 1e5, si: MM };
/// A coordinate, either sign.
pub const COORDINATE: Quantity = Quantity { what: "a coordinate", unit: "mm", low: -1e5, high: 1e5, si: MM };
pub const STRESS: Quantity = Quantity { what: "a stress", unit: "MPa", low: 1e-6, high: 1e5, si: MPA };
pub const MODULUS: Quantity = Quantity { what: "a modulus", unit: "GPa", low: 1e-6, high: 1e4, si: GPA };
pub const FORCE: Quantity = Quantity { what: "a force", unit: "N", low: 1e-6, high: 1e10, si: 1.0 };
pub const FORCE_KN: Quantity = Quantity { what: "a force", unit: "kN", low: 1e-9, high: 1e7, si: crate::units::KN };
pub const INTENSITY: Quantity = Quantity { what: "a stress intensity", unit: "MPa√m", low: 1e-9, high: 1e6, si: MPA_SQRT_M };
pub const FRACTURE_ENERGY: Quantity = Quantity { what: "an energy", unit: "J/m²", low: 1e-6, high: 1e12, si: 1.0 };
pub const DENSITY: Quantity = Quantity { what: "a density", unit: "kg/m³", low: 1e-3, high: 1e6, si: 1.0 };
pub const TIME: Quantity = Quantity { what: "a time", unit: "s", low: 1e-15, high: 1e6, si: 1.0 };

pub const fn number(what: &'static str, low: f64, high: f64) -> Quantity {
    Quantity { what, unit: "", low, high, si: 1.0 }
}

impl Quantity {
    /// The value of `key` in SI units, or words about what is wrong with it.
    pub fn read(&self, key: &str, value: f64) -> Result<f64> {
        fail_if!(!value.is_finite(), input(key, value, "is not a finite number", self.remedy()));
        fail_if!(value <= 0.0 && self.low > 0.0, input(key, value, "must be above zero", self.remedy()));
        fail_if!(value < self.low || value > self.high, input(key, value, "is out of range", self.remedy()));
        Ok(value * self.si)
    }

    /// [`read`](Self::read) for a key that may be left out.
    pub fn read_optional(&self, key: &str, value: Option<f64>) -> Result<Option<f64>> {
        value.map(|value| self.read(key, value)).transpose()
    }

    pub fn remedy(&self) -> String {
        let text = format!("give {} between {} and {} {}", self.what, self.low, self.high, self.unit);
        text.trim_end().to_owned()
    }
}
