//! Growth data of the library: `data/materials/growth.csv`, constants of the NASGRO equation by alloy, form, orientation and environment, and the
//! `[growth]` of a user's own material file, which has the keys of a law in `[fatigue]`.

use serde::Deserialize;
use toml::{Table, Value};

use super::library::{MaterialFile, Property};
use crate::fatigue::growth_law::nasgro::opening;

/// A record of the file, in its units.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GrowthRecord {
    /// Name, as `material.name` takes it.
    pub name: String,
    /// Alloy and temper.
    pub alloy: String,
    /// Product.
    pub form: String,
    /// Loading and crack direction.
    pub orientation: String,
    /// Environment of the tests.
    pub environment: String,
    youngs_modulus_gpa: f64,
    poisson_ratio: f64,
    tensile_ksi: f64,
    yield_ksi: f64,
    k_1c_ksi_sqrt_in: f64,
    a_k: f64,
    b_k: f64,
    c_in_per_cycle: f64,
    n: f64,
    p: f64,
    q: f64,
    delta_k_1_ksi_sqrt_in: f64,
    c_th: f64,
    c_th_negative: f64,
    alpha: f64,
    smax_over_flow: f64,
}

/// MPa in a ksi, mm in an inch, and MPa√m in a ksi√in.
const MPA_PER_KSI: f64 = 6.894_757_293;
const MM_PER_INCH: f64 = 25.4;
const MPA_SQRT_M_PER_KSI_SQRT_IN: f64 = 1.098_843_4;

const FILE: &str = include_str!("../../../data/materials/growth.csv");
/// Where its figures come from.
pub const SOURCE: &str = "NASGRO 4, constants of the NASGRO equation (Forman and Mettu 1992), fits of NASA and FAA";
/// What another batch of the same material may grow at, over the rate of a record, or under it.
pub const BATCH_FACTOR: f64 = 2.0;

/// All records.
pub fn records() -> Vec<GrowthRecord> {
    let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_reader(FILE.as_bytes());
    reader.deserialize().filter_map(Result::ok).collect()
}

/// The record of a name.
pub fn record(name: &str) -> Option<GrowthRecord> {
    records().into_iter().find(|record| record.name == name)
}

impl GrowthRecord {
    /// In words.
    pub fn title(&self) -> String {
        format!("{}, {}, {}, {}", self.alloy, self.form, self.orientation, self.environment)
    }

    /// K_c of a thickness, mm, in MPa√m: `K_1c (1 + B_k exp(-(A_k t/t₀)²))` with `t₀ = 2.5 (K_1c/σ_y)²`.
    pub fn toughness(&self, thickness_mm: f64) -> f64 {
        let t0 = 2.5 * (self.k_1c_ksi_sqrt_in / self.yield_ksi).powi(2) * MM_PER_INCH;
        let k_1c = self.k_1c_ksi_sqrt_in * MPA_SQRT_M_PER_KSI_SQRT_IN;
        k_1c * (1.0 + self.b_k * (-(self.a_k * thickness_mm / t0).powi(2)).exp())
    }

    /// Its law at a thickness, mm, as the keys of `[fatigue]`.
    ///
    /// The file has the threshold as `ΔK₁ [(1-R)/(1-f)]^(1 + R C_th) / (1-A₀)^((1-R) C_th)`, which is that of the law with
    /// `ΔK₀ = ΔK₁ (1-A₀)^-(1 + C_th)`; below R = 0 both have the same form with the C_th of there.
    pub fn keys(&self, thickness_mm: f64) -> Table {
        let (_, a0) = opening(self.alpha, self.smax_over_flow, 0.0);
        let threshold = self.delta_k_1_ksi_sqrt_in * MPA_SQRT_M_PER_KSI_SQRT_IN * (1.0 - a0).powf(-(1.0 + self.c_th));
        let numbers = [
            ("nasgro_c_mm_per_cycle", self.c_in_per_cycle * MM_PER_INCH / MPA_SQRT_M_PER_KSI_SQRT_IN.powf(self.n)),
            ("nasgro_n", self.n),
            ("nasgro_p", self.p),
            ("nasgro_q", self.q),
            ("nasgro_alpha", self.alpha),
            ("nasgro_smax_over_flow", self.smax_over_flow),
            ("nasgro_delta_k_0_mpa_sqrt_m", threshold),
            ("nasgro_c_th", self.c_th),
            ("nasgro_c_th_negative", self.c_th_negative),
            ("k_c_mpa_sqrt_m", self.toughness(thickness_mm)),
        ];
        let law = ("growth_law".to_owned(), Value::String("nasgro".to_owned()));
        numbers.into_iter().map(|(key, number)| (key.to_owned(), Value::Float(number))).chain([law]).collect()
    }

    /// What it says of the material beside its growth.
    pub fn file(&self) -> MaterialFile {
        let property = |value: f64| Property { value, source: SOURCE.to_owned(), note: None };
        let family = |value: f64| Property { source: "MIL-HDBK-5J, typical of the alloy's family".to_owned(), ..property(value) };
        MaterialFile {
            title: self.title(),
            youngs_modulus_gpa: family(self.youngs_modulus_gpa),
            poisson_ratio: family(self.poisson_ratio),
            yield_strength_mpa: Some(property(self.yield_ksi * MPA_PER_KSI)),
            tensile_strength_mpa: Some(property(self.tensile_ksi * MPA_PER_KSI)),
            toughness_mpa_sqrt_m: None,
            fracture_energy_j_m2: None,
            density_kg_m3: None,
            growth: None,
        }
    }
}
