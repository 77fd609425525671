//! `result.json`: the figures of a run, what model computed it and why, and the case as it was given.

use serde_json::{Map, Value, json};

use crate::bond_law::BondLawKind;
use crate::case::{Case, LawSource, Method};
use crate::net::Refinement;
use crate::predict::laws::paris_law;
use crate::predict::plastic_zone::{PlasticZone, Zone};
use crate::predict::{Prediction, StopReason};
use crate::specimen::handbook::handbook;
use crate::units::{MM, MM_PER_CYCLE, MPA_SQRT_M};

use super::fit_use::extrapolated;
pub use super::fit_use::life_share_extrapolated;

/// Name of the file.
pub const RESULT_FILE: &str = "result.json";

/// The whole object. A figure that does not exist (no fitted range to compare with, no ΔK) is `null`.
#[must_use]
pub fn result(case: &Case, prediction: &Prediction) -> Value {
    let figures = &prediction.figures;
    let extrapolated = extrapolated(case, prediction);
    // What the run found comes first: it counts more than what an assumption may do.
    let warnings: Vec<&String> = prediction.warnings.iter().chain(&extrapolated).chain(&case.warnings).collect();
    json!({
        "name": case.name,
        "life_cycles": prediction.life(),
        "stop_reason": prediction.stop.name(),
        "stop_meaning": prediction.stop.meaning(),
        "converged": prediction.stop != StopReason::NoConvergence,
        "crack_length_initial_mm": clean(case.specimen.crack_length / MM),
        "crack_length_final_mm": clean(prediction.crack_length_final() / MM),
        "life_share_extrapolated": life_share_extrapolated(case, prediction),
        "plastic_zone": plastic_zone(case, prediction),
        "k_cross_check": prediction.cross_check.map(|check| json!({
            "compared": check.compared,
            "largest_difference_percent": 100.0 * check.difference,
            "crack_length_mm": clean(check.crack_length / MM),
        })),
        "points": figures.points,
        "points_solved": figures.points_solved,
        "bonds": figures.bonds,
        "blocks": figures.blocks,
        "solves": figures.solves,
        "solver_iterations": figures.iterations,
        "wall_s": figures.wall_s,
        "memory_mb": figures.memory_mb,
        "model": model(case, prediction),
        "law": law(case, prediction),
        "warnings": warnings,
        "version": env!("CARGO_PKG_VERSION"),
        "case": case.echo,
    })
}

/// The model that ran: every choice with its value, and under `why` whether the case asked for it or the program chose it.
fn model(case: &Case, prediction: &Prediction) -> Value {
    if case.model.method == Method::Handbook {
        return hand_calculation(case);
    }
    let (model, figures) = (&case.model, &prediction.figures);
    let values = json!({
        "method": model.method.name(),
        "driver": case.fatigue.driver.name(),
        "bond_law": model.bond_law.kind.name(),
        "kernel": model.bond_law.kernel.name(),
        "rotation": model.bond_law.rotation.name(),
        "surface_correction": model.bond_law.surface_correction.name(),
        "discretisation": model.arrangement.name(),
        "levels": 1 + model.refinement.as_ref().map_or(0, Refinement::deepest),
        "spacing_mm": clean(figures.spacing / MM),
        "spacing_coarsest_mm": clean(figures.spacing * model.coarsest_spacing() / model.spacing / MM),
        "horizon_ratio": model.horizon_ratio,
        "horizon_mm": clean(figures.horizon / MM),
        "lattice_angle_deg": clean(model.lattice_angle.to_degrees()),
        "solver": model.solver.name(),
        "symmetry": model.symmetry.name(),
    });
    let why: Map<String, Value> =
        WHY_CHOSEN.iter().map(|(key, reason)| ((*key).to_owned(), why_text(case, prediction, key, reason).into())).collect();
    let mut object = values.as_object().cloned().unwrap_or_default();
    object.insert("why".to_owned(), Value::Object(why));
    Value::Object(object)
}

/// The formula of a run of method `handbook`. Other keys of `[model]` say nothing there.
fn hand_calculation(case: &Case) -> Value {
    let formula = handbook(&case.specimen);
    json!({
        "method": case.model.method.name(),
        "formula": formula.map(|formula| formula.name),
        "source": formula.map(|formula| formula.source),
        "range": formula.map(|formula| formula.range),
        "why": { "method": "given in the case", "formula": "that of the kind of specimen" },
    })
}

/// Plastic zone at the first and the last row whose K is known; `null` without yield strength.
fn plastic_zone(case: &Case, prediction: &Prediction) -> Value {
    let Some(found) = PlasticZone::of(case, prediction) else { return Value::Null };
    let zone = |zone: &Zone| {
        json!({
            "crack_length_mm": clean(zone.crack_length / MM),
            "k_max_mpa_sqrt_m": clean(zone.k_max / MPA_SQRT_M),
            "size_mm": clean(zone.size / MM),
            "over_horizon": clean(zone.size / prediction.figures.horizon),
            "ligament_mm": clean(zone.ligament / MM),
            "over_ligament": clean(zone.size / zone.ligament),
            "over_thickness": clean(zone.size / case.specimen.thickness),
        })
    };
    json!({
        "first": zone(&found.first),
        "last": zone(&found.last),
        "small_scale_yielding": found.too_large_from.is_none(),
        "too_large_from_mm": found.too_large_from.map(|length| clean(length / MM)),
        "life_share_too_large": clean(found.life_share_too_large),
    })
}

/// Why the program takes what it takes where the case leaves a choice open.
const WHY_CHOSEN: [(&str, &str); 11] = [
    ("method", "default: computes any plate and the path of its cracks"),
    ("bond_law", "default: takes Poisson's ratio from the material instead of fixing it"),
    ("kernel", "default: of the kernels tried, its crack growth depends least on the lattice"),
    ("rotation", "default: rigid rotation of crack flanks must cost no energy"),
    ("surface_correction", "default: the most accurate one built"),
    ("discretisation", "default: one spacing everywhere"),
    ("spacing_mm", "default: the smaller of crack length / 9 and width / 100"),
    ("horizon_ratio", "default: 3.015, three neighbours in every lattice direction"),
    ("lattice_angle_deg", "default: lattice rows along x"),
    ("solver", "default: the fastest exact one built"),
    ("symmetry", "default: exact"),
];

/// Why the default bond law is not taken.
const BEYOND_SPRINGS: &str = "chosen: springs alone cannot have this Poisson's ratio";

fn why_text(case: &Case, prediction: &Prediction, key: &str, reason: &str) -> String {
    let given = case.echo.get("model").and_then(|model| model.get(key)).is_some();
    let recorded = match &case.law {
        // A record of hand calculation fixes nothing.
        LawSource::Fitted(record) => record.rate_constant.is_some() && FIXED_BY_RECORD.contains(&key),
        _ => false,
    };
    let source = match (given, recorded) {
        (true, _) => "given in the case",
        (false, true) => "as in the fitted record: the law holds for this choice only",
        (false, false) if key == "bond_law" && case.model.bond_law.kind == BondLawKind::StateBased => BEYOND_SPRINGS,
        (false, false) => reason,
    };
    let (asked, actual) = (case.model.spacing / MM, prediction.figures.spacing / MM);
    if key == "spacing_mm" {
        let finest = if case.model.refinement.is_some() { "; that of the finest level, on which cracks grow" } else { "" };
        let is_moved = ((asked - actual) / actual).abs() > 1e-9;
        let moved =
            if is_moved { format!("; moved from {asked:.6} to {actual:.6} so that it divides the width") } else { String::new() };
        return format!("{source}{finest}{moved}");
    }
    if key == "symmetry" {
        return format!("{source}; {}", solved_part(prediction));
    }
    source.to_owned()
}

/// How much of the plate was solved for.
fn solved_part(prediction: &Prediction) -> &'static str {
    let (all, solved) = (prediction.figures.points, prediction.figures.points_solved);
    // A line of symmetry through a row of points leaves half a row more.
    match (solved == all, 3 * solved > all) {
        (true, _) => "the whole plate was solved",
        (false, true) => "one half was solved, the other is its mirror image",
        (false, false) => "a quarter was solved, the others are its mirror images",
    }
}

/// Choices that a fitted law is meaningless without.
const FIXED_BY_RECORD: [&str; 5] = ["bond_law", "kernel", "rotation", "surface_correction", "horizon_ratio"];

/// The constants as given, and A as it was used: at this run's horizon, modulus and stress ratio.
fn law(case: &Case, prediction: &Prediction) -> Value {
    let hand = !case.spends_bond_life();
    let used = case.fatigue_law(prediction.figures.horizon).ok().filter(|_| !hand).map(|law| law.a);
    let c_used = paris_law(case).ok().filter(|_| hand).map(|law| clean(law.c / MM_PER_CYCLE));
    match &case.law {
        LawSource::Inline(law) => {
            json!({ "source": "inline", "a": law.a, "p": law.p, "horizon_mm": clean(law.horizon / MM), "a_used": used,
                "paris_c_used_mm_per_cycle": c_used })
        }
        LawSource::Paris(law) => json!({
            "source": "inline", "paris_c_mm_per_cycle": clean(law.c / MM_PER_CYCLE), "paris_m": law.m,
            "paris_c_used_mm_per_cycle": c_used,
        }),
        LawSource::Fitted(record) => json!({
            "source": "fitted", "a": record.a, "p": record.p, "rate_constant": record.rate_constant, "horizon_mm": record.horizon_mm, "a_used": used,
            "paris_c_mm_per_cycle": record.paris_c_mm_per_cycle, "paris_m": record.paris_m,
            "paris_m_error": record.paris_m_error, "paris_c_used_mm_per_cycle": c_used, "p_error": record.p_error,
            "pivot_delta_k_mpa_sqrt_m": record.pivot_delta_k_mpa_sqrt_m,
            "rate_at_pivot_mm_per_cycle": record.rate_at_pivot_mm_per_cycle,
            "rate_at_pivot_relative_error": record.rate_at_pivot_relative_error,
            "delta_k_min_mpa_sqrt_m": record.delta_k_min_mpa_sqrt_m, "delta_k_max_mpa_sqrt_m": record.delta_k_max_mpa_sqrt_m,
        }),
        LawSource::Factor(law) => json!({ "source": "inline", "constants_si": law }),
        LawSource::Missing(path) => json!({ "source": "missing", "file": path }),
    }
}

/// Hides the last digits of a double, which a unit conversion may have disturbed.
pub(super) fn clean(value: f64) -> f64 {
    format!("{value:.14e}").parse().unwrap_or(value)
}
