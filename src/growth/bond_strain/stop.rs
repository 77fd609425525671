//! Reasons to stop a run.

use super::history::GrowthHistory;
use crate::body::Body;
use crate::case::Case;
use crate::fatigue::FatigueSettings;
use crate::fatigue::ageing::FatigueBond;
use crate::fatigue::crack_tip::{CrackTip, TipState};
use crate::growth::end_of_life::End;
use crate::growth::record::StopReason;
use crate::levels::multi_level_body::clear_way;
use crate::specimen::Point;

/// Reasons that show before a block: the crack is too long for its load, no tip is left, or nothing ages.
pub(super) fn before_block(
    case: &Case,
    end: Option<End>,
    track: &GrowthHistory,
    tips: &[CrackTip],
    ageing: &[FatigueBond],
) -> Option<StopReason> {
    if let Some(end) = end.filter(|end| end.crack_length <= case.specimen.crack_length && track.is_counting()) {
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

/// Where an active tip has come so near the rim of the finest level that its growth would not be that on fine points, m; `None` in
/// a plate of one level.
pub(super) fn at_rim(body: &Body, tips: &[CrackTip], settings: &FatigueSettings) -> Option<Point> {
    let reach = clear_way(body.horizon(), settings.zone_radius_horizons);
    tips.iter().find(|tip| tip.is_active() && body.is_near_rim(tip.position, reach)).map(|tip| tip.position)
}

/// Reasons that show after a block: a known end is passed. The run goes on for a spacing more, so that the length averaged over
/// a spacing of growth is known up to the end; the curve stops there.
pub(super) fn after_block(case: &Case, end: Option<End>, track: &GrowthHistory) -> Option<StopReason> {
    end.filter(|end| track.last().crack_length >= end.crack_length + case.model.spacing).map(|end| end.reason)
}

/// The reason that counts where a run had passed a known end before it stopped for another reason.
pub(super) fn settled(end: Option<End>, track: &GrowthHistory, stop: StopReason) -> StopReason {
    end.filter(|end| track.last().crack_length >= end.crack_length).map_or(stop, |end| end.reason)
}
