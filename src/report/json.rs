//! `result.json`: the figures of a run, what model computed it and why, and the case as it was given.

use serde_json::{Map, Value, json};

use crate::case::{Case, LawSource};
use crate::predict::{Prediction, StopReason};
use crate::units::{MM, MPA_SQRT_M};

/// Name of the file.
pub const RESULT_FILE: &str = "result.json";

/// The whole object. A figure that does not exist (no fitted range to compare with, no ΔK) is `null`.
#[must_use]
pub fn result(case: &Case, prediction: &Prediction) -> Value {
    let figures = &prediction.figures;
    let warnings: Vec<&String> = case.warnings.iter().chain(&prediction.warnings).collect();
    json!({
        "name": case.name,
        "life_cycles": prediction.life_cycles(),
        "stop_reason": prediction.stop.name(),
        "stop_meaning": prediction.stop.meaning(),
        "converged": prediction.stop != StopReason::NoConvergence,
        "crack_length_initial_mm": clean(case.specimen.crack_length / MM),
        "crack_length_final_mm": clean(prediction.crack_length_final() / MM),
        "life_share_extrapolated": life_share_extrapolated(case, prediction),
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
    let (model, figures) = (&case.model, &prediction.figures);
    let values = json!({
        "method": "peridynamics",
        "bond_law": model.bond_law.kind.name(),
        "kernel": model.bond_law.kernel.name(),
        "rotation": model.bond_law.rotation.name(),
        "surface_correction": model.bond_law.surface_correction.name(),
        "spacing_mm": clean(figures.spacing / MM),
        "horizon_ratio": model.horizon_ratio,
        "horizon_mm": clean(figures.horizon / MM),
        "lattice_angle_deg": clean(model.lattice_angle.to_degrees()),
        "solver": model.solver.name(),
    });
    let why: Map<String, Value> =
        WHY_CHOSEN.iter().map(|(key, reason)| ((*key).to_owned(), why_text(case, prediction, key, reason).into())).collect();
    let mut object = values.as_object().cloned().unwrap_or_default();
    object.insert("why".to_owned(), Value::Object(why));
    Value::Object(object)
}

/// Why the program takes what it takes where the case leaves a choice open.
const WHY_CHOSEN: [(&str, &str); 9] = [
    ("method", "the only method built"),
    ("bond_law", "default: takes Poisson's ratio from the material instead of fixing it"),
    ("kernel", "default: of the kernels tried, its crack growth depends least on the lattice"),
    ("rotation", "default: rigid rotation of crack flanks must cost no energy"),
    ("surface_correction", "default: the most accurate one built"),
    ("spacing_mm", "default: the smaller of crack length / 9 and width / 100"),
    ("horizon_ratio", "default: 3.015, three neighbours in every lattice direction"),
    ("lattice_angle_deg", "default: lattice rows along x"),
    ("solver", "default: the fastest exact one built"),
];

fn why_text(case: &Case, prediction: &Prediction, key: &str, reason: &str) -> String {
    let given = case.echo.get("model").and_then(|model| model.get(key)).is_some();
    let recorded = matches!(case.law, LawSource::Fitted(_)) && FIXED_BY_RECORD.contains(&key);
    let source = match (given, recorded) {
        (true, _) => "given in the case",
        (false, true) => "as in the fitted record: the law holds for this choice only",
        (false, false) => reason,
    };
    let (asked, actual) = (case.model.spacing / MM, prediction.figures.spacing / MM);
    if key == "spacing_mm" && ((asked - actual) / actual).abs() > 1e-9 {
        return format!("{source}; moved from {asked:.6} to {actual:.6} so that it divides the width");
    }
    source.to_owned()
}

/// Choices that a fitted law is meaningless without.
const FIXED_BY_RECORD: [&str; 5] = ["bond_law", "kernel", "rotation", "surface_correction", "horizon_ratio"];

/// The constants as given, and A as it was used: at this run's horizon, modulus and stress ratio.
fn law(case: &Case, prediction: &Prediction) -> Value {
    let used = case.fatigue_law(prediction.figures.horizon).ok().map(|law| law.a);
    match &case.law {
        LawSource::Inline(law) => {
            json!({ "source": "inline", "a": law.a, "p": law.p, "horizon_mm": clean(law.horizon / MM), "a_used": used })
        }
        LawSource::Fitted(record) => json!({
            "source": "fitted", "a": record.a, "p": record.p, "horizon_mm": record.horizon_mm, "a_used": used,
            "paris_c_mm_per_cycle": record.paris_c_mm_per_cycle, "paris_m": record.paris_m,
            "delta_k_min_mpa_sqrt_m": record.delta_k_min_mpa_sqrt_m, "delta_k_max_mpa_sqrt_m": record.delta_k_max_mpa_sqrt_m,
        }),
        LawSource::Missing(path) => json!({ "source": "missing", "file": path }),
    }
}

/// Share of the life that was spent at a ΔK outside the range the law was fitted to, 0 to 1; ΔK is taken linear in N
/// within each block. `None` without a fitted record, without life, or without any known ΔK.
#[must_use]
pub fn life_share_extrapolated(case: &Case, prediction: &Prediction) -> Option<f64> {
    let LawSource::Fitted(record) = &case.law else { return None };
    let (low, high) = (record.delta_k_min_mpa_sqrt_m * MPA_SQRT_M, record.delta_k_max_mpa_sqrt_m * MPA_SQRT_M);
    let (mut outside, mut known) = (0.0, 0.0);
    for pair in prediction.curve.windows(2) {
        let (from, to) = (pair[0].delta_k, pair[1].delta_k);
        let cycles = pair[1].cycles - pair[0].cycles;
        if from.is_nan() || to.is_nan() {
            continue;
        }
        known += cycles;
        outside += cycles * share_outside(from.min(to), from.max(to), low, high);
    }
    (known > 0.0).then(|| outside / known)
}

/// Share of the interval `from..to` that lies outside `low..high`. The ends of the range count as inside with a margin of
/// 1e-6, for a curve that starts where the fit started.
fn share_outside(from: f64, to: f64, low: f64, high: f64) -> f64 {
    let (low, high) = (low * (1.0 - 1e-6), high * (1.0 + 1e-6));
    if to - from <= 1e-12 * to {
        return if (low..=high).contains(&from) { 0.0 } else { 1.0 };
    }
    1.0 - (to.min(high) - from.max(low)).max(0.0) / (to - from)
}

/// Hides the last digits of a double, which a unit conversion may have disturbed.
fn clean(value: f64) -> f64 {
    format!("{value:.14e}").parse().unwrap_or(value)
}
