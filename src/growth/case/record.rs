//! `fitted.toml`: the calibrated law with all it depends on. One record is one whole: constants are meaningless
//! without horizon, law, kernel, corrections and zone they were fitted with. Of a law over K: its constants under the keys of `[fatigue]`,
//! and what they were fitted to.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use toml::{Table, Value};

use perilife_base::error::Result;
use perilife_base::units::{GPA, MM_PER_CYCLE, MPA_SQRT_M};
use perilife_laws::curve::{CurveLaw, ROWS};
use perilife_measured::LeaveOut;
use perilife_plate::material::Material;

perilife_base::kinds! {
    /// Laws that a fit to lives writes.
    pub enum FittedLaw for "law" {
        Paris = "paris": "da/dN = C ΔK^m, where the rates show no shape",
        Curve = "curve": "the curve of the rates over ln ΔK, a natural spline through six knots",
    }
}

/// A calibrated fatigue law with its provenance; keys and units as in `fitted.toml`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FittedRecord {
    /// A at `horizon_mm`, 1/cycle.
    pub a: f64,
    pub p: f64,
    pub horizon_mm: f64,
    /// Lattice spacing of the calibration.
    pub spacing_mm: f64,
    /// Horizon over spacing.
    pub horizon_ratio: f64,
    /// How A moves to another horizon, in words.
    pub scaling: String,
    /// β of da/dN = β A δ^(1-p/2) (ΔK/E')^p, K by the field of the tip: what the crack that was fitted to grew by. Absent in a record of
    /// `handbook`, which has no A.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rate_constant: Option<f64>,
    /// Paris constant of the same material: da/dN = C ΔK^m in mm/cycle and MPa√m.
    pub paris_c_mm_per_cycle: f64,
    /// Paris exponent m (not the same as p).
    pub paris_m: f64,
    /// Standard error of m.
    pub paris_m_error: f64,
    /// ΔK at which the fit is best determined.
    pub pivot_delta_k_mpa_sqrt_m: f64,
    /// da/dN there.
    pub rate_at_pivot_mm_per_cycle: f64,
    pub rate_at_pivot_relative_error: f64,
    pub p_error: f64,
    /// Smallest ΔK of the fit window.
    pub delta_k_min_mpa_sqrt_m: f64,
    /// Largest ΔK of the fit window.
    pub delta_k_max_mpa_sqrt_m: f64,
    /// Measured rate over that of the law at an end of its range, less one, in percent, whichever end misses more.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lack_of_fit_percent: Option<f64>,
    pub stress_ratio: f64,
    /// `model.method` of the fit. A record of `handbook` holds C and m; its a, horizon_mm and spacing_mm are nan.
    pub method: String,
    pub bond_law: String,
    pub kernel: String,
    pub rotation: String,
    pub surface_correction: String,
    pub ageing: String,
    pub zone_radius_horizons: f64,
    /// Young's modulus of the calibration.
    pub youngs_modulus_gpa: f64,
    /// Poisson's ratio of the calibration.
    pub poisson_ratio: f64,
    pub plane: String,
    pub thickness_mm: f64,
    pub material: String,
    pub version: String,
    /// The law of its lives: C and m are the best power law all the same.
    #[serde(default = "paris")]
    pub law: FittedLaw,
    /// Measured files with their hashes.
    pub sources: Vec<SourceFile>,
    /// Readings that were left out, with the reasons.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub left_out: Vec<LeaveOut>,
    /// The curve, where it is the law.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub curve: Option<CurveRecord>,
    /// Scatter of the specimens about a common law; what it holds is the calibration's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub population: Option<Table>,
}

impl FittedRecord {
    /// E' of the plate that it was fitted on, Pa.
    pub fn plane_modulus(&self) -> Result<f64> {
        let modulus = self.youngs_modulus_gpa * GPA;
        Ok(Material::elastic(modulus, self.poisson_ratio, self.plane.parse()?).plane_modulus())
    }
}

/// Law of a record of before, which names none.
fn paris() -> FittedLaw {
    FittedLaw::Paris
}

/// A curve of rates: its values at both ends of its range and at knots between them, even in ln ΔK, which make the whole of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CurveRecord {
    /// Gain of the logarithm of the likelihood over a power law.
    pub gain: f64,
    /// ΔK.
    pub delta_k_mpa_sqrt_m: [f64; ROWS],
    pub da_dn_mm_per_cycle: [f64; ROWS],
    /// Relative standard errors of the rates.
    pub da_dn_relative_error: [f64; ROWS],
    /// Local exponents d ln(da/dN)/d ln ΔK.
    pub m: [f64; ROWS],
    pub m_error: [f64; ROWS],
}

impl CurveRecord {
    /// A law with the gain of the likelihood that it was taken for, and standard errors of ln rate and exponent at a ΔK (Pa√m).
    pub fn of(law: &CurveLaw, gain: f64, errors: &dyn Fn(f64) -> [f64; 2]) -> Self {
        let knots = law.knots();
        CurveRecord {
            gain,
            delta_k_mpa_sqrt_m: knots.map(|k| k / MPA_SQRT_M),
            da_dn_mm_per_cycle: knots.map(|k| law.log_rate(k).exp() / MM_PER_CYCLE),
            da_dn_relative_error: knots.map(|k| errors(k)[0]),
            m: knots.map(|k| law.local_slope(k)),
            m_error: knots.map(|k| errors(k)[1]),
        }
    }

    pub fn law(&self) -> CurveLaw {
        let [low, high] = [0, ROWS - 1].map(|end| self.delta_k_mpa_sqrt_m[end] * MPA_SQRT_M);
        CurveLaw::through([low, high], self.da_dn_mm_per_cycle.map(|rate| rate * MM_PER_CYCLE))
    }
}

/// A measured file a record was fitted to.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SourceFile {
    /// Path as given in the calibration file.
    pub file: String,
    /// SHA-256 of its bytes, hexadecimal.
    pub sha256: String,
}

/// A fitted law; keys and units as in the file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LawRecord {
    /// Material name; empty where the calibration had none.
    pub material: String,
    /// Smallest ΔK of the rates.
    pub delta_k_min_mpa_sqrt_m: f64,
    /// Largest ΔK of the rates.
    pub delta_k_max_mpa_sqrt_m: f64,
    /// Smallest stress ratio of the rates.
    pub stress_ratio_min: f64,
    /// Largest stress ratio of the rates.
    pub stress_ratio_max: f64,
    pub rates: usize,
    /// Root mean square of ln da/dN about the law.
    pub rms_log_rate: f64,
    /// Criterion of the next best law less that of this one; absent where there is no other.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub aicc_margin: Option<f64>,
    pub version: String,
    /// `growth_law` and its constants, as a case has them.
    pub fatigue: Table,
    /// Standard errors of the constants that were fitted, by the same keys.
    pub errors: BTreeMap<String, f64>,
    pub sources: Vec<SourceFile>,
}

impl LawRecord {
    /// Whether the content of a `fitted.toml` is such a record.
    pub fn is_of(table: &Table) -> bool {
        table.contains_key("fatigue")
    }

    /// `growth_law`.
    pub fn kind(&self) -> &str {
        self.fatigue.get("growth_law").and_then(Value::as_str).unwrap_or_default()
    }
}
