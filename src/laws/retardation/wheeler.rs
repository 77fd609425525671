//! Wheeler 1972 (J. Basic Eng. 94:181).

use super::description::{Constant, RetardationSpec};
use perilife_base::input::number;

/// `da/dN = φ v(K_max, R)`, `φ = [r_p / (a_OL + r_OL - a)]^m` while a + r_p lies within the zone of the overload. φ counts on the rate, so that
/// nothing is ever arrested.
pub static MODEL: RetardationSpec = RetardationSpec {
    name: "wheeler",
    meaning: "rate × (plastic zone / remaining overload zone)^wheeler_exponent (Wheeler 1972)",
    constants: &[Constant {
        key: "wheeler_exponent",
        quantity: number("a Wheeler exponent m", 0.0, 10.0),
        default: |_, _| None,
        remedy: "fit to overload tests; 1 to 2 for many aluminum alloys",
    }],
    rate: Some(|constants, law, now, zone| (now.size / (zone.end() - now.a)).powf(constants[0]) * law.rate(now.k_max, now.ratio)),
    underload: "not modeled",
};
