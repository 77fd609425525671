//! Rims of a plate as straight sides: the outline, holes, slots; holes in sides a quarter of the local spacing long.

use super::grid::Grid;
use perilife_plate::specimen::geometry::{along, direction, distance, distance_to_segment, edges, turn_at};
use perilife_plate::specimen::{Hole, Point, Specimen};

/// Turn of a re-entrant corner of the outline up to which it belongs to an arc drawn as a polygon, rad; beyond, the corner is sharp.
pub const ARC_TURN: f64 = 0.45;
/// Sides of a hole in its local spacing.
const SIDES_IN_SPACING: f64 = 4.0;
/// Sides of a hole at the least.
const SIDES_LEAST: usize = 32;
/// Divisions of a circle come in fours: a hole is its own image as a plate may be.
const QUARTERS: usize = 4;
/// Places at which a stretch is asked for its largest spacing.
const LOOKS: usize = 32;

/// A stretch of rim that nodes are spread on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Stretch {
    /// Straight, between two corners.
    Straight([Point; 2]),
    Circle(Hole),
}

impl Stretch {
    /// The point at a share of its length, m.
    pub fn at(&self, share: f64) -> Point {
        match self {
            Stretch::Straight([a, b]) => along(*a, *b, share),
            Stretch::Circle(hole) => {
                let (sin, cos) = (std::f64::consts::TAU * share).sin_cos();
                [hole.centre[0] + hole.radius * cos, hole.centre[1] + hole.radius * sin]
            }
        }
    }

    /// Its length, m.
    pub fn length(&self) -> f64 {
        match self {
            Stretch::Straight([a, b]) => distance(*a, *b),
            Stretch::Circle(hole) => std::f64::consts::TAU * hole.radius,
        }
    }

    /// Distance of a point from it, m.
    pub fn distance(&self, at: Point) -> f64 {
        match self {
            Stretch::Straight([a, b]) => distance_to_segment(at, *a, *b),
            Stretch::Circle(hole) => (distance(at, hole.centre) - hole.radius).abs(),
        }
    }

    /// Unit vector into the material.
    pub fn inward(&self, share: f64) -> Point {
        match self {
            Stretch::Straight([a, b]) => {
                let [x, y] = direction(*a, *b);
                [-y, x]
            }
            Stretch::Circle(_) => {
                let (sin, cos) = (std::f64::consts::TAU * share).sin_cos();
                [cos, sin]
            }
        }
    }

    /// Shares at which it is divided into pieces no longer than `share_of_spacing` local spacings, first and last included.
    pub fn divided(&self, grid: &Grid, pieces_least: usize, share_of_spacing: f64) -> Vec<f64> {
        let mut shares = vec![0.0];
        let whole = self.length();
        let mut first = pieces_least.max(1);
        // Both ends may lie where the grid is finest.
        let looks = first.max(LOOKS);
        let largest = (0..=looks).map(|k| self.spacing(grid, k as f64 / looks as f64)).fold(0.0, f64::max);
        first = first.max((whole / (share_of_spacing * largest) - 1e-6).ceil() as usize);
        if matches!(self, Stretch::Circle(_)) {
            first = first.next_multiple_of(QUARTERS);
        }
        for k in 0..first {
            self.divide(grid, [k, k + 1].map(|k| k as f64 / first as f64), share_of_spacing, &mut shares);
        }
        shares
    }

    /// Spacing at a share of it, that of the finer cell on a border of two.
    pub fn spacing(&self, grid: &Grid, share: f64) -> f64 {
        grid.finest(self.at(share))
    }

    fn divide(&self, grid: &Grid, [from, to]: [f64; 2], share_of_spacing: f64, shares: &mut Vec<f64>) {
        let middle = 0.5 * (from + to);
        let wanted = [0.5 * (from + middle), middle, 0.5 * (middle + to)].map(|share| self.spacing(grid, share));
        let wanted = wanted.into_iter().fold(f64::INFINITY, f64::min);
        if (to - from) * self.length() > 1.5 * share_of_spacing * wanted {
            self.divide(grid, [from, middle], share_of_spacing, shares);
            self.divide(grid, [middle, to], share_of_spacing, shares);
        } else {
            shares.push(to);
        }
    }
}

pub fn stretches(specimen: &Specimen) -> Vec<Stretch> {
    let outline = edges(&specimen.outline).map(|(a, b)| Stretch::Straight([a, b]));
    let holes = specimen.holes.iter().map(|hole| Stretch::Circle(*hole));
    let mut all: Vec<Stretch> = outline.chain(holes).collect();
    for slot in &specimen.slots {
        // Counter-clockwise around the slot, so that the material is on the right: turned over.
        all.extend(edges(&slot.corners()).map(|(a, b)| Stretch::Straight([b, a])));
    }
    all
}

/// Straight sides of rims, by their ends, m, that cells are cut along.
pub fn sides(specimen: &Specimen, grid: &Grid) -> Vec<[Point; 2]> {
    let outline = &specimen.outline;
    let kept = well_apart(outline, grid, 1.0 / SIDES_IN_SPACING);
    let kept: Vec<Point> = outline.iter().zip(kept).filter(|(_, kept)| *kept).map(|(corner, _)| *corner).collect();
    let mut sides: Vec<[Point; 2]> = edges(&kept).map(|(a, b)| [a, b]).collect();
    for stretch in &stretches(specimen)[outline.len()..] {
        match stretch {
            Stretch::Straight(ends) => sides.push(*ends),
            Stretch::Circle(_) => {
                let shares = stretch.divided(grid, SIDES_LEAST, 1.0 / SIDES_IN_SPACING);
                sides.extend(shares.windows(2).map(|pair| [stretch.at(pair[0]), stretch.at(pair[1])]));
            }
        }
    }
    sides
}

/// Of every corner of the outline, whether it is kept where corners of arcs are to be this share of the local spacing apart: sharp ones are.
pub fn well_apart(outline: &[Point], grid: &Grid, share: f64) -> Vec<bool> {
    let count = outline.len();
    let corner = |k: usize| outline[k % count];
    let is_sharp = |k: usize| turn_at(corner(k + count - 1), corner(k), corner(k + 1)).abs() > ARC_TURN;
    let first = (0..count).find(|k| is_sharp(*k)).unwrap_or(0);
    let mut kept = vec![true; count];
    let mut way = 0.0;
    for k in first + 1..first + count {
        way += distance(corner(k - 1), corner(k));
        let to_sharp = if is_sharp(k + 1) { distance(corner(k), corner(k + 1)) } else { f64::INFINITY };
        if !is_sharp(k) && way.min(to_sharp) < share * grid.finest(corner(k)) {
            kept[k % count] = false;
        } else {
            way = 0.0;
        }
    }
    kept
}
