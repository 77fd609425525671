//! What past blocks teach about the strains foreseen at a crack tip.
//!
//! With w the work that the loads have done since the last solve because bonds of this tip broke, the strains there were
//! foreseen too low by `ln(ε/ε_foreseen) = ∫ β dw`. Every block gives the mean of β over its w. It falls as the crack grows
//! (like 1/K²: the same work then stands for less growth), so a straight line through the last blocks is carried on.

use serde::{Deserialize, Serialize};

/// Weight of a block over that of the next one.
const DISCOUNT: f64 = 0.6;
/// Spread of the blocks along w, in the size of the last one, below which they show a mean but no slope.
const LEAST_SPREAD: f64 = 0.3;

/// Growth of a tip within the block at hand, and the error to expect of strains foreseen.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Foresight {
    /// Growth since the last solve, m.
    pub grown: f64,
    /// Growth since the first block, m.
    pub grown_in_all: f64,
    /// Work of the loads since the last solve, as foreseen, J.
    released: f64,
    /// Weighted sums over past blocks; w counts from the last solve, x is that of the middle of a block.
    sums: Sums,
}

/// Σ g, Σ g x, Σ g x², Σ g β, Σ g x β with weights g = w², since the mean of a block is known to ±1/w.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
struct Sums {
    one: f64,
    x: f64,
    xx: f64,
    beta: f64,
    x_beta: f64,
    /// w of the last block.
    last: f64,
}

impl Foresight {
    /// Takes in growth and the work that it brought.
    pub fn grow(&mut self, growth: f64, work: f64) {
        self.grown += growth;
        self.grown_in_all += growth;
        self.released += work;
    }

    /// Begins a block.
    pub fn open(&mut self) {
        (self.grown, self.released) = (0.0, 0.0);
    }

    /// Whether nothing has broken here since the last solve.
    #[must_use]
    pub fn is_at_rest(&self) -> bool {
        self.released == 0.0
    }

    /// Whether a block has shown how good it is.
    #[must_use]
    pub fn is_known(&self) -> bool {
        self.sums.one > 0.0
    }

    /// Logarithm of the factor by which strains are foreseen too low, as past blocks say.
    #[must_use]
    pub fn correction(&self) -> f64 {
        if self.is_known() { self.released * self.sums.line(0.5 * self.released) } else { 0.0 }
    }

    /// Learns from the mean logarithm of strains solved for over those foreseen, uncorrected.
    pub fn learn(&mut self, mean: f64) {
        if self.released > 0.0 {
            self.sums.add(self.released, mean / self.released);
        }
    }
}

impl Sums {
    /// β at x by weighted least squares.
    fn line(&self, x: f64) -> f64 {
        let (middle, mean) = (self.x / self.one, self.beta / self.one);
        let spread = self.xx / self.one - middle * middle;
        let slope = (self.x_beta / self.one - middle * mean) / (spread + (LEAST_SPREAD * self.last).powi(2));
        // The work of a break is above zero, and so is what the rim would add; a line that says otherwise reaches too far.
        let reached = mean + slope * (x - middle);
        reached.clamp((0.5 * mean).min(1.5 * mean), (0.5 * mean).max(1.5 * mean))
    }

    /// Takes in a block of work w with mean β, from whose end x counts from now on.
    fn add(&mut self, w: f64, beta: f64) {
        // The blocks before lie w farther back.
        self.xx = DISCOUNT * (self.xx - 2.0 * w * self.x + w * w * self.one);
        self.x_beta = DISCOUNT * (self.x_beta - w * self.beta);
        self.x = DISCOUNT * (self.x - w * self.one);
        (self.one, self.beta) = (DISCOUNT * self.one, DISCOUNT * self.beta);
        let (g, x) = (w * w, -0.5 * w);
        self.one += g;
        self.x += g * x;
        self.xx += g * x * x;
        self.beta += g * beta;
        self.x_beta += g * x * beta;
        self.last = w;
    }
}
