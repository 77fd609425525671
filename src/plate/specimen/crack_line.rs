//! A crack as a line of straight pieces.

use super::Point;
use super::geometry::{direction, distance, distance_to_segment, segments_touch, turn_at};

/// Share of the last piece that is kept where an end is drawn back over it.
const STUB: f64 = 0.1;
/// Turn of a crack, rad, up to which it is straight for what is read around its tip: a fifth of the radius of an arc.
pub const STRAIGHT_TURN: f64 = 0.2;

/// A crack from one end to the other, m; either end may be a tip.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct CrackLine {
    /// Corners, both ends included.
    pub points: Vec<Point>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct LineEnd {
    pub line: usize,
    /// Whether the tip is the last of its points, else the first.
    pub at_last: bool,
}

impl CrackLine {
    /// Length of its straight piece at one end, m.
    pub fn last_piece(&self, at_last: bool) -> f64 {
        let piece = if at_last { self.points.windows(2).last() } else { self.points.windows(2).next() };
        piece.map_or(0.0, |piece| distance(piece[0], piece[1]))
    }

    pub fn straight(from: Point, to: Point) -> Self {
        CrackLine { points: vec![from, to] }
    }

    /// Length along the line, m.
    pub fn length(&self) -> f64 {
        self.points.windows(2).map(|piece| distance(piece[0], piece[1])).sum()
    }

    pub fn end(&self, at_last: bool) -> Point {
        // A line has two points at the least.
        if at_last { self.points[self.points.len() - 1] } else { self.points[0] }
    }

    /// Unit vector in which the line points at one of its ends, out of itself.
    pub fn direction(&self, at_last: bool) -> Point {
        let n = self.points.len();
        if at_last { direction(self.points[n - 2], self.points[n - 1]) } else { direction(self.points[1], self.points[0]) }
    }

    /// Way back from one of its ends along it as far as its direction stays within 0.2 rad of that at the end, m; infinite where
    /// all of it does, or up to a corner that turns by more than `sharp`, rad.
    pub fn straight_way(&self, at_last: bool, sharp: f64) -> f64 {
        let turn = |[x, y]: Point, [u, v]: Point| (x * v - y * u).atan2(x * u + y * v).abs();
        let ahead = self.direction(at_last);
        let pieces: Vec<[Point; 2]> = self.pieces().collect();
        let back: Vec<[Point; 2]> =
            if at_last { pieces.into_iter().rev().collect() } else { pieces.into_iter().map(|[a, b]| [b, a]).collect() };
        let (mut way, mut last) = (0.0, ahead);
        for [a, b] in back {
            let here = direction(a, b);
            if turn(here, last) > sharp {
                return f64::INFINITY;
            }
            if turn(here, ahead) > STRAIGHT_TURN {
                return way;
            }
            (way, last) = (way + distance(a, b), here);
        }
        f64::INFINITY
    }

    /// Turn into the last piece towards one of its ends, rad, counter-clockwise.
    pub fn last_turn(&self, at_last: bool) -> f64 {
        let place = |i: usize| if at_last { self.points.len() - 1 - i } else { i };
        if self.points.len() < 3 { 0.0 } else { turn_at(self.points[place(2)], self.points[place(1)], self.points[place(0)]) }
    }

    /// The line without its corners nearer than `least` to one of its ends, m: a piece that short shows no direction.
    pub fn blunted(&self, at_last: bool, least: f64) -> Self {
        let mut points = self.points.clone();
        if !at_last {
            points.reverse();
        }
        while let [.., corner, end] = points[..]
            && points.len() > 2
            && distance(corner, end) < least
        {
            points.remove(points.len() - 2);
        }
        if !at_last {
            points.reverse();
        }
        CrackLine { points }
    }

    /// Moves one of its ends along the line, m: ahead in the direction of its last piece, back over earlier pieces if need be, where it
    /// keeps a stub of the last one and so its direction; at most to a tenth of the first piece.
    pub fn stretch(&mut self, at_last: bool, by: f64) {
        let ahead = self.direction(at_last);
        if !at_last {
            self.points.reverse();
        }
        let piece = |points: &[Point]| distance(points[points.len() - 2], points[points.len() - 1]);
        let stub = STUB * piece(&self.points);
        let mut back = -by;
        if back > piece(&self.points) - stub {
            back += stub;
            while self.points.len() > 2 && back >= piece(&self.points) {
                back -= piece(&self.points);
                self.points.pop();
            }
            let last = piece(&self.points);
            let way = direction(self.points[self.points.len() - 1], self.points[self.points.len() - 2]);
            self.move_last(way, back.min((1.0 - STUB) * last));
            self.points.push(self.end(true));
            self.move_last(ahead, stub);
        } else {
            self.move_last(ahead, by);
        }
        if !at_last {
            self.points.reverse();
        }
    }

    fn move_last(&mut self, [x, y]: Point, by: f64) {
        if let Some(end) = self.points.last_mut() {
            *end = [end[0] + by * x, end[1] + by * y];
        }
    }

    /// Adds a straight piece at one of its ends.
    pub fn grow(&mut self, at_last: bool, to: Point) {
        if at_last { self.points.push(to) } else { self.points.insert(0, to) }
    }

    #[inline]
    pub fn pieces(&self) -> impl Iterator<Item = [Point; 2]> + '_ {
        self.points.windows(2).map(|piece| [piece[0], piece[1]])
    }

    /// Whether a straight segment crosses the line or comes as near to it as `slack`, m, with one of its ends.
    #[inline]
    pub fn meets(&self, from: Point, to: Point, slack: f64) -> bool {
        self.pieces()
            .any(|[a, b]| segments_touch(from, to, a, b) || [a, b].iter().any(|p| distance_to_segment(*p, from, to) < slack))
            || [from, to].iter().any(|end| self.distance(*end) < slack)
    }

    /// Distance of a point from the line, m.
    #[inline]
    pub fn distance(&self, point: Point) -> f64 {
        self.pieces().map(|[a, b]| distance_to_segment(point, a, b)).fold(f64::INFINITY, f64::min)
    }
}
