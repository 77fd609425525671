//! Where nodes lie: at the corners of the cells, on rims, doubled along cracks, and at every tip.

use std::collections::HashMap;

use super::crack::TipAxes;
use super::cuts::Cut;
use super::grid::Grid;
use super::rims::{Stretch, stretches, well_apart};
use perilife_plate::specimen::geometry::{along, direction, distance, distance_to_segment, nearest_of_segment};
use perilife_plate::specimen::{Point, Specimen};

/// Distance from a rim, in spacings, within which corners of cells give way to nodes on the rim.
const RIM_SHARE: f64 = 0.4;
/// Distance of the two nodes that stand for one beside a crack from it, in spacings; nodes nearer than that are doubled. Nodes on one
/// side alone leave K 2 to 12 % wrong.
const FLANK_SHARE: f64 = 0.25;
/// Difference of the distances from two pieces of a crack, over that of its flanks, below which their corner is nearest.
const ON_CORNER: f64 = 1e-6;
/// Distance from a limit, over it, within which a node is on it, as its image is.
const ON_LIMIT: f64 = 1e-9;
/// Distance from a tip, in spacings, within which the nearest node becomes that of the tip.
const TIP_SHARE: f64 = 0.5;
/// Distance of two nodes on rims or beside a crack, in spacings, within which they are one: where corners of a rim come closer to its mouth than
/// [`FLANK_SHARE`], those on either side of it have the same foot, and two nodes on one place leave no stiffness to either.
const TWIN_SHARE: f64 = 0.1;
/// Distance of nodes on an arc that is drawn as a polygon, in spacings, at the least: where its corners are closer, not every one has a node. With
/// one at each of corners an eighth of a spacing apart K of a crack nearby is 1 to 10 % wrong.
const ON_ARC: f64 = 0.5;
/// Pieces of a hole between nodes at the least.
const PIECES_LEAST: usize = 12;

#[derive(Debug, Clone, Default)]
pub struct Nodes {
    /// Positions, m.
    pub at: Vec<Point>,
    /// Spacing around each, m.
    pub spacing: Vec<f64>,
}

impl Nodes {
    /// Nodes of a plate in these cells.
    pub fn place(specimen: &Specimen, grid: &Grid, sides: &[[Point; 2]], cuts: &[Cut], axes: &[TipAxes]) -> Self {
        let mut nodes = Nodes::default();
        let near_sides = by_leaf(grid, sides.iter().copied(), RIM_SHARE);
        let mut corners: HashMap<[i64; 2], (f64, bool)> = HashMap::new();
        let mut order = Vec::new();
        for leaf in grid.leaves() {
            let spacing = grid.spacing(leaf);
            for corner in grid.corners(leaf) {
                let at = grid.position(corner);
                let beside = near_sides.get(&leaf).is_some_and(|near| {
                    near.iter().any(|&side| {
                        let [a, b] = sides[side as usize];
                        distance_to_segment(at, a, b) < (1.0 - ON_LIMIT) * RIM_SHARE * spacing
                    })
                });
                let entry = corners.entry(corner).or_insert_with(|| {
                    order.push(corner);
                    (spacing, false)
                });
                *entry = (entry.0.max(spacing), entry.1 || beside);
            }
        }
        for corner in order {
            let (spacing, beside) = corners[&corner];
            let at = grid.position(corner);
            if !beside && specimen.contains(at) {
                nodes.push(at, spacing);
            }
        }
        let inside = nodes.at.len();
        let has_node = well_apart(&specimen.outline, grid, ON_ARC);
        for (index, stretch) in stretches(specimen).into_iter().enumerate() {
            let least = if matches!(stretch, Stretch::Circle(_)) { PIECES_LEAST } else { 1 };
            let shares = stretch.divided(grid, least, 1.0);
            // The last of a stretch is the first of the next one.
            let first = usize::from(has_node.get(index) == Some(&false));
            for share in &shares[first..shares.len() - 1] {
                let at = stretch.at(*share);
                let spacing = stretch.spacing(grid, *share);
                // Where the wall of a slot meets the outline both have a node.
                let is_alone = nodes.at[inside..].iter().all(|other| distance(*other, at) > TWIN_SHARE * spacing);
                // Slots and holes may cover others' rims, and slots reach beyond the outline.
                // At a corner the way inwards of one side may lie on the other.
                let ([x, y], step) = (stretch.inward(*share), 1e-6 * spacing);
                let mut ways = [[x, y], [x - y, x + y], [x + y, y - x]].into_iter();
                if is_alone && ways.any(|[x, y]| specimen.contains([at[0] + step * x, at[1] + step * y])) {
                    nodes.push(at, spacing);
                }
            }
        }
        nodes.part(specimen, cuts, axes)
    }

    fn push(&mut self, at: Point, spacing: f64) {
        self.at.push(at);
        self.spacing.push(spacing);
    }

    /// Doubles the nodes beside cracks, and puts one at every tip.
    fn part(mut self, specimen: &Specimen, cuts: &[Cut], axes: &[TipAxes]) -> Self {
        let mut at_tip = vec![None; self.at.len()];
        for (tip, axes) in axes.iter().enumerate() {
            let away = |k: &usize| distance(self.at[*k], axes.at);
            let nearest = (0..self.at.len()).filter(|k| at_tip[*k].is_none()).min_by(|a, b| away(a).total_cmp(&away(b)));
            if let Some(nearest) = nearest.filter(|k| away(k) < (1.0 - ON_LIMIT) * TIP_SHARE * self.spacing[*k]) {
                self.at[nearest] = axes.at;
                at_tip[nearest] = Some(tip);
            }
        }
        let mut parted = Nodes::default();
        let mut flanks: Vec<Point> = Vec::new();
        for (k, (&at, &spacing)) in self.at.iter().zip(&self.spacing).enumerate() {
            let reach = FLANK_SHARE * spacing;
            let is_near = |[a, b]: &[Point; 2]| (0..2).all(|i| at[i] > a[i].min(b[i]) - reach && at[i] < a[i].max(b[i]) + reach);
            let piece = cuts.iter().flat_map(|cut| cut.points.windows(2)).map(|piece| [piece[0], piece[1]]).filter(is_near);
            let near: Vec<(f64, [Point; 2])> = piece.map(|[a, b]| (distance_to_segment(at, a, b), [a, b])).collect();
            let nearest = near.iter().map(|near| near.0).fold(reach, f64::min);
            if nearest >= (1.0 - ON_LIMIT) * reach || at_tip[k].is_some() {
                parted.push(at, spacing);
                continue;
            }
            // Beside a corner, off the line between its sides.
            let level: Vec<[Point; 2]> =
                near.iter().filter(|near| near.0 <= nearest + ON_CORNER * reach).map(|near| near.1).collect();
            let sum = level.iter().map(|&[a, b]| direction(a, b)).fold([0.0; 2], |[x, y], [u, v]| {
                let sign = 1.0_f64.copysign(x * u + y * v);
                [x + sign * u, y + sign * v]
            });
            let [x, y] = direction([0.0; 2], sum);
            let feet = level.iter().map(|&[a, b]| nearest_of_segment(at, a, b));
            let foot = feet.fold([0.0; 2], |sum, foot| [0, 1].map(|i| sum[i] + foot[i] / level.len() as f64));
            for side in [-reach, reach] {
                let beside = [foot[0] - side * y, foot[1] + side * x];
                // At a mouth that is not square to its rim.
                let moved = || nearest_on_rim(specimen, [at[0] - side * y, at[1] + side * x]);
                let flank = if specimen.has_point_at(beside, ON_LIMIT * spacing) { beside } else { moved() };
                if flanks.iter().all(|other| distance(*other, flank) > TWIN_SHARE * spacing) {
                    flanks.push(flank);
                    parted.push(flank, spacing);
                }
            }
        }
        parted
    }
}

/// The point of a rim nearest to a place.
fn nearest_on_rim(specimen: &Specimen, at: Point) -> Point {
    let nearest = |stretch: Stretch| match stretch {
        Stretch::Straight([a, b]) => nearest_of_segment(at, a, b),
        Stretch::Circle(hole) => along(hole.centre, at, hole.radius / distance(hole.centre, at)),
    };
    let all = stretches(specimen).into_iter().map(nearest);
    all.min_by(|a, b| distance(*a, at).total_cmp(&distance(*b, at))).unwrap_or(at)
}

/// Segments by the leaves within `margin` spacings of which they come.
pub fn by_leaf(grid: &Grid, segments: impl Iterator<Item = [Point; 2]>, margin: f64) -> HashMap<usize, Vec<u32>> {
    let mut of_leaf: HashMap<usize, Vec<u32>> = HashMap::new();
    for (index, [a, b]) in segments.enumerate() {
        let low = [0, 1].map(|i| a[i].min(b[i]));
        let high = [0, 1].map(|i| a[i].max(b[i]));
        let wide =
            margin * grid.spacing(grid.leaf(along(a, b, 0.5))).max(grid.spacing(grid.leaf(a))).max(grid.spacing(grid.leaf(b)));
        grid.visit([low[0] - wide, low[1] - wide], [high[0] + wide, high[1] + wide], &mut |leaf| {
            let [from, to] = grid.bounds(leaf);
            let reach = 0.5 * distance(from, to) + margin * grid.spacing(leaf);
            if distance_to_segment(grid.middle(leaf), a, b) <= reach {
                of_leaf.entry(leaf).or_default().push(index as u32);
            }
        });
    }
    of_leaf
}
