//! What drives a crack: from the plate as it stands to the plate a cycle block later.

pub mod plate;
pub mod tip_field;

use crate::specimen::Point;

/// A tip as a step leaves it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TipNow {
    /// Position, m.
    pub position: Point,
    /// Growth since the start, m.
    pub growth: f64,
    /// K_I and K_II at maximum load, Pa√m.
    pub factors: [f64; 2],
    /// da/dN, m/cycle.
    pub rate: f64,
}
