//! The loads of a specimen as forces on short pieces of its rim.

use crate::specimen::facets::{Facet, PER_SPACING, arc, behind, straight, turned_over};
use crate::specimen::geometry::{along, distance};
use crate::specimen::pin::{Contact, LOOSE_PIN, Pin, RimForce};
use crate::specimen::{Bearing, Hole, Load, Point, Specimen};

#[derive(Debug, Clone, Copy)]
pub struct LoadPiece {
    /// Where it acts; the normal points out of the material.
    pub facet: Facet,
    /// Force in plate axes at unit nominal load, N.
    pub force: Point,
}

/// A facet with its normal out of the material.
pub fn outward(specimen: &Specimen, facet: Facet, spacing: f64) -> Facet {
    if specimen.contains(behind(&facet, spacing)) { facet } else { turned_over(facet) }
}

pub fn load_pieces(specimen: &Specimen, spacing: f64) -> Vec<LoadPiece> {
    specimen.loads.iter().flat_map(|load| pieces_of(load, specimen, spacing)).collect()
}

pub fn pieces_of(load: &Load, specimen: &Specimen, spacing: f64) -> Vec<LoadPiece> {
    if let Some((from, to, [first, last])) = load.on_edge() {
        let piece = |facet: Facet| {
            let area = facet.length * specimen.thickness;
            let traction = along(first, last, distance(from, facet.at) / distance(from, to));
            LoadPiece { facet: outward(specimen, facet, spacing), force: traction.map(|t| t * area) }
        };
        return off_mouths(straight(from, to, spacing).map(piece).collect(), specimen, spacing);
    }
    let Load::Pin { hole, direction, force, ref contact } = *load else { return Vec::new() };
    match (contact, &specimen.holes[hole]) {
        (Bearing::Elastic(Pin { found: Some(found), .. }), hole) => rim_forces(hole, direction, found, spacing, force),
        // Of a pin whose contact is not found yet nothing is known but its force.
        (_, hole) => bearing(hole, direction, contact.half_angle().unwrap_or(LOOSE_PIN), spacing, force),
    }
}

/// Loads of a side with their resultant and moment as they are, where holes and notches open into it: what would act on a mouth acts on the
/// material at both ends of it; at a corner, which has one end, the moment is not kept.
fn off_mouths(mut pieces: Vec<LoadPiece>, specimen: &Specimen, spacing: f64) -> Vec<LoadPiece> {
    let carries: Vec<bool> = pieces.iter().map(|piece| specimen.contains(behind(&piece.facet, spacing))).collect();
    if !carries.contains(&true) {
        return pieces;
    }
    for i in (0..pieces.len()).filter(|i| !carries[*i]) {
        let LoadPiece { facet, force } = pieces[i];
        let shares = match ((0..i).rev().find(|j| carries[*j]), (i..pieces.len()).find(|j| carries[*j])) {
            (Some(a), Some(b)) => {
                let [from, to] = [a, b].map(|end| pieces[end].facet.at);
                let share = distance(from, facet.at) / distance(from, to);
                [(a, 1.0 - share), (b, share)]
            }
            (one, other) => [(one.or(other).unwrap_or(i), 1.0), (i, 0.0)],
        };
        for (end, share) in shares {
            pieces[end].force = [0, 1].map(|axis| pieces[end].force[axis] + share * force[axis]);
        }
    }
    let mut carries = carries.into_iter();
    pieces.retain(|_| carries.next() == Some(true));
    pieces
}

/// What a pin does where it touches its hole, in pieces no longer than those of other rims.
fn rim_forces(hole: &Hole, direction: Point, found: &Contact, spacing: f64, force: f64) -> Vec<LoadPiece> {
    let middle = direction[1].atan2(direction[0]);
    let of_piece = |piece: &RimForce| {
        let count = (hole.radius * piece.width * PER_SPACING / spacing).ceil();
        let (length, size) = (hole.radius * piece.width / count, force * piece.share / count);
        let (angle, width) = (middle + piece.angle, piece.width);
        (0..count as usize).map(move |i| {
            let (y, x) = (angle + width * ((i as f64 + 0.5) / count - 0.5)).sin_cos();
            let at = [hole.centre[0] + hole.radius * x, hole.centre[1] + hole.radius * y];
            LoadPiece { facet: Facet { at, normal: [-x, -y], length }, force: [size * x, size * y] }
        })
    };
    found.pieces.iter().flat_map(of_piece).collect()
}

/// Pressure `p cos(π θ / 2θ_c)` over the arc |θ| ≤ θ_c of a hole around `direction`, its resultant `force`. With θ_c = 90° this
/// is the cosine of a pin that fills its hole.
fn bearing(hole: &Hole, direction: Point, contact: f64, spacing: f64, force: f64) -> Vec<LoadPiece> {
    let middle = direction[1].atan2(direction[0]);
    let facets = arc(hole.centre, hole.radius, middle - contact, 2.0 * contact, spacing);
    let along = |facet: &Facet| (facet.normal[0] * direction[0] + facet.normal[1] * direction[1]).clamp(-1.0, 1.0);
    let push = |facet: &Facet| (std::f64::consts::FRAC_PI_2 * along(facet).acos() / contact).cos() * facet.length;
    let resultant: f64 = facets.iter().map(|facet| push(facet) * along(facet)).sum();
    let piece = |facet: &Facet| {
        let size = force * push(facet) / resultant;
        LoadPiece { facet: turned_over(*facet), force: facet.normal.map(|n| size * n) }
    };
    facets.iter().map(piece).collect()
}
