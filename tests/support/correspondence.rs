//! Correspondence bodies without loads, their forces, and equilibria of small patches.

use nalgebra::{DMatrix, DVector};
use perilife_plate::material::{Material, Plane};
use perilife_plate::specimen::Specimen;
use perilife_points::body::Body;
use perilife_points::net::Net;
use perilife_scenes::Scene;
use perilife_scenes::bonds::BondState;
use perilife_scenes::correspondence::{Correspondence, NET_LAW};
use perilife_scenes::interaction::{Damaging, Interaction, Reaction};
use perilife_scenes::scene::{SceneLaw, ZeroEnergyControl};
use perilife_study::uniform_tension::strip;

/// Thickness of the patch and the disc of the source, m.
pub const THICKNESS: f64 = 6.35e-3;

/// PBX 9501 as far as elasticity goes.
pub fn material(plane: Plane) -> Material {
    Material::elastic(1e9, 0.35, plane)
}

/// A rectangle without loads and cracks, m.
pub fn rectangle(width: f64, length: f64) -> Specimen {
    let mut specimen = strip(width, length);
    specimen.thickness = THICKNESS;
    specimen.crack_plane_y = None;
    specimen.loads.clear();
    specimen
}

/// A scene of correspondence without loads.
pub fn scene(specimen: Specimen, plane: Plane, control: (ZeroEnergyControl, f64), spacing: f64, ratio: f64) -> Scene {
    let law = SceneLaw::Correspondence { control: control.0, factor: control.1 };
    let mut scene = Scene::bare("test", specimen, material(plane), law, spacing);
    scene.model.horizon_ratio = ratio;
    scene
}

/// Points and bonds of a scene.
pub fn net(scene: &Scene) -> Net {
    let model = &scene.model;
    let body =
        Body::build(&scene.specimen, &scene.material, &NET_LAW, model.spacing, model.horizon_ratio, model.lattice_angle).unwrap();
    Net::of_body(&body)
}

pub fn law<'n>(scene: &Scene, net: &'n Net) -> Correspondence<'n> {
    let SceneLaw::Correspondence { control, factor } = scene.model.law else { panic!("a scene of correspondence") };
    Correspondence::new(scene, net, control, factor).unwrap()
}

/// Bonds of a net, none near loads.
pub fn bonds(net: &Net) -> BondState {
    BondState::new(net, &vec![false; net.len()])
}

pub fn field(net: &Net, u: impl Fn([f64; 2]) -> [f64; 2]) -> Vec<f64> {
    net.positions.iter().flat_map(|&x| u(x)).collect()
}

/// Forces at a displacement, bonds as they are.
pub fn forces(law: &mut Correspondence<'_>, bonds: &mut BondState, u: &[f64]) -> (Vec<f64>, Reaction) {
    let mut force = vec![0.0; u.len()];
    let reaction = law.internal_force(u, bonds, Damaging::Frozen, &mut force);
    (force, reaction)
}

/// The patch of theory: 15 x 15 free points, 1 MPa on both end columns.
pub struct Patch {
    /// Young's modulus from the middle 7 x 7 points over E.
    pub modulus: f64,
    /// Largest second difference of u_x on the middle row over strain times spacing, strain 1e-3.
    pub oscillation: f64,
    /// Motions that cost nothing.
    pub free_motions: usize,
}

/// Side of the patch in points.
const SIDE: usize = 15;
const SPACING: f64 = 0.25e-3;

/// Equilibrium of the patch by the eigenvectors of its stiffness, motions that cost nothing left out.
pub fn patch(control: (ZeroEnergyControl, f64), ratio: f64) -> Patch {
    let side = SIDE as f64 * SPACING;
    let scene = scene(rectangle(side, side), Plane::Stress, control, SPACING, ratio);
    let net = net(&scene);
    assert_eq!(net.len(), SIDE * SIDE);
    let (mut law, mut bonds) = (law(&scene, &net), bonds(&net));
    let size = 2 * net.len();
    // Small enough that Green strain is linear to 1e-9.
    const STEP: f64 = 1e-13;
    let mut stiffness = DMatrix::zeros(size, size);
    for i in 0..size {
        let mut u = vec![0.0; size];
        u[i] = STEP;
        let (force, _) = forces(&mut law, &mut bonds, &u);
        stiffness.column_mut(i).iter_mut().zip(&force).for_each(|(k, f)| *k = -f / STEP);
    }
    let stiffness = 0.5 * (&stiffness + stiffness.transpose());
    let end = |x: f64| if x.abs() > 0.5 * side - SPACING { x.signum() } else { 0.0 };
    let load = 1e6 * SPACING * THICKNESS;
    let f = DVector::from_vec(field(&net, |x| [load * end(x[0]), 0.0]));
    let eigen = stiffness.symmetric_eigen();
    let largest = eigen.eigenvalues.amax();
    let mut u = DVector::zeros(size);
    let mut free_motions = 0;
    for (value, vector) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
        if value.abs() < 1e-8 * largest {
            free_motions += 1;
        } else {
            u += vector.dot(&f) / value * vector;
        }
    }
    let at = |column: usize, row: usize| u[2 * (row * SIDE + column)];
    // Least squares of u_x over x on the middle points.
    let middle = || (4..11).flat_map(|row| (4..11).map(move |column| (column, row)));
    let slope = middle().map(|(c, r)| (c as f64 - 7.0) * at(c, r)).sum::<f64>()
        / middle().map(|(c, _)| (c as f64 - 7.0).powi(2) * SPACING).sum::<f64>();
    let second = (1..SIDE - 1).map(|c| (at(c + 1, 7) - 2.0 * at(c, 7) + at(c - 1, 7)).abs()).fold(0.0, f64::max);
    Patch { modulus: 1e6 / slope / 1e9, oscillation: second / (1e-3 * SPACING), free_motions }
}
