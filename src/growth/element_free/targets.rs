//! Where tips go in an increment, and what they meet.

use super::ElementFree;
use super::step::{Move, unit};
use crate::fatigue::crack_tip::TipState;
use crate::growth::tip_field::ahead;
use crate::specimen::Point;
use crate::specimen::geometry::along;

/// Share of the way to what it meets from which a step goes all of it.
const ALL_OF_WAY: f64 = 0.999;

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
