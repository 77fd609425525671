//! What lies ahead of a tip: the outline, a hole, a slot, another crack.

use perilife_plate::specimen::geometry::{
    along, circle_shares, distance, edges, meeting_share, nearest_of_segment, segments_touch,
};
use perilife_plate::specimen::{CrackLine, LineEnd, Point, Specimen};
use perilife_points::crack_tip::TipState;

/// What a tip meets, and what it becomes by that.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Encounter {
    pub(crate) state: TipState,
    pub(crate) crack: Option<usize>,
}

impl Encounter {
    const EDGE: Encounter = Encounter { state: TipState::LeftPlate, crack: None };
    const HOLE: Encounter = Encounter { state: TipState::EnteredHole, crack: None };

    fn crack(index: usize) -> Encounter {
        Encounter { state: TipState::LinkedUp, crack: Some(index) }
    }
}

/// Way from `from` straight to `to` up to the first rim or crack, as share of it, and what the tip becomes there.
pub(crate) fn first_rim(
    specimen: &Specimen,
    lines: &[CrackLine],
    own: usize,
    from: Point,
    to: Point,
) -> Option<(f64, Encounter)> {
    let walls = |polygon: &[Point], encounter: Encounter| {
        let meets = edges(polygon).filter(|(a, b)| segments_touch(from, to, *a, *b));
        meets.filter_map(|(a, b)| meeting_share(from, to, a, b)).map(|share| (share, encounter)).collect::<Vec<_>>()
    };
    let outline = walls(&specimen.outline, Encounter::EDGE);
    let slots = specimen.slots.iter().flat_map(|slot| walls(&slot.corners(), Encounter::HOLE));
    let holes = specimen.holes.iter().filter_map(|hole| {
        let [enters, _] = circle_shares(from, to, hole.centre, hole.radius)?;
        (0.0..=1.0).contains(&enters).then_some((enters, Encounter::HOLE))
    });
    let cracks = lines.iter().enumerate().filter(|(index, _)| *index != own).flat_map(|(index, line)| {
        let meets = line.pieces().filter(|[a, b]| segments_touch(from, to, *a, *b));
        meets.filter_map(|[a, b]| meeting_share(from, to, a, b)).map(|share| (share, Encounter::crack(index))).collect::<Vec<_>>()
    });
    let all = outline.into_iter().chain(slots).chain(holes).chain(cracks);
    all.map(|(share, encounter)| (share.clamp(0.0, 1.0), encounter)).min_by(|a, b| a.0.total_cmp(&b.0))
}

/// The nearest point of a hole, slot, edge or other crack within `reach` of a place, and what a tip there becomes by it.
pub(crate) fn beside(specimen: &Specimen, lines: &[CrackLine], own: usize, at: Point, reach: f64) -> Option<(Point, Encounter)> {
    let of_segment = |a: Point, b: Point, encounter: Encounter| (nearest_of_segment(at, a, b), encounter);
    let outline = edges(&specimen.outline).map(|(a, b)| of_segment(a, b, Encounter::EDGE));
    let corners: Vec<[Point; 4]> = specimen.slots.iter().map(|slot| slot.corners()).collect();
    let slots = corners.iter().flat_map(|corners| edges(corners)).map(|(a, b)| of_segment(a, b, Encounter::HOLE));
    let holes = specimen.holes.iter().map(|hole| {
        let from_centre = distance(hole.centre, at).max(f64::MIN_POSITIVE);
        (along(hole.centre, at, hole.radius / from_centre), Encounter::HOLE)
    });
    let others = lines.iter().enumerate().filter(|(index, _)| *index != own);
    let cracks = others.flat_map(|(index, line)| line.pieces().map(move |[a, b]| of_segment(a, b, Encounter::crack(index))));
    let all = outline.chain(slots).chain(holes).chain(cracks).map(|near| (distance(at, near.0), near));
    all.filter(|(gap, _)| *gap < reach).min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, near)| near)
}

/// Whether a rim or another crack lies within `reach` straight ahead of a tip or 45° to either side.
pub(crate) fn is_near_rim(specimen: &Specimen, lines: &[CrackLine], end: LineEnd, reach: f64) -> bool {
    let (from, [x, y]) = (lines[end.line].end(end.at_last), lines[end.line].direction(end.at_last));
    let half = std::f64::consts::FRAC_1_SQRT_2;
    [[x, y], [half * (x - y), half * (x + y)], [half * (x + y), half * (y - x)]]
        .into_iter()
        .map(|[x, y]| [from[0] + reach * x, from[1] + reach * y])
        .any(|to| first_rim(specimen, lines, end.line, from, to).is_some())
}
