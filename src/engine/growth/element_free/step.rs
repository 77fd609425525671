//! How far every tip goes while the fastest goes a step, and what it meets.
//!
//! Direction and the ratio of rates are those at the middle of the step, extrapolated from the last two equilibria (second order, as Adams
//! and Bashforth 1883). No tip goes farther than a share of its crack and of the room ahead of it. A kink begins with a thirteenth of the
//! local spacing, since K changes with the root of its length.

use super::ElementFree;
use super::front::Front;
use crate::fatigue::crack_tip::TipState;
use crate::growth::tip_field::ahead;
use crate::specimen::Point;
use crate::specimen::geometry::{along, distance};

/// Share of the way to what it meets from which a step goes all of it.
const ALL_OF_WAY: f64 = 0.999;
/// First step of a kink in spacings at the tip, over the share of crack and room that a step goes at the most.
const FIRST_OF_KINK: f64 = 0.3;
/// First step of a crack that goes straight on, over the step that is allowed at the most.
const FIRST: f64 = 0.1;
/// A step over the last one at the most, after a kink and without one.
const RISE: [f64; 2] = [1.3, 1.6];
/// Share of the cycles so far that the way to a rim or another tip takes at the most where it is gone in one step.
const SHARE_LEFT: f64 = 5e-4;
/// Way to a rim, in far spacings, that is gone in one step whatever it takes.
const WAY_LEFT: f64 = 2e-3;
/// Share of the room to another tip that both take together at the most: K rises fast between tips that join.
const TO_JOINT: f64 = 0.08;
/// Distance of a tip that another faces over the way to its crack, at the most.
const ALIKE: f64 = 1.1;
/// Turn of a tip in an increment at the most, rad: between two equilibria a path is straight.
const TURN: f64 = 3.0 * std::f64::consts::PI / 180.0;
/// Cosine of the angle between a tip and the way to another within which they face each other.
const FACING: f64 = 0.8;

/// What limits a tip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Way {
    /// Growth at the most in the next increment, m.
    pub most: f64,
    /// Whether that is all of the way to what it meets.
    pub is_last: bool,
}

/// Growth and direction, rad, of a tip.
pub(super) type Move = (f64, f64);

impl ElementFree<'_> {
    /// Growth and direction of every tip while the fastest goes a step.
    pub(super) fn moves(&self, lead: usize, until: f64) -> Vec<Move> {
        let fronts = &self.state.fronts;
        let fastest = fronts[lead].rate;
        let growing = || fronts.iter().enumerate().filter(|(_, front)| front.is_growing());
        let of_front = |(index, front): (usize, &Front)| self.way(index).most * fastest / front.rate;
        let limit = growing().map(of_front).fold(f64::INFINITY, f64::min);
        let is_last = growing().any(|(index, front)| {
            let way = self.way(index);
            way.is_last && way.most * fastest / front.rate <= limit * (1.0 + 1e-9)
        });
        let step = if is_last { limit } else { limit.min(self.state.step.max(self.step_least())) };
        let mut moves = self.moves_in(lead, step);
        let grown = |moves: &[Move]| {
            let growths: Vec<f64> = fronts.iter().zip(moves).map(|(front, step)| front.growth + step.0).collect();
            self.case.specimen.crack_length_after(&growths)
        };
        let (now, then) = (grown(&vec![(0.0, 0.0); moves.len()]), grown(&moves));
        if then > until {
            let share = ((until - now) / (then - now)).clamp(0.0, 1.0);
            moves.iter_mut().for_each(|step| step.0 *= share);
        }
        moves
    }

    fn step_least(&self) -> f64 {
        1e-6 * self.settings.resolution.far
    }

    /// Moves while the lead goes `step`, m.
    fn moves_in(&self, lead: usize, step: f64) -> Vec<Move> {
        let fronts = &self.state.fronts;
        let middle = |front: &Front| {
            let half = 0.5 * step * front.rate / fronts[lead].rate;
            (front.aim + half * front.turn, front.rate.ln() + half * front.gain)
        };
        let of_lead = middle(&fronts[lead]).1;
        let of_front = |front: &Front| {
            if !front.is_growing() {
                return (0.0, front.aim);
            }
            let (aim, ln_rate) = middle(front);
            (step * (ln_rate - of_lead).exp(), aim)
        };
        fronts.iter().map(of_front).collect()
    }

    /// What limits a tip in its surroundings.
    pub(super) fn way(&self, index: usize) -> Way {
        let front = &self.state.fronts[index];
        let share = self.settings.step_share;
        let ((gap, is_facing), room) = (self.gap(index), self.room(index));
        let closing = if is_facing { gap * self.share_of_gap(index) } else { gap.min(room) };
        let cycles = self.curve.last().map_or(0.0, |row| row.cycles);
        if front.growth > 0.0 && (closing < SHARE_LEFT * cycles * front.rate || closing < WAY_LEFT * self.settings.resolution.far)
        {
            return Way { most: closing, is_last: true };
        }
        let to_gap = if is_facing { TO_JOINT * gap } else { share * gap };
        let crack = share * (front.length + front.growth);
        let turning = if front.turn == 0.0 { f64::INFINITY } else { TURN / front.turn.abs() };
        let most = crack.min(share * room).min(to_gap).min(turning);
        let most = if front.begins_kink() { most.min(FIRST_OF_KINK * share * front.spacing) } else { most };
        Way { most, is_last: false }
    }

    /// Distance of a tip from rims and other cracks, m.
    pub(super) fn room(&self, index: usize) -> f64 {
        let (front, lines) = (&self.state.fronts[index], &self.state.lines);
        let at = lines[front.end.line].end(front.end.at_last);
        let others = lines.iter().enumerate().filter(|(other, _)| *other != front.end.line).map(|(_, line)| line.distance(at));
        others.fold(self.case.specimen.rim_distance(at), f64::min)
    }

    /// Way of a tip straight ahead to a rim or another crack, or to a tip that it faces, m; whether it is the latter.
    pub(super) fn gap(&self, index: usize) -> (f64, bool) {
        let front = &self.state.fronts[index];
        let (from, ahead_of) = (self.position(front), unit(front.aim));
        let reach = 4.0 * crate::element_free::field::Discretisation::size(&self.case.specimen);
        let to = [from[0] + reach * ahead_of[0], from[1] + reach * ahead_of[1]];
        let rim = ahead::first_rim(&self.case.specimen, &self.state.lines, front.end.line, from, to);
        let rim = rim.map_or(f64::INFINITY, |(share, _)| share * reach);
        match self.faced(index) {
            Some((_, gap)) if gap <= ALIKE * rim => (gap, true),
            _ => (rim, false),
        }
    }

    /// What a tip goes of the way to one that it faces: both come towards each other.
    fn share_of_gap(&self, index: usize) -> f64 {
        let rate = |tip: usize| self.state.fronts[tip].rate;
        let other = self.faced(index).map_or(0.0, |(other, _)| rate(other));
        if rate(index) > 0.0 { rate(index) / (rate(index) + other) } else { 0.0 }
    }

    /// The active tip of another crack that a tip faces, and its distance, m.
    pub(super) fn faced(&self, index: usize) -> Option<(usize, f64)> {
        let fronts = &self.state.fronts;
        let here = self.position(&fronts[index]);
        let towards = |other: &Front| {
            let there = self.position(other);
            let gap = distance(here, there);
            let cosine = |aim: f64, sign: f64| {
                let [x, y] = unit(aim);
                sign * (x * (there[0] - here[0]) + y * (there[1] - here[1])) / gap
            };
            (cosine(fronts[index].aim, 1.0) > FACING && cosine(other.aim, -1.0) > FACING).then_some(gap)
        };
        let others = fronts.iter().enumerate().filter(|(other, front)| {
            *other != index
                && front.end.line != fronts[index].end.line
                && front.state == crate::fatigue::crack_tip::TipState::Active
        });
        others.filter_map(|(other, front)| Some((other, towards(front)?))).min_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Step of the lead in the first increment after a start or a joint, m.
    pub(super) fn first_step(&self) -> f64 {
        let growing = self.state.fronts.iter().enumerate().filter(|(_, front)| front.is_growing());
        let Some(fastest) = self.fastest().map(|lead| self.state.fronts[lead].rate) else { return 0.0 };
        let of_front = |(index, front): (usize, &Front)| {
            let most = self.way(index).most * fastest / front.rate;
            if front.begins_kink() { most } else { FIRST * most }
        };
        growing.map(of_front).fold(f64::INFINITY, f64::min)
    }

    /// Step of the lead after one of length `grown`, m, in which a parabola of ln of the rate added the share `curvature` to the cycles.
    pub(super) fn next_step(&self, grown: f64, curvature: f64) -> f64 {
        let kinked = self
            .state
            .fronts
            .iter()
            .any(|front| front.is_growing() && front.corner.is_some() && front.own_length() < front.spacing * 12.0);
        let error = 0.01 * self.case.fatigue.step_error_percent;
        let by_error = (error / curvature.abs().max(f64::MIN_POSITIVE)).sqrt();
        grown * by_error.min(RISE[usize::from(!kinked)]).max(0.5)
    }
}

/// Unit vector of an angle from x.
pub(super) fn unit(angle: f64) -> Point {
    let (sin, cos) = angle.sin_cos();
    [cos, sin]
}

impl ElementFree<'_> {
    /// Where a tip goes with its move, what becomes of it, and the tip that it meets, which comes as well.
    fn target(&self, index: usize, (length, aim): Move) -> (Point, TipState, Option<usize>) {
        let front = &self.state.fronts[index];
        let (from, [x, y]) = (self.position(front), unit(aim));
        let straight = [from[0] + length * x, from[1] + length * y];
        let way = self.way(index);
        let goes_all = way.is_last && length >= ALL_OF_WAY * way.most;
        if let (true, (_, true), Some((other, _))) = (goes_all, self.gap(index), self.faced(index)) {
            return (straight, TipState::LinkedUp, Some(other));
        }
        let reach = [from[0] + length / ALL_OF_WAY * x, from[1] + length / ALL_OF_WAY * y];
        let (specimen, lines, own) = (&self.case.specimen, &self.state.lines, front.end.line);
        if let Some((share, what)) = ahead::first_rim(specimen, lines, own, from, reach) {
            return (along(from, reach, share), what.state, None);
        }
        let beside = if goes_all { ahead::beside(specimen, lines, own, from, 1.01 * self.room(index)) } else { None };
        beside.map_or((straight, TipState::Active, None), |(at, what)| (at, what.state, None))
    }

    /// Where all tips go, and what becomes of them; tips that face each other meet between them.
    pub(super) fn targets(&self, moves: &[Move]) -> Vec<(Point, TipState)> {
        let targets: Vec<_> = moves.iter().enumerate().map(|(index, step)| self.target(index, *step)).collect();
        let mut found: Vec<(Point, TipState)> = targets.iter().map(|target| (target.0, target.1)).collect();
        for (index, target) in targets.iter().enumerate() {
            let Some(other) = target.2 else { continue };
            let [here, there] = [index, other].map(|tip| self.position(&self.state.fronts[tip]));
            let [own, towards] = [moves[index].0, moves[other].0];
            // The same place for both, whichever is asked first.
            let share = own / (own + towards).max(f64::MIN_POSITIVE);
            let meeting = if index < other { along(here, there, share) } else { along(there, here, 1.0 - share) };
            (found[index], found[other]) = ((meeting, TipState::LinkedUp), (meeting, TipState::LinkedUp));
        }
        found
    }
}
