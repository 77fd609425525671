//! What lies ahead of a tip: the outline, a hole, a slot, another crack.

use crate::fatigue::crack_tip::TipState;
use crate::specimen::geometry::{along, distance, edges, meeting_share, segments_touch};
use crate::specimen::{CrackLine, Point, Specimen};

/// What a tip meets, and what it becomes by that.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Met {
    pub(super) state: TipState,
    /// The crack that it meets.
    pub(super) crack: Option<usize>,
}

impl Met {
    const EDGE: Met = Met { state: TipState::LeftPlate, crack: None };
    const HOLE: Met = Met { state: TipState::EnteredHole, crack: None };

    fn crack(index: usize) -> Met {
        Met { state: TipState::LinkedUp, crack: Some(index) }
    }
}

/// Way from `from` straight to `to` up to the first rim or crack, as share of it, and what the tip becomes there.
pub(super) fn first_rim(specimen: &Specimen, lines: &[CrackLine], own: usize, from: Point, to: Point) -> Option<(f64, Met)> {
    let walls = |polygon: &[Point], met: Met| {
        let meets = edges(polygon).filter(|(a, b)| segments_touch(from, to, *a, *b));
        meets.filter_map(|(a, b)| meeting_share(from, to, a, b)).map(|share| (share, met)).collect::<Vec<_>>()
    };
    let outline = walls(&specimen.outline, Met::EDGE);
    let slots = specimen.slots.iter().flat_map(|slot| walls(&slot.corners(), Met::HOLE));
    let holes = specimen.holes.iter().filter_map(|hole| {
        let (d, f) = ([to[0] - from[0], to[1] - from[1]], [from[0] - hole.centre[0], from[1] - hole.centre[1]]);
        let (dd, df, ff) = (d[0] * d[0] + d[1] * d[1], d[0] * f[0] + d[1] * f[1], f[0] * f[0] + f[1] * f[1]);
        let root = (df * df - dd * (ff - hole.radius * hole.radius)).sqrt();
        // NaN where the line passes the hole.
        let share = (-df - root) / dd;
        (0.0..=1.0).contains(&share).then_some((share, Met::HOLE))
    });
    let cracks = lines.iter().enumerate().filter(|(index, _)| *index != own).flat_map(|(index, line)| {
        let meets = line.pieces().filter(|[a, b]| segments_touch(from, to, *a, *b));
        meets.filter_map(|[a, b]| meeting_share(from, to, a, b)).map(|share| (share, Met::crack(index))).collect::<Vec<_>>()
    });
    let all = outline.into_iter().chain(slots).chain(holes).chain(cracks);
    all.map(|(share, met)| (share.clamp(0.0, 1.0), met)).min_by(|a, b| a.0.total_cmp(&b.0))
}

/// The nearest point of a hole, slot, edge or other crack within `reach` of a place, and what a tip there becomes by it.
pub(super) fn beside(specimen: &Specimen, lines: &[CrackLine], own: usize, at: Point, reach: f64) -> Option<(Point, Met)> {
    let of_segment = |a: Point, b: Point, met: Met| (nearest_of_segment(at, a, b), met);
    let outline = edges(&specimen.outline).map(|(a, b)| of_segment(a, b, Met::EDGE));
    let corners: Vec<[Point; 4]> = specimen.slots.iter().map(|slot| slot.corners()).collect();
    let slots = corners.iter().flat_map(|corners| edges(corners)).map(|(a, b)| of_segment(a, b, Met::HOLE));
    let holes = specimen.holes.iter().map(|hole| {
        let from_centre = distance(hole.centre, at).max(f64::MIN_POSITIVE);
        (along(hole.centre, at, hole.radius / from_centre), Met::HOLE)
    });
    let others = lines.iter().enumerate().filter(|(index, _)| *index != own);
    let cracks = others.flat_map(|(index, line)| line.pieces().map(move |[a, b]| of_segment(a, b, Met::crack(index))));
    let all = outline.chain(slots).chain(holes).chain(cracks).map(|near| (distance(at, near.0), near));
    all.filter(|(gap, _)| *gap < reach).min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, near)| near)
}

fn nearest_of_segment(p: Point, a: Point, b: Point) -> Point {
    let ab = [b[0] - a[0], b[1] - a[1]];
    let squared = ab[0] * ab[0] + ab[1] * ab[1];
    let t = if squared > 0.0 { (((p[0] - a[0]) * ab[0] + (p[1] - a[1]) * ab[1]) / squared).clamp(0.0, 1.0) } else { 0.0 };
    along(a, b, t)
}
