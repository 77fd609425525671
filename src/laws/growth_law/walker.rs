//! The law of Walker, which at γ = 1 is that of Paris.

use super::GrowthLaw;
use super::description::{Constant, GAMMA, GrowthLawSpec, UNSAID, rate_of};
use crate::paris::ParisLaw;

/// C.
pub(super) const LEVEL: Constant = Constant::new("paris_c_mm_per_cycle", "c", rate_of("a Paris C"));

/// The law, of C, m and γ.
pub static LAW: GrowthLawSpec = GrowthLawSpec {
    name: "walker",
    meaning: "da/dN = C (K_max (1-R)^γ)^m (Walker 1970)",
    constants: &[LEVEL, Constant::exponent("paris_m", "m", "a Paris exponent m"), GAMMA],
    rate: |law, k_max, ratio| {
        Walker { paris: ParisLaw { c: law[0], m: law[1] }, gamma: law[2], threshold: 0.0 }.rate(k_max, ratio)
    },
    read: None,
    fit: Some("da/dN = C (K_max (1-R)^γ)^m"),
    ..UNSAID
};

/// `da/dN = C (K_max (1-R)^γ)^m` above a threshold of ΔK (Walker 1970, ASTM STP 462; γ = 1: Paris and Erdogan 1963); compression
/// does not count.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Walker {
    /// C and m at R = 0.
    pub paris: ParisLaw,
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
