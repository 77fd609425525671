//! Fracture scenes on points of several levels, and a plate of springs at rest.

use perilife::bond_law::{BondLaw, BondLawKind, Kernel, Rotation, SurfaceCorrection};
use perilife::fracture::bonds::BondState;
use perilife::fracture::failure::Failure;
use perilife::fracture::interaction::{Damaging, Interaction};
use perilife::fracture::net::Net;
use perilife::fracture::scene::{
    Action, Arrangement, Damage, DamageEntry, DamageLaw, Drive, Procedure, RefinedRegion, Refinement, Region, Scene, SceneLaw,
    SceneModel, SceneSolver,
};
use perilife::fracture::springs::Springs;
use perilife::material::{Material, Plane};
use perilife::specimen::{self, Edge, Point};

use crate::statics;

/// The published bond-based law: constant kernel on the stretch.
pub const BOND_BASED: BondLaw = BondLaw {
    kind: BondLawKind::BondBased,
    kernel: Kernel::Constant,
    rotation: Rotation::Resisted,
    surface_correction: SurfaceCorrection::None,
};

/// A plate of `[specimen]` keys beside `kind = "plate"`, without loads; nothing breaks.
pub fn plate(keys: &str, law: BondLaw, spacing: f64, regions: &[(RefinedRegion, usize)]) -> Scene {
    let value: toml::Value = format!("kind = \"plate\"\nthickness_mm = 2.0\n{keys}").parse::<toml::Table>().unwrap().into();
    Scene {
        name: "plate".to_owned(),
        specimen: specimen::from_value(&value).unwrap(),
        material: Material {
            density: Some(8000.0),
            fracture_energy: Some(5e3),
            ..statics::material(law.kind, Plane::Stress)
        },
        model: SceneModel {
            law: SceneLaw::Bonds(law),
            finite: false,
            spacing,
            horizon_ratio: 3.015,
            lattice_angle: 0.0,
            arrangement: Arrangement::DualHorizon,
            solver: SceneSolver::VelocityVerlet,
        },
        drives: Vec::new(),
        holds: Vec::new(),
        damage: Damage {
            law: DamageLaw::None,
            enters: DamageEntry::Influence,
            stretch: None,
            nonlinear: None,
            tensile_strength: None,
        },
        procedure: Procedure::Static,
        refinement: Some(Refinement { regions: regions.to_vec() }),
        warnings: Vec::new(),
        echo: serde_json::Value::Null,
    }
}

/// An upright box, m.
pub fn a_box(low: Point, high: Point) -> RefinedRegion {
    RefinedRegion::Box { low, high }
}

/// Velocity across an edge, m/s, that rises over a time, s.
pub fn pulled(edge: Edge, velocity: [Option<f64>; 2], ramp: f64) -> Drive {
    let region = Region::Edge { edge, depth: 0.0, range: [f64::NEG_INFINITY, f64::INFINITY] };
    Drive { region, action: Action::Velocity(velocity), ramp }
}

/// Forces of whole springs at a displacement, N.
pub fn forces(net: &Net, u: &[f64]) -> Vec<f64> {
    let mut bonds = BondState::new(net, &vec![false; net.len()]);
    let mut force = vec![0.0; u.len()];
    Springs::new(net, Failure::Never, false).react(u, &mut bonds, Damaging::Frozen, &mut force);
    force
}

/// Displacement at rest under external forces, unknowns that are held staying at their value in `u`: conjugate gradients on the
/// springs, scaled by their diagonal bound, until the residual has fallen by 1e-10.
pub fn at_rest(net: &Net, mut u: Vec<f64>, held: &[bool], external: &[f64]) -> Vec<f64> {
    let mut bonds = BondState::new(net, &vec![false; net.len()]);
    let mut springs = Springs::new(net, Failure::Never, false);
    let bound = springs.stiffness_bound(&bonds);
    let unknowns = net.unknowns;
    let scale: Vec<f64> = (0..u.len()).map(|i| 1.0 / bound[i / unknowns][usize::from(i % unknowns == 2)]).collect();
    let free = |v: &mut [f64]| v.iter_mut().zip(held).filter(|(_, held)| **held).for_each(|(v, _)| *v = 0.0);
    let mut force = vec![0.0; u.len()];
    springs.react(&u, &mut bonds, Damaging::Frozen, &mut force);
    let mut r: Vec<f64> = force.iter().zip(external).map(|(f, e)| f + e).collect();
    free(&mut r);
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut z: Vec<f64> = r.iter().zip(&scale).map(|(r, s)| r * s).collect();
    let mut p = z.clone();
    let (mut rz, first) = (dot(&r, &z), dot(&r, &r));
    for _ in 0..20_000 {
        if dot(&r, &r) <= 1e-20 * first {
            return u;
        }
        springs.react(&p, &mut bonds, Damaging::Frozen, &mut force);
        free(&mut force);
        let step = rz / -dot(&p, &force);
        for i in 0..u.len() {
            u[i] += step * p[i];
            r[i] += step * force[i];
            z[i] = scale[i] * r[i];
        }
        let next = dot(&r, &z);
        p.iter_mut().zip(&z).for_each(|(p, z)| *p = z + next / rz * *p);
        rz = next;
    }
    panic!("conjugate gradients do not converge");
}
