//! Willenborg, Engle and Wood 1971 (AFFDL-TM-71-1-FBR), generalised by Gallagher and Hughes 1974 (AFFDL-TR-74-27).

use super::description::{Constant, RetardationSpec};
use perilife_base::input::{INTENSITY, Quantity, number};

/// `da/dN = v(K_max - K_red, R_eff)`, `R_eff = (K_min - K_red)/(K_max - K_red)`, `K_red = φ [K_OL √(1 - Δa/r_OL) - K_max]`,
/// `φ = (1 - K_th/K_max)/(S - 1)`, Δa being the growth since the overload. At K_OL √… = S K_max, the shut-off ratio, K_max - K_red is K_th and
/// the crack is arrested. The residual stress takes the same from both ends of the cycle: ΔK is kept and R falls, below 0 as the law takes it.
pub static MODEL: RetardationSpec = RetardationSpec {
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
