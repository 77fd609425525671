//! A case to go with the run nobody computed.

use perilife::bond_law::{BondLaw, BondLawKind, Kernel, Rotation, SurfaceCorrection};
use perilife::calibration::record::FittedRecord;
use perilife::case::{Case, LawSource, Model, Stop};
use perilife::fatigue::{Ageing, Block, BlockKind, FatigueLaw, FatigueSettings, Precrack};
use perilife::loading::Loading;
use perilife::material::{Material, Plane};
use perilife::solver::SolverKind;
use perilife::specimen::{LengthConvention, LoadMeasure, Specimen, SpecimenKind};
use serde_json::json;

use crate::made_up_run;

/// A plate of 100 x 300 mm with the slant crack of the made-up run and an inline law; the echo names the bond law only.
pub fn case() -> Case {
    Case {
        name: "made_up".to_owned(),
        specimen: Specimen {
            kind: SpecimenKind::Plate,
            outline: vec![[-0.05, -0.15], [0.05, -0.15], [0.05, 0.15], [-0.05, 0.15]],
            holes: Vec::new(),
            slots: Vec::new(),
            cracks: made_up_run::cracks(),
            tips: Vec::new(),
            thickness: 2e-3,
            width: 0.1,
            gross_width: 0.1,
            crack_plane_y: None,
            crack_length: 10e-3,
            convention: LengthConvention::SumOfTips,
            loads: Vec::new(),
            load_measure: LoadMeasure::Stress,
            supports: Vec::new(),
        },
        material: Material {
            name: "inline".to_owned(),
            youngs_modulus: 72e9,
            poisson_ratio: 0.3,
            plane: Plane::Stress,
            yield_strength: None,
            toughness: None,
            fracture_energy: None,
        },
        loading: Loading { maximum: 70e6, ratio: 0.1, parallel_ratio: 0.0 },
        model: Model {
            bond_law: BondLaw {
                kind: BondLawKind::TwoParameter,
                kernel: Kernel::Conical,
                rotation: Rotation::Free,
                surface_correction: SurfaceCorrection::VolumeAndSurface,
            },
            spacing: 1.01e-3,
            horizon_ratio: 3.015,
            lattice_angle: 0.0,
            solver: SolverKind::Multigrid,
        },
        fatigue: FatigueSettings {
            ageing: Ageing::CrackTip,
            zone_radius_horizons: 0.5,
            precrack: Precrack::SteadyProfile,
            block: Block { kind: BlockKind::UntilNextBreak, cycles: f64::NAN, bonds: 1 },
            critical_stretch: f64::INFINITY,
            walker_gamma: 1.0,
            threshold: 0.0,
        },
        law: LawSource::Inline(FatigueLaw { a: 1e5, p: 3.0, horizon: 3.015e-3 }),
        stop: Stop { crack_length: f64::INFINITY, cycles_max: 1e7 },
        warnings: vec!["spacing moved".to_owned()],
        echo: json!({ "model": { "bond_law": "two_parameter" } }),
        allow_extrapolation: false,
        choices: Default::default(),
    }
}

/// A record fitted between two ΔK in MPa√m.
pub fn fitted(delta_k_min: f64, delta_k_max: f64) -> LawSource {
    LawSource::Fitted(Box::new(FittedRecord {
        a: 1e5,
        p: 3.0,
        horizon_mm: 3.015,
        spacing_mm: 1.0,
        horizon_ratio: 3.015,
        scaling: String::new(),
        paris_c_mm_per_cycle: 1e-8,
        paris_m: 3.0,
        pivot_delta_k_mpa_sqrt_m: 15.0,
        rate_at_pivot_mm_per_cycle: 3.4e-5,
        rate_at_pivot_relative_error: 0.01,
        p_error: 0.02,
        delta_k_min_mpa_sqrt_m: delta_k_min,
        delta_k_max_mpa_sqrt_m: delta_k_max,
        stress_ratio: 0.1,
        bond_law: "two_parameter".to_owned(),
        kernel: "conical".to_owned(),
        rotation: "free".to_owned(),
        surface_correction: "volume_and_surface".to_owned(),
        ageing: "crack_tip".to_owned(),
        zone_radius_horizons: 0.5,
        precrack: "steady_profile".to_owned(),
        youngs_modulus_gpa: 72.0,
        poisson_ratio: 0.3,
        plane: "stress".to_owned(),
        thickness_mm: 2.0,
        material: "inline".to_owned(),
        version: "0.0.0".to_owned(),
        sources: Vec::new(),
    }))
}
