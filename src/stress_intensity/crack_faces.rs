//! The crack behind a tip, as the auxiliary fields of a ring see it: continued past joints, its faces, and angles counted to them.

use std::f64::consts::{PI, TAU};

use super::gradient::TipFrame;
use crate::body::Body;
use crate::body::facets::Facet;
use crate::body::pre_crack::as_cut;
use crate::specimen::geometry::{along, circle_shares, direction, distance, distance_to_segment};
use crate::specimen::{CrackLine, LineEnd, Point};

/// Pieces of a crack face per spacing.
const PIECES_PER_SPACING: f64 = 2.0;

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

/// Both faces of a straight piece of crack, as the bonds see it: a trifle aside of the line that was asked for.
pub(super) fn faces(body: &Body, piece: [Point; 2]) -> impl Iterator<Item = Facet> {
    let [a, b] = as_cut(body, piece);
    let length = distance(a, b);
    let count = (PIECES_PER_SPACING * length / body.lattice.spacing).ceil().max(1.0);
    let [x, y] = [0, 1].map(|i| (b[i] - a[i]) / length.max(f64::MIN_POSITIVE));
    (0..count as usize).flat_map(move |i| {
        let at = along(a, b, (i as f64 + 0.5) / count);
        // Outward from the material on the left of the line is to its right, and the other way round.
        [[y, -x], [-y, x]].map(|normal| Facet { at, normal, length: length / count })
    })
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
