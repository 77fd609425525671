//! A body that turns as a whole stores no energy: every law, procedure and arrangement of scenes, and the plates of `predict`.
//! Elasticity of the lattice kernel itself: `elasticity.rs`.

use std::path::Path;

use perilife_growth::plate;
use perilife_growth::predict::Silent;
use perilife_points::bond_law::{BondLawKind, Rotation, SurfaceCorrection};
use perilife_scenes::assembly::Assembly;
use perilife_scenes::scene::PointLaw;
use perilife_scenes::{Scene, run};

use crate::support::plates::try_case;

/// A plate with a hole, an edge crack and a slanted one: every kind of rim.
const PLATE: &str = "[specimen]\nkind = \"plate\"\nwidth_mm = 40\nlength_mm = 30\nthickness_mm = 2\n\
                     holes = [{ x_mm = 8, y_mm = 5, diameter_mm = 8 }]\n\
                     cracks = [{ from_mm = [-20, 0], to_mm = [-8, 0] }, { from_mm = [-2, -8], to_mm = [6, -4] }]\n\
                     [material]\nyoungs_modulus_gpa = 70\npoisson_ratio = 0.2\ndensity_kg_m3 = 2700\nfracture_energy_j_m2 = 500\n\
                     [model]\nspacing_mm = 1\n[loading]\nkind = \"displacement\"\ndisplacement_mm = 0.001\nedges = [\"top\", \"bottom\"]\n";
const LEVELS: &str = "refinement.regions=[{box_mm=[[-20,-5],[0,5]],levels=1}]";
/// Motion must not start at once.
const RAMP: &str = "loading.ramp_s=1e-6";
/// Energy of a turn over that of a strain that round-off may leave: that of displacements, 1e-16 of some 10 mm, against relative ones of
/// bonds, 1e-3 of a millimetre, squared.
const ROUND_OFF: f64 = 1e-20;

fn scene(set: &[&str]) -> Option<Scene> {
    let overrides: Vec<String> = set.iter().map(|key| (*key).to_owned()).collect();
    Scene::from_toml(PLATE, "turned", Path::new("."), &overrides).ok()
}

fn cost(scene: &Scene) -> f64 {
    Assembly::of(scene).unwrap().turning_cost().unwrap().expect("an extension costs energy")
}

/// Every law by default: at rest, in steps, in motion, on turned rows and on several levels.
#[test]
fn a_rigid_turn_of_a_scene_costs_nothing() {
    let springs = BondLawKind::ALL.iter().filter(|kind| **kind != BondLawKind::StateBased).map(|kind| kind.name());
    let laws: Vec<&str> = springs.chain(PointLaw::ALL.iter().map(|law| law.name())).collect();
    let ways: [&[&str]; 9] = [
        &[],
        &["loading.steps=5"],
        &["loading.steps=5", "model.solver=adaptive_dynamic_relaxation"],
        &["loading.steps=5", "loading.iterations_per_step=2"],
        &["loading.duration_s=1e-5", RAMP],
        &["loading.duration_s=1e-5", RAMP, "model.kinematics=finite"],
        &["model.lattice_angle_deg=20", "model.surface_correction=balanced"],
        &["model.discretisation=dual_horizon", LEVELS],
        &["model.discretisation=dual_horizon", LEVELS, "model.surface_correction=balanced"],
    ];
    let (mut counted, mut went) = (vec![0; laws.len()], vec![0; ways.len()]);
    for (law, counted) in laws.iter().zip(&mut counted) {
        for (way, went) in ways.iter().copied().zip(&mut went) {
            let nu = if *law == "bond_based" { "0.3333333333333333" } else { "0.2" };
            let keys = [format!("model.bond_law={law}"), format!("material.poisson_ratio={nu}")];
            let set = [&[keys[0].as_str(), keys[1].as_str()], way].concat();
            // Choices that do not go together are refused, each with a test of its own.
            let Some(scene) = scene(&set) else { continue };
            let cost = cost(&scene);
            assert!(cost.abs() < ROUND_OFF, "{law}, {way:?}: {cost:e}");
            *counted += 1;
            *went += 1;
        }
    }
    // A way that every law refused would be none.
    assert!(went.iter().all(|&went| went > 0), "{went:?} laws went {ways:?}");
    assert!(counted.iter().all(|&count| count >= 3), "{laws:?}: {counted:?} ways");
}

/// Whoever asks for the printed law is told what a turn of this body costs: 8 c_t/(3 c_n + c_t) = 2 (C₁₁ - 3 C₁₂)/C₁₁ = 2 (1 - 3 ν) of
/// the energy of an extension in plane stress, less at the rim; nothing at 1/3.
#[test]
fn what_resists_a_turn_is_told_with_its_cost() {
    for law in ["two_parameter", "one_bond_two_parameter"] {
        for nu in ["0.0", "0.1", "0.2", "0.3"] {
            for way in
                [&["loading.steps=1"][..], &["loading.duration_s=1e-6", RAMP], &["model.discretisation=dual_horizon", LEVELS]]
            {
                let keys = [format!("model.bond_law={law}"), format!("material.poisson_ratio={nu}")];
                let scene = scene(&[&[keys[0].as_str(), &keys[1], "model.rotation=resisted"], way].concat()).unwrap();
                let (cost, inside) = (cost(&scene), 2.0 * (1.0 - 3.0 * nu.parse::<f64>().unwrap()));
                assert!(cost > 0.7 * inside && cost < 1.05 * inside, "{law}, nu {nu}, {way:?}: {cost}");
                let warnings = run(&scene, &Silent).unwrap().warnings;
                let words = format!("{:.3} % of the energy of 1e-3 strain", 100.0 * cost);
                let told = warnings.iter().any(|w| w.contains("model.rotation = \"resisted\"") && w.contains(&words));
                assert!(told, "{law}, nu {nu}, {way:?}: {words} in {warnings:?}");
            }
        }
        let keys = [format!("model.bond_law={law}"), "material.poisson_ratio=0.3333333333333333".to_owned()];
        let scene = scene(&[&keys[0], &keys[1], "model.rotation=resisted"]).unwrap();
        assert!(cost(&scene) < 1e-9, "{law} at 1/3: {}", cost(&scene));
        assert!(run(&scene, &Silent).unwrap().warnings.is_empty());
    }
    let spring = ["model.bond_law=correspondence", "model.zero_energy_control=spring", "model.zero_energy_factor=1e22"];
    let scene = scene(&spring).unwrap();
    let warnings = run(&scene, &Silent).unwrap().warnings;
    assert!(cost(&scene) > 1e-3 && warnings.iter().any(|w| w.contains("zero_energy_control = \"spring\"")), "{warnings:?}");
}

/// Plates of `predict`: every law and correction; none resists unless it was asked to.
#[test]
fn a_rigid_turn_of_a_plate_costs_nothing() {
    const SLANT: &str = "kind=\"plate\"\nwidth_mm=60\nlength_mm=80\nthickness_mm=2\ncracks=[{from_mm=[-7,-5],to_mm=[7,5]}]\n";
    let mut counted = 0;
    for kind in BondLawKind::ALL {
        for correction in SurfaceCorrection::ALL {
            for way in [&[][..], &["model.lattice_angle_deg=20"]] {
                let nu = if *kind == BondLawKind::BondBased { "0.3333333333333333" } else { "0.2" };
                let keys = [
                    format!("model.bond_law={kind}"),
                    format!("model.surface_correction={correction}"),
                    format!("material.poisson_ratio={nu}"),
                ];
                let given: Vec<&str> = keys.iter().map(String::as_str).chain(way.iter().copied()).collect();
                for rotation in [None, Some(Rotation::Free), Some(Rotation::Resisted)] {
                    let key = rotation.map(|rotation| format!("model.rotation={rotation}"));
                    let set: Vec<&str> = given.iter().copied().chain(key.as_deref()).collect();
                    let Ok(case) = try_case(SLANT, &set) else { continue };
                    let body = case.points().body(&case.specimen, &case.material).unwrap();
                    let cost = plate::turning_cost(&body).unwrap();
                    let resists = rotation == Some(Rotation::Resisted) && kind.is_two_parameter();
                    let is_told = plate::warning(&body).is_some_and(|w| w.contains("model.rotation = \"resisted\""));
                    assert_eq!((cost.abs() > ROUND_OFF, is_told), (resists, resists), "{set:?}: {cost:e}");
                    counted += 1;
                }
            }
        }
    }
    assert!(counted > 40, "{counted} plates");
}
