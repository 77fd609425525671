//! Where a tip turns to: maximum circumferential stress (Erdogan and Sih 1963, J. Basic Eng. 85:519).
//!
//! `K_I sin θ + K_II (3 cos θ - 1) = 0`, and the factor that opens the crack in that direction is
//! `K_eq = cos(θ/2) [K_I cos²(θ/2) - 3/2 K_II sin θ]`.
//!
//! A single reading of K_II scatters with how the bonds around the tip lie. The direction is read at the tip off a straight line
//! through the aims of the last two horizons of growth: a mean over that length would trail behind a curving crack by half of
//! it.

use serde::{Deserialize, Serialize};

use crate::specimen::Point;

/// Growth, in steps, whose aims show where the crack is heading. Steps are short where it curves; a line through more than that would
/// trail behind. Like all lengths here no multiple of a step: on a limit round-off would tell mirror twins apart.
const MEMORY_STEPS: f64 = 5.3;
/// Bounds of that growth, in horizons: aims scatter within the former with how the points lie.
const MEMORY_HORIZONS: [f64; 2] = [0.83, 2.1];
/// Spread of growth, in horizons, below which the slope of the aims says nothing.
const SLOPE_HORIZONS: f64 = 0.15;
/// Turn from which a crack has a corner, rad: nothing before it says where it heads after it.
const CORNER: f64 = 8.0 * std::f64::consts::PI / 180.0;
/// Growth after a corner, in horizons, over which the direction is held: the core of the tip has to leave the corner first.
const HELD_HORIZONS: f64 = 1.15;
/// Growth after that, in horizons, until the aims since then show how the crack curves.
const FOUND_HORIZONS: f64 = 1.0;

/// Angle θ of the largest circumferential stress, rad, counter-clockwise from straight ahead.
pub fn kink_angle([k_i, k_ii]: [f64; 2]) -> f64 {
    if k_ii == 0.0 {
        return 0.0;
    }
    // The root with the larger stress, for either sign of K_II; in this form nothing cancels.
    -2.0 * (2.0 * k_ii).atan2(k_i + k_i.hypot(8.0_f64.sqrt() * k_ii))
}

/// K_eq, Pa√m: the opening factor in the direction of [`kink_angle`]; none where the flanks are in contact.
pub fn equivalent_factor(factors: [f64; 2]) -> f64 {
    let (k_i, k_ii) = (factors[0].max(0.0), factors[1]);
    let theta = kink_angle([k_i, k_ii]);
    let half = (0.5 * theta).cos();
    (half * (k_i * half * half - 1.5 * k_ii * theta.sin())).max(0.0)
}

/// What a tip has aimed at.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Steering {
    /// Growth and aim, as angle from x, rad, since the last corner.
    aims: Vec<[f64; 2]>,
    /// Growth at the last corner, m, while the direction after it is held.
    corner: Option<f64>,
    /// Growth at which the direction after a corner was last held, m.
    held: Option<f64>,
}

impl Steering {
    /// Takes in the factors of a tip that has grown by `growth` along `ahead`.
    pub fn read(&mut self, factors: [f64; 2], growth: f64, ahead: Point, horizon: f64) {
        if self.corner.is_some_and(|corner| growth < corner + HELD_HORIZONS * horizon) {
            self.held = Some(growth);
            return;
        }
        let turn = kink_angle([factors[0].max(0.0), factors[1]]);
        // Counted on from the last aim, so that angles beyond ±180° are no jump.
        let heading = ahead[1].atan2(ahead[0]);
        let last = self.aims.last().map_or(heading, |aim| aim[1]);
        let turns = ((last - heading) / std::f64::consts::TAU).round() * std::f64::consts::TAU;
        let aim = heading + turns + turn;
        if turn.abs() > CORNER {
            (self.aims, self.corner, self.held) = (vec![[growth, aim]], Some(growth), Some(growth));
            return;
        }
        if self.corner.take().is_some() {
            self.aims.clear();
        }
        let step = self.aims.last().map_or(0.0, |last| growth - last[0]);
        let [least, most] = MEMORY_HORIZONS.map(|horizons| horizons * horizon);
        self.aims.push([growth, aim]);
        self.aims.retain(|aim| aim[0] >= growth - (MEMORY_STEPS * step).clamp(least, most));
    }

    /// Direction for the next `step` of growth, m: the aim at its middle.
    pub fn direction(&self, growth: f64, step: f64, ahead: Point, horizon: f64) -> Point {
        if self.aims.is_empty() {
            return ahead;
        }
        let ([x, y], slope) = self.line(horizon);
        let at = if self.corner.is_some() { x } else { growth + 0.5 * step };
        let (sin, cos) = (y + slope * (at - x)).sin_cos();
        [cos, sin]
    }

    /// Curvature of the crack ahead, rad/m, counter-clockwise.
    pub fn curvature(&self, horizon: f64) -> f64 {
        if self.aims.is_empty() { 0.0 } else { self.line(horizon).1 }
    }

    /// Middle and slope of the straight line through the aims.
    fn line(&self, horizon: f64) -> ([f64; 2], f64) {
        let count = self.aims.len() as f64;
        let [x, y] = [0, 1].map(|i| self.aims.iter().map(|aim| aim[i]).sum::<f64>() / count);
        let product = |i: usize| self.aims.iter().map(|aim| (aim[0] - x) * (aim[i] - [x, y][i])).sum::<f64>();
        ([x, y], product(1) / (product(0) + count * (SLOPE_HORIZONS * horizon).powi(2)))
    }

    /// Whether a tip that has grown by `growth` has come round a corner so lately that its aims do not show yet how it curves.
    pub fn is_turning(&self, growth: f64, horizon: f64) -> bool {
        self.held.is_some_and(|held| growth < held + FOUND_HORIZONS * horizon)
    }

    /// Growth at the last corner, m, while the direction after it is held.
    pub fn corner(&self) -> Option<f64> {
        self.corner
    }
}
