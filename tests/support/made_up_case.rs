//! A case to go with the run nobody computed.

use std::path::Path;

use perilife_growth::case::record::FittedRecord;
use perilife_growth::case::{Case, LawSource};

use crate::support::rows::rows;

/// A plate of 100 x 300 mm with the slant crack of the made-up run and an inline law; the model names the bond law and a
/// spacing that has to move.
const TEXT: &str = r#"
[specimen]
kind = "plate"
width_mm = 100.0
length_mm = 300.0
thickness_mm = 2.0
cracks = [{ from_mm = [-4.330127, -2.5], to_mm = [4.330127, 2.5] }]
[material]
youngs_modulus_gpa = 72.0
poisson_ratio = 0.3
plane = "stress"
[loading]
kind = "constant_amplitude"
stress_max_mpa = 70.0
stress_ratio = 0.1
[model]
bond_law = "two_parameter"
spacing_mm = 1.01
[fatigue]
a = 1e5
p = 3.0
horizon_mm = 3.015
driver = "bond_strain"
[stop]
cycles_max = 1e7
"#;

/// The case, with one warning of its own.
pub fn case() -> Case {
    let mut case = Case::from_toml(TEXT, "made_up", Path::new("."), &[]).unwrap();
    case.warnings = vec!["spacing moved".to_owned()];
    case
}

/// A record fitted between two ΔK in MPa√m.
pub fn fitted(delta_k_min: f64, delta_k_max: f64) -> LawSource {
    let made_up: FittedRecord = rows("records", "made_up");
    LawSource::Fitted(Box::new(FittedRecord {
        delta_k_min_mpa_sqrt_m: delta_k_min,
        delta_k_max_mpa_sqrt_m: delta_k_max,
        ..made_up
    }))
}
