//! Reasons to stop a run.

use super::StopReason;
use super::curve::Track;
use crate::case::Case;
use crate::fatigue::ageing::AgeingBond;
use crate::fatigue::crack_tip::{CrackTip, TipState};

/// Reasons that show before a block: no tip is left, or nothing ages.
pub(super) fn before_block(case: &Case, tips: &[CrackTip], ageing: &[AgeingBond]) -> Option<StopReason> {
    let gone = !tips.is_empty() && tips.iter().all(|tip| !tip.is_active());
    if gone && case.fatigue.ageing == crate::fatigue::Ageing::CrackTip {
        let entered = tips.iter().any(|tip| tip.state == TipState::EnteredHole);
        return Some(if entered { StopReason::EnteredHole } else { StopReason::LeftPlate });
    }
    ageing.is_empty().then_some(StopReason::NothingAges)
}

/// Reasons that show after a block: length reached, toughness, net-section yield.
pub(super) fn after_block(case: &Case, track: &Track) -> Option<StopReason> {
    let length = track.last().crack_length;
    let horizon = case.model.horizon_ratio * case.model.spacing;
    // A spacing more, so that the length averaged over a spacing of growth is known up to there; the curve ends at the length.
    if length >= case.stop.crack_length + case.model.spacing {
        return Some(StopReason::CrackLengthReached);
    }
    if let Some(toughness) = case.material.toughness
        && track.k_max(case, horizon) >= toughness
    {
        return Some(StopReason::Toughness);
    }
    if let (Some(strength), Some(stress)) =
        (case.material.yield_strength, case.specimen.net_section_stress(length, case.loading.maximum))
        && stress >= strength
    {
        return Some(StopReason::NetSectionYield);
    }
    None
}

/// The reason that counts where a run had passed the length to stop at before it ended for another one.
pub(super) fn settled(case: &Case, track: &Track, stop: StopReason) -> StopReason {
    if track.last().crack_length >= case.stop.crack_length { StopReason::CrackLengthReached } else { stop }
}
