//! How far a run has come on its way: a guess for who waits, on which nothing that is computed depends.

use super::Progress;
use super::chain::Chain;
use crate::case::Case;
use crate::record::{CurvePoint, TipRecord};
use perilife_plate::loading::LoadControl;
use perilife_plate::specimen::geometry::{direction, distance, edges};
use perilife_plate::specimen::{Hole, Point, Specimen, TipSeed};
use perilife_points::crack_tip::TipState;

/// The way of a run to its nearest end, told by the growth of all tips together.
#[derive(Debug, Default)]
pub(super) struct Way {
    /// Growth, m, and limit load, Pa or N, where the latter was asked for first.
    first: Option<[f64; 2]>,
    /// The share told last, which never falls.
    share: f64,
}

impl Way {
    /// Progress to the nearest end: length or cycle limit, edges straight ahead, toughness (K² ∝ a), collapse load (linear).
    pub(super) fn progress(&mut self, case: &Case, chain: &Chain<'_>) -> Progress {
        let now = chain.now();
        let grown = now.growth();
        let specimen = &case.specimen;
        // Of several cracks that of the longest on its way to the end.
        let longest = || specimen.length_towards(case.stop.crack_length, now.tips.iter().map(|tip| tip.growth));
        let length = if specimen.has_several_cracks() { longest() } else { now.crack_length };
        let start = specimen.shortest_crack();
        let by_length =
            if case.stop.crack_length.is_finite() { (length - start) / (case.stop.crack_length - start) } else { 0.0 };
        let ahead = [Some(until_rims(&case.specimen, now)), until_toughness(case, now), self.until_limit_load(case, now, grown)];
        let left = ahead.into_iter().flatten().filter(|left| !left.is_nan()).fold(f64::INFINITY, f64::min).max(0.0);
        let by_growth = if grown > 0.0 { grown / (grown + left) } else { 0.0 };
        let share = by_length.max(by_growth).max(now.cycles / case.stop.cycles_max).clamp(0.0, 1.0);
        self.share = self.share.max(if share.is_nan() { 0.0 } else { share });
        Progress { cycles: now.cycles, crack_length: length, share: self.share }
    }

    /// Growth left until the weakest section yields, m.
    fn until_limit_load(&mut self, case: &Case, now: &CurvePoint, grown: f64) -> Option<f64> {
        if !case.stop.by_net_section || case.loading.control != LoadControl::Load {
            return None;
        }
        let limit = now.limit_load?;
        let [from, before] = *self.first.get_or_insert([grown, limit]);
        let fall = (before - limit) / (grown - from);
        let load = case.stop.required.unwrap_or(1.0) * case.loading.maximum;
        (fall > 0.0).then(|| (limit - load) / fall)
    }
}

/// Growth left until K_max is the toughness, m.
fn until_toughness(case: &Case, now: &CurvePoint) -> Option<f64> {
    let k_max = case.stop.required.unwrap_or(1.0) * now.k_max(&case.loading);
    let ratio = case.toughness_at_end()? / k_max;
    Some(now.crack_length * (ratio * ratio - 1.0))
}

/// Growth of all tips until each has met a rim straight on, m.
fn until_rims(specimen: &Specimen, now: &CurvePoint) -> f64 {
    let of_tip = |(tip, seed): (&TipRecord, &TipSeed)| match tip.state {
        // On from where it began; in its first direction while it stands there.
        TipState::Active if distance(seed.position, tip.position) > 0.0 => {
            to_rim(specimen, tip.position, direction(seed.position, tip.position))
        }
        TipState::Active => to_rim(specimen, tip.position, seed.direction),
        _ => 0.0,
    };
    now.tips.iter().zip(&specimen.tips).map(of_tip).sum()
}

/// Way straight on to the outline or a hole, m; 0 where none lies ahead.
fn to_rim(specimen: &Specimen, from: Point, [dx, dy]: Point) -> f64 {
    let of_side = |(a, b): (Point, Point)| {
        let (ex, ey) = (b[0] - a[0], b[1] - a[1]);
        let across = dx * ey - dy * ex;
        let (px, py) = (a[0] - from[0], a[1] - from[1]);
        let (way, place) = ((px * ey - py * ex) / across, (px * dy - py * dx) / across);
        (way > 0.0 && (0.0..=1.0).contains(&place)).then_some(way)
    };
    let of_hole = |hole: &Hole| {
        let (px, py) = (hole.centre[0] - from[0], hole.centre[1] - from[1]);
        let (along, beside) = (px * dx + py * dy, px * dy - py * dx);
        (along > 0.0 && beside.abs() < hole.radius).then(|| along - (hole.radius * hole.radius - beside * beside).sqrt())
    };
    let ahead = edges(&specimen.outline).filter_map(of_side).chain(specimen.holes.iter().filter_map(of_hole));
    ahead.reduce(f64::min).unwrap_or(0.0)
}
