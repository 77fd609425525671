//! Contact of crack flanks, without friction.
//!
//! Twice per spacing along every crack stands a place with both its flanks. The displacement of a flank there is that of the points on
//! its side, by the shares that the balanced correction has for tractions on flanks ([`flanks::shares`]): exact for rigid motion and
//! for uniform strain, so that the gap `g = n·(u⁺ - u⁻)`, n the unit normal of the crack from its first flank to its second, is zero
//! where the plate is as if it had no crack. Flanks cannot overlap: places with g < 0 get a penalty spring of stiffness
//! `k = κ E' l h / Δ` (l the length that a place stands for, h the thickness, Δ the spacing), and the equilibrium is sought anew until
//! no place opens or closes (active set).
//!
//! Springs in place of the cut bonds would not do: along an oblique bond they resist sliding, along the normal of the crack they
//! resist a rigid turn of the plate.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use perilife_plate::loading::residual::{Components, across};
use perilife_plate::specimen::facets::Facet;
use perilife_plate::specimen::geometry::{along, direction, distance, distance_to_segment};
use perilife_plate::specimen::{CrackLine, LineEnd, Point};
use perilife_points::body::Body;
use perilife_points::body::balanced::flanks;
use perilife_points::body::pre_crack::as_cut;
use perilife_points::solver::field::Layout;
use perilife_points::solver::spring::GapSpring;
use perilife_points::stress_intensity::ring::FlankPressure;

/// Places per spacing. With 4 lives differ by 1e-5.
const PLACES_PER_SPACING: f64 = 2.0;
/// κ. Lives of a plate with a pressed crack at 1, 10 and 100 differ by 0.1 %; at 100 the shares of neighbouring places overlap so much
/// that only half of them stays pressed, and a closed tip cannot be told from the set.
const PENALTY: f64 = 10.0;
/// Overlap over the largest opening or overlap of all places that is none: round-off.
const ROUND_OFF: f64 = 1e-3;
/// Distance from a place that was in contact, in lengths of a place, within which a new one begins in contact.
const SAME_PLACE: f64 = 0.6;
/// Places nearest to a tip, within a spacing, whose contact closes it.
const PLACES_AT_TIP: usize = 2;

/// A place of a crack with its flanks.
#[derive(Debug, Clone)]
struct Place {
    at: Point,
    /// From the first flank to the second.
    normal: Point,
    /// Length of crack that it stands for, m.
    length: f64,
    spring: GapSpring,
    in_contact: bool,
}

/// A straight piece of crack.
#[derive(Debug, Clone)]
struct Piece {
    line: usize,
    /// As the bonds see it.
    ends: [Point; 2],
    /// `None` where too few points lie behind a flank.
    places: Vec<Option<Place>>,
}

/// A place in contact, for a resumed run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ClosedPlace {
    line: usize,
    at: Point,
}

/// Flanks of all cracks and where they are in contact.
#[derive(Debug, Clone, Default)]
pub(super) struct Contact {
    pieces: Vec<Piece>,
    /// Of a resumed run, until its places stand.
    known: Vec<ClosedPlace>,
}

impl Contact {
    /// Follows the cracks: places whose surroundings are as they were stay, and a new one begins as the old one there was.
    pub(super) fn follow(&mut self, body: &Body, lines: &[CrackLine], plane_modulus: f64) {
        let ends = |line: usize| move |piece: [Point; 2]| (line, as_cut(body, piece));
        let new: Vec<(usize, [Point; 2])> = lines
            .iter()
            .enumerate()
            .flat_map(|(line, crack)| crack.pieces().map(ends(line)))
            .filter(|(_, [a, b])| a != b)
            .collect();
        let was = |&(line, ends): &(usize, [Point; 2])| self.pieces.iter().position(|old| old.line == line && old.ends == ends);
        let of_old: Vec<Option<usize>> = new.iter().map(was).collect();
        let gone = (0..self.pieces.len()).filter(|old| !of_old.contains(&Some(*old))).map(|old| self.pieces[old].ends);
        let come = new.iter().zip(&of_old).filter(|(_, old)| old.is_none()).map(|((_, ends), _)| *ends);
        let changed: Vec<[Point; 2]> = gone.chain(come).collect();
        if changed.is_empty() {
            return;
        }
        let all: Vec<[Point; 2]> = new.iter().map(|(_, ends)| *ends).collect();
        let known = std::mem::take(&mut self.known);
        let closed: Vec<ClosedPlace> = self.closed_places().chain(known).collect();
        let reach = flanks::reach_of_shares(body);
        let piece = |(&(line, [a, b]), old): (&(usize, [Point; 2]), &Option<usize>)| {
            let count = (PLACES_PER_SPACING * distance(a, b) / body.lattice.spacing).ceil().max(1.0);
            let length = distance(a, b) / count;
            let place = |i: usize| {
                let at = along(a, b, (i as f64 + 0.5) / count);
                let is_as_it_was = || changed.iter().all(|[p, q]| distance_to_segment(at, *p, *q) > reach);
                if let Some(old) = old.filter(|_| is_as_it_was()) {
                    return self.pieces[old].places[i].clone();
                }
                let was_closed = |old: &ClosedPlace| old.line == line && distance(old.at, at) < SAME_PLACE * length;
                let stiffness = PENALTY * plane_modulus * length * body.thickness / body.lattice.spacing;
                place(body, at, [a, b], length, &all, stiffness)
                    .map(|new| Place { in_contact: closed.iter().any(was_closed), ..new })
            };
            Piece { line, ends: [a, b], places: (0..count as usize).into_par_iter().map(place).collect() }
        };
        self.pieces = new.par_iter().zip(&of_old).map(piece).collect();
    }

    fn places(&self) -> impl Iterator<Item = &Place> {
        self.pieces.iter().flat_map(|piece| piece.places.iter().flatten())
    }

    /// Springs of the places in contact, and on all places the forces that a stress, Pa, releases on the flanks: p·I of a pressure p.
    pub(super) fn springs(&self, released: &dyn Fn(Point) -> Components, thickness: f64) -> Vec<GapSpring> {
        let of_place = |place: &Place| {
            let force = across(released(place.at), place.normal).map(|t| t * place.length * thickness);
            let [x, y] = place.normal;
            let [apart, along] = [force[0] * x + force[1] * y, force[1] * x - force[0] * y];
            let stiffness = if place.in_contact { place.spring.stiffness } else { 0.0 };
            let weights = &place.spring.weights;
            let opening =
                (stiffness > 0.0 || apart != 0.0).then(|| GapSpring { weights: weights.clone(), stiffness, force: apart });
            // The displacement along the flanks has the same weights, a quarter turn on.
            let turned = || weights.iter().map(|&(place, [a, b])| (place, [-b, a])).collect();
            let sliding = (along != 0.0).then(|| GapSpring { weights: turned(), stiffness: 0.0, force: along });
            [opening, sliding]
        };
        self.places().flat_map(of_place).flatten().collect()
    }

    /// Opens places whose faces move apart, closes those that overlap by more than `least`, m; whether any changed.
    pub(super) fn update(&mut self, layout: &Layout, displacement: &[f64], least: f64) -> bool {
        let gap = |place: &Place| place.spring.gap(layout, displacement);
        let largest = self.places().map(|place| gap(place).abs()).fold(0.0, f64::max);
        let limit = -(ROUND_OFF * largest).max(least);
        let mut has_changed = false;
        for place in self.pieces.iter_mut().flat_map(|piece| piece.places.iter_mut().flatten()) {
            let is_closed = gap(place) < if place.in_contact { 0.0 } else { limit };
            has_changed |= is_closed != place.in_contact;
            place.in_contact = is_closed;
        }
        has_changed
    }

    /// Places in contact, from which [`Contact::resumed`] goes on.
    pub(super) fn closed_places(&self) -> impl Iterator<Item = ClosedPlace> + '_ {
        self.pieces.iter().flat_map(|piece| {
            let closed = piece.places.iter().flatten().filter(|place| place.in_contact);
            closed.map(|place| ClosedPlace { line: piece.line, at: place.at })
        })
    }

    /// Contact that begins with these places closed.
    pub(super) fn resumed(closed: Vec<ClosedPlace>) -> Self {
        Contact { pieces: Vec::new(), known: closed }
    }

    /// Whether flanks are in contact up to a tip.
    pub(super) fn is_closed(&self, lines: &[CrackLine], end: LineEnd, spacing: f64) -> bool {
        let tip = lines[end.line].end(end.at_last);
        let of_line = self.pieces.iter().filter(|piece| piece.line == end.line).flat_map(|piece| piece.places.iter().flatten());
        let mut near: Vec<(f64, bool)> =
            of_line.map(|place| (distance(place.at, tip), place.in_contact)).filter(|(away, _)| *away < spacing).collect();
        near.sort_by(|a, b| a.0.total_cmp(&b.0));
        !near.is_empty() && near.iter().take(PLACES_AT_TIP).all(|(_, in_contact)| *in_contact)
    }

    /// Tractions on both flanks of the places in contact, and of all places where a stress is released, Pa.
    pub(super) fn pressures(
        &self,
        layout: &Layout,
        displacement: &[f64],
        thickness: f64,
        released: &dyn Fn(Point) -> Components,
    ) -> Vec<FlankPressure> {
        let of_place = |place: &Place| {
            let gap = if place.in_contact { place.spring.gap(layout, displacement) } else { 0.0 };
            let contact = place.spring.stiffness * gap / (place.length * thickness);
            [1.0, -1.0].map(|sign| {
                let normal = place.normal.map(|n| sign * n);
                let released = across(released(place.at), normal);
                let traction = [0, 1].map(|i| contact * normal[i] - released[i]);
                FlankPressure { facet: Facet { at: place.at, normal, length: place.length }, traction }
            })
        };
        let acts = |place: &&Place| place.in_contact || released(place.at) != [0.0; 3];
        self.places().filter(acts).flat_map(of_place).collect()
    }
}

/// A place of a straight piece of crack; `None` where too few points lie behind one of its flanks.
fn place(body: &Body, at: Point, [a, b]: [Point; 2], length: f64, all: &[[Point; 2]], stiffness: f64) -> Option<Place> {
    let [x, y] = direction(a, b);
    let normal = [-y, x];
    let axes = body.lattice.to_axes(normal);
    let mut weights = Vec::new();
    // The material of the first flank lies against the normal, and its facet faces along it.
    for sign in [-1.0, 1.0] {
        let facet = Facet { at, normal: normal.map(|n| -sign * n), length };
        let shares = flanks::shares(body, &facet, all)?;
        weights.extend(shares.into_iter().map(|(place, share)| (place, axes.map(|n| sign * share * n))));
    }
    Some(Place { at, normal, length, spring: GapSpring { weights, stiffness, force: 0.0 }, in_contact: false })
}
