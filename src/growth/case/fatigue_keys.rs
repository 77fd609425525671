//! Keys of `[fatigue]` that give no law.

use serde::Deserialize;
use toml::{Table, Value};

use super::Failure;
use perilife_laws::growth_law::description::law_keys;
use perilife_laws::{Ageing, Driver};

perilife_base::kinds! {
    /// Lot of material that the plate of a case is of, beside that of the calibration.
    pub enum Lot for "fatigue.lot" {
        Same = "same": "that of the tested specimens: the band of lives is their scatter",
        Other = "other": "another one of the same material: the band holds the scatter between lots too",
    }
}

/// Keys of `[fatigue]` beside those of laws.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FatigueKeys {
    pub driver: Option<Driver>,
    pub ageing: Option<Ageing>,
    pub zone_radius_horizons: Option<f64>,
    pub step_error_percent: Option<f64>,
    pub critical_stretch: Option<f64>,
    pub walker_gamma: Option<f64>,
    pub delta_k_threshold_mpa_sqrt_m: Option<f64>,
    pub allow_extrapolation: Option<bool>,
    pub lot: Option<Lot>,
    pub initiation: Option<Value>,
    #[serde(rename = "failure")]
    _failure: Option<Failure>,
}

/// Takes the law out of the sections of a case that is to get another one, or needs none.
pub fn remove_law(sections: &mut Table) {
    if let Some(fatigue) = sections.get_mut("fatigue").and_then(Value::as_table_mut) {
        law_keys().for_each(|key| drop(fatigue.remove(key)));
    }
}
