//! Stress and displacement over a plate of nodes as convex pieces, which rims and cracks bound: what lies beside a flank is read from its own
//! side only, so that a crack opens between pieces and no stress is carried over it.

use std::collections::HashMap;

use rayon::prelude::*;

use super::cells::{Dividers, middle};
use super::field::{Discretisation, Local};
use super::solve::Stress;
use perilife_plate::material::Plane;
use perilife_plate::specimen::geometry::{along, bounding_box, distance_to_segment};
use perilife_plate::specimen::{Point, Specimen};

/// Pieces at the least over the larger side of the plate, and over the cracks and their surroundings.
const ACROSS: f64 = 56.0;
/// See [`ACROSS`].
const ACROSS_CRACKS: f64 = 24.0;
/// Way from a corner to the middle of its piece at which the corner is read, over the whole way.
const INWARDS: f64 = 1e-3;
/// Distance from a rim or crack, over the spacing, within which a side of a piece lies on it.
const ON_RIM: f64 = 1e-2;

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Corner {
    /// Where it is, m.
    pub at: Point,
    /// Displacement, m.
    pub displacement: Point,
    /// Stress, Pa.
    pub stress: Stress,
    /// Whether the side to the next corner is a rim of the plate or a flank of a crack.
    pub is_free: bool,
}

/// Convex pieces of the whole plate, counter-clockwise; both of them times `share`.
pub fn stress_pieces(specimen: &Specimen, plate: &Discretisation, u: &[f64], plane: Plane, share: f64) -> Vec<Vec<Corner>> {
    let (grid, dividers) = (&plate.grid, Dividers::of(plate));
    let of_cracks: Vec<Point> = specimen.cracks.iter().flat_map(|crack| [crack.from, crack.to]).collect();
    let [low, high] = bounding_box(&of_cracks);
    let cracked = (high[0] - low[0]).max(high[1] - low[1]);
    let size = Discretisation::size(specimen);
    let finest =
        if of_cracks.is_empty() { size / ACROSS } else { (size / ACROSS).min(cracked / ACROSS_CRACKS).max(0.4 * size / ACROSS) };
    let leaves: Vec<usize> = grid.leaves().collect();
    let of_leaf = |local: &mut Local, &leaf: &usize| {
        let (near, spacing) = (dividers.of_cell(leaf), grid.spacing(leaf));
        let parts = (spacing / finest).ceil().clamp(1.0, 16.0) as usize;
        let pieces = near.divide(specimen, squares(grid.bounds(leaf), parts), spacing);
        // What nothing divides is read once at a corner of four pieces.
        let is_whole = near.sides.is_empty() && near.cracks.is_empty();
        let mut known: HashMap<[u64; 2], (Point, Stress)> = HashMap::new();
        let read = |piece: &Vec<Point>| {
            let centre = middle(piece);
            let corner = |k: usize| {
                let (at, next) = (piece[k], piece[(k + 1) % piece.len()]);
                let key = at.map(f64::to_bits);
                let (displacement, stress) = match known.get(&key).copied().filter(|_| is_whole) {
                    Some(found) => found,
                    None => {
                        let (moved, gradient) = plate.displacement_in(leaf, u, along(at, centre, INWARDS), local)?;
                        let stress = Stress::of(plate.elasticity(), plane, &gradient).times(share);
                        (moved.map(|u| share * u), stress)
                    }
                };
                known.insert(key, (displacement, stress));
                let beside = along(at, next, 0.5);
                let is_on = |[a, b]: &[Point; 2]| distance_to_segment(beside, *a, *b) < ON_RIM * spacing;
                Some(Corner { at, displacement, stress, is_free: near.sides.iter().chain(&near.cracks).any(is_on) })
            };
            (0..piece.len()).map(corner).collect::<Option<Vec<Corner>>>()
        };
        pieces.iter().filter_map(read).collect::<Vec<_>>()
    };
    leaves.par_iter().map_init(Local::default, of_leaf).flatten_iter().collect()
}

/// A cell as `parts` by `parts` squares.
fn squares([low, high]: [Point; 2], parts: usize) -> Vec<Vec<Point>> {
    let at = |i: usize, axis: usize| low[axis] + i as f64 / parts as f64 * (high[axis] - low[axis]);
    let square = |k: usize| {
        let [x, y] = [(k % parts, 0), (k / parts, 1)].map(|(i, axis)| [at(i, axis), at(i + 1, axis)]);
        vec![[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]]]
    };
    (0..parts * parts).map(square).collect()
}
