//! Where a tip turns to: maximum circumferential stress (Erdogan and Sih 1963, J. Basic Eng. 85:519).
//!
//! `K_I sin θ + K_II (3 cos θ - 1) = 0`, and the factor that opens the crack in that direction is
//! `K_eq = cos(θ/2) [K_I cos²(θ/2) - 3/2 K_II sin θ]`.
//!
//! The direction is read at the tip off a straight line through the last aims: a mean over them would trail behind a curving crack by half
//! of their length. On points a single reading of K_II scatters with how the bonds around the tip lie, and the line goes through the aims
//! of the last two horizons of growth; on nodes it goes through the last two, or the last four where these lie to one side and the other in
//! turn, over the root of the length of crack ([`SteeringScales`]).

use serde::{Deserialize, Serialize};

use super::scales::SteeringScales;
use perilife_plate::specimen::Point;

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
    factor_across([k_i, k_ii], kink_angle([k_i, k_ii])).max(0.0)
}

/// Opening factor of K_I and K_II, Pa√m, in a direction θ: `cos(θ/2) [K_I cos²(θ/2) - 3/2 K_II sin θ]`.
pub fn factor_across(factors: [f64; 2], theta: f64) -> f64 {
    factors_across(factors, theta)[0]
}

/// K_I and K_II, Pa√m, of a crack of these factors that has just turned by θ: σ_θθ and τ_rθ ahead of it times √(2πr), K_II as
/// `cos(θ/2)/2 [K_I sin θ + K_II (3 cos θ - 1)]`. Within 0.6 % of K by Amestoy and Leblond up to 15°.
pub fn factors_across([k_i, k_ii]: [f64; 2], theta: f64) -> [f64; 2] {
    let (half, (sin, cos)) = ((0.5 * theta).cos(), theta.sin_cos());
    [half * (k_i * half * half - 1.5 * k_ii * sin), 0.5 * half * (k_i * sin + k_ii * (3.0 * cos - 1.0))]
}

/// What a tip has aimed at.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Steering {
    /// Growth and aim, as angle from x, rad, since the last corner.
    aims: Vec<[f64; 2]>,
    /// Growth at the last corner, m, while the direction after it is held.
    corner: Option<f64>,
    /// The same for ever.
    last_corner: Option<f64>,
    /// Growth at which the direction after a corner was last held, m.
    held: Option<f64>,
}

impl Steering {
    /// Takes in the factors of a tip that has grown by `growth` along `ahead`.
    pub fn read(&mut self, factors: [f64; 2], growth: f64, ahead: Point, scales: &SteeringScales) {
        if self.corner.is_some_and(|corner| growth < corner + scales.held) {
            self.held = Some(growth);
            return;
        }
        let turn = kink_angle([factors[0].max(0.0), factors[1]]);
        // Counted on from the last aim, so that angles beyond ±180° are no jump.
        let heading = ahead[1].atan2(ahead[0]);
        let last = self.aims.last().map_or(heading, |aim| aim[1]);
        let turns = ((last - heading) / std::f64::consts::TAU).round() * std::f64::consts::TAU;
        let aim = heading + turns + turn;
        let is_new = self.aims.is_empty() && self.last_corner.is_none();
        if turn.abs() > if is_new { scales.corner_at_start } else { scales.corner } {
            (self.aims, self.corner, self.held) = (vec![[growth, aim]], Some(growth), Some(growth));
            self.last_corner = self.corner;
            return;
        }
        if self.corner.take().is_some() {
            self.aims.clear();
        }
        let step = self.aims.last().map_or(0.0, |last| growth - last[0]);
        let [least, most] = scales.memory;
        self.aims.push([growth, aim]);
        self.aims.retain(|aim| aim[0] >= growth - (scales.memory_steps * step).clamp(least, most));
        self.aims.drain(..self.aims.len().saturating_sub(scales.aims[1]));
    }

    /// Direction for the next `step` of growth, m: the aim at its middle. Aims lie on a straight line over `smooth_in` of the growth.
    pub fn direction(
        &self,
        [growth, step]: [f64; 2],
        ahead: Point,
        scales: &SteeringScales,
        smooth_in: impl Fn(f64) -> f64,
    ) -> Point {
        if self.aims.is_empty() {
            return ahead;
        }
        let ([x, y], slope) = self.line(scales, &smooth_in);
        let at = if self.corner.is_some() { x } else { smooth_in(growth + 0.5 * step) };
        let (sin, cos) = (y + slope * (at - x)).sin_cos();
        [cos, sin]
    }

    /// Slope of the aims over `smooth_in` of the growth, rad over its unit, counter-clockwise: curvature of the crack ahead where that is
    /// the growth.
    pub fn slope(&self, scales: &SteeringScales, smooth_in: impl Fn(f64) -> f64) -> f64 {
        if self.aims.is_empty() { 0.0 } else { self.line(scales, &smooth_in).1 }
    }

    /// Middle and slope of the straight line through the aims.
    fn line(&self, scales: &SteeringScales, smooth_in: &impl Fn(f64) -> f64) -> ([f64; 2], f64) {
        let rise = |k: usize| self.aims[k + 1][1] - self.aims[k][1];
        let zigzags = self.aims.len() == scales.aims[1] && (1..self.aims.len() - 1).all(|k| rise(k) * rise(k - 1) < 0.0);
        let from = if zigzags { 0 } else { self.aims.len().saturating_sub(scales.aims[0]) };
        let count = (self.aims.len() - from) as f64;
        let aims = || self.aims[from..].iter().map(|&[growth, aim]| [smooth_in(growth), aim]);
        let [x, y] = [0, 1].map(|i| aims().map(|aim| aim[i]).sum::<f64>() / count);
        let product = |i: usize| aims().map(|aim| (aim[0] - x) * (aim[i] - [x, y][i])).sum::<f64>();
        let spread = product(0) + count * scales.slope.powi(2);
        ([x, y], if spread > 0.0 { product(1) / spread } else { 0.0 })
    }

    /// Whether a tip that has grown by `growth` has come round a corner so lately that its aims do not show yet how it curves.
    pub fn is_turning(&self, growth: f64, scales: &SteeringScales) -> bool {
        self.held.is_some_and(|held| growth < held + scales.found)
    }

    /// Growth at the last corner, m, while the direction after it is held.
    pub fn corner(&self) -> Option<f64> {
        self.corner
    }

    /// Growth at the last corner, m.
    pub fn last_corner(&self) -> Option<f64> {
        self.last_corner
    }

    pub fn forget(&mut self) {
        *self = Steering { last_corner: self.last_corner, ..Steering::default() };
    }
}
