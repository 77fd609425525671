//! `fitted.toml` of a law over K: its constants under the keys of `[fatigue]`, and what they were fitted to.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use toml::{Table, Value};

use super::SourceFile;

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
    /// How many rates.
    pub rates: usize,
    /// Root mean square of ln da/dN about the law.
    pub rms_log_rate: f64,
    /// Criterion of the next best law less that of this one; absent where there is no other.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub aicc_margin: Option<f64>,
    /// Program version.
    pub version: String,
    /// `growth_law` and its constants, as a case has them.
    pub fatigue: Table,
    /// Standard errors of the constants that were fitted, by the same keys.
    pub errors: BTreeMap<String, f64>,
    /// Files with their hashes.
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
