//! Initial cracks as cut bonds: no point is removed, every bond that crosses the crack line is.

use super::lattice::Lattice;
use super::{Body, Bond};
use crate::specimen::geometry::{direction, distance, distance_to_segment, segments_touch};
use crate::specimen::{Crack, Point};

/// Share of the spacing by which a crack is shifted sideways, so that a crack along a row of points has that row on one side.
const TIE_BREAK: f64 = 1e-7;

/// Bonds of the body that a list of cracks cuts, ascending.
#[must_use]
pub fn bonds_cut_by(body: &Body, cracks: &[Crack]) -> Vec<Bond> {
    let mut cut: Vec<Bond> = cracks.iter().flat_map(|crack| bonds_across(body, crack.from, crack.to)).collect();
    cut.sort_unstable();
    cut.dedup();
    cut
}

/// A straight crack as the bonds see it, in one or two pieces in its own sense: shifted aside by a trifle, away from the centre of the
/// lattice, so that points on it all lie on one side, and those of its mirror image on the image's. A crack through the centre has no
/// such side: its two halves are shifted to the left seen from the centre, each the other turned by half a turn.
#[must_use]
pub fn as_cut(lattice: &Lattice, a: Point, b: Point) -> Vec<[Point; 2]> {
    let shifted = |[a, b]: [Point; 2]| {
        let [x, y] = tie_break(lattice, a, b);
        [[a[0] + x, a[1] + y], [b[0] + x, b[1] + y]]
    };
    match centre_between(lattice, a, b) {
        Some(centre) => vec![shifted([a, centre]), shifted([centre, b])],
        None => vec![shifted([a, b])],
    }
}

/// The centre of the lattice, where a segment runs through it.
fn centre_between(lattice: &Lattice, a: Point, b: Point) -> Option<Point> {
    let centre = lattice.centre();
    let near = 10.0 * TIE_BREAK * lattice.spacing;
    let is_inside = distance(a, centre) > near && distance(b, centre) > near;
    (is_inside && distance_to_segment(centre, a, b) < near).then_some(centre)
}

/// How far a straight crack from `a` to `b`, not across the centre of the lattice, is shifted before bonds are cut, m.
#[must_use]
pub fn tie_break(lattice: &Lattice, a: Point, b: Point) -> Point {
    let ([x, y], centre) = (direction(a, b), lattice.centre());
    let from_centre = [0.5 * (a[0] + b[0]) - centre[0], 0.5 * (a[1] + b[1]) - centre[1]];
    let aside = x * from_centre[1] - y * from_centre[0];
    let away = if aside.abs() > 10.0 * TIE_BREAK * lattice.spacing { aside } else { x * from_centre[0] + y * from_centre[1] };
    let shift = (TIE_BREAK * lattice.spacing).copysign(away);
    [-y * shift, x * shift]
}

/// Segments that cut the bonds of a crack from `a` to `b`: as it is shifted aside, and longer by ten times that shift, so that a
/// bond through an end of the crack is cut at both ends alike; where two halves meet, a short one across.
#[must_use]
pub fn cutting_lines(lattice: &Lattice, a: Point, b: Point) -> Vec<[Point; 2]> {
    let more = 10.0 * TIE_BREAK * lattice.spacing;
    let [x, y] = direction(a, b).map(|d| more * d);
    let longer = |[a, b]: [Point; 2]| [[a[0] - x, a[1] - y], [b[0] + x, b[1] + y]];
    let across = centre_between(lattice, a, b).map(|centre| [[centre[0] + y, centre[1] - x], [centre[0] - y, centre[1] + x]]);
    as_cut(lattice, a, b).into_iter().map(longer).chain(across).collect()
}

/// Bonds that cross the segment from `a` to `b`.
#[must_use]
pub fn bonds_across(body: &Body, a: Point, b: Point) -> Vec<Bond> {
    let (lattice, places) = (&body.lattice, body.places());
    if distance(a, b) == 0.0 {
        return Vec::new();
    }
    let lines = cutting_lines(lattice, a, b);
    let mut cut = Vec::new();
    for place in places_near(body, a, b, body.horizon() + lattice.spacing) {
        let here = lattice.position(place);
        for (k, &step) in body.steps.iter().enumerate() {
            let bond = k * places + place;
            let there = lattice.position(place.wrapping_add_signed(step));
            if body.multiplier[bond] > 0.0 && lines.iter().any(|&[a, b]| segments_touch(here, there, a, b)) {
                cut.push(bond as Bond);
            }
        }
    }
    cut
}

/// Points within a distance of a segment, in memory order.
pub fn places_near(body: &Body, a: Point, b: Point, reach: f64) -> impl Iterator<Item = usize> + '_ {
    let lattice = &body.lattice;
    let (p, q) = (lattice.locate(a), lattice.locate(b));
    let margin = reach / lattice.spacing + 1.0;
    let range = |i: usize, count: usize| {
        let low = (p[i].min(q[i]) - margin).floor().max(0.0) as usize;
        let high = (p[i].max(q[i]) + margin).ceil().clamp(-1.0, count as f64 - 1.0);
        low..(high + 1.0) as usize
    };
    let (columns, rows) = (range(0, lattice.columns), range(1, lattice.rows));
    rows.flat_map(move |row| columns.clone().map(move |column| lattice.place(column, row)))
        .filter(move |&place| body.is_point[place] && distance_to_segment(lattice.position(place), a, b) <= reach)
}
