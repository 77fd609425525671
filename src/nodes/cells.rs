//! Points of integration: Gauss points of whole cells, and those of the convex pieces into which rims and cracks divide a cell.
//!
//! A cell is divided by the line of every side of a rim and every piece of crack that crosses it, and at a tip also across the crack;
//! pieces that are no material are dropped. A piece has 3 × 3 points for every four of its corners, one that has a tip as corner
//! 5 × 5 with the distance from the tip squared, so that r^(-1) is integrated as a polynomial.

use std::collections::HashMap;

use rayon::prelude::*;

use super::field::Discretisation;
use super::grid::Grid;
use super::nodes::by_leaf;
use perilife_plate::specimen::geometry::{along, distance, polygon_area as area, turn};
use perilife_plate::specimen::{Point, Specimen};

/// Gauss points on [0, 1] of order 3, and their weights.
const THREE: [(f64, f64); 3] = [(0.112_701_665_379_258_3, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.887_298_334_620_741_7, 5.0 / 18.0)];
/// Gauss points on [0, 1] of order 8.
pub const EIGHT: [(f64, f64); 8] = [
    (0.019_855_071_751_231_88, 0.050_614_268_145_188_13),
    (0.101_666_761_293_186_6, 0.111_190_517_226_687_2),
    (0.237_233_795_041_835_5, 0.156_853_322_938_943_6),
    (0.408_282_678_752_175_1, 0.181_341_891_689_181),
    (0.591_717_321_247_825, 0.181_341_891_689_181),
    (0.762_766_204_958_164_5, 0.156_853_322_938_943_6),
    (0.898_333_238_706_813_4, 0.111_190_517_226_687_2),
    (0.980_144_928_248_768_1, 0.050_614_268_145_188_13),
];
/// Gauss points on [0, 1] of order 5.
const FIVE: [(f64, f64); 5] = [
    (0.046_910_077_030_668, 0.118_463_442_528_094_5),
    (0.230_765_344_947_158_4, 0.239_314_335_249_683_2),
    (0.5, 0.284_444_444_444_444_4),
    (0.769_234_655_052_841_6, 0.239_314_335_249_683_2),
    (0.953_089_922_969_332, 0.118_463_442_528_094_5),
];
/// Area of a piece over that of its cell below which it is round-off.
const SLIVER: f64 = 1e-9;
/// Size of a piece over that of its cell from which one point is enough: its share of the energy is the square of that.
const SMALL: f64 = 0.1;
/// Distance, in spacings, within which a corner of a piece is the tip.
const AT_TIP: f64 = 1e-6;

/// Distance of a line from a cell, in its spacings, within which it runs along the border: cells on both sides of it have it as a side.
const ON_BORDER: f64 = 1e-6;
/// Distance of a tip from a cell, in its spacings, within which the cell is integrated as one with a tip, at the point nearest to it: 1/r
/// a thousandth of a spacing beyond a side leaves K 2 % wrong by 3 × 3 points.
const BESIDE_TIP: f64 = 0.3;

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct QuadraturePoint {
    /// Position, m.
    pub at: Point,
    /// Area that it stands for, m².
    pub area: f64,
}

pub struct Dividers {
    sides: Vec<[Point; 2]>,
    cracks: Vec<[Point; 2]>,
    sides_near: HashMap<usize, Vec<u32>>,
    cracks_near: HashMap<usize, Vec<u32>>,
    tips: HashMap<usize, Vec<(Point, Point)>>,
}

/// What divides one cell: sides of rims, pieces of cracks, and tips with the directions ahead of them.
pub struct OfCell {
    pub sides: Vec<[Point; 2]>,
    pub cracks: Vec<[Point; 2]>,
    tips: Vec<(Point, Point)>,
}

impl Dividers {
    pub fn of(plate: &Discretisation) -> Self {
        let grid = &plate.grid;
        let pieces = plate.obstacles.cuts.iter().flat_map(|cut| cut.points.windows(2)).map(|piece| [piece[0], piece[1]]);
        let cracks: Vec<[Point; 2]> = pieces.collect();
        let mut tips: HashMap<usize, Vec<(Point, Point)>> = HashMap::new();
        for axes in &plate.axes {
            let reach = BESIDE_TIP * axes.spacing;
            grid.visit(axes.at.map(|x| x - reach), axes.at.map(|x| x + reach), &mut |leaf| {
                let [low, high] = grid.bounds(leaf);
                let nearest = [0, 1].map(|i| axes.at[i].clamp(low[i], high[i]));
                tips.entry(leaf).or_default().push((nearest, axes.ahead));
            });
        }
        let [sides_near, cracks_near] =
            [&plate.sides, &cracks].map(|segments| by_leaf(grid, segments.iter().copied(), ON_BORDER));
        Dividers { sides: plate.sides.clone(), cracks, sides_near, cracks_near, tips }
    }

    pub fn of_cell(&self, leaf: usize) -> OfCell {
        let beside = |near: &HashMap<usize, Vec<u32>>, all: &[[Point; 2]]| -> Vec<[Point; 2]> {
            near.get(&leaf).into_iter().flatten().map(|&index| all[index as usize]).collect()
        };
        OfCell {
            sides: beside(&self.sides_near, &self.sides),
            cracks: beside(&self.cracks_near, &self.cracks),
            tips: self.tips.get(&leaf).cloned().unwrap_or_default(),
        }
    }
}

impl OfCell {
    fn is_empty(&self) -> bool {
        self.sides.is_empty() && self.cracks.is_empty() && self.tips.is_empty()
    }

    /// The material of convex pieces of a cell of this spacing, m, as convex pieces.
    pub fn divide(&self, specimen: &Specimen, mut pieces: Vec<Vec<Point>>, spacing: f64) -> Vec<Vec<Point>> {
        let least = SLIVER * spacing * spacing;
        for &side in &self.sides {
            divide(&mut pieces, side, least);
        }
        pieces.retain(|piece| specimen.contains(middle(piece)));
        for &crack in &self.cracks {
            divide(&mut pieces, crack, least);
        }
        for &(tip, [x, y]) in &self.tips {
            let reach = 2.0 * spacing;
            for [x, y] in [[x, y], [-y, x]] {
                let across = [[tip[0] - reach * x, tip[1] - reach * y], [tip[0] + reach * x, tip[1] + reach * y]];
                let (mut holding, others): (Vec<_>, Vec<_>) =
                    pieces.into_iter().partition(|piece| holds(piece, tip, AT_TIP * spacing));
                divide(&mut holding, across, least);
                pieces = [others, holding].concat();
            }
        }
        pieces
    }
}

/// Points of integration of cells, of each that has material, with a share of their area.
pub fn quadrature(specimen: &Specimen, plate: &Discretisation, cells: &[(usize, f64)]) -> Vec<(usize, Vec<QuadraturePoint>)> {
    let (grid, dividers) = (&plate.grid, Dividers::of(plate));
    let of_leaf = |&(leaf, share): &(usize, f64)| {
        let near = dividers.of_cell(leaf);
        let mut points = if near.is_empty() {
            if specimen.contains(grid.middle(leaf)) { whole(grid, leaf) } else { Vec::new() }
        } else {
            divided(specimen, grid, leaf, &near)
        };
        points.iter_mut().for_each(|point| point.area *= share);
        // A piece may be divided at a corner that lies on one of its sides; on a crack, what has no area would be a side of its own.
        points.retain(|point| point.area > 0.0);
        (!points.is_empty()).then_some((leaf, points))
    };
    cells.par_iter().filter_map(of_leaf).collect()
}

/// Points of a cell that nothing divides.
fn whole(grid: &Grid, leaf: usize) -> Vec<QuadraturePoint> {
    let [low, high] = grid.bounds(leaf);
    let mut points = Vec::with_capacity(9);
    quadrilateral([low, [high[0], low[1]], high, [low[0], high[1]]], &mut points);
    points
}

/// Points of a cell that something divides.
fn divided(specimen: &Specimen, grid: &Grid, leaf: usize, near: &OfCell) -> Vec<QuadraturePoint> {
    let ([low, high], spacing) = (grid.bounds(leaf), grid.spacing(leaf));
    let mut points = Vec::new();
    for piece in near.divide(specimen, vec![vec![low, [high[0], low[1]], high, [low[0], high[1]]]], spacing) {
        let corner = |tip: &Point| piece.iter().position(|corner| distance(*corner, *tip) < AT_TIP * spacing);
        match near.tips.iter().find_map(|(tip, _)| corner(tip)) {
            Some(corner) => fan(&piece, corner, &mut points),
            None => convex(&piece, spacing, &mut points),
        }
    }
    points
}

/// Whether a convex piece holds a point, its rim included.
fn holds(piece: &[Point], at: Point, slack: f64) -> bool {
    (0..piece.len()).all(|k| {
        let (a, b) = (piece[k], piece[(k + 1) % piece.len()]);
        turn(a, b, at) >= -slack * distance(a, b)
    })
}

pub fn middle(piece: &[Point]) -> Point {
    [0, 1].map(|i| piece.iter().map(|corner| corner[i]).sum::<f64>() / piece.len() as f64)
}

/// Divides every piece that a segment crosses by its line.
fn divide(pieces: &mut Vec<Vec<Point>>, [a, b]: [Point; 2], least: f64) {
    for index in 0..pieces.len() {
        if !crosses(&pieces[index], a, b) {
            continue;
        }
        let (left, right) = split(&pieces[index], a, b);
        if area(&left) > least && area(&right) > least {
            pieces[index] = left;
            pieces.push(right);
        }
    }
}

/// Whether a segment has a stretch in a convex piece.
fn crosses(piece: &[Point], a: Point, b: Point) -> bool {
    // What is left of the segment within every side.
    let (mut from, mut to) = (0.0_f64, 1.0_f64);
    for k in 0..piece.len() {
        let (c, d) = (piece[k], piece[(k + 1) % piece.len()]);
        let (at_a, at_b) = (turn(c, d, a), turn(c, d, b));
        if at_a <= 0.0 && at_b <= 0.0 {
            return false;
        }
        if at_a < 0.0 {
            from = from.max(at_a / (at_a - at_b));
        } else if at_b < 0.0 {
            to = to.min(at_a / (at_a - at_b));
        }
    }
    to - from > 1e-9
}

/// The parts of a convex piece on the left and on the right of a line.
fn split(piece: &[Point], a: Point, b: Point) -> (Vec<Point>, Vec<Point>) {
    let (mut left, mut right) = (Vec::new(), Vec::new());
    for k in 0..piece.len() {
        let (p, q) = (piece[k], piece[(k + 1) % piece.len()]);
        let (at_p, at_q) = (turn(a, b, p), turn(a, b, q));
        if at_p >= 0.0 {
            left.push(p);
        }
        if at_p <= 0.0 {
            right.push(p);
        }
        if (at_p > 0.0 && at_q < 0.0) || (at_p < 0.0 && at_q > 0.0) {
            let meeting = along(p, q, at_p / (at_p - at_q));
            left.push(meeting);
            right.push(meeting);
        }
    }
    (left, right)
}

/// Points of a convex piece: of quadrilaterals and a triangle around its first corner.
fn convex(piece: &[Point], spacing: f64, points: &mut Vec<QuadraturePoint>) {
    let whole = area(piece);
    if whole < SMALL * SMALL * spacing * spacing && piece.len() > 2 {
        for k in 1..piece.len() - 1 {
            let triangle = [piece[0], piece[k], piece[k + 1]];
            points.push(QuadraturePoint { at: middle(&triangle), area: area(&triangle) });
        }
        return;
    }
    let mut k = 1;
    while k + 2 < piece.len() {
        quadrilateral([piece[0], piece[k], piece[k + 1], piece[k + 2]], points);
        k += 2;
    }
    if k + 1 < piece.len() {
        triangle([piece[0], piece[k], piece[k + 1]], points);
    }
}

/// 3 × 3 points of the bilinear map of a square.
fn quadrilateral([a, b, c, d]: [Point; 4], points: &mut Vec<QuadraturePoint>) {
    for (s, of_s) in THREE {
        for (t, of_t) in THREE {
            let at = along(along(a, b, s), along(d, c, s), t);
            let of_s_side = [0, 1].map(|i| (1.0 - t) * (b[i] - a[i]) + t * (c[i] - d[i]));
            let of_t_side = [0, 1].map(|i| (1.0 - s) * (d[i] - a[i]) + s * (c[i] - b[i]));
            let determinant = of_s_side[0] * of_t_side[1] - of_s_side[1] * of_t_side[0];
            points.push(QuadraturePoint { at, area: of_s * of_t * determinant });
        }
    }
}

/// The rule of degree 5 with seven points (Radon 1948).
fn triangle(corners: [Point; 3], points: &mut Vec<QuadraturePoint>) {
    let whole = area(&corners);
    let root = 15.0_f64.sqrt();
    let centre = middle(&corners);
    points.push(QuadraturePoint { at: centre, area: 0.225 * whole });
    for (share, weight) in [((6.0 - root) / 21.0, (155.0 - root) / 1200.0), ((6.0 + root) / 21.0, (155.0 + root) / 1200.0)] {
        for k in 0..3 {
            let at =
                [0, 1].map(|i| share * (corners[(k + 1) % 3][i] + corners[(k + 2) % 3][i]) + (1.0 - 2.0 * share) * corners[k][i]);
            points.push(QuadraturePoint { at, area: weight * whole });
        }
    }
}

/// Points of the triangles from a tip to the sides of a piece that do not meet it.
fn fan(piece: &[Point], tip: usize, points: &mut Vec<QuadraturePoint>) {
    let corner = |k: usize| piece[(tip + k) % piece.len()];
    for k in 1..piece.len() - 1 {
        let (a, b, c) = (corner(0), corner(k), corner(k + 1));
        let whole = area(&[a, b, c]);
        for (s, of_s) in FIVE {
            for (t, of_t) in FIVE {
                // Way from the tip s²: dA = 2 A s² d(s²) dt = 4 A s³ ds dt.
                let at = along(a, along(b, c, t), s * s);
                points.push(QuadraturePoint { at, area: 4.0 * whole * s * s * s * of_s * of_t });
            }
        }
    }
}
