//! Opening load of Newman 1984 (Int. J. Fract. 24:R131), kept from the overload on.

use super::description::{Constant, RetardationSpec};
use crate::growth_law::nasgro::opening;
use perilife_base::input::{Quantity, number};
use perilife_plate::material::Plane;

/// S_max over the flow stress.
const SHARE: Quantity = number("a ratio Smax/flow stress", 0.0, 0.99);
/// In place of a share: that of every cycle, by K and crack length.
const BY_THE_CRACK: f64 = f64::INFINITY;
/// Least stress ratio for which the opening is known.
const LEAST: f64 = -2.0;

/// Within the zone of an overload the crack opens at `K_op = f(K_min/K_OL) K_OL`, f being S_open/S_max of constant amplitude and K_min the least
/// K since the overload; a cycle grows as one of constant amplitude that opens at the same load: `da/dN = v(K_max, R*)`, `f(R*) = K_op/K_max`, so
/// that cycles of one size have the rate of the law. S_max over the flow stress is K_max/(σ_Y √(πa)) where the case gives none: the stress at which a
/// crack in a wide plate has this K, by which closure of M(T), SE(T) and bending specimens agrees (McClung 1994, Fatigue Fract. Eng. Mater. Struct.
/// 17:861). The yield strength in place of the flow stress is conservative: more stress opens the crack sooner.
pub static MODEL: RetardationSpec = RetardationSpec {
    name: "newman",
    meaning: "crack opening load of the overload, by Newman's S_open of R, within its plastic zone (Newman 1984)",
    constants: &[
        Constant {
            key: "newman_alpha",
            quantity: number("a constraint factor α", 1.0, 3.0),
            default: |plane, _| Some(if plane == Plane::Strain { 3.0 } else { 1.0 }),
            remedy: "",
        },
        Constant { key: "newman_smax_over_flow", quantity: SHARE, default: |_, _| Some(BY_THE_CRACK), remedy: "" },
    ],
    rate: Some(|constants, law, now, zone| {
        let over = |k_max: f64| match constants[1] {
            BY_THE_CRACK => (now.stress_over_yield * k_max / now.k_max).min(SHARE.high),
            given => given,
        };
        let open_at = |share: f64, ratio: f64| opening(constants[0], share, ratio.max(LEAST)).0;
        let wanted = open_at(over(zone.k_max), zone.k_min / zone.k_max) * zone.k_max / now.k_max;
        let own = over(now.k_max);
        let open = |ratio: f64| open_at(own, ratio);
        match wanted {
            _ if wanted <= open(now.ratio) => law.rate(now.k_max, now.ratio),
            _ if wanted >= 1.0 => 0.0,
            _ => law.rate(now.k_max, ratio_of(wanted, open, now.ratio)),
        }
    }),
    underload: "an underload within the zone lowers the opening load",
};

/// Stress ratio above `low` at which cracks open at the share `wanted` of the maximum, which rises with the ratio: halved 40 times.
fn ratio_of(wanted: f64, open: impl Fn(f64) -> f64, low: f64) -> f64 {
    let (mut low, mut high) = (low, 1.0);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if open(middle) < wanted { low = middle } else { high = middle }
    }
    low
}
