//! A crack as a line of straight pieces.

use super::Point;
use super::geometry::{direction, distance, distance_to_segment};

/// A crack from one end to the other, m; either end may be a tip.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct CrackLine {
    /// Corners, both ends included.
    pub points: Vec<Point>,
}

/// Which end of which line a tip is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct LineEnd {
    /// Index of the line.
    pub line: usize,
    /// Whether the tip is the last of its points, else the first.
    pub at_last: bool,
}

impl CrackLine {
    /// A straight crack.
    #[must_use]
    pub fn straight(from: Point, to: Point) -> Self {
        CrackLine { points: vec![from, to] }
    }

    /// Length along the line, m.
    #[must_use]
    pub fn length(&self) -> f64 {
        self.points.windows(2).map(|piece| distance(piece[0], piece[1])).sum()
    }

    /// One of its ends.
    #[must_use]
    pub fn end(&self, at_last: bool) -> Point {
        // A line has two points at the least.
        if at_last { self.points[self.points.len() - 1] } else { self.points[0] }
    }

    /// Unit vector in which the line points at one of its ends, out of itself.
    #[must_use]
    pub fn direction(&self, at_last: bool) -> Point {
        let n = self.points.len();
        if at_last { direction(self.points[n - 2], self.points[n - 1]) } else { direction(self.points[1], self.points[0]) }
    }

    /// Moves one of its ends along its last piece, m; back by nine tenths of it at the most.
    pub fn stretch(&mut self, at_last: bool, by: f64) {
        let n = self.points.len();
        let (end, before) = if at_last { (n - 1, n - 2) } else { (0, 1) };
        let piece = distance(self.points[before], self.points[end]);
        let (ahead, by) = (self.direction(at_last), by.max(-0.9 * piece));
        self.points[end] = [0, 1].map(|i| self.points[end][i] + by * ahead[i]);
    }

    /// Adds a straight piece at one of its ends.
    pub fn grow(&mut self, at_last: bool, to: Point) {
        if at_last { self.points.push(to) } else { self.points.insert(0, to) }
    }

    /// Its straight pieces, in its own sense.
    pub fn pieces(&self) -> impl Iterator<Item = [Point; 2]> + '_ {
        self.points.windows(2).map(|piece| [piece[0], piece[1]])
    }

    /// Distance of a point from the line, m.
    #[must_use]
    pub fn distance(&self, point: Point) -> f64 {
        self.pieces().map(|[a, b]| distance_to_segment(point, a, b)).fold(f64::INFINITY, f64::min)
    }
}
