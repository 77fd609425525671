//! A case to go with the run nobody computed.

use std::path::Path;

use perilife_growth::case::record::{FittedLaw, FittedRecord};
use perilife_growth::case::{Case, LawSource};

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
    LawSource::Fitted(Box::new(FittedRecord {
        method: "peridynamics".to_owned(),
        a: 1e5,
        p: 3.0,
        horizon_mm: 3.015,
        spacing_mm: 1.0,
        horizon_ratio: 3.015,
        scaling: String::new(),
        rate_constant: Some(0.19),
        paris_c_mm_per_cycle: 1e-8,
        paris_m: 3.0,
        paris_m_error: 0.02,
        pivot_delta_k_mpa_sqrt_m: 15.0,
        rate_at_pivot_mm_per_cycle: 3.4e-5,
        rate_at_pivot_relative_error: 0.01,
        p_error: 0.02,
        delta_k_min_mpa_sqrt_m: delta_k_min,
        delta_k_max_mpa_sqrt_m: delta_k_max,
        lack_of_fit_percent: None,
        stress_ratio: 0.1,
        bond_law: "two_parameter".to_owned(),
        kernel: "conical".to_owned(),
        rotation: "free".to_owned(),
        surface_correction: "volume_and_surface".to_owned(),
        ageing: "crack_tip".to_owned(),
        zone_radius_horizons: 0.5,
        youngs_modulus_gpa: 72.0,
        poisson_ratio: 0.3,
        plane: "stress".to_owned(),
        thickness_mm: 2.0,
        material: "inline".to_owned(),
        version: "0.0.0".to_owned(),
        sources: Vec::new(),
        law: FittedLaw::Paris,
        curve: None,
        left_out: Vec::new(),
        population: None,
    }))
}
