//! `model.method = "auto"`: no more of a model than a scene needs.

use toml::Value;

use super::Method;
use super::fatigue_keys::key_that_asks_for_bonds;
use super::model_keys::telling_key;
use perilife_base::input::{number_of, value_at};
use perilife_laws::growth_law::GrowthLawKind;
use perilife_plate::loading::Loading;
use perilife_plate::specimen::beta::KEY;
use perilife_plate::specimen::handbook::{HandbookFormula, handbook, handbook_beside};
use perilife_plate::specimen::part_through::SOURCE;
use perilife_plate::specimen::{Bearing, Load, Specimen};

/// Error of a life over that of K where the case does not say its exponent: that of most metals.
const EXPONENT_USUAL: f64 = 3.0;

/// Sections of a case that say what it needs.
pub(super) struct Sections<'a> {
    pub model: &'a Value,
    pub fatigue: &'a Value,
    pub output: &'a Value,
}

/// The method for a case that leaves it open, and why, for an error of life asked for in percent.
pub(super) fn choose(asked: &Sections<'_>, specimen: &Specimen, loading: &Loading, percent: f64) -> (Method, String) {
    if let Some(flaw) = &specimen.part_through {
        return (Method::Handbook, format!("part-through crack: K of {SOURCE} ({})", flaw.kind()));
    }
    if specimen.beta.is_some() {
        return (Method::Handbook, format!("K(a) is given ({KEY})"));
    }
    match telling_key(asked.model) {
        Some((key, Method::Peridynamics)) => return (Method::Peridynamics, format!("set by model.{key}")),
        Some((key, method)) => return (method, format!("set by model.{key}")),
        None => {}
    }
    if let Some(key) = key_that_asks_for_bonds(asked.fatigue) {
        return (Method::Peridynamics, format!("set by fatigue.{key}"));
    }
    if !specimen.has_sharp_tips() {
        return (Method::Peridynamics, "a crack starts at a slot or notch".to_owned());
    }
    let has_own_pins =
        specimen.loads.iter().any(|load| matches!(load, Load::Pin { contact: Bearing::Cosine(_) | Bearing::Elastic(_), .. }));
    if has_own_pins && handbook(specimen).is_some() {
        return (Method::ElementFreeGalerkin, "the handbook solution assumes the pins of its standard".to_owned());
    }
    if specimen.crack_pressure != 0.0 {
        return (Method::ElementFreeGalerkin, "no handbook formula includes crack-face pressure".to_owned());
    }
    let Some(formula) = handbook_beside(specimen) else {
        return (Method::ElementFreeGalerkin, "no handbook solution for this plate".to_owned());
    };
    match beyond_formula(&formula, asked, specimen, loading, percent) {
        None => (Method::Handbook, format!("standard specimen within the range of {}", formula.name)),
        Some(why) => (Method::ElementFreeGalerkin, format!("{}: {why}", formula.name)),
    }
}

/// Why a formula does not do for a case; `None` where it does.
fn beyond_formula(
    formula: &HandbookFormula,
    asked: &Sections<'_>,
    specimen: &Specimen,
    loading: &Loading,
    percent: f64,
) -> Option<String> {
    let has_fields = value_at(asked.output, "paraview").and_then(Value::as_bool) == Some(true);
    let unknown = [
        (loading.displacement().is_some(), "not valid under displacement control"),
        (loading.residual.is_some(), "no stated error with residual stress"),
        (has_fields, "no fields for output.paraview"),
    ];
    if let Some((_, why)) = unknown.iter().find(|(is_so, _)| *is_so) {
        return Some((*why).to_owned());
    }
    if !formula.holds_at(specimen.crack_length) {
        return Some(format!("not valid at this crack length ({})", formula.range));
    }
    let error = 100.0 * formula.error_at(specimen.crack_length);
    let exponent = exponent(asked.fatigue).unwrap_or(EXPONENT_USUAL);
    // 0.5 % of K at m = 4 are 2 %, whatever round-off makes of it.
    let of_life = exponent * error * (1.0 - 1e-9);
    let is_good = of_life <= percent && handbook(specimen).is_some();
    (!is_good).then(|| format!("K may be off by {error:.1} % ({of_life:.1} % of life at m = {exponent}); target {percent} %"))
}

/// The exponent of ΔK that `[fatigue]` gives.
fn exponent(fatigue: &Value) -> Option<f64> {
    let constants = GrowthLawKind::all().flat_map(|kind| kind.0.constants).filter(|constant| constant.is_exponent);
    constants.filter_map(|constant| value_at(fatigue, constant.key)).find_map(number_of)
}
