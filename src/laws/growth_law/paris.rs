//! The law of Paris as a growth law: that of Walker at γ = 1.

use super::description::{Constant, GrowthLawSpec, UNSAID};
use super::walker::{self, LEVEL};

/// The law, of C and m.
pub static LAW: GrowthLawSpec = GrowthLawSpec {
    name: "paris",
    meaning: "da/dN = C ΔK^m (Paris and Erdogan 1963)",
    constants: &[LEVEL, Constant::exponent("paris_m", "m", "a Paris exponent m")],
    rate: |law, k_max, ratio| (walker::LAW.rate)(&[law[0], law[1], 1.0], k_max, ratio),
    read: None,
    complete: "give paris_c_mm_per_cycle and paris_m together, or fitted",
    fit: Some("da/dN = C ΔK^m; of a-N readings A and p of bonds as well"),
    takes_ratio: false,
    ..UNSAID
};
