//! Fracture scenes of rectangular plates, built without files.

use perilife::bond_law::{BondLaw, BondLawKind, Kernel, Rotation, SurfaceCorrection};
use perilife::fracture::scene::{
    Action, Arrangement, Damage, DamageEntry, DamageLaw, Drive, Hold, Procedure, Region, Scene, SceneLaw, SceneModel, SceneSolver,
};
use perilife::material::{Material, Plane};
use perilife::specimen::{Edge, Specimen};
use perilife::verify::uniform_tension::strip;

pub const MM: f64 = 1e-3;

/// The two-parameter law of the sources: conical kernel, rotation resisted, classical corrections.
pub const SOURCE_LAW: BondLaw = BondLaw {
    kind: BondLawKind::TwoParameter,
    kernel: Kernel::Conical,
    rotation: Rotation::Resisted,
    surface_correction: SurfaceCorrection::VolumeAndSurface,
};

/// Q345 steel.
pub fn steel() -> Material {
    Material {
        name: "q345".to_owned(),
        youngs_modulus: 203e9,
        poisson_ratio: 0.3,
        plane: Plane::Stress,
        yield_strength: Some(345e6),
        toughness: None,
        fracture_energy: None,
        density: Some(7850.0),
        tensile_strength: Some(572e6),
    }
}

/// No damage.
pub const WHOLE: Damage =
    Damage { law: DamageLaw::None, enters: DamageEntry::Influence, stretch: None, nonlinear: None, tensile_strength: None };

/// All points within the outermost row of an edge.
pub fn edge(edge: Edge) -> Region {
    Region::Edge { edge, depth: 0.0, range: [f64::NEG_INFINITY, f64::INFINITY] }
}

/// A plate whose ends move apart by `pull` each, one static solve, nothing breaks. The bottom corner row is held along x too.
pub fn pulled(width: f64, length: f64, spacing: f64, pull: f64, law: BondLaw) -> Scene {
    let ends = [(Edge::Top, pull), (Edge::Bottom, -pull)];
    let drive = |(end, motion)| Drive { region: edge(end), action: Action::Displacement([Some(0.0), Some(motion)]), ramp: 0.0 };
    Scene {
        name: "pulled".to_owned(),
        specimen: Specimen { loads: vec![], thickness: 4.0 * MM, ..strip(width, length) },
        material: steel(),
        model: SceneModel {
            law: SceneLaw::Bonds(law),
            finite: false,
            spacing,
            horizon_ratio: 3.015,
            lattice_angle: 0.0,
            arrangement: Arrangement::Lattice,
            solver: SceneSolver::Secant,
        },
        drives: ends.map(drive).to_vec(),
        holds: Vec::<Hold>::new(),
        damage: WHOLE,
        procedure: Procedure::Static,
        refinement: None,
        warnings: vec![],
        echo: serde_json::Value::Null,
    }
}
