//! A tip between two equilibria: what was read at it, where it aims, and how both change.

use serde::{Deserialize, Serialize};

use crate::fatigue::crack_tip::TipState;
use crate::growth::tip_field::kink::coefficients;
use crate::growth::tip_field::steering::{equivalent_factor, kink_angle};
use crate::specimen::LineEnd;

/// Turn from which a crack has a corner, rad: what was known before says nothing of what comes after.
const CORNER: f64 = 5.0 * std::f64::consts::PI / 180.0;
/// The same at the start, where nothing is known before: twice what K_II of a crack that goes straight on is wrong by.
const CORNER_AT_START: f64 = 0.25 * std::f64::consts::PI / 180.0;
/// ln of a rate over that of the fastest tip below which a tip is at rest.
const REST: f64 = -6.0;

/// A tip and what is known of its growth.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Front {
    /// Which crack it ends.
    pub end: LineEnd,
    /// What has become of it.
    pub state: TipState,
    /// Growth since the start, m.
    pub growth: f64,
    /// Length of crack that belonged to it at the start, m.
    pub length: f64,
    /// K_I and K_II at maximum load, Pa√m.
    pub factors: [f64; 2],
    /// Stress along the crack T at maximum load, Pa.
    pub t_stress: f64,
    /// da/dN, m/cycle.
    pub rate: f64,
    /// Spacing of nodes at it, m.
    pub spacing: f64,
    /// Angle from x at which it grows on, rad.
    pub aim: f64,
    /// Change of the aim over its own growth, rad/m.
    pub turn: f64,
    /// Change of ln of the rate over its own growth, 1/m.
    pub gain: f64,
    /// Growth at its last corner, m, where it has one.
    pub corner: Option<f64>,
    /// Equilibria since the start, a corner or a joint.
    pub age: usize,
    /// Growth in the last increment, m.
    pub advance: f64,
}

impl Front {
    /// A tip at the start, of a crack that gives it this length, m.
    pub fn new(end: LineEnd, length: f64) -> Self {
        Front {
            end,
            state: TipState::Active,
            growth: 0.0,
            length,
            factors: [0.0; 2],
            t_stress: 0.0,
            rate: 0.0,
            spacing: 0.0,
            aim: 0.0,
            turn: 0.0,
            gain: 0.0,
            corner: None,
            age: 0,
            advance: 0.0,
        }
    }

    /// Whether it grows under this load.
    pub fn is_growing(&self) -> bool {
        self.state == TipState::Active && self.rate > 0.0
    }

    /// K_eq at maximum load, Pa√m; none where the load presses the tip shut.
    pub fn equivalent(&self) -> f64 {
        if self.factors[0] <= 0.0 { 0.0 } else { equivalent_factor(self.factors) }
    }

    /// Whether its next step begins a kink.
    pub fn begins_kink(&self) -> bool {
        self.corner == Some(self.growth)
    }

    /// Length of crack that its field knows of, m: since the last corner, if there is one.
    pub fn own_length(&self) -> f64 {
        match self.corner {
            Some(corner) if self.growth > corner => self.growth - corner,
            _ => self.length + self.growth,
        }
    }

    /// Takes the direction from what was read, `heading` being that of its crack, rad.
    pub fn aim_at(&mut self, heading: f64) {
        let kink = if self.factors[0] > 0.0 { kink_angle(self.factors) } else { 0.0 };
        let aim = heading + kink;
        if kink.abs() > if self.age <= 1 && self.corner.is_none() { CORNER_AT_START } else { CORNER } {
            (self.corner, self.turn, self.gain, self.age) = (Some(self.growth), 0.0, 0.0, 0);
        } else if self.age > 1 && self.advance > 0.0 {
            let turned = (aim - self.aim + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU) - std::f64::consts::PI;
            self.turn = turned / self.advance;
        }
        self.aim = aim;
    }

    /// Takes the rate, m/cycle; `fastest` is that of the tip that grows fastest.
    pub fn grow_at(&mut self, before: f64, fastest: f64) {
        let at_rest = self.rate <= fastest * REST.exp();
        let known = self.age > 1 && self.advance > 0.0 && before > 0.0 && self.rate > 0.0;
        self.gain = if known && !at_rest { (self.rate / before).ln() / self.advance } else { 0.0 };
        if at_rest {
            self.turn = 0.0;
        }
    }

    /// Forgets how aim and rate change: the crack that it ends is another one.
    pub fn forget(&mut self) {
        (self.turn, self.gain, self.age, self.advance) = (0.0, 0.0, 0, 0.0);
    }
}

/// K of the kink that a tip begins, Pa√m, of none of its length.
pub(super) fn kinked(front: &Front) -> f64 {
    let factors = [front.factors[0].max(0.0), front.factors[1]];
    let [f11, f12, _] = coefficients(kink_angle(factors));
    (f11 * factors[0] + f12 * factors[1]).max(0.0)
}
