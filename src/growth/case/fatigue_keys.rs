//! Keys of `[fatigue]` that give no law.

use toml::{Table, Value};

use super::Failure;
use perilife_base::input::value_at;
use perilife_base::keys::{OrNone, Section, intensity, key, number};
use perilife_laws::growth_law::description::law_keys;
use perilife_laws::initiation::SnLaw;
use perilife_laws::{Ageing, Driver};

perilife_base::kinds! {
    /// Lot of material that the plate of a case is of, beside that of the calibration.
    pub enum Lot for "fatigue.lot" {
        Same = "same": "same lot as the specimens: band = scatter within the lot",
        Other = "other": "other lot of the same material: band includes lot-to-lot scatter",
    }
}

const OF_BONDS: (&str, &[&str]) = ("driver", &["bond_strain"]);

perilife_base::keys! {
    /// Keys of `[fatigue]` beside those of laws.
    pub struct FatigueKeys {
        driver: Option<Driver> = key("driver", "Driver: of crack growth");
        ageing: Option<Ageing> = key("ageing", "Ageing: bonds that lose life").only(OF_BONDS.0, OF_BONDS.1);
        zone_radius_horizons: Option<f64> = number("zone_radius_horizons", "Zone of ageing bonds, horizons", "a radius in horizons", 0.05, 10.0).only(OF_BONDS.0, OF_BONDS.1);
        step_error_percent: Option<f64> = number("step_error_percent", "Error of an increment, %", "an error in percent", 0.001, 10.0);
        critical_stretch: Option<f64> = number("critical_stretch", "Critical stretch: beyond which a bond breaks at once", "a stretch", 1e-9, 10.0).only(OF_BONDS.0, OF_BONDS.1);
        walker_gamma: Option<f64> = number("walker_gamma", "Walker exponent γ: effect of the stress ratio", "a Walker exponent", 0.0, 2.0);
        threshold: Option<OrNone> = intensity("delta_k_threshold_mpa_sqrt_m", "Threshold ΔK_th: no growth below; 0 for none");
        allow_extrapolation: bool = key("allow_extrapolation", "Extrapolation: of a fitted law outside its range"), or "false" false;
        lot: Lot = key("lot", "Lot of material: against that of the tests"), or "same" Lot::Same;
        initiation: Option<SnLaw> = key("initiation", "Initiation life: S-N law of the local stress, phase I");
        failure: Option<Failure> = key("failure", "Failure: criterion of bonds");
    }
}

/// Keys of `[fatigue]` that belong to fatigue bonds.
pub fn keys_of_bonds() -> Vec<&'static str> {
    FatigueKeys::KEYS.iter().filter(|key| key.only == Some(OF_BONDS)).map(|key| key.name).collect()
}

/// The key by which `[fatigue]` asks for bonds that fail by their own strain, if it does.
pub(super) fn key_that_asks_for_bonds(fatigue: &Value) -> Option<&'static str> {
    let is_driver = value_at(fatigue, "driver").and_then(Value::as_str) == Some("bond_strain");
    keys_of_bonds().into_iter().find(|key| value_at(fatigue, key).is_some()).or(is_driver.then_some("driver"))
}

/// Takes the law out of the sections of a case that is to get another one, or needs none.
pub fn remove_law(sections: &mut Table) {
    if let Some(fatigue) = sections.get_mut("fatigue").and_then(Value::as_table_mut) {
        law_keys().for_each(|key| drop(fatigue.remove(key)));
    }
}
