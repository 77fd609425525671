//! Fracture scenes on points of several levels, and a plate of springs at rest.

use perilife::bond_law::{BondLaw, BondLawKind, Kernel, Rotation, SurfaceCorrection};
use perilife::fracture::bonds::BondState;
use perilife::fracture::failure::Failure;
use perilife::fracture::interaction::{Damaging, Interaction};
use perilife::fracture::net::Net;
use perilife::fracture::scene::{Arrangement, DamageLaw, RefinedRegion, Refinement, Scene};
use perilife::fracture::springs::Springs;
use perilife::material::{Material, Plane};
use perilife::specimen::{self, Point};

use crate::{scenes, statics};

/// The published bond-based law: constant kernel on the stretch.
pub const BOND_BASED: BondLaw = BondLaw {
    kind: BondLawKind::BondBased,
    kernel: Kernel::Constant,
    rotation: Rotation::Resisted,
    surface_correction: SurfaceCorrection::None,
};

/// A plate of `[specimen]` keys beside `kind = "plate"`, without loads; nothing breaks.
pub fn plate(keys: &str, law: BondLaw, spacing: f64, regions: &[(RefinedRegion, usize)]) -> Scene {
    let text = format!("kind = \"plate\"\nthickness_mm = 2.0\n{keys}");
    let mut scene = scenes::pulled(law, DamageLaw::None, spacing, 1.0, 1e-6);
    scene.specimen = specimen::from_value(&toml::Value::Table(text.parse().unwrap())).unwrap();
    scene.material = Material { density: Some(8000.0), fracture_energy: Some(5e3), ..statics::material(law.kind, Plane::Stress) };
    scene.drives.clear();
    refined(scene, regions)
}

/// The scene on a dual horizon with these regions.
pub fn refined(mut scene: Scene, regions: &[(RefinedRegion, usize)]) -> Scene {
    scene.model.arrangement = Arrangement::DualHorizon;
    scene.refinement = Some(Refinement { regions: regions.to_vec() });
    scene
}

/// An upright box, m.
pub fn a_box(low: Point, high: Point) -> RefinedRegion {
    RefinedRegion::Box { low, high }
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
