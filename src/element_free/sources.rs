//! What asks for fine nodes away from tips: holes, concave arcs, ligaments, cracks alongside rims and each other.

use super::field::Tip;
use super::grid::Source;
use super::resolution::Resolution;
use super::rims::stretches;
use crate::specimen::geometry::{along, circle_shares, direction, distance, edges, meeting_share, segments_touch};
use crate::specimen::{CrackLine, Point, Specimen};

/// Spacings in the radius of a hole or fillet that K of a crack nearby asks for.
pub const IN_RADIUS: f64 = 2.4;
/// Turn of a re-entrant corner of the outline up to which it belongs to an arc drawn as a polygon, rad; beyond, the corner is sharp.
pub const ARC_TURN: f64 = 0.45;
/// Reach of rims and ligaments, in spacings of the coarser level.
const RIM_REACH: f64 = 1.5;
/// Spacings across a ligament.
pub(super) const ACROSS_LIGAMENT: f64 = 3.0;
/// Gap over the way along a crack to its mouth below which it is the wedge between the crack and the rim that it starts from: no load
/// goes there.
const WEDGE: f64 = 0.7;
/// Stretch of a crack for which one place stands, over the gap beside it.
const STRETCH_OF_GAP: f64 = 2.0;
/// The same over the far spacing at the least.
const STRETCH_LEAST: f64 = 1e-3;
/// Gap at the ends of a stretch over that at its middle above which the gap runs along it.
const ALONGSIDE: f64 = 0.5;

impl Resolution {
    /// Holes by their radius, and ligaments between rims by the way straight into the material.
    pub(super) fn of_rims(&self, specimen: &Specimen) -> Vec<Source> {
        let holes = specimen.holes.iter().map(|hole| Source {
            at: hole.centre,
            radius: hole.radius,
            spacing: hole.radius / self.in_radius,
            reach: RIM_REACH,
        });
        let mut sources: Vec<Source> = holes.collect();
        sources.extend(self.of_arcs(&specimen.outline));
        let rims = stretches(specimen);
        let reach = ACROSS_LIGAMENT * self.far;
        let walls: Vec<[Point; 2]> = edges(&specimen.outline)
            .chain(specimen.slots.iter().flat_map(|slot| edges(&slot.corners()).collect::<Vec<_>>()))
            .map(|(a, b)| [a, b])
            .collect();
        for (_, stretch) in &rims {
            let count = (2.0 * stretch.length() / self.far).ceil().clamp(2.0, 400.0) as usize;
            for k in 0..count {
                let share = (k as f64 + 0.5) / count as f64;
                let (from, [x, y]) = (stretch.at(share), stretch.inward(share));
                let start = [from[0] + 1e-6 * reach * x, from[1] + 1e-6 * reach * y];
                let to = [from[0] + reach * x, from[1] + reach * y];
                if !specimen.contains(start) {
                    continue;
                }
                let straight = walls.iter().filter(|[a, b]| segments_touch(start, to, *a, *b));
                let straight = straight.filter_map(|[a, b]| meeting_share(start, to, *a, *b));
                let round = specimen.holes.iter().filter_map(|hole| Some(circle_shares(start, to, hole.centre, hole.radius)?[0]));
                let nearest = straight.chain(round).filter(|share| *share > 0.0).fold(2.0, f64::min);
                if nearest <= 1.0 {
                    let width = nearest * reach;
                    let at = [from[0] + 0.5 * width * x, from[1] + 0.5 * width * y];
                    sources.push(Source { at, radius: 0.0, spacing: width / ACROSS_LIGAMENT, reach: RIM_REACH });
                }
            }
        }
        sources
    }

    /// Concave arcs of the outline by their radius: the length of the shorter side at a corner over its turn.
    fn of_arcs(&self, outline: &[Point]) -> Vec<Source> {
        let mut sources = Vec::new();
        for (k, &at) in outline.iter().enumerate() {
            let [before, after] = [(k + outline.len() - 1) % outline.len(), (k + 1) % outline.len()].map(|k| outline[k]);
            let turn = turn_at(before, at, after);
            if !(-ARC_TURN..-1e-6).contains(&turn) {
                continue;
            }
            let side = distance(before, at).min(distance(at, after));
            let spacing = side / -turn / self.in_radius;
            let count = (0.5 * side / spacing).ceil().min(100.0) as usize;
            for end in [before, after] {
                let share = 0.5 * side / distance(at, end);
                let place = |i: usize| along(at, end, share * i as f64 / count as f64);
                sources.extend((0..count).map(|i| Source { at: place(i), radius: 0.0, spacing, reach: RIM_REACH }));
            }
        }
        sources
    }

    /// Gaps between cracks and rims, and between cracks.
    pub(super) fn of_cracks(&self, specimen: &Specimen, lines: &[CrackLine], tips: &[Tip]) -> Vec<Source> {
        let mut sources = Vec::new();
        let rims = stretches(specimen);
        let reach = ACROSS_LIGAMENT * self.far;
        for (own, line) in lines.iter().enumerate() {
            let is_tip = |at_last: bool| tips.iter().any(|tip| tip.end.line == own && tip.end.at_last == at_last);
            let mouths: Vec<(bool, Point)> =
                [false, true].into_iter().filter(|end| !is_tip(*end)).map(|end| (end, line.end(end))).collect();
            let (total, mut way) = (line.length(), 0.0);
            for [a, b] in line.pieces() {
                let length = distance(a, b);
                let gap = |share: f64| {
                    let at = along(a, b, share);
                    let passed = way + share * length;
                    // Whether something at this distance from the crack forms a wedge with it.
                    let is_wedge = |gap: f64, from: &dyn Fn(Point) -> f64| {
                        let way = |at_last: bool| if at_last { total - passed } else { passed };
                        mouths.iter().any(|&(end, mouth)| from(mouth) < 1e-6 * total && gap < WEDGE * way(end))
                    };
                    let mut gap = f64::INFINITY;
                    for (_, rim) in &rims {
                        let from = |at: Point| rim.distance(at);
                        if !is_wedge(from(at), &from) {
                            gap = gap.min(from(at));
                        }
                    }
                    for (_, other) in lines.iter().enumerate().filter(|(other, _)| *other != own) {
                        let from = |at: Point| other.distance(at);
                        if !is_wedge(from(at), &from) {
                            gap = gap.min(from(at));
                        }
                    }
                    gap
                };
                let count = (2.0 * length / self.far).ceil().max(1.0) as usize;
                let mut stretches: Vec<[f64; 2]> = (0..count).map(|k| [k, k + 1].map(|k| k as f64 / count as f64)).collect();
                while let Some([from, to]) = stretches.pop() {
                    let middle = 0.5 * (from + to);
                    let narrow = gap(middle);
                    if narrow >= reach {
                        continue;
                    }
                    sources.push(Source {
                        at: along(a, b, middle),
                        radius: 0.0,
                        spacing: narrow / ACROSS_LIGAMENT,
                        reach: RIM_REACH,
                    });
                    let stretch = (to - from) * length;
                    // Beside a line that crosses, the gap goes to nothing: what is fine there helps nobody.
                    let is_alongside = || gap(from).min(gap(to)) > ALONGSIDE * narrow;
                    if stretch > STRETCH_OF_GAP * narrow && stretch > STRETCH_LEAST * self.far && is_alongside() {
                        stretches.extend([[from, middle], [middle, to]]);
                    }
                }
                way += length;
            }
        }
        sources
    }
}

/// Turn of the way from `before` over `at` to `after`, rad, negative where a counter-clockwise outline is concave.
pub fn turn_at(before: Point, at: Point, after: Point) -> f64 {
    let ([ax, ay], [bx, by]) = (direction(before, at), direction(at, after));
    (ax * by - ay * bx).atan2(ax * bx + ay * by)
}

