//! Cracks of a plate as cuts, and the axes of their tips.

use super::cuts::{Cut, lengthened, simplified};
use perilife_plate::specimen::geometry::{
    along, bounding_box, direction, distance, distance_to_polygon, edges, meeting_share, nearest_share, segments_touch,
};
use perilife_plate::specimen::{CrackLine, LineEnd, Point, Slot, Specimen};
use perilife_plate::williams::{Eigenfunction, Elasticity};

/// Distance within which an end of a crack lies on a rim or on another crack, in sizes of the plate.
const TOUCH: f64 = 1e-7;
/// By how much a crack is cut beyond another that it meets, in sizes of the plate.
const BEYOND: f64 = 1e-6;
/// Corners within this of a straight line, in spacings at the tip, are none.
const STRAIGHT: f64 = 0.005;

/// A tip as nodes see it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tip {
    pub end: LineEnd,
    /// Length of its crack, half of it with two tips, or growth since the last kink if that is less, m.
    pub length: f64,
}

/// The initial cracks of a specimen, and their tips as nodes see them; ends of slots are none.
pub fn initial_cracks(specimen: &Specimen) -> (Vec<CrackLine>, Vec<Tip>) {
    let lines = specimen.crack_lines();
    let ends = (0..specimen.tips.len()).filter_map(|tip| specimen.line_end(tip));
    let length = |line: &CrackLine| line.length() / specimen.tips_of(line).max(1) as f64;
    let tips = ends.map(|end| Tip { end, length: length(&lines[end.line]) }).collect();
    (lines, tips)
}

/// Axes of a tip: x₁ along the crack, out of it.
#[derive(Debug, Clone, PartialEq)]
pub struct TipAxes {
    /// The tip, m.
    pub at: Point,
    /// Unit vector x₁.
    pub ahead: Point,
    /// The crack from the tip backwards, m, the tip first.
    pub back: Vec<Point>,
    /// Spacing of nodes at the tip, m.
    pub spacing: f64,
}

/// Cuts of a plate and the axes of its tips, in the order of `tips`: line end and spacing at it, m.
pub fn cracks(specimen: &Specimen, lines: &[CrackLine], tips: &[(LineEnd, f64)], far: f64) -> (Vec<Cut>, Vec<TipAxes>) {
    let [low, high] = bounding_box(&specimen.outline);
    let size = distance(low, high);
    let spacing = |line: usize| tips.iter().filter(|tip| tip.0.line == line).map(|tip| tip.1).fold(far, f64::min);
    let drawn: Vec<Vec<Point>> =
        lines.iter().enumerate().map(|(index, line)| simplified(&line.points, STRAIGHT * spacing(index))).collect();
    let mut taken = vec![[false; 2]; specimen.slots.len()];
    let mut cuts: Vec<Cut> = drawn
        .iter()
        .enumerate()
        .map(|(index, points)| {
            let (mut points, mut free) = (points.clone(), Vec::new());
            for at_last in [false, true] {
                let end = LineEnd { line: index, at_last };
                if tips.iter().any(|tip| tip.0 == end) {
                    free.push(lines[index].end(at_last));
                    continue;
                }
                if !at_last {
                    points.reverse();
                }
                points = beyond_mouth(specimen, lines, index, points, size, far, &mut taken);
                if !at_last {
                    points.reverse();
                }
            }
            Cut { points, free }
        })
        .collect();
    let slots = specimen.slots.iter().zip(&taken).filter(|(_, taken)| **taken == [false; 2]);
    cuts.extend(slots.map(|(slot, _)| Cut { points: vec![slot.from, slot.to], free: inner_ends(specimen, slot, size) }));
    let axes = tips.iter().map(|&(end, spacing)| {
        let mut back = drawn[end.line].clone();
        if end.at_last {
            back.reverse();
        }
        TipAxes { at: back[0], ahead: direction(back[1], back[0]), back, spacing }
    });
    (cuts, axes.collect())
}

/// Ends of a slot that lie in the material.
fn inner_ends(specimen: &Specimen, slot: &Slot, size: f64) -> Vec<Point> {
    let is_inner = |&(end, other): &(Point, Point)| {
        let [x, y] = direction(other, end);
        specimen.contains([end[0] + TOUCH * size * x, end[1] + TOUCH * size * y])
    };
    [(slot.from, slot.to), (slot.to, slot.from)].into_iter().filter(is_inner).map(|(end, _)| end).collect()
}

/// A crack whose last end lies on a rim or on another crack, cut on beyond it.
fn beyond_mouth(
    specimen: &Specimen,
    lines: &[CrackLine],
    own: usize,
    mut points: Vec<Point>,
    size: f64,
    far: f64,
    taken: &mut [[bool; 2]],
) -> Vec<Point> {
    let Some(&mouth) = points.last() else { return points };
    let touch = TOUCH * size;
    if let Some(hole) = specimen.holes.iter().find(|hole| (distance(mouth, hole.centre) - hole.radius).abs() < touch) {
        points.push(hole.centre);
        return points;
    }
    let slot = specimen.slots.iter().position(|slot| slot.contains(mouth) || distance_to_polygon(mouth, &slot.corners()) < touch);
    if let Some(index) = slot {
        let Slot { from, to, .. } = specimen.slots[index];
        let share = nearest_share(mouth, from, to);
        let foot = along(from, to, share);
        if distance(foot, mouth) > touch {
            points.push(foot);
        }
        // From an end face on the slot is part of the crack.
        if share == 0.0 || share == 1.0 {
            taken[index][usize::from(share == 1.0)] = true;
            points.push(if share == 0.0 { to } else { from });
            return points;
        }
        return lengthened(points, BEYOND * size);
    }
    let meets = |(other, line): (usize, &CrackLine)| other != own && line.distance(mouth) < touch;
    if lines.iter().enumerate().any(meets) || distance_to_polygon(mouth, &specimen.outline) > touch {
        return lengthened(points, BEYOND * size);
    }
    // Beyond the edge as far as there is nothing, and half of the way back into the plate at the most.
    let beyond = lengthened(points.clone(), far);
    let end = beyond[beyond.len() - 1];
    let from = along(mouth, end, 10.0 * touch / far);
    let back = edges(&specimen.outline).filter(|(a, b)| segments_touch(from, end, *a, *b));
    let share = back.filter_map(|(a, b)| meeting_share(from, end, a, b)).fold(2.0, f64::min);
    lengthened(points, (0.5 * share).min(1.0) * far)
}

impl TipAxes {
    /// Distance from the tip, m, and angle from x₁, rad, counted on across ±π up to the face of the crack on the side of the point.
    pub fn polar(&self, at: Point) -> (f64, f64) {
        let [x, y] = self.to_axes([at[0] - self.at[0], at[1] - self.at[1]]);
        let (r, theta) = (x.hypot(y), y.atan2(x));
        if self.is_beside_bend(at) { (r, theta - std::f64::consts::TAU.copysign(theta)) } else { (r, theta) }
    }

    pub fn to_axes(&self, [x, y]: Point) -> Point {
        let [c, s] = self.ahead;
        [c * x + s * y, c * y - s * x]
    }

    /// A vector of the axes of the tip in those of the plate.
    pub fn from_axes(&self, [x, y]: Point) -> Point {
        let [c, s] = self.ahead;
        [c * x - s * y, s * x + c * y]
    }

    /// A gradient ∂u_i/∂x_j of the axes of the tip in those of the plate.
    pub fn gradient_from_axes(&self, gradient: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
        let rows = gradient.map(|row| self.from_axes(row));
        let columns = [0, 1].map(|j| self.from_axes([rows[0][j], rows[1][j]]));
        [[columns[0][0], columns[1][0]], [columns[0][1], columns[1][1]]]
    }

    /// A gradient of the axes of the plate in those of the tip.
    pub fn gradient_to_axes(&self, gradient: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
        let rows = gradient.map(|row| self.to_axes(row));
        let columns = [0, 1].map(|j| self.to_axes([rows[0][j], rows[1][j]]));
        [[columns[0][0], columns[1][0]], [columns[0][1], columns[1][1]]]
    }

    /// Whether a point lies between a crack that bends and the straight line behind its tip.
    fn is_beside_bend(&self, at: Point) -> bool {
        let [.., last] = self.back[..] else { return false };
        if self.back.len() < 3 {
            return false;
        }
        let reach = distance(self.at, last);
        let behind = [self.at[0] - reach * self.ahead[0], self.at[1] - reach * self.ahead[1]];
        let corner = |k: usize| if k < self.back.len() { self.back[k] } else { behind };
        let mut inside = false;
        for k in 0..=self.back.len() {
            let (a, b) = (corner(k), corner((k + 1) % (self.back.len() + 1)));
            if (a[1] > at[1]) != (b[1] > at[1]) && at[0] < a[0] + (at[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]) {
                inside = !inside;
            }
        }
        inside
    }

    /// Near-tip displacement of modes I and II at a point and its gradient ∂u_i/∂x_j, in the axes of the plate: of the term of
    /// Williams' series that goes with √r, r in spacings of the tip, over κ + 1, so that it is about 1 at a spacing.
    pub fn near_tip(&self, elasticity: Elasticity, at: Point) -> [(Point, [[f64; 2]; 2]); 2] {
        let (r, theta) = self.polar(at);
        let (r, size) = ((r / self.spacing).max(1e-9), 1.0 / (elasticity.kappa + 1.0));
        Eigenfunction::both(1, elasticity.kappa, r, theta).map(|(u, gradient)| {
            let gradient = gradient.map(|row| row.map(|g| size / self.spacing * g));
            (self.from_axes(u.map(|u| size * u)), self.gradient_from_axes(gradient))
        })
    }
}
