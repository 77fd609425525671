//! What lies beyond a body that is only the finest part of a plate: coarser points, as far as the body has to know of them.
//!
//! The points of coarser levels fall into pieces that hang together without the body. Each is told as one thing that some points
//! of the body, its rim, are tied to; a crack that cuts the body in two has not cut the plate while both parts hang on one piece.

use super::Body;
use super::pre_crack::places_near;
use crate::specimen::Point;
use crate::specimen::geometry::distance;

/// Pieces of coarser points around a body.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CoarseNeighbours {
    /// Places tied to a piece, ascending, and which.
    ties: Vec<(u32, u32)>,
    /// Places tied to every piece.
    rims: Vec<Vec<u32>>,
    /// Whether loads or supports act on a piece.
    loaded: Vec<bool>,
}

impl CoarseNeighbours {
    /// Pieces, loaded or not, and the places tied to them.
    pub fn new(mut ties: Vec<(u32, u32)>, loaded: Vec<bool>) -> Self {
        ties.sort_unstable();
        ties.dedup();
        let mut rims = vec![Vec::new(); loaded.len()];
        ties.iter().for_each(|&(place, piece)| rims[piece as usize].push(place));
        CoarseNeighbours { ties, rims, loaded }
    }

    /// Number of pieces.
    pub fn pieces(&self) -> usize {
        self.loaded.len()
    }

    /// Pieces that a place is tied to.
    pub fn pieces_at(&self, place: usize) -> impl Iterator<Item = usize> + '_ {
        let first = self.ties.partition_point(|tie| (tie.0 as usize) < place);
        self.ties[first..].iter().take_while(move |tie| tie.0 as usize == place).map(|tie| tie.1 as usize)
    }

    /// Places tied to a piece, ascending.
    pub fn rim_of(&self, piece: usize) -> &[u32] {
        &self.rims[piece]
    }

    /// Whether loads or supports act on a piece.
    pub fn is_loaded(&self, piece: usize) -> bool {
        self.loaded[piece]
    }

    /// Whether a place is tied to any piece.
    pub fn is_rim(&self, place: usize) -> bool {
        self.pieces_at(place).next().is_some()
    }
}

impl Body {
    /// Whether a place of the material lies within `reach` (m) of what is beyond the body, or there.
    pub fn is_near_rim(&self, at: Point, reach: f64) -> bool {
        self.rim_distance(at, reach).is_some()
    }

    /// Distance of a place of the material from what is beyond the body, m, if it is at most `reach`; 0 there.
    pub fn rim_distance(&self, at: Point, reach: f64) -> Option<f64> {
        if self.beyond.pieces() == 0 {
            return None;
        }
        let mut near = places_near(self, at, at, reach.max(self.lattice.spacing)).peekable();
        if near.peek().is_none() {
            return Some(0.0);
        }
        let rims = near.filter(|&place| self.beyond.is_rim(place));
        rims.map(|place| distance(self.lattice.position(place), at)).min_by(f64::total_cmp)
    }
}
