//! From a calibrated record to the law of this case: what must agree, what is rescaled, and the words about it.

use std::path::Path;
use std::str::FromStr;

use super::{Case, Engine, LawSource, Method, Model, usual_nodes};
use crate::case::record::{CurveRecord, FittedLaw, FittedRecord};
use perilife_base::error::{Error, Result, input, input_missing};
use perilife_base::input::{LENGTH, MODULUS, number};
use perilife_base::units::{GPA, MM, MM_PER_CYCLE, MPA_SQRT_M};
use perilife_laws::curve::{Shape, Shaped};
use perilife_laws::growth_law::{GrowthLaw, Walker};
use perilife_laws::paris::ParisLaw;
use perilife_laws::{Driver, FatigueLaw};
use perilife_plate::loading::SAME_RATIO;
use perilife_plate::material::{Material, Plane};
use perilife_plate::specimen::{CrackLine, Specimen};

/// Numbers and names of a record make sense.
pub(super) fn check_record(record: &FittedRecord) -> Result<()> {
    number("an exponent", 0.5, 20.0).read("p", record.p)?;
    number("a rate in mm/cycle", 1e-60, 1e3).read("paris_c_mm_per_cycle", record.paris_c_mm_per_cycle)?;
    number("an exponent", 0.0, 30.0).read("paris_m", record.paris_m)?;
    if record.rate_constant.is_some() || Method::from_str(&record.method)? == Method::Peridynamics {
        number("a constant in 1/cycle", 1e-60, 1e100).read("a", record.a)?;
        LENGTH.read("horizon_mm", record.horizon_mm)?;
        let beta = record.rate_constant.ok_or_else(|| input_missing("rate_constant", "is missing", "fit again"))?;
        number("a rate constant", 1e-60, 1e100).read("rate_constant", beta)?;
    }
    MODULUS.read("youngs_modulus_gpa", record.youngs_modulus_gpa)?;
    number("a Poisson's ratio", 0.0, 0.499).read("poisson_ratio", record.poisson_ratio)?;
    number("a ratio", -100.0, 0.999).read("stress_ratio", record.stress_ratio)?;
    number("a horizon ratio", 1.5, 12.0).read("horizon_ratio", record.horizon_ratio)?;
    number("a radius in horizons", 0.05, 10.0).read("zone_radius_horizons", record.zone_radius_horizons)?;
    Plane::from_str(&record.plane)?;
    if record.curve.is_some() != (record.law == FittedLaw::Curve) {
        return Err(input("law", record.law, "conflicts with section [curve] of the fitted law", "fit again"));
    }
    record.curve.as_ref().map_or(Ok(()), check_curve)
}

fn check_curve(curve: &CurveRecord) -> Result<()> {
    let (rate, delta_k) = (number("a rate in mm/cycle", 1e-30, 1e6), number("a range of K in MPa√m", 1e-3, 1e5));
    for (key, values, of) in
        [("da_dn_mm_per_cycle", &curve.da_dn_mm_per_cycle, rate), ("delta_k_mpa_sqrt_m", &curve.delta_k_mpa_sqrt_m, delta_k)]
    {
        values.iter().try_for_each(|value| of.read(&format!("curve.{key}"), *value).map(|_| ()))?;
    }
    let knots = curve.law().knots().map(|k| k / MPA_SQRT_M);
    let off = knots.iter().zip(&curve.delta_k_mpa_sqrt_m).find(|(even, given)| (*even / *given - 1.0).abs() > 1e-6);
    off.map_or(Ok(()), |(even, given)| {
        let problem = format!("is not {even:.6}: the values rise even in their logarithms from the first to the last");
        Err(input("curve.delta_k_mpa_sqrt_m", given, problem, "fit again"))
    })
}

/// Takes the record as the law of the case. Where the case is silent the record decides; where both speak they must agree.
pub(super) fn adopt(case: &mut Case, record: FittedRecord) -> Result<()> {
    check_record(&record)?;
    let by_hand = record.rate_constant.is_none();
    if case.model.method() != Method::Peridynamics || by_hand && case.is_driven_by_tips() {
        // C and m belong to ΔK, whatever bonds they were fitted with.
        check_stress_ratio(case, &record)?;
        case.law = LawSource::Fitted(Box::new(record));
        return Ok(());
    }
    if by_hand {
        let problem = "contains C and m but no bond constant A (fitted with handbook K or nodes)";
        let remedy = "fit with model.method = \"peridynamics\", or use fatigue.driver = \"tip_field\" here";
        return Err(input("fatigue.fitted", &record.material, problem, remedy));
    }
    let choices = case.choices;
    let Some(points) = case.model.points_mut() else { return Ok(()) };
    let law = &mut points.bond_law;
    law.kind = agree("model.bond_law", choices.bond_law, &record.bond_law)?;
    law.kernel = agree("model.kernel", choices.kernel, &record.kernel)?;
    law.rotation = agree("model.rotation", choices.rotation, &record.rotation)?;
    law.surface_correction = agree("model.surface_correction", choices.surface_correction, &record.surface_correction)?;
    points.horizon_ratio = choices.horizon_ratio.unwrap_or(record.horizon_ratio);
    if case.spends_bond_life() {
        adopt_ageing(case, &record)?;
    }
    check_stress_ratio(case, &record)?;
    case.law = LawSource::Fitted(Box::new(record));
    Ok(())
}

/// The part of a record that says how bonds age.
fn adopt_ageing(case: &mut Case, record: &FittedRecord) -> Result<()> {
    let choices = case.choices;
    case.fatigue.ageing = agree("fatigue.ageing", choices.ageing, &record.ageing)?;
    if let Some(given) = choices.zone_radius_horizons
        && (given - record.zone_radius_horizons).abs() > 1e-9
    {
        return Err(disagree("fatigue.zone_radius_horizons", &given.to_string(), &record.zone_radius_horizons.to_string()));
    }
    case.fatigue.zone_radius_horizons = record.zone_radius_horizons;
    Ok(())
}

/// The record's name as a kind, equal to the explicit choice if there is one.
fn agree<K: FromStr<Err = Error> + PartialEq + std::fmt::Display + Copy>(
    key: &str,
    chosen: Option<K>,
    recorded: &str,
) -> Result<K> {
    let recorded: K = recorded.parse()?;
    match chosen {
        Some(chosen) if chosen != recorded => Err(disagree(key, &format!("\"{chosen}\""), &format!("\"{recorded}\""))),
        _ => Ok(recorded),
    }
}

fn disagree(key: &str, chosen: &str, recorded: &str) -> Error {
    let problem = format!("differs from the value of the fitted law, {recorded}");
    input(key, chosen, problem, format!("remove the key or set it to {recorded}; or fit again with {chosen}"))
}

fn check_stress_ratio(case: &Case, record: &FittedRecord) -> Result<()> {
    let other = case.loading.ratios().into_iter().find(|ratio| (ratio - record.stress_ratio).abs() >= 1e-9);
    let Some(other) = other.filter(|_| case.choices.walker_gamma.is_none()) else { return Ok(()) };
    let problem = format!("differs from the tested stress ratio, {}", record.stress_ratio);
    let remedy = "set fatigue.walker_gamma (ΔK_eff = K_max (1-R)^γ; γ = 1: no mean-stress effect), or fit a law at this R";
    let key = if case.loading.spectrum.is_some() { "loading.spectrum_file" } else { "loading.stress_ratio" };
    Err(input(key, other, problem, remedy))
}

fn bonds_of(record: &FittedRecord) -> FatigueLaw {
    FatigueLaw { a: record.a, p: record.p, horizon: record.horizon_mm * MM }
}

/// Warnings of a fitted law used in this case.
pub(super) fn record_lines(case: &Case, record: &FittedRecord) -> Result<Vec<String>> {
    let mut lines = Vec::new();
    let bonds = case.spends_bond_life();
    if bonds && (case.points().horizon_ratio - record.horizon_ratio).abs() > 1e-9 {
        let (given, recorded) = (case.points().horizon_ratio, record.horizon_ratio);
        lines.push(format!(
            "law: horizon_ratio {given} is used with a law fitted at {recorded}; the transfer between them is not validated"
        ));
    }
    if case.model.method() == Method::Peridynamics {
        lines.extend(material_line(&case.material, record, bonds)?);
    }
    Ok(lines)
}

/// One line about a plate of other elastic constants than the calibrated one, for bonds or tips; `None` where they agree.
fn material_line(material: &Material, record: &FittedRecord, bonds: bool) -> Result<Option<String>> {
    let (e, nu) = (material.youngs_modulus / GPA, material.poisson_ratio);
    let same = (e - record.youngs_modulus_gpa).abs() < 1e-9 * e
        && (nu - record.poisson_ratio).abs() < 1e-9
        && material.plane.name() == record.plane;
    if same {
        return Ok(None);
    }
    let factor = (material.plane_modulus() / record.plane_modulus()?).powf(record.p);
    let bonds = if bonds { format!(", A times (E'2/E'1)^p = {factor:.4}") } else { String::new() };
    Ok(Some(format!(
        "law: growth law of {} (E {} GPa, ν {}, plane {}) used at E {e} GPa, ν {nu}, plane {}: da/dN at equal ΔK is kept{bonds}",
        record.material, record.youngs_modulus_gpa, record.poisson_ratio, record.plane, material.plane
    )))
}

impl Case {
    /// Toughness, Pa√m, where the life ends at it.
    pub fn toughness_at_end(&self) -> Option<f64> {
        self.material.toughness.filter(|_| self.stop.by_toughness)
    }

    /// Yield strength, Pa, where the life ends at the limit load of a section.
    pub fn yield_strength_at_end(&self) -> Option<f64> {
        self.material.yield_strength.filter(|_| self.stop.by_net_section)
    }

    /// [`Case::limit_load`] at a crack length, m, that all tips have grown to alike, straight ahead.
    pub fn limit_load_at(&self, crack_length: f64) -> Option<f64> {
        self.specimen.limit_load_at(crack_length, self.material.yield_strength?)
    }

    /// Nominal load, Pa or N, at which the weakest section is fully plastic, for a crack length, m, of a standard kind, or the cracks of
    /// a plate; `None` without yield strength, or where the loads determine what no section bears.
    pub fn limit_load(&self, crack_length: f64, cracks: &[CrackLine]) -> Option<f64> {
        self.specimen.limit_load(crack_length, cracks, self.material.yield_strength?)
    }

    /// What computes its growth.
    pub fn engine(&self) -> Engine {
        match (&self.model, self.fatigue.driver) {
            (Model::Handbook(_), _) if !self.specimen.is_through() => Engine::PartThrough,
            (Model::Handbook(_), _) => Engine::Handbook,
            (Model::Nodes(_), _) => Engine::Nodes,
            (Model::Points(_), Driver::TipField) => Engine::Points,
            (Model::Points(_), Driver::BondStrain) if self.fatigue.hands_over(&self.specimen) => Engine::BondsThenPoints,
            (Model::Points(_), Driver::BondStrain) => Engine::Bonds,
        }
    }

    /// Whether its crack grows, at first at least, as bonds lose remaining life, not by the K of its tips.
    pub fn spends_bond_life(&self) -> bool {
        matches!(self.engine(), Engine::Bonds | Engine::BondsThenPoints)
    }

    /// The same case with the cracks that its bonds have made, driven by the K of their tips.
    pub fn driven_by_tips(&self, specimen: Specimen) -> Case {
        let mut case = Case { specimen, ..self.clone() };
        case.fatigue.driver = Driver::TipField;
        if self.choices.surface_correction.is_none() && !matches!(self.law, LawSource::Fitted(_)) {
            case.model.take_most_accurate_rim();
        }
        case
    }

    /// The same case of which the crack is through, on this plate of nodes.
    pub fn with_through_crack(&self, specimen: Specimen) -> Case {
        let mut case = Case { model: Model::Nodes(usual_nodes(&specimen)), specimen, ..self.clone() };
        case.fatigue.driver = Driver::TipField;
        case.stop.crack_depth = f64::INFINITY;
        case
    }

    /// Whether its crack grows by the K of its tips, on points or nodes.
    pub fn is_driven_by_tips(&self) -> bool {
        matches!(self.engine(), Engine::Points | Engine::Nodes)
    }

    /// A and p at the body's actual horizon (m).
    ///
    /// A moves over the horizon by [`FatigueLaw::at_horizon`]. A record keeps its measured growth rate (C and m) in a plate
    /// of other constants, `A₂ = A₁ (E'₂/E'₁)^p`. It was fitted with ε = s_max (1-R₁); under a Walker exponent γ the same
    /// rate at R₁ needs `A_γ = A₁ (1-R₁)^(p (1-γ))`, so that ε = s_max (1-R)^γ carries only the difference in R.
    pub fn fatigue_law(&self, horizon: f64) -> Result<FatigueLaw> {
        match &self.law {
            LawSource::Inline(law) => Ok(law.at_horizon(horizon)),
            LawSource::Fitted(record) => {
                let modulus = (self.material.plane_modulus() / record.plane_modulus()?).powf(record.p);
                let range = 1.0 - record.stress_ratio.max(0.0);
                let walker = range.powf(record.p * (1.0 - self.fatigue.walker_gamma));
                let law = bonds_of(record);
                Ok(FatigueLaw { a: law.a * modulus * walker, ..law }.at_horizon(horizon))
            }
            // What it stands for takes a computation (`predict::laws`).
            LawSource::Paris(_) | LawSource::Factor(_) => Err(missing(Method::Peridynamics, Path::new(""))),
            LawSource::Missing(path) => Err(missing(Method::Peridynamics, path)),
        }
    }

    /// What the fitted rates are beside their power law; `None` where that is the law.
    pub fn shape(&self) -> Result<Option<Shape>> {
        let LawSource::Fitted(record) = &self.law else { return Ok(None) };
        shape(record)
    }

    /// C and m of hand calculation for `da/dN = C (K_max (1-R)^γ)^m`, γ Walker's exponent.
    ///
    /// Inline constants are those at R = 0 (Walker 1970; without γ the same at every R). A record holds them for its own
    /// ratio: the same rate at R₁ needs `C_γ = C₁ (1-R₁)^(m (1-γ))`. C and m do not depend on elastic constants.
    pub fn paris_law(&self) -> Result<ParisLaw> {
        match &self.law {
            LawSource::Paris(law) => Ok(*law),
            LawSource::Fitted(record) => {
                // K of the tip's field and K of the handbook are not quite the same: each law stays with its own.
                let law = match self.model.method() {
                    Method::Peridynamics => fitted_paris(record)?,
                    _ => ParisLaw { c: record.paris_c_mm_per_cycle * MM_PER_CYCLE, m: record.paris_m },
                };
                let range = 1.0 - record.stress_ratio.max(0.0);
                let walker = range.powf(law.m * (1.0 - self.fatigue.walker_gamma));
                Ok(ParisLaw { c: law.c * walker, m: law.m })
            }
            LawSource::Inline(_) | LawSource::Factor(_) => Err(missing(Method::Handbook, Path::new(""))),
            LawSource::Missing(path) => Err(missing(Method::Handbook, path)),
        }
    }
}

/// The law of a record over ΔK, and the ΔK, Pa√m, between which it was fitted.
/// Errors: a stress ratio that is not that of its tests.
pub(super) fn of_record(record: &FittedRecord, ratio: f64) -> Result<(Box<dyn GrowthLaw>, [f64; 2])> {
    if (ratio - record.stress_ratio).abs() >= SAME_RATIO {
        let problem = format!("differs from the tested stress ratio, {}", record.stress_ratio);
        return Err(input("stress_ratio", ratio, problem, "use that of the fit"));
    }
    let walker = Walker { paris: fitted_paris(record)?, gamma: 1.0, threshold: 0.0 };
    let law: Box<dyn GrowthLaw> = match shape(record)? {
        Some(shape) => Box::new(Shaped { walker, shape }),
        None => Box::new(walker),
    };
    Ok((law, [record.delta_k_min_mpa_sqrt_m, record.delta_k_max_mpa_sqrt_m].map(|k| k * MPA_SQRT_M)))
}

/// What a record departs from its power law by, where its law is a curve.
fn shape(record: &FittedRecord) -> Result<Option<Shape>> {
    let of = |curve: &CurveRecord| Ok(Shape { curve: curve.law(), paris: fitted_paris(record)?, ratio: record.stress_ratio });
    record.curve.as_ref().map(of).transpose()
}

/// C and m of a record over the K that its curve is over.
fn fitted_paris(record: &FittedRecord) -> Result<ParisLaw> {
    match record.rate_constant {
        Some(beta) => Ok(ParisLaw::of_bonds(&bonds_of(record), beta, record.plane_modulus()?)),
        None => Ok(ParisLaw { c: record.paris_c_mm_per_cycle * MM_PER_CYCLE, m: record.paris_m }),
    }
}

/// The error of a case whose law is needed: none was given (an empty path), or the record does not exist.
pub(super) fn missing(method: Method, path: &Path) -> Error {
    if !path.as_os_str().is_empty() {
        let action = "cannot read the fatigue law (write it with `perilife calibrate`)";
        return Error::file(path, action, std::io::ErrorKind::NotFound.into());
    }
    let constants = if method == Method::Peridynamics { "a, p and horizon_mm" } else { "paris_c_mm_per_cycle and paris_m" };
    let remedy = format!("give fitted = \"fitted.toml\" from `perilife calibrate`, or {constants}");
    input_missing("fatigue.fitted", "is missing: the case has no fatigue law", remedy)
}
