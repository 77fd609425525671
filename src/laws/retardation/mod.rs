//! How large cycles of a spectrum slow down those after them.
//!
//! An overload leaves a plastic zone ahead of the tip. Cycles whose own zone stays within it grow by a lower rate, by the model of
//! `loading.retardation`; the first one whose zone reaches its end makes a zone of its own. Zones are `(K_max/σ_Y)²/2π` in plane stress and a third of
//! it in plane strain (Irwin 1960).

mod description;
mod march;
mod models;

pub use description::{Constant, Now, RetardationSpec, Zone};
pub use march::{Laws, March, Marched, Underway, between};

use std::f64::consts::PI;

use serde_json::{Map, Value, json};

use perilife_base::error::{Result, input, input_missing};
use perilife_base::input::value_at;
use perilife_base::keys::{Field, Given, Key, quantity};
use perilife_plate::loading::Loading;
use perilife_plate::material::{Material, Plane};

/// Every model, in the order of `perilife list`. A new one is a line here and in `models`.
const MODELS: &[&RetardationSpec] = &[&models::NONE, &models::WHEELER, &models::WILLENBORG, &models::CLOSURE, &models::NEWMAN];

perilife_base::kinds! {
    pub struct RetardationKind of RetardationSpec in MODELS for "loading.retardation"
}

const KEY: &str = "retardation";

/// All keys of `[loading]` that belong to models of retardation.
pub fn retardation_keys() -> Vec<&'static str> {
    keys_to_tell().iter().map(|key| key.name).collect()
}

/// The same for whoever tells of them.
pub fn keys_to_tell() -> Vec<Key> {
    let mut keys = vec![Key::of_choice::<RetardationKind>(KEY, "Retardation: load interaction of a spectrum; default none")];
    for constant in RetardationKind::all().flat_map(|kind| kind.0.constants) {
        if keys.iter().all(|key| key.name != constant.key) {
            keys.push(constant.to_key());
        }
    }
    keys
}

#[derive(Debug, Clone, PartialEq)]
pub struct Retardation {
    pub kind: RetardationKind,
    /// Its constants, SI, in the order of their description.
    pub constants: Vec<f64>,
    /// Yield strength, Pa.
    pub strength: f64,
    pub plane: Plane,
}

impl Retardation {
    /// A model of constants in the units of their keys.
    pub fn of(kind: RetardationKind, constants: &[f64], (strength, plane): (f64, Plane)) -> Self {
        let constants = constants.iter().zip(kind.0.constants).map(|(value, constant)| value * constant.quantity.si).collect();
        Retardation { kind, constants, strength, plane }
    }

    /// The model that `[loading]` asks for; `threshold` is ΔK_th of the law of the case, Pa√m.
    /// Errors: no spectrum, no yield strength, constants that are missing, beyond reason or of another model.
    pub fn read(section: &toml::Value, loading: &Loading, material: &Material, threshold: Option<f64>) -> Result<Option<Self>> {
        let given = |key: &str| value_at(section, key);
        if loading.spectrum.is_none() {
            let problem = "applies only to kind = \"spectrum\"";
            let given = Given::of(section, "loading")?;
            return given.refuse_any(&retardation_keys(), problem, "set kind = \"spectrum\", or remove it").map(|()| None);
        }
        let asked = given(KEY).map(|value| RetardationKind::take(&Key::new(KEY, ""), RetardationKind::KEY, value)).transpose()?;
        let kind = asked.unwrap_or(RetardationKind(&models::NONE));
        if kind.0.rate.is_none() {
            // Constants stay where a model is turned off.
            return Ok(None);
        }
        let is_own = |key: &str| key == KEY || kind.0.constants.iter().any(|constant| constant.key == key);
        if let Some(key) = retardation_keys().into_iter().find(|key| given(key).is_some() && !is_own(key)) {
            let problem = format!("is not a key of retardation = \"{kind}\"");
            return Err(input_missing(&format!("loading.{key}"), problem, "remove it, or set its model by loading.retardation"));
        }
        let strength = material.yield_strength.ok_or_else(|| {
            let problem = "needs a yield strength (plastic zone of the tip)";
            input(RetardationKind::KEY, format!("\"{kind}\""), problem, "give material.yield_strength_mpa")
        })?;
        let constant = |constant: &description::Constant| {
            let path = format!("loading.{}", constant.key);
            let otherwise = (constant.default)(material.plane, threshold);
            match (given(constant.key), otherwise) {
                (Some(value), _) => quantity(&constant.to_key(), &path, value),
                (None, Some(value)) => Ok(value),
                (None, None) => {
                    let problem = format!("is missing (required by retardation = \"{kind}\")");
                    Err(input_missing(&path, problem, constant.remedy))
                }
            }
        };
        let constants = kind.0.constants.iter().map(constant).collect::<Result<_>>()?;
        Ok(Some(Retardation { kind, constants, strength, plane: material.plane }))
    }

    /// Plastic zone of a tip, m, at K_max, Pa√m.
    pub fn zone_size(&self, k_max: f64) -> f64 {
        let constraint = if self.plane == Plane::Strain { 3.0 } else { 1.0 };
        (k_max / self.strength).powi(2) / (2.0 * PI * constraint)
    }

    /// Name and constants, by the keys of `[loading]`.
    pub fn json(&self) -> Map<String, Value> {
        let constants = self.kind.0.constants.iter().zip(&self.constants);
        let mut all: Map<String, Value> =
            constants.map(|(constant, value)| (constant.key.to_owned(), json!(value / constant.quantity.si))).collect();
        all.insert("model".to_owned(), json!(self.kind));
        all
    }
}
