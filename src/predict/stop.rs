//! Reasons to stop a run.

use super::StopReason;
use super::curve::Track;
use super::end_of_life::End;
use crate::case::Case;
use crate::fatigue::ageing::AgeingBond;
use crate::fatigue::crack_tip::{CrackTip, TipState};

/// Reasons that show before a block: the crack is too long for its load, no tip is left, or nothing ages.
pub(super) fn before_block(
    case: &Case,
    end: Option<End>,
    track: &Track,
    tips: &[CrackTip],
    ageing: &[AgeingBond],
) -> Option<StopReason> {
    if let Some(end) = end.filter(|end| track.last().crack_length >= end.crack_length) {
        return Some(end.reason);
    }
    // Where no handbook knows K, the energy released so far does.
    let horizon = case.model.horizon_ratio * case.model.spacing;
    let released = case.material.toughness.zip(track.k_max_released(case, horizon));
    if released.is_some_and(|(toughness, k_max)| k_max >= toughness) {
        return Some(StopReason::Toughness);
    }
    let gone = !tips.is_empty() && tips.iter().all(|tip| !tip.is_active());
    if gone && case.fatigue.ageing == crate::fatigue::Ageing::CrackTip {
        let entered = tips.iter().any(|tip| tip.state == TipState::EnteredHole);
        return Some(if entered { StopReason::EnteredHole } else { StopReason::LeftPlate });
    }
    ageing.is_empty().then_some(StopReason::NothingAges)
}

/// Reasons that show after a block: a known end is reached. The last row is shortened to it.
pub(super) fn after_block(end: Option<End>, track: &mut Track) -> Option<StopReason> {
    let end = end.filter(|end| track.last().crack_length >= end.crack_length)?;
    track.end_at(end.crack_length);
    Some(end.reason)
}
