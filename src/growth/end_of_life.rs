//! Where a run ends: crack lengths at which a standard specimen is at its end, known before any run since its K(a) and its net section
//! are; and of a run by K of its tips the reasons known before an increment, and those that lie within one.

use super::record::{CurvePoint, StopReason};
use crate::case::Case;
use perilife_plate::loading::LoadControl;
use perilife_plate::specimen::Specimen;
use perilife_plate::specimen::handbook::handbook;
use perilife_points::crack_tip::TipState;

/// Relative difference between lengths that are equal but for round-off.
const ROUND_OFF: f64 = 1e-12;

/// A crack length that ends a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct End {
    /// Crack length in the specimen's convention, m; that of the start where the end is there already.
    pub crack_length: f64,
    /// Why the run ends there.
    pub reason: StopReason,
}

impl End {
    /// What is set against it of cracks that are in all so long, m, after these growths of their tips.
    pub fn length(&self, specimen: &Specimen, crack_length: f64, growth_of_tips: impl Iterator<Item = f64>) -> f64 {
        match self.reason {
            StopReason::CrackLengthReached if specimen.has_several_cracks() => {
                specimen.length_towards(self.crack_length, growth_of_tips)
            }
            _ => crack_length,
        }
    }

    /// The same of a row.
    pub fn length_of(&self, specimen: &Specimen, row: &CurvePoint) -> f64 {
        self.length(specimen, row.crack_length, row.tips.iter().map(|tip| tip.growth))
    }
}

/// The first of: the length the case stops at, K = toughness under the required load (where a handbook has K), yield of a whole section (of a
/// plate that with its initial cracks). `None` where nothing of that is given. Where cycles are of a displacement the load is not known before the run:
/// only the length that the case stops at is.
pub fn first_end(case: &Case) -> Option<End> {
    // The plate has to bear a load, that of the cycles or a larger one.
    let (specimen, load) = (&case.specimen, case.loading.maximum * case.stop.required.unwrap_or(1.0));
    let start = specimen.crack_length;
    let end = |crack_length: f64, reason| End { crack_length, reason };
    let wanted = case.stop.crack_length.is_finite().then(|| end(case.stop.crack_length, StopReason::CrackLengthReached));
    if case.loading.displacement().is_some() {
        return wanted;
    }
    let yields_at_once = case.yield_strength_at_end().filter(|_| specimen.ligament(start).is_none()).and_then(|strength| {
        // Of a plate only the section that its initial cracks leave is known before the run.
        let borne = specimen.limit_load(start, &specimen.crack_lines(), strength)?;
        (borne <= load).then(|| end(start, strength_reason(case, StopReason::NetSectionYield)))
    });
    [wanted, critical_length(case), yields_at_once].into_iter().flatten().min_by(|a, b| a.crack_length.total_cmp(&b.crack_length))
}

/// Crack length of a standard specimen at failure by toughness or collapse, whichever is first; `None` if unknown before a run.
pub fn critical_length(case: &Case) -> Option<End> {
    critical_lengths(case).into_iter().flatten().min_by(|a, b| a.crack_length.total_cmp(&b.crack_length))
}

/// Crack lengths of a standard specimen at K = toughness and at collapse; `None` if unknown before a run, or not a limit.
pub fn critical_lengths(case: &Case) -> [Option<End>; 2] {
    // Of a load that follows the crack known row by row: it need not rise with the crack.
    if case.loading.control != LoadControl::Load {
        return [None; 2];
    }
    let (specimen, load) = (&case.specimen, case.loading.maximum * case.stop.required.unwrap_or(1.0));
    let (start, limit) = (specimen.crack_length, specimen.length_limit().0);
    let end = |crack_length: f64, breaks| End { crack_length, reason: strength_reason(case, breaks) };
    let toughness = case
        .toughness_at_end()
        // With residual stress K is known row by row.
        .filter(|_| case.loading.residual.is_none())
        .zip(handbook(specimen))
        .map(|(toughness, formula)| end(first_reach(|a| formula.k_i(a, load), toughness, start, limit), StopReason::Toughness));
    let is_known = specimen.ligament(start).is_some() || handbook(specimen).is_some();
    let net_section = case.yield_strength_at_end().filter(|_| is_known).map(|strength| {
        // A plate reaches its strength at its limit load; NaN, which counts as reached, where nothing is left of it.
        let of_plate = |a: f64| specimen.limit_load_at(a, strength).map(|limit| strength * load / limit);
        let stress = |a: f64| specimen.net_section_stress(a, load).or_else(|| of_plate(a)).unwrap_or(f64::NAN);
        end(first_reach(stress, strength, start, limit), StopReason::NetSectionYield)
    });
    [toughness, net_section]
}

/// Smallest `a` in `from..=to` at which the rising `value` reaches `wanted`; NaN counts as reached (end of the plate).
fn first_reach(value: impl Fn(f64) -> f64, wanted: f64, from: f64, to: f64) -> f64 {
    let reached = |a: f64| value(a).partial_cmp(&wanted) != Some(std::cmp::Ordering::Less);
    if reached(from) {
        return from;
    }
    let (mut below, mut above) = (from, to);
    loop {
        let middle = 0.5 * (below + above);
        // No double lies between: the halving is done.
        if middle <= below || middle >= above {
            return above;
        }
        if reached(middle) { above = middle } else { below = middle }
    }
}

/// Excess of the required load over each strength at a row: `K_max/K_c - 1` and `1 - limit load/load`, negative below it.
fn excess(case: &Case, row: &CurvePoint) -> [(Option<f64>, StopReason); 2] {
    let required = case.stop.required.unwrap_or(1.0);
    let k_max = row.k_max_at(required, &case.loading);
    let load = case.loading.doing(row.work, row.crack_length);
    let known = |excess: f64| Some(excess).filter(|excess| excess.is_finite());
    [
        (case.toughness_at_end().and_then(|toughness| known(k_max / toughness - 1.0)), StopReason::Toughness),
        (
            row.limit_load.filter(|_| case.stop.by_net_section).and_then(|limit| known(1.0 - limit / (required * load))),
            StopReason::NetSectionYield,
        ),
    ]
}

/// Required load over the load at toughness or collapse at a row, proportional to the load; 0 if unknown.
pub fn demands(case: &Case, row: &CurvePoint) -> [f64; 2] {
    let [(toughness, _), (net_section, _)] = excess(case, row);
    [toughness.map_or(0.0, |excess| 1.0 + excess), net_section.map_or(0.0, |excess| 1.0 / (1.0 - excess))]
}

/// Why a run ends where the plate no longer bears its load, by what breaks under it: that of the cycles, or one that it has to bear.
pub fn strength_reason(case: &Case, breaks: StopReason) -> StopReason {
    if case.stop.required.is_some() { StopReason::RequiredStrength } else { breaks }
}

/// Why there is no increment from the last row: a known end is reached, K_max of a tip is the toughness, no tip is left or `grows`.
pub(super) fn reason_to_stop(
    case: &Case,
    end: Option<End>,
    last: &CurvePoint,
    states: &[TipState],
    grows: bool,
) -> Option<StopReason> {
    let [(by_toughness, _), (by_section, _)] = excess(case, last).map(|(excess, breaks)| (excess.filter(|e| *e >= 0.0), breaks));
    // What breaks first on the way to the load: load over limit load is 1/(1 - e).
    let breaks = match (by_toughness, by_section) {
        (Some(k), Some(e)) if k + 1.0 < 1.0 / (1.0 - e) => Some(StopReason::NetSectionYield),
        (Some(_), _) => Some(StopReason::Toughness),
        (None, by_section) => by_section.map(|_| StopReason::NetSectionYield),
    };
    if let Some(breaks) = breaks {
        return Some(strength_reason(case, breaks));
    }
    let length = |end: &End| end.length_of(&case.specimen, last);
    if let Some(end) = end.filter(|end| length(end) >= end.crack_length * (1.0 - ROUND_OFF)) {
        return Some(end.reason);
    }
    if !states.contains(&TipState::Active) {
        return Some(gone(states));
    }
    (!grows).then_some(StopReason::NothingAges)
}

/// The row after an increment and the reason to stop: run-out or failure between two rows, or `end` after this one.
pub(super) fn row_after(
    case: &Case,
    last: &CurvePoint,
    next: CurvePoint,
    end: Option<StopReason>,
) -> (CurvePoint, Option<StopReason>) {
    let cycles_max = case.stop.cycles_max;
    let run_out =
        (next.cycles > cycles_max).then(|| ((cycles_max - last.cycles) / (next.cycles - last.cycles), StopReason::RunOut));
    let broken = excess(case, last).into_iter().zip(excess(case, &next)).filter_map(|((before, breaks), (now, _))| {
        let (before, now) = (before?, now?);
        (before < 0.0 && now > 0.0).then(|| (before / (before - now), strength_reason(case, breaks)))
    });
    match run_out.into_iter().chain(broken).min_by(|a, b| a.0.total_cmp(&b.0)) {
        // Not a round-off beside the limit.
        Some((share, StopReason::RunOut)) => {
            (CurvePoint { cycles: cycles_max, ..next.between(last, share) }, Some(StopReason::RunOut))
        }
        Some((share, reason)) => (next.between(last, share), Some(reason)),
        None => (next, end),
    }
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
