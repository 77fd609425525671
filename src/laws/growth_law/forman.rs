//! The law of Forman: Paris growth that becomes unstable at K_max = K_c (Forman, Kearney and Engle 1967, J. Basic Eng. 89:459).

use super::description::{Constant, GrowthLawSpec, K_C, UNSAID, rate_of};
use perilife_base::units::MPA_SQRT_M;

const LEVEL: Constant = Constant::new("forman_c_mm_per_cycle", "c", rate_of("a Forman C"));
/// The law, of C, m and K_c.
pub static LAW: GrowthLawSpec = GrowthLawSpec {
    name: "forman",
    meaning: "da/dN = C ΔK^m / ((1-R) K_c - ΔK) (Forman, Kearney and Engle 1967)",
    constants: &[LEVEL, Constant::exponent("forman_m", "m", "a Forman exponent m"), K_C],
    rate,
    fit: Some("da/dN = C ΔK^m / ((1-R) K_c - ΔK)"),
    ..UNSAID
};

/// `C ΔK^m / ((1-R) K_c - ΔK)`, C in m/cycle (MPa√m)^(1-m); compression does not count.
fn rate(law: &[f64], k_max: f64, ratio: f64) -> f64 {
    let [c, m, k_c] = *law else { return f64::NAN };
    let range = 1.0 - ratio.max(0.0);
    let left = range * (k_c - k_max) / MPA_SQRT_M;
    if left <= 0.0 { f64::INFINITY } else { c * (range * k_max / MPA_SQRT_M).powf(m) / left }
}
