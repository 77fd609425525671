//! Models of retardation: each its formula, its constants and what it says of itself.

use super::description::{Constant, RetardationSpec};
use crate::growth_law::nasgro::opening;
use perilife_base::input::{INTENSITY, Quantity, number};
use perilife_base::monotone::bisected;
use perilife_plate::material::Plane;

pub static NONE: RetardationSpec =
    RetardationSpec { name: "none", meaning: "no load interaction", constants: &[], rate: None, underload: "none" };

/// Wheeler 1972 (J. Basic Eng. 94:181): `da/dN = φ v(K_max, R)`, `φ = [r_p / (a_OL + r_OL - a)]^m` while a + r_p lies within the zone of the
/// overload. φ counts on the rate, so that nothing is ever arrested.
pub static WHEELER: RetardationSpec = RetardationSpec {
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

/// Willenborg, Engle and Wood 1971 (AFFDL-TM-71-1-FBR), generalised by Gallagher and Hughes 1974 (AFFDL-TR-74-27):
/// `da/dN = v(K_max - K_red, R_eff)`, `R_eff = (K_min - K_red)/(K_max - K_red)`, `K_red = φ [K_OL √(1 - Δa/r_OL) - K_max]`,
/// `φ = (1 - K_th/K_max)/(S - 1)`, Δa being the growth since the overload. At K_OL √… = S K_max, the shut-off ratio, K_max - K_red is K_th and
/// the crack is arrested. The residual stress takes the same from both ends of the cycle: ΔK is kept and R falls, below 0 as the law takes it.
pub static WILLENBORG: RetardationSpec = RetardationSpec {
    name: "willenborg",
    meaning: "K reduced by residual stress, no growth above the shut-off ratio (Willenborg 1971, Gallagher and Hughes 1974)",
    constants: &[
        Constant {
            key: "shutoff_ratio",
            quantity: number("a shut-off ratio S", 1.01, 100.0),
            default: |_, _| None,
            remedy: "give the ratio of overload to cycle that arrests a crack, 2 to 3 for many aluminum and titanium alloys",
        },
        Constant {
            key: "willenborg_k_th_mpa_sqrt_m",
            quantity: Quantity { what: "a threshold K_max at R = 0", ..INTENSITY },
            default: |_, threshold| threshold,
            remedy: "give K_max at the threshold of R = 0, or fatigue.delta_k_threshold_mpa_sqrt_m",
        },
    ],
    rate: Some(|constants, law, now, zone| {
        let [shutoff, threshold] = [constants[0], constants[1]];
        let asked = zone.k_max * (1.0 - (now.a - zone.from) / zone.size).max(0.0).sqrt();
        let reduction = (1.0 - threshold / now.k_max) / (shutoff - 1.0) * (asked - now.k_max);
        let effective = now.k_max - reduction.max(0.0);
        let ratio = ((now.ratio * now.k_max - reduction.max(0.0)) / effective).max(now.least);
        if now.k_max <= threshold || asked >= shutoff * now.k_max { 0.0 } else { law.rate(effective, ratio) }
    }),
    underload: "not modeled",
};

/// `da/dN = v(K_max, C_f)` within the zone of an overload: the crack is open from C_f K_max on, `C_f = 1 - (1 - C_f0)(1 + 0.6 R)(1 - R)` (Bell
/// and Creager 1974, AFFDL-TR-74-129), and the law takes that for its R. R is at least -1 here.
pub static CLOSURE: RetardationSpec = RetardationSpec {
    name: "closure",
    meaning: "stress ratio C_f = 1 - (1 - closure_cf0)(1 + 0.6 R)(1 - R) within the zone of an overload",
    constants: &[Constant {
        key: "closure_cf0",
        quantity: number("a closure factor Cf0", 0.0, 0.99),
        default: |_, _| None,
        remedy: "give opening load over maximum at R = 0, 0.3 for many aluminum alloys",
    }],
    rate: Some(|constants, law, now, _| {
        let ratio = now.ratio.max(-1.0);
        let factor = 1.0 - (1.0 - constants[0]) * (1.0 + 0.6 * ratio) * (1.0 - ratio);
        law.rate(now.k_max, factor.max(now.ratio))
    }),
    underload: "not modeled",
};

/// S_max over the flow stress.
const SHARE: Quantity = number("a ratio Smax/flow stress", 0.0, 0.99);
/// In place of a share: that of every cycle, by K and crack length.
const BY_THE_CRACK: f64 = f64::INFINITY;
/// Least stress ratio for which the opening is known.
const LEAST: f64 = -2.0;

/// Opening load of Newman 1984 (Int. J. Fract. 24:R131), kept from the overload on.
/// Within the zone of an overload the crack opens at `K_op = f(K_min/K_OL) K_OL`, f being S_open/S_max of constant amplitude and K_min the least
/// K since the overload; a cycle grows as one of constant amplitude that opens at the same load: `da/dN = v(K_max, R*)`, `f(R*) = K_op/K_max`, so
/// that cycles of one size have the rate of the law. S_max over the flow stress is K_max/(σ_Y √(πa)) where the case gives none: the stress at which a
/// crack in a wide plate has this K, by which closure of M(T), SE(T) and bending specimens agrees (McClung 1994, Fatigue Fract. Eng. Mater. Struct.
/// 17:861). The yield strength in place of the flow stress is conservative: more stress opens the crack sooner.
pub static NEWMAN: RetardationSpec = RetardationSpec {
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
            _ => law.rate(now.k_max, bisected([now.ratio, 1.0], 40, |ratio| open(ratio) < wanted)[0]),
        }
    }),
    underload: "an underload within the zone lowers the opening load",
};
