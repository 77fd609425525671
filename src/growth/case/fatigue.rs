//! `[fatigue]` and `[stop]` of an input file: how bonds age, where the law comes from, when a run stops.

use toml::Value;

use super::fatigue_keys::{FatigueKeys, Lot, keys_of_bonds};
use super::{Choices, LawSource, Method, Stop, law_source};
use perilife_base::error::{Result, input, input_missing};
use perilife_base::input::{Folder, Quantity, STRESS};
use perilife_base::keys::{Given, Plain, key, length, number, section, section_beside};
use perilife_base::units::MPA;
use perilife_laws::growth_law::description::{Given as GivenLaw, law_keys};
use perilife_laws::initiation::{self, SnLaw};
use perilife_laws::{Ageing, Driver, FatigueSettings, OVERLOAD_STRETCH, STEP_ERROR_PERCENT, ZONE_RADIUS_HORIZONS};
use perilife_plate::loading::{LoadControl, Loading};
use perilife_plate::material::Material;
use perilife_plate::specimen::{LengthConvention, LoadMeasure, Specimen, SpecimenKind};

const CYCLES_MAX: f64 = 1e9;

pub(super) struct Fatigue {
    pub settings: FatigueSettings,
    /// `None` where the file gives no law, as in a calibration.
    pub law: Option<LawSource>,
    pub allow_extrapolation: bool,
    pub lot: Lot,
}

/// Reads `[fatigue]` with the law of `method`, a fitted one from `folder`; explicit choices go into `choices`.
pub(super) fn from_value(
    value: &Value,
    method: Method,
    (specimen, material, loading): (&Specimen, &Material, &Loading),
    folder: &Folder,
    choices: &mut Choices,
) -> Result<Fatigue> {
    let input: FatigueKeys = section_beside(value, "fatigue", &law_keys().collect::<Vec<_>>())?;
    choices.ageing = input.ageing;
    choices.zone_radius_horizons = input.zone_radius_horizons;
    choices.walker_gamma = input.walker_gamma;
    let driver = read_driver(&input, Given::of(value, "fatigue")?.first(&keys_of_bonds()), method, specimen)?;
    let mut settings = FatigueSettings {
        driver,
        ageing: choices.ageing.unwrap_or(Ageing::CrackTip),
        zone_radius_horizons: choices.zone_radius_horizons.unwrap_or(ZONE_RADIUS_HORIZONS),
        step_error_percent: STEP_ERROR_PERCENT,
        critical_stretch: input.critical_stretch.unwrap_or(OVERLOAD_STRETCH),
        walker_gamma: choices.walker_gamma.unwrap_or(1.0),
        threshold: input.threshold.as_ref().map_or(0.0, |threshold| threshold.0),
        initiation: read_initiation(&input, (driver, specimen, loading))?,
    };
    // What is driven by bonds to the end needs no rate over K.
    let by_bonds = method == Method::Peridynamics && driver == Driver::BondStrain;
    let hands_over = by_bonds.then(|| settings.hands_over(specimen));
    settings.step_error_percent = read_step_error(&input, driver == Driver::TipField || hands_over == Some(true))?;
    let given = GivenLaw { section: value, material, ratios: loading.ratios(), folder, rates: law_source::rates };
    let law = law_source::read(settings.threshold, hands_over, &given)?;
    Ok(Fatigue { settings, law, allow_extrapolation: input.allow_extrapolation, lot: input.lot })
}

/// The given driver; else tips, unless a key of bonds is given or a tip is not sharp. Keys of bonds conflict with tips.
fn read_driver(input: &FatigueKeys, of_bonds: Option<&str>, method: Method, specimen: &Specimen) -> Result<Driver> {
    if method == Method::ElementFreeGalerkin {
        let remedy = "remove it, or use model.method = \"peridynamics\"";
        return match (input.driver, of_bonds) {
            (Some(Driver::BondStrain), _) => {
                let problem = "requires bonds; model.method = \"element_free_galerkin\" has none";
                Err(perilife_base::error::input("fatigue.driver", "\"bond_strain\"", problem, remedy))
            }
            (_, Some(key)) => {
                let problem = "applies only to fatigue bonds, not to model.method = \"element_free_galerkin\"";
                Err(input_missing(&format!("fatigue.{key}"), problem, remedy))
            }
            _ => Ok(Driver::TipField),
        };
    }
    match (input.driver, of_bonds) {
        (Some(Driver::TipField), Some(key)) if method == Method::Peridynamics => {
            let problem = "applies only to fatigue bonds, not to fatigue.driver = \"tip_field\"";
            Err(input_missing(&format!("fatigue.{key}"), problem, "remove it, or use driver = \"bond_strain\""))
        }
        (Some(driver), _) => Ok(driver),
        (None, None) if specimen.has_sharp_tips() => Ok(Driver::TipField),
        (None, _) => Ok(Driver::BondStrain),
    }
}

/// Reads the law by which the cracks of the case form.
/// Errors: a plate whose cracks nobody lets form, or drilled holes that nobody says when they crack again.
fn read_initiation(input: &FatigueKeys, (driver, specimen, loading): (Driver, &Specimen, &Loading)) -> Result<Option<SnLaw>> {
    let Some(law) = input.initiation else {
        if specimen.kind == SpecimenKind::StopHole {
            let problem = "required: initiation at the stop holes needs an S-N curve";
            return Err(input_missing(initiation::KEY, problem, "give range_mpa, cycles and slope of the S-N curve"));
        }
        return Ok(None);
    };
    if driver != Driver::TipField || !specimen.is_through() || loading.spectrum.is_some() || loading.control != LoadControl::Load
    {
        let problem = "requires constant amplitude and through cracks driven by K";
        return Err(input_missing(initiation::KEY, problem, "remove it"));
    }
    Ok(Some(law))
}

/// Reads the error of a block of growth by K; bonds that break one by one are solved for after every break, without such an error.
fn read_step_error(slice: &FatigueKeys, has_tips: bool) -> Result<f64> {
    const KEY: &str = "fatigue.step_error_percent";
    let error = slice.step_error_percent;
    if let Some(error) = error.filter(|_| !has_tips) {
        let problem = "applies only to driver = \"tip_field\", not to \"bond_strain\"";
        return Err(input(KEY, error, problem, "remove it, or use driver = \"tip_field\""));
    }
    Ok(error.unwrap_or(STEP_ERROR_PERCENT))
}

const REQUIRED: &str = "the load";

perilife_base::keys! {
    pub struct StopKeys {
        crack_length: Option<f64> = length("crack_length_mm", "Final crack length");
        crack_depth: Option<f64> = length("crack_depth_mm", "Final crack depth: of a part-through crack");
        at_break_through: Option<bool> = key("at_break_through", "Stop at breakthrough: of a part-through crack");
        cycles_max: f64 = number("cycles_max", "Maximum cycles: run-out", "a number of cycles", 1.0, 1e15), or "1e9" CYCLES_MAX;
        required_strength: Option<Plain> = key("required_strength_mpa", "Required strength: gross stress").of(ANY_STRESS).group(REQUIRED);
        limit_load_factor: Option<f64> = key("limit_load_factor", "Required load: over the maximum load of the cycles").group(REQUIRED);
        toughness: bool = key("toughness", "Fracture ends the life"), or "true" true;
        net_section: bool = key("net_section", "Net-section yield ends the life"), or "true" true;
    }
}
/// What is too low is told by the load of the cycles.
const ANY_STRESS: Quantity = Quantity { low: -STRESS.high, ..STRESS };

/// Reads `[stop]`.
pub(super) fn stop_from_value(value: &Value, (specimen, material, loading): (&Specimen, &Material, &Loading)) -> Result<Stop> {
    let own: StopKeys = section(value, "stop")?;
    let given = Given::of(value, "stop")?;
    if let Some(length) = own.crack_length {
        const KEY: &str = "crack_length_mm";
        if length <= specimen.shortest_crack() {
            let start = perilife_base::units::round_mm(specimen.shortest_crack());
            let problem = format!("must be above the initial crack length {start} mm");
            return Err(given.refuse(KEY, problem, "give a longer crack, or remove it"));
        }
        let (limit, _) = specimen.length_limit();
        if specimen.convention == LengthConvention::MeanOfTips && length >= limit {
            let limit = perilife_base::units::round_mm(limit);
            let problem = format!("is outside the plate, which ends at {limit} mm");
            return Err(given.refuse(KEY, problem, "give a shorter crack, or remove it"));
        }
    }
    let (crack_depth, at_break_through) = stop_in_depth(&given, &own, specimen)?;
    let cycles_max = own.cycles_max;
    let of_passes = loading.spectrum.as_ref().and_then(|spectrum| Some(spectrum.repeats? * spectrum.per_pass));
    let cycles_max = of_passes.map_or(cycles_max, |cycles| cycles_max.min(cycles));
    let required = required_load(&own, specimen, material, loading)?;
    let StopKeys { toughness: by_toughness, net_section: by_net_section, .. } = own;
    let crack_length = own.crack_length.unwrap_or(f64::INFINITY);
    Ok(Stop { crack_length, crack_depth, at_break_through, cycles_max, required, by_toughness, by_net_section })
}

/// Depth, m, at which the run of a crack that does not go through ends, and whether it does where it is through.
fn stop_in_depth(given: &Given<'_>, own: &StopKeys, specimen: &Specimen) -> Result<(f64, bool)> {
    const DEPTH: &str = "crack_depth_mm";
    let Some(flaw) = &specimen.part_through else {
        let problem = format!("applies only to part-through cracks; {} has a through crack", specimen.kind);
        given.refuse_any(&[DEPTH, "at_break_through"], &problem, "remove it")?;
        return Ok((f64::INFINITY, false));
    };
    if let Some(depth) = own.crack_depth {
        let [start, through] = [flaw.depth, flaw.through_depth()].map(perilife_base::units::round_mm);
        if depth <= flaw.depth {
            let problem = format!("must be above the initial crack depth {start} mm");
            return Err(given.refuse(DEPTH, problem, "give a larger depth, or remove it"));
        }
        if depth > flaw.through_depth() {
            let problem = format!("exceeds the thickness {through} mm");
            return Err(given.refuse(DEPTH, problem, "use a smaller depth, or at_break_through = true"));
        }
    }
    Ok((own.crack_depth.unwrap_or(f64::INFINITY), own.at_break_through == Some(true)))
}

/// The required residual strength, a load, over the maximum load of the cycle.
fn required_load(stop: &StopKeys, specimen: &Specimen, material: &Material, loading: &Loading) -> Result<Option<f64>> {
    const FACTOR: &str = "stop.limit_load_factor";
    const STRENGTH: &str = "stop.required_strength_mpa";
    let (key, given, factor) = match (stop.limit_load_factor, stop.required_strength.map(|strength| strength.0)) {
        (None, None) => return Ok(None),
        (Some(factor), _) => (FACTOR, factor, factor),
        (None, Some(strength)) if specimen.load_measure == LoadMeasure::Stress => {
            (STRENGTH, strength, strength * MPA / loading.maximum)
        }
        (None, Some(strength)) => {
            let problem = format!("is a gross stress, but a {} needs a force on its pins", specimen.kind);
            return Err(input(STRENGTH, strength, problem, format!("set {FACTOR} = required load / maximum load")));
        }
    };
    if let (Some(course), STRENGTH) = (loading.course(), key) {
        let problem = format!("is one stress, and {} is one for every crack length", course.key);
        return Err(input(key, given, problem, format!("set {FACTOR} = required load / maximum load")));
    }
    if loading.displacement().is_some() {
        let problem = "is a load, and the cycles are of a displacement";
        return Err(input(key, given, problem, "remove it, or give the load of the cycles"));
    }
    if !(factor.is_finite() && factor >= 1.0) {
        let problem = "is below the maximum load of the cycle";
        return Err(input(key, given, problem, "set the required residual strength (service limit load)"));
    }
    let ends = [(stop.toughness, material.toughness), (stop.net_section, material.yield_strength)];
    if !ends.iter().any(|(asked, strength)| *asked && strength.is_some()) {
        let remedy = "give material.toughness_mpa_sqrt_m, yield_strength_mpa or both";
        return Err(input(key, given, "requires material.toughness or material.yield_strength", remedy));
    }
    Ok(Some(factor))
}
