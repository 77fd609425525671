//! Initial cracks as cut bonds: no point is removed, every bond that crosses the crack line is.

use super::{Body, Bond};
use perilife_plate::specimen::facets::Facet;
use perilife_plate::specimen::geometry::{along, direction, distance, distance_to_segment, segments_touch};
use perilife_plate::specimen::{Crack, Point, Specimen};

/// Share of the spacing by which a crack is shifted sideways, so that a crack along a row of points has that row on one side.
const TIE_BREAK: f64 = 1e-7;

/// Bonds of the body that the cracks of a specimen cut, ascending.
pub fn bonds_cut_by(body: &Body, specimen: &Specimen) -> Vec<Bond> {
    let cracks = through_mouths(specimen, body.lattice.spacing);
    let mut cut: Vec<Bond> = cracks.iter().flat_map(|crack| bonds_across(body, crack.from, crack.to)).collect();
    cut.sort_unstable();
    cut.dedup();
    cut
}

/// Steps in which the way through a mouth is tried.
const MOUTH_STEPS: usize = 8;

/// The cracks of a specimen, longer by a spacing, m, at every mouth, as far as there is no material: bonds that graze the void there
/// would hold the mouth shut.
pub fn through_mouths(specimen: &Specimen, spacing: f64) -> Vec<Crack> {
    let longer = |end: Point, other: Point| {
        let [x, y] = direction(other, end);
        let at = |step: usize| {
            let way = spacing * step as f64 / MOUTH_STEPS as f64;
            [end[0] + way * x, end[1] + way * y]
        };
        let is_tip = specimen.tips.iter().any(|tip| tip.position == end);
        let steps = if is_tip { 0 } else { (1..=MOUTH_STEPS).take_while(|&step| !specimen.contains(at(step))).count() };
        if steps == 0 { end } else { at(steps) }
    };
    specimen.cracks.iter().map(|crack| Crack::straight(longer(crack.from, crack.to), longer(crack.to, crack.from))).collect()
}

/// A piece of crack where it cuts the bonds: shifted a trifle aside.
pub fn as_cut(body: &Body, [a, b]: [Point; 2]) -> [Point; 2] {
    let shift = aside(body.lattice.spacing, a, b);
    [a, b].map(|p| [p[0] + shift[0], p[1] + shift[1]])
}

/// Both faces of a straight piece of crack in facets of about a length, m.
pub fn faces([a, b]: [Point; 2], length: f64) -> impl Iterator<Item = Facet> {
    let count = (distance(a, b) / length).ceil().max(1.0);
    let (length, [x, y]) = (distance(a, b) / count, direction(a, b));
    (0..count as usize).flat_map(move |i| {
        let at = along(a, b, (i as f64 + 0.5) / count);
        // Outward from the material on the left of the line is to its right, and the other way round.
        [[y, -x], [-y, x]].map(|normal| Facet { at, normal, length })
    })
}

/// How far a crack from `a` to `b` is shifted, to its left, before bonds are cut, m.
fn aside(spacing: f64, a: Point, b: Point) -> Point {
    let [x, y] = direction(a, b);
    let shift = TIE_BREAK * spacing;
    [-y * shift, x * shift]
}

/// Ends of the line that cuts bonds for a crack from `a` to `b` on points of a spacing, m: shifted aside, and longer by ten times
/// that shift, so that a bond through an end of the crack is cut at both ends alike.
pub fn cutting_line(spacing: f64, a: Point, b: Point) -> [Point; 2] {
    let aside = aside(spacing, a, b);
    let (x, y) = (10.0 * aside[1], -10.0 * aside[0]);
    [[a[0] + aside[0] - x, a[1] + aside[1] - y], [b[0] + aside[0] + x, b[1] + aside[1] + y]]
}

/// Bonds that cross the segment from `a` to `b`.
pub fn bonds_across(body: &Body, a: Point, b: Point) -> Vec<Bond> {
    let (lattice, places) = (&body.lattice, body.places());
    if distance(a, b) == 0.0 {
        return Vec::new();
    }
    let [a, b] = cutting_line(lattice.spacing, a, b);
    let mut cut = Vec::new();
    for place in places_near(body, a, b, body.horizon()) {
        let here = lattice.position(place);
        for (k, &step) in body.steps.iter().enumerate() {
            let bond = k * places + place;
            if body.multiplier[bond] > 0.0 && segments_touch(here, lattice.position(place.wrapping_add_signed(step)), a, b) {
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
