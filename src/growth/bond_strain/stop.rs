//! Tips that come to an edge or a hole, and reasons to stop a run.

use super::history::GrowthHistory;
use crate::ageing::FatigueBond;
use crate::case::Case;
use crate::end_of_life::{End, row_after, strength_reason};
use crate::record::{CurvePoint, StopReason};
use perilife_plate::specimen::Specimen;
use perilife_plate::specimen::geometry::distance;
use perilife_points::body::pre_crack::bonds_across;
use perilife_points::body::{Body, Bond};
use perilife_points::crack_tip::{CrackTip, TipState};
use perilife_points::state::Bonds;

/// Reasons that show before a block: the crack is too long for its load, no tip is left, or nothing ages.
pub(super) fn before_block(
    case: &Case,
    end: Option<End>,
    track: &GrowthHistory,
    tips: &[CrackTip],
    ageing: &[FatigueBond],
) -> Option<StopReason> {
    if let Some(end) = end.filter(|end| {
        let specimen = &case.specimen;
        end.crack_length <= end.length(specimen, specimen.crack_length, std::iter::empty())
    }) {
        return Some(end.reason);
    }
    // Where no handbook knows K, the energy released so far does.
    let horizon = case.points().horizon_ratio * case.points().spacing;
    let released = case.toughness_at_end().zip(track.k_max_released(case, horizon));
    let factor = case.stop.required.unwrap_or(1.0);
    if released.is_some_and(|(toughness, k_max)| k_max * factor >= toughness) {
        return Some(strength_reason(case, StopReason::Toughness));
    }
    let gone = !tips.is_empty() && tips.iter().all(|tip| !tip.is_active());
    if gone && case.fatigue.ageing == perilife_laws::Ageing::CrackTip {
        let entered = tips.iter().any(|tip| tip.state == TipState::EnteredHole);
        return Some(if entered { StopReason::EnteredHole } else { StopReason::LeftPlate });
    }
    ageing.is_empty().then_some(StopReason::NothingAges)
}

/// Where on its curve a plate no longer bears its load.
pub(super) fn at_section(case: &Case, curve: &[CurvePoint]) -> Option<End> {
    curve.windows(2).find_map(|rows| {
        let (row, reason) = row_after(case, &rows[0], rows[1].clone(), None);
        reason.filter(|reason| reason.is_strength()).map(|reason| End { crack_length: row.crack_length, reason })
    })
}

/// The reason that counts where a run had passed a known end before it stopped for another reason.
pub(super) fn settled(end: Option<End>, (track, specimen): (&GrowthHistory, &Specimen), stop: StopReason) -> StopReason {
    end.filter(|end| end.length_of(specimen, track.last()) >= end.crack_length).map_or(stop, |end| end.reason)
}

/// Bonds between tips and an edge or hole less than one spacing ahead; those tips end.
pub(super) fn break_through(tips: &mut [CrackTip], body: &Body, bonds: &Bonds, specimen: &Specimen) -> Vec<Bond> {
    let mut through = Vec::new();
    for tip in tips.iter_mut().filter(|tip| tip.is_active()) {
        if tip.retire(specimen, body.lattice.spacing) {
            let along = |way: f64| [0, 1].map(|i| tip.position[i] + way * tip.direction[i]);
            let across = bonds_across(body, along(-body.horizon()), along(body.horizon()));
            through.extend(across.into_iter().filter(|&bond| bonds.is_intact(bond) && body.can_fail(bond)));
        }
    }
    through.sort_unstable();
    through.dedup();
    through
}

/// Ends the tips at an edge or hole around which no bond is left.
pub(super) fn retire_tips(
    tips: &mut [CrackTip],
    body: &Body,
    specimen: &Specimen,
    candidates: &[Bond],
    zone_radius_horizons: f64,
) {
    let radius = zone_radius_horizons * body.horizon();
    for tip in tips.iter_mut().filter(|tip| tip.is_active()) {
        if !candidates.iter().any(|&bond| distance(body.middle(bond), tip.position) <= radius) {
            tip.retire(specimen, body.horizon());
        }
    }
}
