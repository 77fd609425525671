//! What a model of retardation says of itself: its name, its constants with their keys and bounds, and its rate within a zone.

use crate::growth_law::GrowthLaw;
use perilife_base::input::Quantity;
use perilife_base::keys::Key;
use perilife_plate::material::Plane;

/// da/dN, m/cycle, by the constants of a model, the law of a cycle alone, the cycle, and the zone that it lies in.
pub type Rate = fn(&[f64], &dyn GrowthLaw, &Now, &Zone) -> f64;

pub struct RetardationSpec {
    pub name: &'static str,
    pub meaning: &'static str,
    pub constants: &'static [Constant],
    /// da/dN, m/cycle, of a cycle whose plastic zone stays within that of an overload, by the constants in SI units; `None` where nothing is
    /// retarded.
    pub rate: Option<Rate>,
    pub underload: &'static str,
}

#[derive(Clone, Copy)]
pub struct Constant {
    /// Key in `[loading]`.
    pub key: &'static str,
    pub quantity: Quantity,
    /// Value, SI, in a case that does not give it, by its plane state and the threshold ΔK_th of its law; `None`: it is refused.
    pub default: fn(Plane, Option<f64>) -> Option<f64>,
    pub remedy: &'static str,
}

impl Constant {
    /// It as a key of `[loading]`.
    pub fn to_key(self) -> Key {
        Key::of_constant(self.key, self.quantity, self.remedy)
    }
}

/// A tip at maximum load: its way and plastic zone in m, K in Pa√m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Now {
    pub a: f64,
    pub k_max: f64,
    pub ratio: f64,
    /// Least stress ratio that the law knows.
    pub least: f64,
    pub size: f64,
    /// K_max/(σ_Y √(πa)): its maximum over the yield strength, of a crack in a wide plate with this K (McClung 1994).
    pub stress_over_yield: f64,
}

/// The plastic zone of the last overload, which is the state of a tip: way after it and size in m, K at its maximum in Pa√m.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Zone {
    pub from: f64,
    pub size: f64,
    pub k_max: f64,
    /// Least K since then, that of the overload included, Pa√m.
    pub k_min: f64,
}

impl Zone {
    /// Way at which it ends, m.
    pub fn end(&self) -> f64 {
        self.from + self.size
    }
}
