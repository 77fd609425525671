//! Pieces that breaking has cut off: set aside when nothing loads them, `severed` when both sides are loaded.

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
    let mut marks = Marks { of: vec![0; body.places()], together: Vec::new() };
    for &bond in broken {
        let (_, a, b) = body.ends(bond);
        let Some(mut piece) = cut_off(body, bonds, [a, b], &mut marks) else { continue };
        piece.sort_unstable();
        let inside = piece.iter().any(|&node| is_loaded(body, node));
        let outside = loaded_nodes(body, bonds).any(|node| piece.binary_search(&node).is_err());
        if inside && outside {
            return Connectivity::Severed;
        }
        if !inside {
            marks.forget();
            for place in piece {
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

/// What is known of places: bits 1 and 2 of those seen from either end of a bond, 4 of those that hang together.
struct Marks {
    of: Vec<u8>,
    together: Vec<usize>,
}

const TOGETHER: u8 = 4;

impl Marks {
    /// Lets all that was seen hang together.
    fn join(&mut self, seen: [Vec<usize>; 2]) {
        for place in seen.into_iter().flatten() {
            if self.of[place] & TOGETHER == 0 {
                self.together.push(place);
            }
            self.of[place] = TOGETHER;
        }
    }

    /// Forgets what hangs together.
    fn forget(&mut self) {
        for place in std::mem::take(&mut self.together) {
            self.of[place] &= !TOGETHER;
        }
    }
}

/// The piece around one of the ends that has lost contact with the other, if any; pieces without bonds do not count. Points found to
/// hang together are remembered: along a crack one way around its tip will do for all its bonds.
fn cut_off(body: &Body, bonds: &Bonds, ends: [usize; 2], marks: &mut Marks) -> Option<Vec<usize>> {
    let mut seen = ends.map(|end| vec![end]);
    let mut front = seen.clone();
    let mut is_known = ends.map(|end| marks.of[end] & TOGETHER != 0);
    [0, 1].into_iter().for_each(|side| marks.of[ends[side]] |= 1 << side);
    loop {
        if is_known == [true; 2] {
            marks.join(seen);
            return None;
        }
        let side = usize::from(front[1].len() < front[0].len());
        let (own, far) = (1 << side, 2 >> side);
        let mut next = Vec::new();
        for place in std::mem::take(&mut front[side]) {
            let mut meets = false;
            for (.., other) in bonds.at(body, place) {
                let mark = marks.of[other];
                meets |= mark & far != 0;
                if mark & own == 0 {
                    marks.of[other] |= own;
                    is_known[side] |= mark & TOGETHER != 0;
                    seen[side].push(other);
                    next.push(other);
                }
            }
            if meets {
                if is_known == [false; 2] {
                    marks.forget();
                }
                marks.join(seen);
                return None;
            }
        }
        if next.is_empty() {
            seen.iter().flatten().for_each(|&place| marks.of[place] &= TOGETHER);
            let piece = std::mem::take(&mut seen[side]);
            return (piece.len() > 1).then_some(piece);
        }
        front[side] = next;
    }
}
