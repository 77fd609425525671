//! Pieces that breaking has cut off: set aside when nothing loads them, `severed` when both sides are loaded.

use std::collections::HashSet;

use crate::body::{Body, Bond};
use crate::state::Bonds;

/// What breaking some bonds did to the plate.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Connectivity {
    /// Still one loaded piece; these further bonds were set aside with pieces or points that carry nothing.
    Connected(Vec<Bond>),
    /// Two loaded pieces.
    Severed,
}

/// Cuts the bonds of points and pieces that hang free after `broken` broke.
///
/// Whether the two ends of a broken bond are still connected is answered by growing a front from each end in turn: around a
/// crack tip they meet after a few steps, and only a piece that is really cut off is ever walked whole.
pub fn remove_fragments(body: &Body, bonds: &mut Bonds, broken: &[Bond]) -> Connectivity {
    let mut aside = Vec::new();
    // A point on a single bond swings freely about it: it carries nothing and leaves the stiffness singular.
    let least = if body.stencil.unknowns == 3 { 2 } else { 3 };
    let mut suspects: Vec<usize> = broken.iter().flat_map(|&b| [body.ends(b).1, body.ends(b).2]).collect();
    while let Some(place) = suspects.pop() {
        if bonds.intact_at(body, place) < least {
            suspects.extend(set_aside(body, bonds, place, &mut aside));
        }
    }
    // Where points come loose one by one no cut-off piece is found between them, however wide the gap.
    let loose = broken.iter().chain(&aside).any(|&bond| {
        let (_, a, b) = body.ends(bond);
        bonds.intact_at(body, a) == 0 || bonds.intact_at(body, b) == 0
    });
    if loose && !loads_are_connected(body, bonds) {
        return Connectivity::Severed;
    }
    // Points that are known to hang together.
    let mut together = HashSet::new();
    for &bond in broken {
        let (_, a, b) = body.ends(bond);
        let Some(piece) = cut_off(body, bonds, a, b, &mut together) else { continue };
        let inside = piece.iter().any(|&node| is_loaded(body, node));
        let outside = loaded_nodes(body, bonds).any(|node| !piece.contains(&node));
        if inside && outside {
            return Connectivity::Severed;
        }
        if !inside {
            together.clear();
            let mut members: Vec<usize> = piece.into_iter().filter(|&node| node < body.places()).collect();
            members.sort_unstable();
            for place in members {
                set_aside(body, bonds, place, &mut aside);
            }
        }
    }
    Connectivity::Connected(aside)
}

/// Cuts all bonds of a point; their other ends.
fn set_aside(body: &Body, bonds: &mut Bonds, place: usize, aside: &mut Vec<Bond>) -> Vec<usize> {
    let (cut, ends): (Vec<Bond>, Vec<usize>) = bonds.at(body, place).map(|(.., bond, other)| (bond as Bond, other)).unzip();
    cut.iter().for_each(|&bond| bonds.cut(body, bond));
    aside.extend(cut);
    ends
}

/// Whether all loaded points that still have bonds hang together.
fn loads_are_connected(body: &Body, bonds: &Bonds) -> bool {
    let loaded: Vec<usize> = loaded_nodes(body, bonds).collect();
    let Some(&first) = loaded.first() else { return false };
    let mut seen = vec![false; body.places()];
    let mut front = vec![first];
    seen[first] = true;
    while let Some(node) = front.pop() {
        let new = bonds.at(body, node).map(|(.., other)| other).filter(|&other| !std::mem::replace(&mut seen[other], true));
        front.extend(new);
    }
    loaded.into_iter().all(|node| seen[node])
}

/// Loaded points that still have bonds.
fn loaded_nodes<'a>(body: &'a Body, bonds: &'a Bonds) -> impl Iterator<Item = usize> + 'a {
    let places = body.points.iter().map(|&place| place as usize);
    places.filter(|&place| is_loaded(body, place) && bonds.intact_at(body, place) > 0)
}

fn is_loaded(body: &Body, node: usize) -> bool {
    let place = node as u32;
    let boundary = &body.boundary;
    boundary.forces.binary_search_by_key(&place, |f| f.0).is_ok()
        || boundary.corners.binary_search(&place).is_ok()
        || boundary.fixed.iter().any(|f| f.0 == place)
        || boundary.clamped.iter().any(|c| c.0 == place)
}

/// The piece around `a` or `b` that has lost contact with the other, if any; pieces without bonds do not count. Points found to
/// hang `together` are remembered: along a crack one way around its tip will do for all its bonds.
fn cut_off(body: &Body, bonds: &Bonds, a: usize, b: usize, together: &mut HashSet<usize>) -> Option<HashSet<usize>> {
    let mut seen = [HashSet::from([a]), HashSet::from([b])];
    let mut front = [vec![a], vec![b]];
    let mut is_known = [a, b].map(|end| together.contains(&end));
    loop {
        if is_known == [true, true] {
            together.extend(seen.iter().flatten());
            return None;
        }
        let side = usize::from(front[1].len() < front[0].len());
        let mut next = Vec::new();
        for place in std::mem::take(&mut front[side]) {
            let mut meets = false;
            for (.., other) in bonds.at(body, place) {
                meets |= seen[1 - side].contains(&other);
                if seen[side].insert(other) {
                    is_known[side] |= together.contains(&other);
                    next.push(other);
                }
            }
            if meets {
                if is_known == [false, false] {
                    together.clear();
                }
                together.extend(seen.iter().flatten());
                return None;
            }
        }
        if next.is_empty() {
            let piece = std::mem::take(&mut seen[side]);
            return (piece.len() > 1).then_some(piece);
        }
        front[side] = next;
    }
}
