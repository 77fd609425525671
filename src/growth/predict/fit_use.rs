//! How far a run stays within what its law was fitted to, and how sure that law is.

use super::Prediction;
use crate::case::record::FittedRecord;
use crate::case::{Case, LawSource, Model};
use perilife_base::units::MPA_SQRT_M;

/// Share of life outside the fitted ΔK range above which a run is warned about, and of a side of the range that is named then.
const WARNED: f64 = 0.05;
/// Share of life above the fitted range from which a run is refused unless the case allows it: there cracks grow faster than computed.
pub const EXTRAPOLATION_REFUSED: f64 = 0.25;
const NAMED: f64 = 0.01;

/// Share of the life that was spent at a ΔK outside the range the law was fitted to, 0 to 1; ΔK is taken linear in N
/// within each block. `None` without a fitted record, without life, or without any known ΔK.
pub fn life_share_extrapolated(case: &Case, prediction: &Prediction) -> Option<f64> {
    let [low, high] = fitted_range(case)?;
    life_share_outside(prediction, low, high)
}

/// Share of the life below the fitted range, where lives come out too short, and above it, where they come out too long; `None` as
/// [`life_share_extrapolated`].
pub fn life_shares_outside(case: &Case, prediction: &Prediction) -> Option<[f64; 2]> {
    let [low, high] = fitted_range(case)?;
    Some([life_share_outside(prediction, low, f64::INFINITY)?, life_share_outside(prediction, 0.0, high)?])
}

/// What is to be said about life outside the fitted range of ΔK, the larger share first.
pub fn extrapolated(case: &Case, prediction: &Prediction) -> Vec<String> {
    let share = life_share_extrapolated(case, prediction).filter(|share| *share > WARNED);
    let Some([low, high]) = fitted_range(case).filter(|_| share.is_some()) else { return Vec::new() };
    let threshold = if case.fatigue.threshold > 0.0 { "" } else { ", or give fatigue.delta_k_threshold_mpa_sqrt_m" };
    let below = (
        life_share_outside(prediction, low, f64::INFINITY),
        format!(
            "below {low:.2} MPa√m, the lowest fitted value: near a threshold cracks grow slower than computed; calibrate on slower \
             growth{threshold}"
        ),
    );
    let above = (
        life_share_outside(prediction, 0.0, high),
        format!(
            "above {high:.2} MPa√m, the highest fitted value: near toughness cracks grow faster than computed; calibrate on longer cracks, \
             or end the life sooner by stop.crack_length_mm"
        ),
    );
    let mut sides: Vec<(f64, String)> =
        [below, above].into_iter().filter_map(|(share, words)| Some((share.filter(|share| *share > NAMED)?, words))).collect();
    sides.sort_by(|a, b| b.0.total_cmp(&a.0));
    sides.into_iter().map(|(share, words)| format!("{:.1} % of the life is spent at ΔK {words}", 100.0 * share)).collect()
}

/// The law of a record in words: rate at the pivot and m with their errors, never A alone. `None` for inline constants, whose
/// errors nobody knows.
pub fn law_line(case: &Case) -> Option<String> {
    let record = fitted(case)?;
    let m_error = record.paris_m_error;
    let exponent = match case.model {
        Model::Points(_) => format!("p = {:.4} ± {:.4}, m", record.p, record.p_error),
        Model::Handbook(_) | Model::Nodes(_) => "m".to_owned(),
    };
    Some(format!(
        "{:.4e} mm/cycle ± {:.1} % at ΔK = {:.2} MPa√m, {exponent} = {:.4} ± {m_error:.4} ({}, R = {})",
        record.rate_at_pivot_mm_per_cycle,
        100.0 * record.rate_at_pivot_relative_error,
        record.pivot_delta_k_mpa_sqrt_m,
        record.paris_m,
        record.material,
        record.stress_ratio
    ))
}

/// Smallest and largest ΔK that the law of a case was fitted to, MPa√m.
pub fn fitted_range(case: &Case) -> Option<[f64; 2]> {
    let of_bonds = fitted(case).map(|record| [record.delta_k_min_mpa_sqrt_m, record.delta_k_max_mpa_sqrt_m]);
    let over_k = case.law_record.as_ref().map(|record| [record.delta_k_min_mpa_sqrt_m, record.delta_k_max_mpa_sqrt_m]);
    over_k.or(of_bonds)
}

fn fitted(case: &Case) -> Option<&FittedRecord> {
    match &case.law {
        LawSource::Fitted(record) => Some(record),
        _ => None,
    }
}

/// Share of the life at a ΔK outside `low..=high`, MPa√m.
fn life_share_outside(prediction: &Prediction, low: f64, high: f64) -> Option<f64> {
    let (low, high) = (low * MPA_SQRT_M, high * MPA_SQRT_M);
    let (mut outside, mut known) = (0.0, 0.0);
    for pair in prediction.curve.windows(2) {
        let cycles = pair[1].cycles - pair[0].cycles;
        // Up to a row whose K nobody read, that of the other end counts.
        let (from, to) = (pair[0].delta_k.min(pair[1].delta_k), pair[0].delta_k.max(pair[1].delta_k));
        if from.is_nan() {
            continue;
        }
        known += cycles;
        outside += cycles * share_outside(from, to, low, high);
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
