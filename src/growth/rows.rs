//! Where a run by K of its tips ends: reasons known before an increment, and those that lie within one.

use super::end_of_life::End;
use super::record::{CurvePoint, StopReason};
use crate::case::Case;
use crate::fatigue::crack_tip::TipState;

/// Relative difference between lengths that are equal but for round-off.
const ROUND_OFF: f64 = 1e-12;

/// Range of K at which its maximum is the toughness, Pa√m.
fn delta_k_most(case: &Case) -> Option<f64> {
    case.material.toughness.map(|toughness| case.loading.range_share() * toughness)
}

/// Why there is no increment from the last row: a known end is reached, K_max of a tip is the toughness, no tip is left or `grows`.
pub(super) fn reason_to_stop(
    case: &Case,
    end: Option<End>,
    last: &CurvePoint,
    states: &[TipState],
    grows: bool,
) -> Option<StopReason> {
    if let Some(end) = end.filter(|end| last.crack_length >= end.crack_length * (1.0 - ROUND_OFF)) {
        return Some(end.reason);
    }
    if delta_k_most(case).is_some_and(|most| last.delta_k >= most) {
        return Some(StopReason::Toughness);
    }
    if !states.contains(&TipState::Active) {
        return Some(gone(states));
    }
    (!grows).then_some(StopReason::NothingAges)
}

/// The row after an increment, and the reason to stop: run-out and toughness end the run between two rows, `end` after this one.
pub(super) fn row_after(
    case: &Case,
    last: &CurvePoint,
    next: CurvePoint,
    end: Option<StopReason>,
) -> (CurvePoint, Option<StopReason>) {
    let cycles_max = case.stop.cycles_max;
    if next.cycles > cycles_max {
        let share = (cycles_max - last.cycles) / (next.cycles - last.cycles);
        return (next.between(last, share), Some(StopReason::RunOut));
    }
    if let Some(most) = delta_k_most(case).filter(|most| next.delta_k > *most && last.delta_k < *most) {
        let fraction = (most - last.delta_k) / (next.delta_k - last.delta_k);
        return (next.between(last, fraction), Some(StopReason::Toughness));
    }
    (next, end)
}

/// Why growth ends where no tip is left, by what became of the last ones.
pub(super) fn gone(last: &[TipState]) -> StopReason {
    let any = |state: TipState| last.contains(&state);
    match (any(TipState::EnteredHole), any(TipState::LinkedUp)) {
        (true, _) => StopReason::EnteredHole,
        (_, true) => StopReason::CracksJoined,
        _ => StopReason::LeftPlate,
    }
}
