//! Following a crack tip through the bonds that break around it.
//!
//! A broken bond stands for the crack length `g_k / ρ(n)` ([`crate::body::severed`]).
//!
//! The bonds that broke last, half a horizon of crack of them, have their centre c a quarter horizon behind the tip;
//! together with the half horizon of crack before them they show the direction d. Growth is the way of that centre along the
//! crack, `∫ d·dc`: a measure in broken bonds that is continuous, that does not depend on the spacing or on how the lattice
//! lies, and that damage beside the crack does not lengthen.

use std::collections::VecDeque;

use serde::{Deserialize, Serialize};

use crate::body::pre_crack::bonds_across;
use crate::body::severed::{severed_per_length, severed_weight};
use crate::body::{Body, Bond};
use crate::state::Bonds;
use perilife_plate::specimen::geometry::{direction, distance, segments_touch};
use perilife_plate::specimen::{Point, Specimen, TipSeed};

/// Least length of crack, in horizons, whose broken bonds show where the tip is; rounded up to whole spacings, since bonds
/// along a row of points break in a pattern that repeats with the spacing.
const FRONT_HORIZONS: f64 = 0.5;
/// Length of crack before the front, in horizons, that shows where the tip is heading together with it. Of a longer one the
/// direction lags behind at a kink, and with it the ageing zone: a crack that should turn by 60° then turned by 45 to 50°.
const TRAIL_HORIZONS: f64 = 0.5;
/// Length of wake behind a tip, in horizons, that is searched for bridges at every block; older ones stand in a list.
const WAKE_HORIZONS: f64 = 2.0;
/// Distance of a bond from every tip, in horizons, beyond which its break moves no tip.
const REACH_HORIZONS: f64 = 1.5;
/// Distance behind a tip, in horizons, beyond which a broken bond was a bridge of the wake: it does not show where the front is.
/// Of a crack along the diagonal of the lattice so many are left that they turned the tip round.
const BEHIND_HORIZONS: f64 = 1.0;
/// Relative difference between lengths that are equal but for round-off: mirror twins must not fall on two sides of a limit.
pub const ROUND_OFF: f64 = 1e-9;
/// Marks that stand for the crack behind a tip at the start.
const SEED_MARKS: usize = 48;

perilife_base::kinds! {
    /// What has become of a tip.
    pub enum TipState for "state of a tip" {
        Active = "active": "growing, or able to grow",
        Closed = "closed": "crack faces in contact: no growth",
        LeftPlate = "left_plate": "crossed the edge of the plate",
        EnteredHole = "entered_hole": "entered a hole or slot",
        LinkedUp = "linked_up": "joined another crack",
    }
}

/// Centre of bonds that broke together near a tip, and the length of crack they stand for.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
struct Mark {
    at: Point,
    length: f64,
}

/// A tip of a growing crack.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CrackTip {
    /// Position, m.
    pub position: Point,
    /// Unit vector of growth.
    pub direction: Point,
    /// Growth since the start, m; never falls.
    pub growth: f64,
    /// Whether it still grows.
    pub state: TipState,
    /// Where the tip has been last, oldest first, the present place last.
    pub wake: Vec<Point>,
    /// Bonds that still bridge the crack farther behind; some may be broken by now.
    pub bridges: Vec<Bond>,
    /// The bonds that broke last: front and trail.
    marks: VecDeque<Mark>,
    /// Way of the front's centre along the crack, m.
    way: f64,
    centre: Point,
}

impl CrackTip {
    /// Tip at the end of an initial crack or at the middle of a slot's end face.
    pub fn at(seed: &TipSeed, body: &Body) -> Self {
        let length = front(body) + TRAIL_HORIZONS * body.horizon();
        let behind =
            |distance: f64| [seed.position[0] - distance * seed.direction[0], seed.position[1] - distance * seed.direction[1]];
        let mark = |i: usize| Mark {
            at: behind(length * (1.0 - (i as f64 + 0.5) / SEED_MARKS as f64)),
            length: length / SEED_MARKS as f64,
        };
        CrackTip {
            position: seed.position,
            direction: seed.direction,
            growth: 0.0,
            state: TipState::Active,
            wake: vec![seed.position],
            bridges: Vec::new(),
            marks: (0..SEED_MARKS).map(mark).collect(),
            way: 0.0,
            centre: behind(0.5 * front(body)),
        }
    }

    /// Whether bonds around it can age.
    pub fn is_active(&self) -> bool {
        self.state == TipState::Active
    }

    /// Takes in the bonds that broke together near this tip.
    ///
    /// A tip that has crossed the outline, or the rim of a hole, keeps its last place inside, where the last bonds before the
    /// edge can still age; [`CrackTip::retire`] ends it when none is left.
    pub fn advance(&mut self, body: &Body, bonds: &Bonds, specimen: &Specimen, broken: &[Bond]) {
        if broken.is_empty() {
            return;
        }
        let along = body.lattice.to_axes(self.direction);
        let per_length = severed_per_length(body, [-along[1], along[0]]);
        // One mark for all that broke together: the order of twins must not tell the tips of a symmetric crack apart.
        let mut mark = Mark { at: [0.0; 2], length: 0.0 };
        for &bond in broken {
            let (middle, length) = (body.middle(bond), severed_weight(body, body.ends(bond).0) / per_length);
            mark.at = [mark.at[0] + length * middle[0], mark.at[1] + length * middle[1]];
            mark.length += length;
        }
        mark.at = mark.at.map(|sum| sum / mark.length);
        self.marks.push_back(mark);
        let horizon = body.horizon();
        let length_of_front = front(body);
        self.forget(length_of_front + TRAIL_HORIZONS * horizon);
        let (trail, front) = self.centres(length_of_front);
        if distance(trail, front) > 0.05 * horizon {
            self.direction = direction(trail, front);
        }
        self.way += self.direction[0] * (front[0] - self.centre[0]) + self.direction[1] * (front[1] - self.centre[1]);
        self.growth = self.growth.max(self.way);
        self.centre = front;
        let ahead = 0.5 * length_of_front;
        let position = [0, 1].map(|i| front[i] + ahead * self.direction[i]);
        if specimen.contains(position) {
            self.position = position;
        }
        self.lengthen_wake(body, bonds);
    }

    /// Ends a tip with the outline, a hole or a slot less than `reach` ahead; returns whether it did.
    pub fn retire(&mut self, specimen: &Specimen, reach: f64) -> bool {
        let ahead = |share: f64| [0, 1].map(|i| self.position[i] + share * reach * self.direction[i]);
        if let Some(outside) = [0.25, 0.5, 0.75, 1.0].map(ahead).into_iter().find(|&point| !specimen.contains(point)) {
            let in_hole = specimen.holes.iter().any(|hole| distance(hole.centre, outside) <= hole.radius);
            let in_void = in_hole || specimen.slots.iter().any(|slot| slot.contains(outside));
            self.state = if in_void { TipState::EnteredHole } else { TipState::LeftPlate };
        }
        !self.is_active()
    }

    /// Takes the present place into the wake, at steps of a quarter horizon; of what then lies too far behind, only the
    /// bonds that bridge it are kept.
    fn lengthen_wake(&mut self, body: &Body, bonds: &Bonds) {
        let settled = self.wake.len() - 1;
        if settled > 0 && distance(self.wake[settled - 1], self.position) < 0.25 * body.horizon() {
            self.wake[settled] = self.position;
        } else {
            self.wake.push(self.position);
        }
        let keep = (WAKE_HORIZONS / 0.25) as usize + 1;
        let excess = self.wake.len().saturating_sub(keep);
        for step in self.wake.windows(2).take(excess) {
            self.bridges.extend(bonds_across(body, step[0], step[1]));
        }
        self.wake.drain(..excess);
        if excess > 0 {
            self.bridges.retain(|&bond| bonds.is_intact(bond));
            self.bridges.sort_unstable();
            self.bridges.dedup();
        }
    }

    /// Whether the line between two points crosses the wake: a bond there bridges the crack.
    pub fn is_bridge(&self, from: Point, to: Point) -> bool {
        self.wake.windows(2).any(|step| segments_touch(from, to, step[0], step[1]))
    }

    /// Drops the oldest marks beyond a length of crack; the last of them is shortened, so that the rest is exactly that long.
    fn forget(&mut self, length: f64) {
        let mut excess = self.marks.iter().map(|mark| mark.length).sum::<f64>() - length;
        while excess > 0.0 {
            let Some(oldest) = self.marks.front_mut() else { return };
            if oldest.length > excess {
                oldest.length -= excess;
                return;
            }
            excess -= oldest.length;
            self.marks.pop_front();
        }
    }

    /// Centres of the trail and of the front, the newest `front` metres of crack.
    fn centres(&self, front: f64) -> (Point, Point) {
        let mut left = front;
        let (mut newer, mut older) = ([0.0; 3], [0.0; 3]);
        for mark in self.marks.iter().rev() {
            // A mark across the border counts to both in shares.
            let share = mark.length.min(left);
            left -= share;
            for (part, share) in [(&mut newer, share), (&mut older, mark.length - share)] {
                *part = [part[0] + share * mark.at[0], part[1] + share * mark.at[1], part[2] + share];
            }
        }
        let centre = |part: [f64; 3]| [part[0] / part[2], part[1] / part[2]];
        (centre(older), centre(newer))
    }
}

/// Length of the front, m. Of whole spacings none is added for round-off.
fn front(body: &Body) -> f64 {
    let spacing = body.lattice.spacing;
    (FRONT_HORIZONS * body.horizon() / spacing * (1.0 - ROUND_OFF)).ceil() * spacing
}

/// Gives every broken bond near a tip to the nearest active one, unless it lies too far behind that to belong to its front.
pub fn share_out(body: &Body, tips: &[CrackTip], broken: &[Bond]) -> Vec<Vec<Bond>> {
    let mut shares = vec![Vec::new(); tips.len()];
    for &bond in broken {
        let middle = body.middle(bond);
        let behind = |tip: &CrackTip| {
            let [x, y] = [0, 1].map(|i| tip.position[i] - middle[i]);
            x * tip.direction[0] + y * tip.direction[1] > BEHIND_HORIZONS * body.horizon() * (1.0 + ROUND_OFF)
        };
        let away = |t: usize| distance(tips[t].position, middle);
        let near =
            (0..tips.len()).filter(|&t| tips[t].is_active() && away(t) <= REACH_HORIZONS * body.horizon() * (1.0 + ROUND_OFF));
        if let Some(nearest) = near.min_by(|&a, &b| away(a).total_cmp(&away(b))).filter(|&t| !behind(&tips[t])) {
            shares[nearest].push(bond);
        }
    }
    shares
}
