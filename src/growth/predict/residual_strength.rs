//! Residual strength: the load that would end the plate at once, over crack length.
//!
//! `load_c(a) = min(load_max K_c / K_max(a), limit load(a))`: K is proportional to load, and the limit load that of the weakest section
//! ([`perilife_plate::specimen::limit_load`]). Where the curve falls to the maximum load of the cycle, the run ends.

use super::{CurvePoint, GoverningCrack};
use crate::case::Case;
use perilife_base::error::{Result, input_missing};
use perilife_plate::specimen::handbook::handbook;

/// Crack lengths of the curve of a specimen whose K(a) is known.
const STEPS: usize = 200;

/// Residual strength at one crack length; loads as the case gives them: gross stress, Pa, or force, N.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Strength {
    /// Crack length, m.
    pub crack_length: f64,
    /// Load at which K reaches the toughness; `None` where one of them is not known.
    pub by_toughness: Option<f64>,
    /// Load at which the net section yields throughout; `None` without yield strength, or where no section is determined by the loads.
    pub by_net_section: Option<f64>,
}

impl Strength {
    /// The lower of the two.
    pub fn load(&self) -> f64 {
        [self.by_toughness, self.by_net_section].into_iter().flatten().fold(f64::INFINITY, f64::min)
    }

    /// What ends the plate.
    pub fn governed_by(&self) -> super::StopReason {
        let net_section = self.by_net_section.unwrap_or(f64::INFINITY);
        if self.by_toughness.is_some_and(|load| load <= net_section) {
            super::StopReason::Toughness
        } else {
            super::StopReason::NetSectionYield
        }
    }
}

/// Residual strength over crack length: from the initial crack to the end of the plate where a handbook knows K, else along
/// the curve of the run.
/// Errors: neither toughness nor yield strength is given, or neither says anything about this plate.
pub fn residual_strength(case: &Case, curve: &[CurvePoint]) -> Result<Vec<Strength>> {
    check_strength(case)?;
    let strength = |crack_length: f64, k_max: Option<f64>, limit_load: Option<f64>| Strength {
        crack_length,
        by_toughness: case
            .material
            .toughness
            .zip(k_max)
            .map(|(toughness, k_max)| case.loading.at(crack_length) * toughness / k_max),
        by_net_section: limit_load,
    };
    let all: Vec<Strength> = match handbook(&case.specimen) {
        Some(formula) => {
            let known = case.specimen.beta.as_ref().map_or(f64::INFINITY, |table| table.bounds()[1]);
            let (from, to) = (case.specimen.crack_length, case.specimen.length_limit().0.min(known));
            let lengths = (0..STEPS).map(|i| from + (to - from) * i as f64 / STEPS as f64);
            lengths.map(|a| strength(a, Some(formula.k_i(a, case.loading.at(a))), case.limit_load_at(a))).collect()
        }
        None => {
            let known = |point: &CurvePoint| Some(point.k_max(&case.loading)).filter(|k| *k > 0.0);
            let governing = GoverningCrack::of(&case.specimen, curve);
            curve.iter().map(|point| strength(governing.length(point), known(point), point.limit_load)).collect()
        }
    };
    Ok(all.into_iter().filter(|strength| strength.load().is_finite()).collect())
}

/// Whether the material has a strength that says anything about this plate.
/// Errors: it has none, or only a yield strength, and the loads determine what no section bears.
pub fn check_strength(case: &Case) -> Result<()> {
    if case.loading.displacement().is_some() {
        let problem = "conflicts with cycles of a displacement, whose load is not that of a strength";
        return Err(input_missing("--residual-strength", problem, "give a case with cycles of a load"));
    }
    if let Some(residual) = &case.loading.residual {
        let problem = "conflicts with residual stress, which K does not lose in proportion to the load";
        return Err(input_missing("--residual-strength", problem, format!("leave the option out, not {}", residual.key())));
    }
    let limit = case.limit_load(case.specimen.crack_length, &case.specimen.crack_lines());
    if case.material.toughness.or(limit).is_some() {
        return Ok(());
    }
    let remedy = match case.material.yield_strength {
        Some(_) => "give material.toughness_mpa_sqrt_m: supports on both sides of every section hide its collapse load",
        None => "give material.toughness_mpa_sqrt_m, material.yield_strength_mpa, or both",
    };
    Err(input_missing("--residual-strength", "needs a strength of the material", remedy))
}
