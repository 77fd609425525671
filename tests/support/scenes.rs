//! Fracture scenes built without files: a cracked square torn in time, a plate pulled at rest, plates with points of several levels.

use perilife_plate::material::{Material, Plane};
use perilife_plate::specimen::{self, Edge, Point, Specimen};
use perilife_points::bond_law::{BondLaw, BondLawKind, Kernel, Rotation, SurfaceCorrection};
use perilife_scenes::Scene;
use perilife_scenes::scene::{Action, Damage, DamageLaw, Procedure, RefinedRegion, Refinement, SceneLaw, SceneLoad, SceneSolver};
use perilife_study::dual_horizon;
use perilife_study::uniform_tension::strip;

pub const MM: f64 = 1e-3;

/// A law as its literature has it: constant kernel for stretches, conical one else, classical corrections.
pub const fn law(kind: BondLawKind, rotation: Rotation) -> BondLaw {
    let kernel = match kind {
        BondLawKind::BondBased | BondLawKind::OneBondTwoParameter => Kernel::Constant,
        BondLawKind::TwoParameter | BondLawKind::StateBased => Kernel::Conical,
    };
    BondLaw { kind, kernel, rotation, surface_correction: SurfaceCorrection::VolumeAndSurface }
}

/// The plate of `[specimen]` keys.
fn specimen_of(keys: &str) -> Specimen {
    specimen::from_value(&toml::Value::Table(keys.parse().unwrap()), &perilife_base::input::Folder::none(), &mut Vec::new())
        .unwrap()
}

/// A square of 50 mm with a central crack of 10 mm, of the steel of Huang, Li, Jin, He and Wang, example 3, its ends driven apart with a velocity, m/s,
/// for a time, s.
pub fn torn(law: BondLaw, damage: DamageLaw, spacing: f64, velocity: f64, duration: f64) -> Scene {
    let mut square =
        specimen_of("kind = \"middle_tension\"\nwidth_mm = 50\nlength_mm = 50\nthickness_mm = 1\ncrack_length_mm = 5");
    square.loads.clear();
    square.supports.clear();
    assert_eq!((square.cracks.len(), square.tips.len()), (1, 2));
    let nu = if law.kind == BondLawKind::BondBased { 1.0 / 3.0 } else { 0.25 };
    let steel = Material { fracture_energy: Some(83e3), density: Some(8000.0), ..Material::elastic(192e9, nu, Plane::Stress) };
    let end = |edge: Edge| SceneLoad::on_side(edge, Action::Velocity([None, Some(velocity * edge.normal()[1])]));
    let mut scene = Scene {
        drives: vec![end(Edge::Top), end(Edge::Bottom)],
        damage: Damage { law: damage, ..Damage::NONE },
        procedure: Procedure::Dynamic { duration, time_step: None },
        ..Scene::bare("torn", square, steel, SceneLaw::Bonds(law), spacing)
    };
    scene.model.solver = SceneSolver::VelocityVerlet;
    scene
}

/// A plate of 4 mm whose ends move apart by `pull` each and are held across it, one static solve, nothing breaks.
pub fn pulled(width: f64, length: f64, spacing: f64, pull: f64, law: BondLaw) -> Scene {
    let drive = |(end, motion)| SceneLoad::on_side(end, Action::Displacement([Some(0.0), Some(motion)]));
    let plate = Specimen { loads: vec![], thickness: 4.0 * MM, ..strip(width, length) };
    Scene {
        drives: [(Edge::Top, pull), (Edge::Bottom, -pull)].map(drive).to_vec(),
        ..Scene::bare("pulled", plate, Material::elastic(203e9, 0.3, Plane::Stress), SceneLaw::Bonds(law), spacing)
    }
}

/// A plate of `[specimen]` keys beside `kind = "plate"`, without loads, on a dual horizon with these regions; nothing breaks.
pub fn plate(keys: &str, law: BondLaw, spacing: f64, regions: &[(RefinedRegion, usize)]) -> Scene {
    dual_horizon::scene(specimen_of(&format!("kind = \"plate\"\nthickness_mm = 2.0\n{keys}")), law, spacing, regions)
}

/// The scene on a dual horizon with these regions.
pub fn refined(mut scene: Scene, regions: &[(RefinedRegion, usize)]) -> Scene {
    scene.model.arrangement = perilife_scenes::scene::Discretisation::DualHorizon;
    scene.refinement = Some(Refinement { regions: regions.to_vec() });
    scene
}

/// An upright box, m.
pub fn a_box(low: Point, high: Point) -> RefinedRegion {
    RefinedRegion::Box { low, high }
}
