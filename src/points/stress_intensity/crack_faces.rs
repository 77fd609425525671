//! The crack behind a tip, as the auxiliary fields of a ring see it: continued past joints, its faces, and angles counted to them; and the cells of
//! the lattice that a rim or a crack cuts, in parts.
//!
//! A point stands for the cell around it. Where a rim or a crack runs through the cell, part of it is void, or belongs to points on
//! the other side, and the fields there are those of that side. Such cells are divided, and every part in the material is given to the nearest point that
//! sees it.

use std::collections::HashSet;
use std::f64::consts::{PI, TAU};

use super::gradient::TipFrame;
use crate::body::Body;
use crate::body::pre_crack::as_cut;
use perilife_plate::specimen::geometry::{along, circle_shares, direction, distance, distance_to_segment, segments_touch};
use perilife_plate::specimen::{CrackLine, LineEnd, Point, Specimen};

/// The crack of a tip with one that its other end lies on, within `slack`, m: behind the place where both are joined the auxiliary field
/// is cut along that one, not through the material.
pub(super) fn continued(lines: &[CrackLine], end: LineEnd, slack: f64) -> CrackLine {
    let mut points = lines[end.line].points.clone();
    // From the tip back.
    if end.at_last {
        points.reverse();
    }
    let mut seen = vec![end.line];
    while let [.., before, joint] = points[..] {
        let is_joined = |line: &usize| !seen.contains(line) && lines[*line].distance(joint) < slack;
        let Some(other) = (0..lines.len()).find(is_joined) else { break };
        seen.push(other);
        let corners = &lines[other].points;
        let piece = (1..corners.len()).find(|&i| distance_to_segment(joint, corners[i - 1], corners[i]) < slack).unwrap_or(1);
        let arms = [corners[..piece].iter().rev().copied().collect::<Vec<_>>(), corners[piece..].to_vec()];
        let back = direction(before, joint);
        // The arm that turns least.
        let straightness = |arm: &Vec<Point>| {
            let far = arm.iter().find(|corner| distance(**corner, joint) > slack);
            far.map_or(f64::NEG_INFINITY, |&far| {
                let way = direction(joint, far);
                back[0] * way[0] + back[1] * way[1]
            })
        };
        let [first, second] = arms;
        let arm = if straightness(&second) > straightness(&first) { second } else { first };
        points.extend(arm.into_iter().filter(|corner| distance(*corner, joint) > slack));
    }
    if end.at_last {
        points.reverse();
    }
    CrackLine { points }
}

/// The crack behind a tip in its frame.
pub(super) struct CrackFaces {
    /// Pieces from the tip on, as the bonds see them.
    pieces: Vec<[Point; 2]>,
}

impl CrackFaces {
    pub(super) fn new(body: &Body, line: &CrackLine, at_last: bool, frame: &TipFrame) -> Self {
        let piece = |piece: [Point; 2]| {
            let ends = as_cut(body, piece).map(|p| frame.local(p));
            if at_last { [ends[1], ends[0]] } else { ends }
        };
        let mut pieces: Vec<[Point; 2]> = line.pieces().map(piece).collect();
        if at_last {
            pieces.reverse();
        }
        CrackFaces { pieces }
    }

    /// Angle by which the crack at a distance r behind the tip lies off the line straight behind it, counter-clockwise.
    fn bend(&self, r: f64) -> f64 {
        let size = |p: Point| p[0].hypot(p[1]);
        // The mouth lies outside the ring, or there is no material behind it.
        let piece = self.pieces.iter().find(|[_, far]| size(*far) >= r).or(self.pieces.last());
        let Some(&[a, b]) = piece else { return 0.0 };
        let at = along(a, b, circle_shares(a, b, [0.0; 2], r).map_or(0.0, |[_, leaves]| leaves));
        (-at[1]).atan2(-at[0])
    }

    /// Distance from the tip and angle from x₁ to a point of the frame, counted to the face of the crack on its side.
    pub(super) fn polar(&self, [x, y]: Point) -> (f64, f64) {
        let r = x.hypot(y);
        let bend = self.bend(r);
        let theta = y.atan2(x) - bend;
        let wrapped = if theta > PI {
            theta - TAU
        } else if theta <= -PI {
            theta + TAU
        } else {
            theta
        };
        (r, wrapped + bend)
    }
}

/// Parts of a cell along either axis.
const PARTS: usize = 4;
/// Places per spacing at which a line is asked which cells it cuts.
const PER_SPACING: f64 = 8.0;

/// Distance in spacings within which a position lies on the line between two cells: more than cracks are drawn aside.
const BESIDE: f64 = 0.01;

/// Difference of distances, in spacings, that is none: points that are equally near share a part.
const EQUAL: f64 = 1e-6;

/// A part of a cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FaceSegment {
    /// Its middle, m.
    pub at: Point,
    /// The point whose field it has.
    pub place: usize,
    /// Its area over that of a cell.
    pub share: f64,
}

/// Cells that hold a position; both where it lies on the line between two, so that mirror images stay mirror images.
pub fn cells_at(body: &Body, at: Point) -> impl Iterator<Item = usize> + '_ {
    let lattice = &body.lattice;
    let (columns, rows) = (lattice.columns as f64, lattice.rows as f64);
    let [column, row] = lattice.locate(at);
    [[-BESIDE, -BESIDE], [BESIDE, -BESIDE], [-BESIDE, BESIDE], [BESIDE, BESIDE]].into_iter().filter_map(move |[dx, dy]| {
        let (column, row) = ((column + dx).round(), (row + dy).round());
        let is_inside = (0.0..columns).contains(&column) && (0.0..rows).contains(&row);
        is_inside.then(|| lattice.place(column as usize, row as usize))
    })
}

/// Cells that straight pieces cut.
pub fn cells_along<'a>(body: &'a Body, pieces: &'a [[Point; 2]]) -> impl Iterator<Item = usize> + 'a {
    pieces.iter().flat_map(move |&[a, b]| {
        let count = (PER_SPACING * distance(a, b) / body.lattice.spacing).ceil().max(1.0);
        (0..=count as usize).flat_map(move |i| cells_at(body, along(a, b, i as f64 / count)))
    })
}

/// Parts of these cells that are material, each with the nearest point that sees it, of those that are `known`.
pub fn parts(
    body: &Body,
    specimen: &Specimen,
    cracks: &[[Point; 2]],
    cells: &HashSet<usize>,
    known: impl Fn(usize) -> bool,
) -> Vec<FaceSegment> {
    let lattice = &body.lattice;
    let neighbours: Vec<isize> = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| lattice.step(dx, dy))).collect();
    let mut cells: Vec<usize> = cells.iter().copied().collect();
    // The same sum on every run.
    cells.sort_unstable();
    let mut parts = Vec::with_capacity(cells.len() * PARTS * PARTS);
    for cell in cells {
        let (column, row) = lattice.column_row(cell);
        let near: Vec<(usize, Point)> = neighbours
            .iter()
            .filter_map(|&step| cell.checked_add_signed(step))
            .filter(|&place| body.is_point.get(place).is_some_and(|&is_point| is_point) && known(place))
            .map(|place| (place, lattice.position(place)))
            .collect();
        let centre = lattice.position(cell);
        let reach = 2.2 * lattice.spacing;
        let cracks: Vec<&[Point; 2]> = cracks.iter().filter(|[a, b]| distance_to_segment(centre, *a, *b) < reach).collect();
        for i in 0..PARTS * PARTS {
            let offset = |i: usize| (i as f64 + 0.5) / PARTS as f64 - 0.5;
            let at = lattice.position_of(column as f64 + offset(i % PARTS), row as f64 + offset(i / PARTS));
            if !specimen.contains(at) {
                continue;
            }
            let sees = |from: Point| !cracks.iter().any(|[a, b]| segments_touch(at, from, *a, *b));
            let seen: Vec<(usize, f64)> =
                near.iter().filter(|(_, from)| sees(*from)).map(|&(place, from)| (place, distance(from, at))).collect();
            let least = seen.iter().map(|(_, away)| *away).fold(f64::INFINITY, f64::min) + EQUAL * lattice.spacing;
            let nearest: Vec<usize> = seen.into_iter().filter(|(_, away)| *away <= least).map(|(place, _)| place).collect();
            let share = 1.0 / (PARTS * PARTS * nearest.len()) as f64;
            parts.extend(nearest.into_iter().map(|place| FaceSegment { at, place, share }));
        }
    }
    parts
}
