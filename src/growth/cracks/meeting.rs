//! Where tips go, what they meet there, and cracks that join.

use super::ahead::{self, Encounter};
use super::{CrackedPlate, Cracks, Tip};
use perilife_plate::specimen::Point;
use perilife_plate::specimen::geometry::{along, direction, distance};
use perilife_points::crack_tip::TipState;

/// Share of a last step from which it is all of it.
const ALL: f64 = 0.999;
/// Distance of a tip that another faces over the way to its crack, at the most.
const ALIKE: f64 = 1.1;
/// Way straight on to a rim over the distance from the nearest rim, up to which a tip heads for it.
const AHEAD: f64 = 1.5;
/// Cosine between a tip and the way to what is nearest to it, below which the tip goes away from that.
const LEAVING: f64 = -0.7;
/// Cosine of the angle between a tip and the way to a rim below which it passes that.
const PASSING: f64 = 0.5;

/// A new straight segment of crack, and what becomes of the tip at its end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Segment {
    /// Where the tip was, m.
    pub from: Point,
    /// Where it is, m.
    pub to: Point,
    pub state: TipState,
    pub(super) meets: Option<Met>,
}

/// What joins cracks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Met {
    /// Another crack, by its flank.
    Crack(usize),
    /// A tip that came towards it.
    Tip(usize),
}

impl Segment {
    /// Its length, m.
    pub fn length(&self) -> f64 {
        distance(self.from, self.to)
    }
}

/// A way that is short enough to be gone in one step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LastWay {
    pub length: f64,
    /// The tip at its end, if it is one.
    faces: Option<usize>,
}

impl<P: CrackedPlate> Cracks<'_, P> {
    /// The nearest active tip of another crack that a tip faces, and its distance, m.
    pub(super) fn faced(&self, index: usize) -> Option<(usize, f64)> {
        let own = &self.state.tips[index];
        let (here, ahead) = (self.state.position(own), self.direction(own, 0.0));
        let cosine = |a: Point, b: Point| a[0] * b[0] + a[1] * b[1];
        let facing = self.scales.meeting.facing;
        let gap = |(other, tip): (usize, &Tip)| {
            let (there, towards) = (self.state.position(tip), self.direction(tip, 0.0));
            let way = direction(here, there);
            (cosine(ahead, way) > facing && cosine(towards, way) < -facing).then(|| (other, distance(here, there)))
        };
        let others = self.state.active().filter(|(_, tip)| tip.end.line != own.end.line);
        others.filter_map(gap).min_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Whether a tip has come so near to another that its K is not read any more.
    pub(super) fn is_closing(&self, index: usize) -> bool {
        self.faced(index).is_some_and(|(_, gap)| gap < self.scales.meeting.unread)
    }

    /// Distance of a tip from rims and other cracks, m.
    pub(super) fn room(&self, index: usize) -> f64 {
        self.state.room(&self.case.specimen, &self.state.tips[index])
    }

    /// Distance of a tip straight ahead to an edge, a crack or a facing tip, m, and which; infinite if far.
    pub(super) fn gap(&self, index: usize) -> (f64, Option<usize>) {
        let (tip, reach) = (&self.state.tips[index], self.scales.step.last[0]);
        let (from, ahead) = (self.state.position(tip), self.direction(tip, 0.0));
        let to = [0, 1].map(|i| from[i] + reach * ahead[i]);
        let rim = ahead::first_rim(&self.case.specimen, &self.state.lines, tip.end.line, from, to);
        let rim = rim.map_or(f64::INFINITY, |(share, _)| share * reach);
        match self.faced(index).filter(|(_, gap)| *gap < reach && *gap <= ALIKE * rim) {
            Some((other, gap)) => (gap, Some(other)),
            None => (rim, None),
        }
    }

    /// The way of a tip to what it meets, if it is gone in one step: where it takes next to none of the cycles so far, or is next to none.
    pub(super) fn last_way(&self, index: usize) -> Option<LastWay> {
        let tip = &self.state.tips[index];
        let (gap, faces) = self.gap(index);
        // Both come towards each other.
        let of_both = |other: usize| tip.rate / (tip.rate + self.state.tips[other].rate);
        let (room, scales) = (self.room(index), &self.scales.step);
        // A tip that passes a rim does not run into it, however few cycles are left.
        let aside = if room < scales.last_aside && !self.leaves(index, room) { room } else { f64::INFINITY };
        let ahead = if gap < AHEAD * room { gap } else { f64::INFINITY };
        let length = faces.map_or_else(|| ahead.min(aside), |other| gap * of_both(other));
        let cycles = self.curve.last().map_or(0.0, |row| row.cycles);
        let [reach, at_once] = scales.last;
        let is_last = length < reach && (length < self.scales.step.share_left * cycles * tip.rate || length < at_once);
        (is_last && tip.growth > 0.0).then_some(LastWay { length, faces })
    }

    /// Whether a tip goes away from the rim or crack nearest to it, at the distance `room`, m, as a short crack from its hole does.
    fn leaves(&self, index: usize, room: f64) -> bool {
        let (specimen, tip) = (&self.case.specimen, &self.state.tips[index]);
        let (at, ahead) = (self.state.position(tip), self.direction(tip, 0.0));
        let nearest = ahead::beside(specimen, &self.state.lines, tip.end.line, at, 1.01 * room);
        nearest.is_some_and(|(nearest, _)| {
            let way = direction(at, nearest);
            ahead[0] * way[0] + ahead[1] * way[1] < LEAVING
        })
    }

    /// The next segments of crack at all tips, which grow by these lengths, m; tips that face each other meet between them.
    pub(super) fn segments(&self, lengths: &[f64]) -> Vec<Option<Segment>> {
        let segment = |(index, length): (usize, &f64)| (*length > 0.0).then(|| self.segment(index, *length));
        let mut segments: Vec<Option<Segment>> = lengths.iter().enumerate().map(segment).collect();
        for index in 0..segments.len() {
            let Some(Segment { meets: Some(Met::Tip(other)), .. }) = segments[index] else { continue };
            let [here, there] = [index, other].map(|tip| self.state.position(&self.state.tips[tip]));
            // The same place for both, whichever is asked first.
            let share = lengths[index] / (lengths[index] + lengths[other]);
            let to = if index < other { along(here, there, share) } else { along(there, here, 1.0 - share) };
            for (own, from, other) in [(index, here, other), (other, there, index)] {
                segments[own] = Some(Segment { from, to, state: TipState::LinkedUp, meets: Some(Met::Tip(other)) });
            }
        }
        segments
    }

    /// The next segment of crack at a tip: straight on, up to a rim or another crack if one lies on the way or right beside its end.
    fn segment(&self, index: usize, length: f64) -> Segment {
        let (specimen, lines, tip) = (&self.case.specimen, &self.state.lines, &self.state.tips[index]);
        let (scales, own) = (&self.scales.meeting, tip.end.line);
        let (from, direction) = (self.state.position(tip), self.direction(tip, length));
        let at = |length: f64| [0, 1].map(|i| from[i] + length * direction[i]);
        let (reach, next) = (at(length * (1.0 + scales.through_share) + scales.through), at(length));
        let goes_all = self.last_way(index).filter(|way| length >= ALL * way.length);
        if let Some(LastWay { faces: Some(other), .. }) = goes_all {
            return Segment { from, to: next, state: TipState::LinkedUp, meets: Some(Met::Tip(other)) };
        }
        let end = |(to, what): (Point, Encounter)| Segment { from, to, state: what.state, meets: what.crack.map(Met::Crack) };
        let rim = ahead::first_rim(specimen, lines, own, from, reach).map(|(share, what)| (along(from, reach, share), what));
        let aside = || goes_all.and_then(|_| ahead::beside(specimen, lines, own, from, 1.01 * self.room(index)));
        let beside = || ahead::beside(specimen, lines, own, next, scales.beside);
        rim.or_else(aside).or_else(beside).map_or(Segment { from, to: next, state: TipState::Active, meets: None }, end)
    }

    /// Joins cracks that have met, and lets the tips that are left forget what they were: the crack that they end is another one.
    pub(super) fn join(&mut self, segments: &[Option<Segment>]) {
        for (tip, segment) in segments.iter().enumerate() {
            let Some(Segment { from, to, meets: Some(Met::Crack(met)), .. }) = segment else { continue };
            let heading = [to[0] - from[0], to[1] - from[1]];
            let (own, lines) = (self.state.tips[tip].end.line, &self.state.lines);
            for other in self.state.tips.iter_mut().filter(|other| other.end.line == *met && other.end.line != own) {
                let line = &lines[other.end.line];
                let [x, y] = line.direction(other.end.at_last);
                let faces = heading[0] * x + heading[1] * y < 0.0;
                let gap = distance(line.end(other.end.at_last), *to);
                if other.is_active() && faces && gap < self.scales.meeting.joined {
                    other.state = TipState::LinkedUp;
                }
            }
        }
        self.state.tips.iter_mut().for_each(Tip::forget_history);
        self.plate.forget_history();
    }

    /// The first of the tips that pass a rim so near that what is between them is not resolved, and that distance, m.
    pub(super) fn unresolved_ligament(&self) -> Option<(usize, f64)> {
        let passes = |tip: &Tip| {
            let (at, ahead) = (self.state.position(tip), self.plate.heading(&self.state.lines, tip.end));
            let (nearest, _) = ahead::beside(&self.case.specimen, &[], 0, at, self.scales.meeting.passing)?;
            let way = direction(at, nearest);
            (ahead[0] * way[0] + ahead[1] * way[1] < PASSING).then(|| distance(at, nearest))
        };
        let grown = self.state.active().filter(|(_, tip)| tip.is_growing() && tip.growth > 0.0);
        grown.filter_map(|(index, tip)| Some((index, passes(tip)?))).next()
    }
}
