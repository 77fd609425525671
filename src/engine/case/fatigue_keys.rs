//! Keys of `[fatigue]`, and which of them give a law.

use serde::Deserialize;
use toml::{Table, Value};

use super::Failure;
use crate::fatigue::growth_law::GrowthLawKind::{self, BondLaw, Forman, Nasgro, Paris, Walker};
use crate::fatigue::{Ageing, Driver};
use crate::measured::RateFile;

crate::kinds! {
    /// What K beyond the rows of a table of rates does.
    pub enum TableEnds for "fatigue.growth_table_ends" {
        Refused = "refused": "the run ends in an error",
        Held = "held": "the crack grows at the rate of the last row; how much of the life that is stands in a warning",
    }
}

crate::kinds! {
    /// Lot of material that the plate of a case is of, beside that of the calibration.
    pub enum Lot for "fatigue.lot" {
        Same = "same": "that of the tested specimens: the band of lives is their scatter",
        Other = "other": "another one of the same material: the band holds the scatter between lots too",
    }
}

/// Keys of `[fatigue]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FatigueKeys {
    pub fitted: Option<String>,
    pub a: Option<f64>,
    pub p: Option<f64>,
    pub horizon_mm: Option<f64>,
    pub paris_c_mm_per_cycle: Option<f64>,
    pub paris_m: Option<f64>,
    pub driver: Option<Driver>,
    pub growth_law: Option<GrowthLawKind>,
    pub forman_c_mm_per_cycle: Option<f64>,
    pub forman_m: Option<f64>,
    pub nasgro_c_mm_per_cycle: Option<f64>,
    pub nasgro_n: Option<f64>,
    pub nasgro_p: Option<f64>,
    pub nasgro_q: Option<f64>,
    pub nasgro_alpha: Option<f64>,
    pub nasgro_smax_over_flow: Option<f64>,
    pub nasgro_delta_k_0_mpa_sqrt_m: Option<f64>,
    pub nasgro_c_th: Option<f64>,
    pub nasgro_c_th_negative: Option<f64>,
    pub k_c_mpa_sqrt_m: Option<f64>,
    pub growth_table: Option<RateFile>,
    pub growth_table_ends: Option<TableEnds>,
    pub ageing: Option<Ageing>,
    pub zone_radius_horizons: Option<f64>,
    /// Of earlier versions, to be refused by name.
    pub precrack: Option<Value>,
    pub step_error_percent: Option<f64>,
    pub critical_stretch: Option<f64>,
    pub walker_gamma: Option<f64>,
    pub delta_k_threshold_mpa_sqrt_m: Option<f64>,
    /// As `precrack`.
    pub growth_rate: Option<Value>,
    pub allow_extrapolation: Option<bool>,
    pub lot: Option<Lot>,
    #[serde(rename = "failure")]
    _failure: Option<Failure>,
}

/// Keys that give a law, with the kinds of `growth_law` that it can be. A case gives keys of one row.
pub(super) const LAWS: [(&[GrowthLawKind], &[&str]); 6] = [
    (&[BondLaw, Paris, Walker], &["fitted"]),
    (&[BondLaw], &["a", "p", "horizon_mm"]),
    (&[Paris, Walker], &["paris_c_mm_per_cycle", "paris_m"]),
    (&[Forman], &["forman_c_mm_per_cycle", "forman_m"]),
    (
        &[Nasgro],
        &[
            "nasgro_c_mm_per_cycle",
            "nasgro_n",
            "nasgro_p",
            "nasgro_q",
            "nasgro_alpha",
            "nasgro_smax_over_flow",
            "nasgro_delta_k_0_mpa_sqrt_m",
            "nasgro_c_th",
            "nasgro_c_th_negative",
        ],
    ),
    (&[GrowthLawKind::Table], &["growth_table", "growth_table_ends"]),
];

/// All keys that give a law, for those who take it out of a file.
pub fn law_keys() -> impl Iterator<Item = &'static str> {
    LAWS.iter().flat_map(|(_, keys)| keys.iter().copied()).chain(["growth_law", "k_c_mpa_sqrt_m"])
}

/// Takes the law out of the sections of a case that is to get another one, or needs none.
pub fn remove_law(sections: &mut Table) {
    if let Some(fatigue) = sections.get_mut("fatigue").and_then(Value::as_table_mut) {
        for key in law_keys() {
            fatigue.remove(key);
        }
    }
}
