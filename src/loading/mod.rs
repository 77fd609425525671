//! Load history. Constant amplitude so far.

mod boundary;
mod forces;
mod read;

pub use boundary::{Imbalance, imbalance};
pub use read::from_values;

crate::kinds! {
    /// Load histories.
    pub enum LoadingKind for "loading.kind" {
        ConstantAmplitude = "constant_amplitude": "sinusoidal or triangular cycles of one range and one stress ratio",
    }
}

/// Constant amplitude cycles between `ratio x maximum` and `maximum`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Loading {
    /// Largest nominal load of a cycle: gross stress in Pa, or force in N (see `Specimen::load_measure`).
    pub maximum: f64,
    /// Stress ratio R = minimum / maximum, below 1.
    pub ratio: f64,
    /// Stress along the crack over stress across it, applied to the side edges. `Specimen::loads` holds these loads
    /// already; the number stands here for the reports.
    pub parallel_ratio: f64,
}

impl Loading {
    /// Share of the maximum that counts as range, `1 - max(R, 0)`: a closed crack does not open under compression
    /// (theory: closure assumption for negative R).
    #[must_use]
    pub fn range_share(&self) -> f64 {
        1.0 - self.ratio.max(0.0)
    }
}
