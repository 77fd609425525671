//! How far a run stays within what its law was fitted to, and how sure that law is.
//!
//! Under a spectrum the cycles that grow the crack count, by their shares of the growth at every K, and not its largest cycle.

use super::laws::{growth_law, law_of_cycle};
use super::{CurvePoint, Prediction};
use crate::case::record::FittedRecord;
use crate::case::{Case, LawSource, Model};
use perilife_base::units::MPA_SQRT_M;
use perilife_laws::growth_law::{Acting, GrowthLaw};
use perilife_laws::response::Response;
use perilife_plate::loading::SAME_RATIO;

/// Share of life above the tested ΔK from which a run is refused unless the case allows it: the life there is overestimated.
pub const EXTRAPOLATION_REFUSED: f64 = 0.25;
/// Share of the growth at other stress ratios that is warned about.
const NAMED: f64 = 0.01;
/// Change of K over which shares of growth are kept.
const SHARES_KEPT: f64 = 0.02;

/// Share of the life at a ΔK outside the tested range, 0 to 1; `None` without a fitted law, life, or ΔK.
pub fn life_share_extrapolated(case: &Case, prediction: &Prediction) -> Option<f64> {
    let [low, high] = fitted_range(case)?;
    life_share_outside(case, prediction, low, high)
}

/// Shares of the life below and above the tested range; `None` as [`life_share_extrapolated`].
pub fn life_shares_outside(case: &Case, prediction: &Prediction) -> Option<[f64; 2]> {
    let [low, high] = fitted_range(case)?;
    Some([life_share_outside(case, prediction, low, f64::INFINITY)?, life_share_outside(case, prediction, 0.0, high)?])
}

/// Warning of cycles of a spectrum at other stress ratios than those of a table; the checks have those of a fitted law.
pub fn of_other_ratios(case: &Case, prediction: &Prediction) -> Option<String> {
    case.loading.spectrum.as_ref().filter(|_| fitted_ratios(case).is_none())?;
    let law = law_of_cycle(case).ok()?;
    let of_table = |acting: &Acting, _| if law.beyond_ratio(acting.ratio).is_some() { 1.0 } else { 0.0 };
    let share = life_share(case, &prediction.curve, &of_table).filter(|share| *share > NAMED)?;
    Some(format!("law: {:.1} % of the growth is by cycles at stress ratios outside those of the law", 100.0 * share))
}

/// The fitted law in words: rate at the reference ΔK and m with their errors; `None` for constants given without errors.
pub fn law_line(case: &Case) -> Option<String> {
    let record = fitted(case)?;
    let m_error = record.paris_m_error;
    let exponent = match case.model {
        Model::Points(_) => format!("p = {:.4} ± {:.4}, m", record.p, record.p_error),
        Model::Handbook(_) | Model::Nodes(_) => "m".to_owned(),
    };
    let curve = if record.curve.is_some() { "curve of the rates; its power law " } else { "" };
    Some(format!(
        "{curve}{:.4e} mm/cycle ± {:.1} % at ΔK = {:.2} MPa√m, {exponent} = {:.4} ± {m_error:.4} ({}, R = {})",
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
fn life_share_outside(case: &Case, prediction: &Prediction, low: f64, high: f64) -> Option<f64> {
    let (low, high) = (low * MPA_SQRT_M, high * MPA_SQRT_M);
    life_share(case, &prediction.curve, &|acting, [from, to]| {
        share_outside(from * acting.delta_k, to * acting.delta_k, low, high)
    })
}

/// Share of the life by growth of cycles of which a share is told, by their size in the middle of a block and what ΔK is over that at its ends.
fn life_share(case: &Case, curve: &[CurvePoint], of: &dyn Fn(&Acting, [f64; 2]) -> f64) -> Option<f64> {
    let law = growth_law(case).ok()?;
    let (mut counted, mut known, mut kept) = (0.0, 0.0, (0.0, Vec::new()));
    for pair in curve.windows(2) {
        let cycles = pair[1].cycles - pair[0].cycles;
        // Up to a row whose K nobody read, that of the other end counts.
        let (from, to) = (pair[0].delta_k.min(pair[1].delta_k), pair[0].delta_k.max(pair[1].delta_k));
        if from.is_nan() {
            continue;
        }
        let middle = 0.5 * (from + to);
        if kept.1.is_empty() || (middle / kept.0 - 1.0_f64).abs() > SHARES_KEPT || !pair[1].response.is_proportional() {
            let k_max = middle / pair[1].range_share(&case.loading);
            kept = (middle, law.acting(k_max, case.loading.ratio, &pair[1].response));
        }
        known += cycles;
        let ends = if kept.0 > 0.0 { [from / kept.0, to / kept.0] } else { [1.0; 2] };
        counted += cycles * kept.1.iter().map(|acting| acting.share * of(acting, ends)).sum::<f64>();
    }
    (known > 0.0).then(|| counted / known)
}

/// The cycles that act at a ΔK of the largest, Pa√m, of K in proportion to the load.
fn acting(case: &Case, law: &dyn GrowthLaw, delta_k: f64) -> Vec<Acting> {
    law.acting(delta_k / case.loading.range_share(), case.loading.ratio, &Response::PROPORTIONAL)
}

/// Shares of the growth at a ΔK of the largest cycle, Pa√m, by cycles below and above the fitted range of ΔK.
pub fn growth_shares_outside(case: &Case, delta_k: f64) -> Option<[f64; 2]> {
    let [low, high] = fitted_range(case)?.map(|k| k * MPA_SQRT_M);
    let acting = acting(case, &*growth_law(case).ok()?, delta_k);
    let share = |from: f64, to: f64| acting.iter().map(|one| one.share * share_outside(one.delta_k, one.delta_k, from, to)).sum();
    Some([share(low, f64::INFINITY), share(0.0, high)])
}

/// Smallest and largest stress ratio that the law of a case was fitted to.
pub fn fitted_ratios(case: &Case) -> Option<[f64; 2]> {
    let of_record = case.law_record.as_ref().map(|record| [record.stress_ratio_min, record.stress_ratio_max]);
    of_record.or(fitted(case).map(|record| [record.stress_ratio; 2]))
}

/// Share of the growth at other R than tested: over a run, or at the middle of the tested ΔK.
pub fn share_of_other_ratios(case: &Case, prediction: Option<&Prediction>) -> Option<f64> {
    let ([low, high], range) = (fitted_ratios(case)?, fitted_range(case)?);
    let of = |acting: &Acting, _| {
        if (low - SAME_RATIO..=high + SAME_RATIO).contains(&acting.ratio) { 0.0 } else { 1.0 }
    };
    let middle = (range[0] * range[1]).sqrt() * MPA_SQRT_M;
    let at_once = || Some(acting(case, &*growth_law(case).ok()?, middle).iter().map(|one| one.share * of(one, [1.0; 2])).sum());
    prediction.and_then(|prediction| life_share(case, &prediction.curve, &of)).or_else(at_once)
}

/// Share of the interval `from..to` outside `low..high`, whose ends have a margin of 1e-6.
fn share_outside(from: f64, to: f64, low: f64, high: f64) -> f64 {
    let (low, high) = (low * (1.0 - 1e-6), high * (1.0 + 1e-6));
    if to - from <= 1e-12 * to {
        return if (low..=high).contains(&from) { 0.0 } else { 1.0 };
    }
    1.0 - (to.min(high) - from.max(low)).max(0.0) / (to - from)
}
