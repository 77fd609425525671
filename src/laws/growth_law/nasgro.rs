//! The NASGRO equation (Forman and Mettu 1992, ASTM STP 1131:519), with the crack opening of Newman 1984 (Int. J. Fract. 24:R131):
//!
//! `da/dN = C [(1-f)/(1-R) ΔK]^n (1 - ΔK_th/ΔK)^p / (1 - K_max/K_c)^q`, ΔK = (1-R) K_max, also at R < 0, down to R = -2.

use std::f64::consts::PI;

use toml::{Table, Value};

use super::description::{Constant, Evidence, GrowthLawSpec, K_C, NEAR_FRACTURE, NEAR_THRESHOLD, RATIOS, Role, UNSAID, rate_of};
use perilife_base::input::{INTENSITY, Quantity, number};
use perilife_base::units::MPA_SQRT_M;
use perilife_plate::material::growth_data::{GrowthRecord, MM_PER_INCH, MPA_SQRT_M_PER_KSI_SQRT_IN};

const fn exponent(what: &'static str) -> Quantity {
    number(what, 0.0, 20.0)
}
const CONSTRAINT: Quantity = number("a constraint factor α", 1.0, 3.0);
const DELTA_K_0: Quantity = Quantity { what: "a threshold ΔK0 at R = 0", ..INTENSITY };
const SLOPE: Quantity = number("a threshold slope Cth over R", -10.0, 10.0);
const SHARE: Quantity = number("a ratio Smax/σ0", 0.0, 0.99);
const RATIOS_NEAR_THRESHOLD: Evidence = Evidence("needs rates near the threshold at several stress ratios", true);

/// The law, of C as the rate at ΔK = 1 MPa√m, n, p of the threshold, q of instability, the constraint α (1 in plane stress, 3 in plane
/// strain), S_max over the flow stress, ΔK₀ at R = 0, C_th for R from 0 on and below, and K_c.
pub static LAW: GrowthLawSpec = GrowthLawSpec {
    name: "nasgro",
    meaning: "crack closure, threshold and instability in one equation (Forman and Mettu 1992)",
    constants: &[
        Constant::new("nasgro_c_mm_per_cycle", "c", rate_of("a NASGRO C")),
        Constant::exponent("nasgro_n", "n", "a NASGRO exponent n"),
        Constant::new("nasgro_p", "p", exponent("a threshold exponent p")).searched([0.0, 5.0], [0.25, 1.0], NEAR_THRESHOLD, 1.0),
        Constant::new("nasgro_q", "q", exponent("a fracture exponent q")).searched([0.0, 5.0], [0.25, 1.0], NEAR_FRACTURE, 1.0),
        Constant::new("nasgro_alpha", "alpha", CONSTRAINT).searched([1.0, 3.0], [1.5, 2.5], RATIOS, 1.0),
        Constant { held: Some(0.3), ..Constant::new("nasgro_smax_over_flow", "stress_over_flow", SHARE) },
        Constant { role: Role::Threshold, ..Constant::new("nasgro_delta_k_0_mpa_sqrt_m", "threshold", DELTA_K_0) }.searched(
            [-3.0, 9.2],
            [0.0, 3.0],
            NEAR_THRESHOLD,
            1.0,
        ),
        Constant { default: Some(0.0), ..Constant::new("nasgro_c_th", "threshold_slopes", SLOPE) }.searched(
            [-5.0, 5.0],
            [0.5; 2],
            RATIOS_NEAR_THRESHOLD,
            2.0,
        ),
        Constant { default: Some(0.0), held: Some(0.0), ..Constant::new("nasgro_c_th_negative", "threshold_slopes", SLOPE) },
        K_C,
    ],
    rate,
    threshold,
    fit: Some("the NASGRO equation"),
    factors: &[
        ("fracture", &[("nasgro_q", 0.0), (K_C.key, f64::INFINITY)]),
        ("stress ratio in the threshold", &[("nasgro_c_th", 0.0)]),
        ("threshold", &[("nasgro_p", 0.0), ("nasgro_delta_k_0_mpa_sqrt_m", 1e-6), ("nasgro_c_th", 0.0)]),
    ],
    compression: Some(("crack opening", -2.0)),
    ..UNSAID
};

/// f at a stress ratio, and A₀:
/// `f = K_op/K_max = max(R, A₀ + A₁ R + A₂ R² + A₃ R³)` for R ≥ 0 and `A₀ + A₁ R` below,
/// `A₀ = (0.825 - 0.34 α + 0.05 α²) cos(π S/2)^(1/α)`, `A₁ = (0.415 - 0.071 α) S`, `A₂ = 1 - A₀ - A₁ - A₃`, `A₃ = 2 A₀ + A₁ - 1`,
/// S being S_max over the flow stress.
pub fn opening(alpha: f64, s: f64, ratio: f64) -> (f64, f64) {
    let a0 = (0.825 - 0.34 * alpha + 0.05 * alpha * alpha) * (0.5 * PI * s).cos().powf(1.0 / alpha);
    let a1 = (0.415 - 0.071 * alpha) * s;
    let a3 = 2.0 * a0 + a1 - 1.0;
    let a2 = 1.0 - a0 - a1 - a3;
    let f = if ratio >= 0.0 { (a0 + ratio * (a1 + ratio * (a2 + ratio * a3))).max(ratio) } else { a0 + a1 * ratio };
    (f, a0)
}

/// That of long cracks, `ΔK_th = ΔK₀ [(1-f) / ((1-A₀)(1-R))]^-(1 + C_th R)`.
fn threshold(law: &[f64], ratio: f64) -> f64 {
    let [_, _, _, _, alpha, s, threshold, above, below, _] = *law else { return f64::NAN };
    let (f, a0) = opening(alpha, s, ratio);
    let base = (1.0 - f) / ((1.0 - a0) * (1.0 - ratio));
    threshold * base.powf(-(1.0 + if ratio < 0.0 { below } else { above } * ratio))
}

fn rate(law: &[f64], k_max: f64, ratio: f64) -> f64 {
    let [c, n, p, q, alpha, s, .., k_c] = *law else { return f64::NAN };
    let delta_k = (1.0 - ratio) * k_max;
    let threshold = threshold(law, ratio);
    if delta_k <= threshold || k_max <= 0.0 {
        return 0.0;
    }
    let left = 1.0 - k_max / k_c;
    if left <= 0.0 {
        return f64::INFINITY;
    }
    let (f, _) = opening(alpha, s, ratio);
    let effective = (1.0 - f) * k_max / MPA_SQRT_M;
    c * effective.powf(n) * (1.0 - threshold / delta_k).powf(p) / left.powf(q)
}

/// The law of a record of the library at a thickness, mm, as the keys of `[fatigue]`.
///
/// Records have the threshold as `ΔK₁ [(1-R)/(1-f)]^(1 + R C_th) / (1-A₀)^((1-R) C_th)`, which is that of the law with
/// `ΔK₀ = ΔK₁ (1-A₀)^-(1 + C_th)`; below R = 0 both have the same form with the C_th of there.
pub fn keys_of(record: &GrowthRecord, thickness_mm: f64) -> Table {
    let (_, a0) = opening(record.alpha, record.smax_over_flow, 0.0);
    let threshold = record.delta_k_1_ksi_sqrt_in * MPA_SQRT_M_PER_KSI_SQRT_IN * (1.0 - a0).powf(-(1.0 + record.c_th));
    // In the order of the law's constants.
    let numbers = [
        record.c_in_per_cycle * MM_PER_INCH / MPA_SQRT_M_PER_KSI_SQRT_IN.powf(record.n),
        record.n,
        record.p,
        record.q,
        record.alpha,
        record.smax_over_flow,
        threshold,
        record.c_th,
        record.c_th_negative,
        record.toughness(thickness_mm),
    ];
    let constants = LAW.constants.iter().zip(numbers).map(|(constant, number)| (constant.key.to_owned(), Value::Float(number)));
    constants.chain([("growth_law".to_owned(), Value::String(LAW.name.to_owned()))]).collect()
}
