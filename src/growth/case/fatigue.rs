//! `[fatigue]` and `[stop]` of an input file: how bonds age, where the law comes from, when a run stops.

use serde::Deserialize;
use toml::Value;

use super::fatigue_keys::{FatigueKeys, Lot};
use super::model_keys::KEYS_OF_BONDS;
use super::{Choices, LawSource, Method, Stop, law_source};
use perilife_base::error::{Result, input, input_missing};
use perilife_base::input::{Folder, INTENSITY, LENGTH, number, refuse_given, slice, slice_beside};
use perilife_base::units::MPA;
use perilife_laws::growth_law::description::{Given, law_keys};
use perilife_laws::initiation::{self, SnLaw};
use perilife_laws::{Ageing, Driver, FatigueSettings, OVERLOAD_STRETCH, STEP_ERROR_PERCENT, ZONE_RADIUS_HORIZONS};
use perilife_plate::loading::{LoadControl, Loading};
use perilife_plate::material::Material;
use perilife_plate::specimen::{LengthConvention, LoadMeasure, Specimen, SpecimenKind};

const CYCLES_MAX: f64 = 1e9;

/// `[fatigue]`, read.
pub(super) struct Fatigue {
    pub settings: FatigueSettings,
    /// `None` where the file gives no law, as in a calibration.
    pub law: Option<LawSource>,
    pub allow_extrapolation: bool,
    pub lot: Lot,
}

/// Reads `[fatigue]` with the law that `method` needs; a fitted record is looked for from `folder`. Explicit choices go into
/// `choices`.
pub(super) fn from_value(
    value: &Value,
    method: Method,
    (specimen, material, loading): (&Specimen, &Material, &Loading),
    folder: &Folder,
    choices: &mut Choices,
) -> Result<Fatigue> {
    let input: FatigueKeys = slice_beside(value, "fatigue", &law_keys().collect::<Vec<_>>())?;
    choices.ageing = input.ageing;
    choices.zone_radius_horizons =
        number("a radius in horizons", 0.05, 10.0).read_optional("fatigue.zone_radius_horizons", input.zone_radius_horizons)?;
    choices.walker_gamma = number("a Walker exponent", 0.0, 2.0).read_optional("fatigue.walker_gamma", input.walker_gamma)?;
    let stretch = number("a stretch", 1e-9, 10.0).read_optional("fatigue.critical_stretch", input.critical_stretch)?;
    let threshold = INTENSITY.read_optional(
        "fatigue.delta_k_threshold_mpa_sqrt_m",
        input.delta_k_threshold_mpa_sqrt_m.filter(|value| *value != 0.0),
    )?;
    let driver = read_driver(&input, method, specimen)?;
    let mut settings = FatigueSettings {
        driver,
        ageing: choices.ageing.unwrap_or(Ageing::CrackTip),
        zone_radius_horizons: choices.zone_radius_horizons.unwrap_or(ZONE_RADIUS_HORIZONS),
        step_error_percent: STEP_ERROR_PERCENT,
        critical_stretch: stretch.unwrap_or(OVERLOAD_STRETCH),
        walker_gamma: choices.walker_gamma.unwrap_or(1.0),
        threshold: threshold.unwrap_or(0.0),
        initiation: read_initiation(&input, (driver, specimen, loading))?,
    };
    let allow_extrapolation = input.allow_extrapolation.unwrap_or(false);
    // What is driven by bonds to the end needs no rate over K.
    let by_bonds = method == Method::Peridynamics && driver == Driver::BondStrain;
    let hands_over = by_bonds.then(|| settings.hands_over(specimen));
    settings.step_error_percent = read_step_error(&input, driver == Driver::TipField || hands_over == Some(true))?;
    let given = Given { section: value, material, ratios: loading.ratios(), folder, rates: law_source::rates };
    let law = law_source::read(settings.threshold, hands_over, &given)?;
    Ok(Fatigue { settings, law, allow_extrapolation, lot: input.lot.unwrap_or(Lot::Same) })
}

/// The driver asked for; else that of tips, unless a key is given that only bonds have, or a tip that is no sharp crack. Keys of
/// fatigue bonds do not go with tips that are driven by their K.
fn read_driver(input: &FatigueKeys, method: Method, specimen: &Specimen) -> Result<Driver> {
    let given = [input.ageing.is_some(), input.zone_radius_horizons.is_some(), input.critical_stretch.is_some()];
    let of_bonds = KEYS_OF_BONDS.iter().zip(given).find(|(_, given)| *given);
    if method == Method::ElementFreeGalerkin {
        let remedy = "leave it out, or use model.method = \"peridynamics\"";
        return match (input.driver, of_bonds) {
            (Some(Driver::BondStrain), _) => {
                let problem = "needs bonds, and model.method = \"element_free_galerkin\" has none";
                Err(perilife_base::error::input("fatigue.driver", "\"bond_strain\"", problem, remedy))
            }
            (_, Some((key, _))) => {
                let problem = "belongs to fatigue bonds, and model.method is \"element_free_galerkin\"";
                Err(input_missing(&format!("fatigue.{key}"), problem, remedy))
            }
            _ => Ok(Driver::TipField),
        };
    }
    match (input.driver, of_bonds) {
        (Some(Driver::TipField), Some((key, _))) if method == Method::Peridynamics => {
            let problem = "belongs to fatigue bonds, and fatigue.driver is \"tip_field\"";
            Err(input_missing(&format!("fatigue.{key}"), problem, "leave it out, or use driver = \"bond_strain\""))
        }
        (Some(driver), _) => Ok(driver),
        (None, None) if specimen.has_sharp_tips() => Ok(Driver::TipField),
        (None, _) => Ok(Driver::BondStrain),
    }
}

/// Reads the law by which the cracks of the case form.
/// Errors: a plate whose cracks nobody lets form, or drilled holes that nobody says when they crack again.
fn read_initiation(input: &FatigueKeys, (driver, specimen, loading): (Driver, &Specimen, &Loading)) -> Result<Option<SnLaw>> {
    let Some(value) = &input.initiation else {
        if specimen.kind == SpecimenKind::StopHole {
            let problem = "is missing: the crack was stopped, and only an S-N law says when the holes crack again";
            return Err(input_missing(
                initiation::KEY,
                problem,
                "give range_mpa, cycles and slope of one point and the line through it",
            ));
        }
        return Ok(None);
    };
    let law = SnLaw::read(value)?;
    if driver != Driver::TipField || !specimen.is_through() || loading.spectrum.is_some() || loading.control != LoadControl::Load
    {
        let problem = "goes with cycles of one load and through cracks that grow by K of their tips";
        return Err(input_missing(initiation::KEY, problem, "leave it out"));
    }
    Ok(Some(law))
}

/// Reads the error of a block of growth by K; bonds that break one by one are solved for after every break, without such an error.
fn read_step_error(slice: &FatigueKeys, has_tips: bool) -> Result<f64> {
    const KEY: &str = "fatigue.step_error_percent";
    let error = number("an error in percent", 0.001, 10.0).read_optional(KEY, slice.step_error_percent)?;
    if let Some(error) = error.filter(|_| !has_tips) {
        let problem = "belongs to growth by K of the tips, and the driver is \"bond_strain\", which solves after every break";
        return Err(input(KEY, error, problem, "leave it out, or use driver = \"tip_field\""));
    }
    Ok(error.unwrap_or(STEP_ERROR_PERCENT))
}

/// Keys of `[stop]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct StopInput {
    crack_length_mm: Option<f64>,
    crack_depth_mm: Option<f64>,
    at_break_through: Option<bool>,
    cycles_max: Option<f64>,
    required_strength_mpa: Option<f64>,
    limit_load_factor: Option<f64>,
    toughness: Option<bool>,
    net_section: Option<bool>,
}

/// Reads `[stop]`.
pub(super) fn stop_from_value(value: &Value, (specimen, material, loading): (&Specimen, &Material, &Loading)) -> Result<Stop> {
    let slice: StopInput = slice(value, "stop")?;
    let crack_length = LENGTH.read_optional("stop.crack_length_mm", slice.crack_length_mm)?;
    if let (Some(length), Some(given)) = (crack_length, slice.crack_length_mm) {
        const KEY: &str = "stop.crack_length_mm";
        if length <= specimen.shortest_crack() {
            let start = perilife_base::units::round_mm(specimen.shortest_crack());
            return Err(input(
                KEY,
                given,
                format!("is not beyond the initial crack length {start} mm"),
                "give a longer crack, or leave it out",
            ));
        }
        let (limit, _) = specimen.length_limit();
        if specimen.convention == LengthConvention::MeanOfTips && length >= limit {
            let limit = perilife_base::units::round_mm(limit);
            return Err(input(
                KEY,
                given,
                format!("is beyond the plate, which ends at {limit} mm"),
                "give a shorter crack, or leave it out",
            ));
        }
    }
    let (crack_depth, at_break_through) = stop_in_depth(&slice, specimen)?;
    let cycles_max = number("a number of cycles", 1.0, 1e15).read("stop.cycles_max", slice.cycles_max.unwrap_or(CYCLES_MAX))?;
    let of_passes = loading.spectrum.as_ref().and_then(|spectrum| Some(spectrum.repeats? * spectrum.per_pass));
    let cycles_max = of_passes.map_or(cycles_max, |cycles| cycles_max.min(cycles));
    let required = required_load(&slice, specimen, material, loading)?;
    let [by_toughness, by_net_section] = [slice.toughness, slice.net_section].map(|asked| asked.unwrap_or(true));
    let crack_length = crack_length.unwrap_or(f64::INFINITY);
    Ok(Stop { crack_length, crack_depth, at_break_through, cycles_max, required, by_toughness, by_net_section })
}

/// Depth, m, at which the run of a crack that does not go through ends, and whether it does where it is through.
fn stop_in_depth(slice: &StopInput, specimen: &Specimen) -> Result<(f64, bool)> {
    const DEPTH: &str = "stop.crack_depth_mm";
    let depth = LENGTH.read_optional(DEPTH, slice.crack_depth_mm)?;
    let Some(flaw) = &specimen.part_through else {
        let problem = format!("belongs to cracks that do not go through, and that of {} does", specimen.kind);
        let given = [("crack_depth_mm", depth.is_some()), ("at_break_through", slice.at_break_through.is_some())];
        refuse_given("stop", &given, &problem, "leave it out")?;
        return Ok((f64::INFINITY, false));
    };
    if let Some((depth, given)) = depth.zip(slice.crack_depth_mm) {
        let [start, through] = [flaw.depth, flaw.through_depth()].map(perilife_base::units::round_mm);
        if depth <= flaw.depth {
            let problem = format!("is not beyond the initial crack depth {start} mm");
            return Err(input(DEPTH, given, problem, "give a larger depth, or leave it out"));
        }
        if depth > flaw.through_depth() {
            let problem = format!("is beyond {through} mm, where the crack is through");
            return Err(input(DEPTH, given, problem, "give a smaller depth, or at_break_through = true"));
        }
    }
    Ok((depth.unwrap_or(f64::INFINITY), slice.at_break_through == Some(true)))
}

/// The required residual strength, a load, over the maximum load of the cycle.
fn required_load(stop: &StopInput, specimen: &Specimen, material: &Material, loading: &Loading) -> Result<Option<f64>> {
    const FACTOR: &str = "stop.limit_load_factor";
    const STRENGTH: &str = "stop.required_strength_mpa";
    let (key, given, factor) = match (stop.limit_load_factor, stop.required_strength_mpa) {
        (None, None) => return Ok(None),
        (Some(factor), Some(_)) => {
            return Err(input(FACTOR, factor, format!("stands beside {STRENGTH}: the load is given twice"), "give one of them"));
        }
        (Some(factor), None) => (FACTOR, factor, factor),
        (None, Some(strength)) if specimen.load_measure == LoadMeasure::Stress => {
            (STRENGTH, strength, strength * MPA / loading.maximum)
        }
        (None, Some(strength)) => {
            let problem = format!("is a gross stress, and a {} is loaded by a force on its pins", specimen.kind);
            return Err(input(STRENGTH, strength, problem, format!("set {FACTOR} = required load / maximum load")));
        }
    };
    if let (Some(course), STRENGTH) = (loading.course(), key) {
        let problem = format!("is one stress, and {} is one for every crack length", course.key);
        return Err(input(key, given, problem, format!("set {FACTOR} = required load / maximum load")));
    }
    if loading.displacement().is_some() {
        let problem = "is a load, and the cycles are of a displacement";
        return Err(input(key, given, problem, "leave it out, or give the load of the cycles"));
    }
    if !(factor.is_finite() && factor >= 1.0) {
        let problem = "is below the maximum load of the cycle";
        return Err(input(key, given, problem, "set the required residual strength (service limit load)"));
    }
    let ends = [(stop.toughness, material.toughness), (stop.net_section, material.yield_strength)];
    if !ends.iter().any(|(asked, strength)| asked.unwrap_or(true) && strength.is_some()) {
        let remedy = "give material.toughness_mpa_sqrt_m, yield_strength_mpa or both";
        return Err(input(
            key,
            given,
            "cannot be compared: the material has neither toughness nor yield strength that ends the life",
            remedy,
        ));
    }
    Ok(Some(factor))
}
