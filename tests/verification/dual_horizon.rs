//! Points of several levels with horizon and dual horizon.

use perilife::bond_law::{BondLaw, BondLawKind, Rotation, SurfaceCorrection};
use perilife::fracture;
use perilife::fracture::net::Net;
use perilife::fracture::scene::{Arrangement, RefinedRegion};

use crate::level_scenes::{BOND_BASED, a_box, at_rest, forces, plate};
use crate::noise::Noise;
use crate::statics;

/// A plate with all that a bond can meet: hole, notch and slant crack.
const FLAWED: &str = "width_mm = 40\nlength_mm = 50\nholes = [{ x_mm = 8, y_mm = 12, diameter_mm = 9 }]\n\
                      notches = [{ from_mm = [-20, -5], to_mm = [-12, -5], width_mm = 2 }]\n\
                      cracks = [{ from_mm = [0, -14], to_mm = [9, -10] }]\n";
/// A plate with nothing but a small crack, as a plate has to have one, in a corner.
const PLAIN: &str = "width_mm = 100\nlength_mm = 60\ncracks = [{ from_mm = [49.9, 29.9], to_mm = [49.99, 29.99] }]\n";

/// Bond laws that springs can carry, with corrections that any net can have.
fn laws() -> impl Iterator<Item = BondLaw> {
    statics::corrected_laws()
        .filter(|law| law.kind != BondLawKind::StateBased && law.surface_correction != SurfaceCorrection::Balanced)
}

/// A disorderly displacement.
fn disorder(net: &Net) -> Vec<f64> {
    let mut noise = Noise::new(5);
    (0..net.len() * net.unknowns).map(|_| 1e-6 * noise.normal()).collect()
}

/// Two levels around the flaws of [`FLAWED`].
fn graded() -> [(RefinedRegion, usize); 2] {
    [(RefinedRegion::AroundFlaws { distance: 3e-3 }, 2), (a_box([-20e-3, -25e-3], [20e-3, -18e-3]), 1)]
}

/// Largest difference over the largest value.
fn difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let largest = a.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    a.iter().zip(b).fold(0.0, |m: f64, (a, b)| m.max((a - b).abs())) / largest
}

#[test]
fn equal_horizons_give_the_ordinary_net() {
    for law in laws() {
        for angle in [0.0, 0.3] {
            let mut scene = plate(FLAWED, law, 1e-3, &[]);
            scene.model.lattice_angle = angle;
            let dual = fracture::build(&scene).unwrap();
            scene.model.arrangement = Arrangement::Lattice;
            let lattice = fracture::build(&scene).unwrap();
            assert_eq!(dual.positions, lattice.positions);
            assert_eq!((dual.bonds.len(), &dual.pre_cut), (lattice.bonds.len(), &lattice.pre_cut));
            let u = disorder(&lattice);
            let error = difference(&forces(&lattice, &u), &forces(&dual, &u));
            // Factors of a lattice body are in single precision.
            let bound = if law.surface_correction == SurfaceCorrection::None { 1e-12 } else { 1e-6 };
            assert!(error <= bound, "{law:?}, rows at {angle} rad: {error:.1e}");
        }
    }
}

#[test]
fn momentum_and_angular_momentum_are_exact() {
    for law in laws() {
        let net = fracture::build(&plate(FLAWED, law, 2e-3, &graded())).unwrap();
        let levels = net.spacings.iter().fold([0; 3], |mut n, s| {
            n[(2e-3 / s).log2().round() as usize] += 1;
            n
        });
        assert!(levels.iter().all(|&n| n > 50), "{levels:?}");
        let force = forces(&net, &disorder(&net));
        let n = net.unknowns;
        let (mut sum, mut moment, mut size, mut lever) = ([0.0; 2], 0.0, 0.0, 0.0);
        for (f, x) in force.chunks_exact(n).zip(&net.positions) {
            sum = [sum[0] + f[0], sum[1] + f[1]];
            moment += x[0] * f[1] - x[1] * f[0] + if n == 3 { net.rotation_length * f[2] } else { 0.0 };
            size += f[0].abs() + f[1].abs();
            lever += (f[0].abs() + f[1].abs()) * x[0].hypot(x[1]);
        }
        assert!(sum[0].abs().max(sum[1].abs()) <= 1e-12 * size, "{law:?}: {sum:?} of {size}");
        // A tangential spring between points that cannot turn leaves a couple, as published.
        let turns = law.kind.is_two_parameter() && law.rotation == Rotation::Resisted;
        assert!(turns || moment.abs() <= 1e-12 * lever, "{law:?}: {moment} of {lever}");
        assert!(!turns || moment.abs() > 1e-6 * lever, "{law:?}: {moment} of {lever}");
    }
}

#[test]
fn without_the_dual_a_uniform_strain_leaves_a_resultant() {
    for law in laws() {
        let resultant = |arrangement| {
            // Refined on one side only: ghost forces of two opposite sides would cancel.
            let mut scene = plate(PLAIN, law, 2e-3, &[(a_box([10e-3, -30e-3], [50e-3, 30e-3]), 1)]);
            scene.model.arrangement = arrangement;
            let net = fracture::build(&scene).unwrap();
            let n = net.unknowns;
            let mut u = vec![0.0; net.len() * n];
            u.chunks_exact_mut(n).zip(&net.positions).for_each(|(u, x)| u[0] = 1e-3 * x[0]);
            let force = forces(&net, &u);
            let sum: f64 = force.chunks_exact(n).map(|f| f[0]).sum();
            let size: f64 = force.chunks_exact(n).map(|f| f[0].abs()).sum();
            sum / size
        };
        let (dual, without) = (resultant(Arrangement::DualHorizon), resultant(Arrangement::VariableHorizon));
        println!("{law:?}: {dual:.1e} {without:.3}");
        assert!(dual.abs() <= 1e-12, "{law:?}: {dual:.1e}");
        assert!(without.abs() > 1e-3, "{law:?}: {without:.1e}");
    }
}

#[test]
fn uniform_tension_across_a_change_of_level() {
    for law in laws() {
        let net = fracture::build(&plate(PLAIN, law, 2e-3, &[(a_box([-20e-3, -30e-3], [20e-3, 30e-3]), 1)])).unwrap();
        let (n, e) = (net.unknowns, 1e-3);
        let mut u = vec![0.0; net.len() * n];
        let mut held = vec![false; u.len()];
        let nu = statics::material(law.kind, perilife::material::Plane::Stress).poisson_ratio;
        for (i, x) in net.positions.iter().enumerate() {
            (u[n * i], u[n * i + 1]) = (e * x[0], -nu * e * x[1]);
            let rim = x[0].abs() > 44e-3 || x[1].abs() > 24e-3;
            (held[n * i], held[n * i + 1]) = (rim, rim);
        }
        let start = u.clone();
        let u = at_rest(&net, u, &held, &vec![0.0; held.len()]);
        let worst = u.chunks_exact(n).zip(start.chunks_exact(n)).fold(0.0, |m: f64, (a, b)| m.max((a[0] - b[0]).abs()));
        // Strain in x between neighbours of a row.
        let mut strains = Vec::new();
        for bond in &net.bonds[..net.mutual] {
            let (a, b) = (bond.from as usize, bond.to as usize);
            if bond.normal[1].abs() < 1e-9 && bond.length < 1.01 * net.spacings[a] && !held[n * a] && !held[n * b] {
                strains.push((u[n * b] - u[n * a]) / (net.positions[b][0] - net.positions[a][0]) / e);
            }
        }
        let (low, high) = strains.iter().fold((9.0_f64, 0.0_f64), |(l, h), &s| (l.min(s), h.max(s)));
        println!("{law:?}: displacement {:.2} % of e x 100 mm, strain {low:.3} to {high:.3}", 100.0 * worst / (e * 0.1));
    }
}

#[test]
fn point_counts_of_the_mixed_mode_plate() {
    let notched = "width_mm = 200\nlength_mm = 200\nnotches = [{ from_mm = [-100, 0], to_mm = [-75, 0], width_mm = 5 },\n\
                   { from_mm = [100, 0], to_mm = [75, 0], width_mm = 5 }]\n";
    let count = |spacing, regions: &[(RefinedRegion, usize)]| {
        let net = fracture::build(&plate(notched, BOND_BASED, spacing, regions)).unwrap();
        let fine = net.spacings.iter().filter(|&&s| s < 0.99 * spacing).count();
        assert!(net.warnings.is_empty(), "{:?}", net.warnings);
        (net.len(), fine)
    };
    assert_eq!(count(2.5e-3, &[]), (6360, 0));
    // The ligament between the notches, 150 mm x 55 mm.
    let ligament = (a_box([-75e-3, -27.5e-3], [75e-3, 27.5e-3]), 1);
    assert_eq!(count(2.5e-3, &[ligament]), (10320, 5280));
    assert_eq!(count(1.25e-3, &[]), (25440, 0));
}
