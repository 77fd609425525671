//! `result.json`: the figures of a run, the law it used, and the case as it was given.

use serde_json::{Value, json};

use perilife_base::units::{MM, MM_PER_CYCLE, MPA, MPA_SQRT_M};
use perilife_growth::case::{Case, LawSource};
use perilife_growth::end_of_life::{critical_length, critical_lengths};
use perilife_growth::predict::judgement::judge;
use perilife_growth::predict::laws::paris_law;
use perilife_growth::predict::part_through::PartThroughLife;
use perilife_growth::predict::plastic_zone::{self, Zone};
use perilife_growth::predict::{CurvePoint, GoverningCrack, Prediction, StopReason};
use perilife_growth::record::TipRecord;
use perilife_plate::specimen::part_through::{BREAK_THROUGH, Limit, STATED_ERROR};

use super::checks;
use super::model_words::{self, clean};
pub use perilife_growth::predict::fit_use::life_share_extrapolated;

/// Name of the file.
pub const RESULT_FILE: &str = "result.json";

/// The whole object. A figure that does not exist (no fitted range to compare with, no ΔK) is `null`.
pub fn result(case: &Case, prediction: &Prediction) -> Value {
    let figures = &prediction.figures;
    let judged = judge(case, prediction).unwrap_or_default();
    // What the run found comes first: it counts more than what an assumption may do.
    let warnings: Vec<&String> = prediction.warnings.iter().chain(&judged).chain(&case.warnings).collect();
    let checks = checks::of_run(case, prediction);
    let governing = GoverningCrack::of(&case.specimen, &prediction.curve);
    let length = |row: Option<&CurvePoint>| row.map_or(f64::NAN, |row| governing.length(row) / MM);
    json!({
        "name": case.name,
        "life_cycles": prediction.life(),
        "passes": super::spectrum::passes(case, prediction),
        "life_is_lower_bound": checks::is_bound_below(case, prediction),
        "stop_reason": prediction.stop.name(),
        "stop_meaning": prediction.stop.meaning(),
        "converged": prediction.stop != StopReason::NoConvergence,
        "crack_length_initial_mm": clean(length(prediction.curve.first())),
        "crack_length_final_mm": clean(length(prediction.curve.last())),
        "critical": critical(case, prediction),
        "tips": tips(case, prediction),
        "part_through": part_through(case, prediction),
        "phase_one": phase_one(prediction),
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
        "spectrum": super::spectrum::json(case, prediction),
        "model": model_words::object(&model_words::of_case(case, Some(figures))),
        "law": law(case, prediction),
        "verdict": checks::verdict(&checks),
        "checks": checks::json(&checks),
        "warnings": warnings,
        "version": env!("CARGO_PKG_VERSION"),
        "case": case.echo,
    })
}

/// The crack length at which the plate no longer bears its load, by what, and by toughness and net section alone as far as formulas say
/// them; `null` where the run did not come to it and no formula
/// says it.
fn critical(case: &Case, prediction: &Prediction) -> Value {
    let length = |row| GoverningCrack::of(&case.specimen, &prediction.curve).length(row);
    let by_run = prediction.curve.last().filter(|_| prediction.stop.is_strength()).map(|row| (length(row), prediction.stop));
    let by_formula = || critical_length(case).map(|end| (end.crack_length, end.reason));
    let [toughness, net_section] = critical_lengths(case).map(|end| end.map(|end| clean(end.crack_length / MM)));
    by_run.or_else(by_formula).map_or(Value::Null, |(length, reason)| {
        json!({
            "crack_length_mm": clean(length / MM),
            "criterion": reason.name(),
            "meaning": reason.meaning(),
            "by_toughness_mm": toughness,
            "by_net_section_mm": net_section,
        })
    })
}

/// The part of a life before its cracks had formed; `null` where they were there at N = 0.
fn phase_one(prediction: &Prediction) -> Value {
    prediction.phase_one.map_or(Value::Null, |phase| {
        json!({
            "cycles": phase.cycles,
            "stress_range_mpa": clean(phase.range / MPA),
            "stress_concentration": phase.concentration,
            "at_mm": phase.at.map(|x| clean(x / MM)),
            "growth_cycles": phase.cycles.map(|cycles| (prediction.life_cycles() - cycles).max(0.0)),
        })
    })
}

/// What became of a crack that did not go through at the start; `null` of through cracks.
fn part_through(case: &Case, prediction: &Prediction) -> Value {
    let found = case.specimen.part_through.zip(PartThroughLife::of(case, &prediction.curve));
    let Some((flaw, PartThroughLife { cycles, axes, is_through, life_factors, outside, .. })) = found else { return Value::Null };
    let life = prediction.life_cycles();
    let [depth, length] = axes.map(|length| clean(length / MM));
    let share = |(limit, cycles): &(&Limit, f64)| json!({ "of": limit.name, "range": [limit.low, limit.high], "life_share": clean(cycles / life) });
    json!({
        "kind": flaw.kind().name(),
        "cycles_at_break_through": is_through.then_some(cycles),
        "crack_length_at_break_through_mm": is_through.then_some(length),
        "crack_depth_initial_mm": clean(flaw.depth / MM),
        "crack_depth_final_mm": depth,
        "aspect_ratio_final": clean(axes[0] / axes[1]),
        "depth_over_thickness": clean(axes[0] / flaw.through_depth()),
        "rule": BREAK_THROUGH,
        "k_error_percent": 100.0 * STATED_ERROR,
        "life_cycles_if_k_is_larger": life * life_factors[0],
        "life_cycles_if_k_is_smaller": Some(life * life_factors[1]).filter(|cycles| cycles.is_finite()),
        "outside_range": outside.iter().map(share).collect::<Vec<_>>(),
    })
}

/// Every tip at the start and at the end: state, place, growth; of a plate also its crack, and which of them ends the life.
fn tips(case: &Case, prediction: &Prediction) -> Vec<Value> {
    let [Some(first), Some(last)] = [prediction.curve.first(), prediction.curve.last()] else { return Vec::new() };
    let leads = prediction.leading_tip(&case.specimen).map(|(tip, _)| tip);
    let of_tip = |(tip, (start, end)): (usize, (&TipRecord, &TipRecord))| {
        json!({
            "crack": case.specimen.line_end(tip).filter(|_| leads.is_some()).map(|end| end.line),
            "leads": leads.is_none_or(|leads| leads == tip),
            "crack_length_initial_mm": first.crack_length_of(&case.specimen, tip).filter(|_| leads.is_some()).map(|length| clean(length / MM)),
            "crack_length_final_mm": last.crack_length_of(&case.specimen, tip).filter(|_| leads.is_some()).map(|length| clean(length / MM)),
            "state_initial": start.state.name(),
            "state": end.state.name(),
            "x_mm": clean(end.position[0] / MM),
            "y_mm": clean(end.position[1] / MM),
            "growth_mm": clean(end.growth / MM),
        })
    };
    first.tips.iter().zip(&last.tips).enumerate().map(of_tip).collect()
}

/// Plastic zone at the first and the last row whose K is known; `null` without yield strength.
fn plastic_zone(case: &Case, prediction: &Prediction) -> Value {
    let Some(found) = plastic_zone::plastic_zone(case, &prediction.curve) else { return Value::Null };
    let zone = |zone: &Zone| {
        json!({
            "crack_length_mm": clean(zone.crack_length / MM),
            "k_max_mpa_sqrt_m": clean(zone.k_max / MPA_SQRT_M),
            "size_mm": clean(zone.size / MM),
            "over_horizon": clean(zone.size / prediction.figures.horizon),
            "ligament_mm": clean(zone.ligament / MM),
            "over_ligament": clean(zone.size / zone.ligament),
            // Of cracks from a rim of a plate.
            "over_crack": Some(zone.size / zone.crack).filter(|_| zone.crack.is_finite()).map(clean),
            "over_thickness": clean(zone.size / case.specimen.thickness),
        })
    };
    json!({
        "first": zone(&found.first),
        "last": zone(&found.last),
        "small_scale_yielding": found.too_large_from.is_none(),
        "too_large_from_mm": found.too_large_from.map(|length| clean(length / MM)),
        "too_large_to_mm": found.too_large_to.map(|length| clean(length / MM)),
        "life_share_too_large": clean(found.life_share_too_large),
    })
}

/// The constants as given, and A as it was used: at this run's horizon, modulus and stress ratio.
fn law(case: &Case, prediction: &Prediction) -> Value {
    let hand = !case.spends_bond_life();
    let used = case.fatigue_law(prediction.figures.horizon).ok().filter(|_| !hand).map(|law| law.a);
    let c_used = paris_law(case).ok().filter(|_| hand).map(|law| clean(law.c / MM_PER_CYCLE));
    let source = if case.law_record.is_some() { "fitted" } else { "inline" };
    let mut law = match &case.law {
        LawSource::Inline(law) => {
            json!({ "source": "inline", "a": law.a, "p": law.p, "horizon_mm": clean(law.horizon / MM), "a_used": used,
                "paris_c_used_mm_per_cycle": c_used })
        }
        LawSource::Paris(law) => json!({
            "source": source, "paris_c_mm_per_cycle": clean(law.c / MM_PER_CYCLE), "paris_m": law.m,
            "paris_c_used_mm_per_cycle": c_used,
        }),
        LawSource::Fitted(record) => json!({
            "source": "fitted", "law": record.law, "curve": record.curve, "a": record.a, "p": record.p, "rate_constant": record.rate_constant, "horizon_mm": record.horizon_mm, "a_used": used,
            "paris_c_mm_per_cycle": record.paris_c_mm_per_cycle, "paris_m": record.paris_m,
            "paris_m_error": record.paris_m_error, "paris_c_used_mm_per_cycle": c_used, "p_error": record.p_error,
            "pivot_delta_k_mpa_sqrt_m": record.pivot_delta_k_mpa_sqrt_m,
            "rate_at_pivot_mm_per_cycle": record.rate_at_pivot_mm_per_cycle,
            "rate_at_pivot_relative_error": record.rate_at_pivot_relative_error,
            "delta_k_min_mpa_sqrt_m": record.delta_k_min_mpa_sqrt_m, "delta_k_max_mpa_sqrt_m": record.delta_k_max_mpa_sqrt_m,
        }),
        LawSource::Factor(law) => json!({ "source": source, "constants_si": law.constants_si() }),
        LawSource::Missing(path) => json!({ "source": "missing", "file": path }),
    };
    if let (Some(record), Some(object)) = (&case.law_record, law.as_object_mut()) {
        object.insert("record".to_owned(), json!(record));
    }
    law
}
