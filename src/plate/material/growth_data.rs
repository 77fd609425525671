//! Growth data of the library: `data/materials/growth.csv`, constants of the NASGRO equation by alloy, form, orientation and environment, and the
//! `[growth]` of a user's own material file, which has the keys of a law in `[fatigue]`.

use serde::Deserialize;

#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GrowthRecord {
    pub name: String,
    pub alloy: String,
    pub form: String,
    pub orientation: String,
    pub environment: String,
    pub(crate) youngs_modulus_gpa: f64,
    pub(crate) poisson_ratio: f64,
    pub(crate) tensile_ksi: f64,
    pub(crate) yield_ksi: f64,
    k_1c_ksi_sqrt_in: f64,
    a_k: f64,
    b_k: f64,
    pub c_in_per_cycle: f64,
    pub n: f64,
    pub p: f64,
    pub q: f64,
    pub delta_k_1_ksi_sqrt_in: f64,
    pub c_th: f64,
    pub c_th_negative: f64,
    pub alpha: f64,
    pub smax_over_flow: f64,
    /// Tests that its rates were compared with, their ranges, and predicted over measured life; empty: none.
    checked: String,
}

/// MPa in a ksi.
pub(crate) const MPA_PER_KSI: f64 = 6.894_757_293;
/// mm in an inch.
pub const MM_PER_INCH: f64 = 25.4;
/// MPa√m in a ksi√in.
pub const MPA_SQRT_M_PER_KSI_SQRT_IN: f64 = 1.098_843_4;
const FILE: &str = include_str!("../../../data/materials/growth.csv");
/// Where its figures come from.
pub const SOURCE: &str = "NASGRO 4, constants of the NASGRO equation (Forman and Mettu 1992), fits of NASA and FAA";
/// What another batch of the same material may grow at, over the rate of a record, or under it.
pub const BATCH_FACTOR: f64 = 2.0;

pub fn records() -> Vec<GrowthRecord> {
    let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_reader(FILE.as_bytes());
    reader.deserialize().filter_map(Result::ok).collect()
}

pub fn record(name: &str) -> Option<GrowthRecord> {
    records().into_iter().find(|record| record.name == name)
}

impl GrowthRecord {
    pub fn title(&self) -> String {
        format!("{}, {}, {}, {}", self.alloy, self.form, self.orientation, self.environment)
    }

    pub fn checked(&self) -> &str {
        if self.checked.is_empty() { "not checked against tests" } else { &self.checked }
    }

    /// K_c of a thickness, mm, in MPa√m: `K_1c (1 + B_k exp(-(A_k t/t₀)²))` with `t₀ = 2.5 (K_1c/σ_y)²`.
    pub fn toughness(&self, thickness_mm: f64) -> f64 {
        let t0 = 2.5 * (self.k_1c_ksi_sqrt_in / self.yield_ksi).powi(2) * MM_PER_INCH;
        let k_1c = self.k_1c_ksi_sqrt_in * MPA_SQRT_M_PER_KSI_SQRT_IN;
        k_1c * (1.0 + self.b_k * (-(self.a_k * thickness_mm / t0).powi(2)).exp())
    }
}
