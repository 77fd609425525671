//! Growth laws over K: da/dN of a cycle between R K_max and K_max.

use super::paris::ParisLaw;

/// How fast a crack grows at the stress intensity of its tip.
pub trait GrowthLaw: std::fmt::Debug + Send + Sync {
    /// da/dN, m/cycle, at K_max, Pa√m, and stress ratio R; 0 where the crack does not grow.
    fn rate(&self, k_max: f64, ratio: f64) -> f64;
}

/// `da/dN = C (K_max (1-R)^γ)^m` above a threshold of ΔK (Walker 1970, ASTM STP 462; γ = 1: Paris and Erdogan 1963); compression
/// does not count.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Walker {
    /// C and m at R = 0.
    pub paris: ParisLaw,
    /// γ.
    pub gamma: f64,
    /// ΔK below which nothing grows, Pa√m.
    pub threshold: f64,
}

impl GrowthLaw for Walker {
    fn rate(&self, k_max: f64, ratio: f64) -> f64 {
        let range = 1.0 - ratio.max(0.0);
        if k_max * range <= self.threshold { 0.0 } else { self.paris.rate(k_max * range.powf(self.gamma)) }
    }
}
