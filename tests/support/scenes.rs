//! Fracture scenes for tests: a cracked square whose ends are pulled apart.

use perilife::bond_law::{BondLaw, BondLawKind, Kernel, Rotation, SurfaceCorrection};
use perilife::fracture::Scene;
use perilife::fracture::scene::{
    Action, Arrangement, Damage, DamageEntry, DamageLaw, Drive, Procedure, Region, SceneLaw, SceneModel, SceneSolver,
};
use perilife::material::{Material, Plane};
use perilife::specimen::{Edge, Specimen, from_value};

/// Steel of source 002, example 3.
pub fn steel(poisson_ratio: f64) -> Material {
    Material {
        name: "inline".to_owned(),
        youngs_modulus: 192e9,
        poisson_ratio,
        plane: Plane::Stress,
        yield_strength: None,
        toughness: None,
        fracture_energy: Some(83e3),
        density: Some(8000.0),
        tensile_strength: None,
    }
}

/// A square plate of a side with a central horizontal crack, m.
pub fn square(side: f64, crack: f64) -> Specimen {
    let text = format!(
        "kind = \"middle_tension\"\nwidth_mm = {0}\nlength_mm = {0}\nthickness_mm = 1.0\ncrack_length_mm = {1}",
        side * 1e3,
        crack * 1e3 / 2.0
    );
    let mut specimen = from_value(&toml::Value::Table(text.parse().unwrap())).unwrap();
    specimen.loads.clear();
    specimen.supports.clear();
    assert_eq!((specimen.cracks.len(), specimen.tips.len()), (1, 2));

    specimen
}

/// The literature's form of a law: constant kernel for stretches, resisted rotation, classical corrections.
pub fn law(kind: BondLawKind, rotation: Rotation) -> BondLaw {
    let kernel = if kind.is_stretch_form() { Kernel::Constant } else { Kernel::Conical };
    BondLaw { kind, kernel, rotation, surface_correction: SurfaceCorrection::VolumeAndSurface }
}

/// A cracked square of 50 mm, its ends driven apart with a velocity, m/s, for a time, s.
pub fn pulled(law: BondLaw, damage: DamageLaw, spacing: f64, velocity: f64, duration: f64) -> Scene {
    let nu = if law.kind == BondLawKind::BondBased { 1.0 / 3.0 } else { 0.25 };
    let end = |edge: Edge| Drive {
        region: Region::Edge { edge, depth: 0.0, range: [f64::NEG_INFINITY, f64::INFINITY] },
        action: Action::Velocity([None, Some(velocity * edge.normal()[1])]),
        ramp: 0.0,
    };
    Scene {
        name: "pulled".to_owned(),
        specimen: square(0.05, 0.01),
        material: steel(nu),
        model: SceneModel {
            law: SceneLaw::Bonds(law),
            finite: false,
            spacing,
            horizon_ratio: 3.015,
            lattice_angle: 0.0,
            arrangement: Arrangement::Lattice,
            solver: SceneSolver::VelocityVerlet,
        },
        drives: vec![end(Edge::Top), end(Edge::Bottom)],
        holds: vec![],
        damage: Damage { law: damage, enters: DamageEntry::Influence, stretch: None, nonlinear: None, tensile_strength: None },
        procedure: Procedure::Dynamic { duration, time_step: None },
        refinement: None,
        warnings: vec![],
        echo: serde_json::Value::Null,
    }
}
