//! Whether the first load breaks a plate, and the load that it would bear.

use super::Case;
use crate::specimen::LoadMeasure;
use crate::specimen::handbook::handbook;
use crate::units::{KN, MPA, MPA_SQRT_M};

/// What the user should know before a run, by the handbook and the net section; `None` where the plate bears the load, or nothing is known.
pub fn warning(case: &Case) -> Option<String> {
    if case.loading.displacement().is_some() {
        return None;
    }
    let (length, load) = (case.specimen.crack_length, case.loading.maximum);
    let factor = handbook(&case.specimen).map(|formula| formula.k_i(length, load));
    words(case, load, factor.filter(|k| k.is_finite()))
}

/// The strengths that a largest nominal load (Pa or N) with this K_max, Pa√m, exceeds at N = 0, and the load that all of them bear.
pub fn words(case: &Case, load: f64, k_max: Option<f64>) -> Option<String> {
    let material = &case.material;
    let stress = case.specimen.net_section_stress(case.specimen.crack_length, load).or_else(|| case.specimen.gross_stress(load));
    let by_toughness = k_max.zip(material.toughness).filter(|(k_max, toughness)| k_max >= toughness);
    let by_yield = stress.zip(material.yield_strength).filter(|(stress, strength)| stress >= strength);
    let mut causes = Vec::new();
    if let Some((k_max, toughness)) = by_toughness {
        causes.push(format!("K_max {:.2} MPa√m is beyond the toughness {:.2} MPa√m", k_max / MPA_SQRT_M, toughness / MPA_SQRT_M));
    }
    if let Some((stress, strength)) = by_yield {
        causes.push(format!(
            "the section beside the crack carries {:.1} MPa, beyond the yield strength {:.1} MPa",
            stress / MPA,
            strength / MPA
        ));
    }
    let shares = [by_toughness, by_yield].into_iter().flatten().map(|(is, may)| may / is);
    let borne = load * shares.fold(f64::INFINITY, f64::min);
    let borne = match case.specimen.load_measure {
        LoadMeasure::Stress => format!("{:.2} MPa", borne / MPA),
        LoadMeasure::Force => format!("{:.4} kN", borne / KN),
    };
    (!causes.is_empty()).then(|| {
        format!(
            "the first load breaks the plate: {}; it would bear {borne} at this crack length, and there is no life",
            causes.join(", and ")
        )
    })
}
