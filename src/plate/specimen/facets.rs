//! The rim of a plate in short pieces, where its boundary lies and which way it faces.

use super::geometry::{along, direction, distance, edges};
use super::{Point, Specimen};

/// Pieces per spacing; even, so that the middle of a piece never falls between two points.
pub const PER_SPACING: f64 = 8.0;
/// Depth in spacings at which a piece is asked whether it has material behind it.
const BEHIND: f64 = 1e-3;

/// A short piece of the rim about its middle, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Facet {
    pub at: Point,
    /// Unit vector out of the material.
    pub normal: Point,
    pub length: f64,
}

/// Outline, holes and slots of a specimen, only the parts of them that bound material.
pub fn facets(specimen: &Specimen, spacing: f64) -> Vec<Facet> {
    let outline = edges(&specimen.outline).flat_map(|(a, b)| straight(a, b, spacing));
    let turn = 2.0 * std::f64::consts::PI;
    let holes = specimen.holes.iter().flat_map(|hole| {
        let around = arc(hole.centre, hole.radius, 0.0, turn, spacing);
        around.into_iter().map(turned_over)
    });
    let slots = specimen.slots.iter().flat_map(|slot| {
        let corners = slot.corners();
        let walls: Vec<Facet> = edges(&corners).flat_map(|(a, b)| straight(a, b, spacing)).map(turned_over).collect();
        walls
    });
    outline.chain(holes).chain(slots).filter(|facet| specimen.contains(behind(facet, spacing))).collect()
}

/// A straight stretch, its normal to the right of the way from `a` to `b`: out of a counter-clockwise polygon.
pub fn straight(a: Point, b: Point, spacing: f64) -> impl Iterator<Item = Facet> {
    let length = distance(a, b);
    let count = (length / spacing).round().max(1.0) * PER_SPACING;
    let [x, y] = direction(a, b);
    (0..count as usize).map(move |i| Facet { at: along(a, b, (i as f64 + 0.5) / count), normal: [y, -x], length: length / count })
}

/// An arc from the angle `from` over `sweep`, its normal away from the centre.
pub fn arc(centre: Point, radius: f64, from: f64, sweep: f64, spacing: f64) -> Vec<Facet> {
    let count = (radius * sweep / spacing).round().max(4.0) * PER_SPACING;
    let piece = |i: usize| {
        let (sin, cos) = (from + sweep * (i as f64 + 0.5) / count).sin_cos();
        let at = [centre[0] + radius * cos, centre[1] + radius * sin];
        Facet { at, normal: [cos, sin], length: radius * sweep / count }
    };
    (0..count as usize).map(piece).collect()
}

pub fn turned_over(facet: Facet) -> Facet {
    Facet { normal: facet.normal.map(|n| -n), ..facet }
}

/// A point just behind a piece, in the material if the piece bounds any.
pub fn behind(facet: &Facet, spacing: f64) -> Point {
    [0, 1].map(|i| facet.at[i] - BEHIND * spacing * facet.normal[i])
}
