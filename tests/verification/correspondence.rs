//! Correspondence peridynamics: exactness on linear fields, zero-energy modes and their control, force as gradient of the
//! energy, momentum.

use nalgebra::Matrix2;
use perilife_plate::material::Plane;
use perilife_plate::specimen::Hole;
use perilife_scenes::correspondence::elasticity::Elasticity;
use perilife_scenes::scene::DamageEntry;
use perilife_scenes::scene::ZeroEnergyControl::{self, Silling, Spring};
use perilife_scenes::{Scene, interaction::Interaction};

use crate::support::correspondence::{bonds, field, forces, law, net, patch, rectangle, scene};
use crate::support::noise::Noise;

/// Controls with factors at which they act.
const CONTROLS: [(ZeroEnergyControl, f64); 3] = [(ZeroEnergyControl::None, 0.0), (Spring, 0.5e23), (Silling, 1.0)];
const SPACING: f64 = 0.25e-3;

/// A plate with a hole on a turned lattice: every kind of rim.
fn holed(control: (ZeroEnergyControl, f64), plane: Plane) -> Scene {
    let mut specimen = rectangle(4e-3, 5e-3);
    specimen.holes.push(Hole { centre: [0.3e-3, 0.2e-3], radius: 0.8e-3 });
    let mut scene = scene(specimen, plane, control, SPACING, 3.015);
    scene.model.lattice_angle = 0.3;
    scene
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.map(f64::abs).fold(0.0, f64::max)
}

/// To round-off at every point, those at the rim and the hole among them; the force state carries the stress (the springs of
/// `spring` add theirs).
#[test]
fn linear_fields_are_exact_at_every_point() {
    let gradient = Matrix2::new(0.02, -0.015, 0.01, -0.03);
    for plane in Plane::ALL {
        for control in CONTROLS {
            let scene = holed(control, *plane);
            let net = net(&scene);
            let (mut law, mut bonds) = (law(&scene, &net), bonds(&net));
            let u = field(&net, |x| (gradient * nalgebra::Vector2::from(x)).into());
            forces(&mut law, &mut bonds, &u);
            let error = largest(law.gradients().map(|h| (h - gradient).amax()));
            assert!(error < 1e-12, "{control:?}, {plane}: {error:e}");
            let (first, _) = Elasticity::of(&scene.material).first_piola_kirchhoff(&gradient);
            let carried = largest((0..net.len()).map(|i| (law.carried(&u, i) - first).amax() / first.amax()));
            println!("{control:?}, {plane}: error of H {error:.1e}, of the stress carried {carried:.1e}");
            assert_eq!(carried < 1e-12, control.0 != Spring, "{control:?}, {plane}: {carried:e}");
        }
    }
}

/// Small strain would be 1 - cos 0.3 = 0.045.
#[test]
fn a_rotation_of_0_3_rad_strains_nothing() {
    let (sin, cos) = 0.3_f64.sin_cos();
    for control in CONTROLS {
        let scene = holed(control, Plane::Stress);
        let net = net(&scene);
        let (mut law, mut bonds) = (law(&scene, &net), bonds(&net));
        let u = field(&net, |[x, y]| [(cos - 1.0) * x - sin * y, sin * x + (cos - 1.0) * y]);
        let (force, reaction) = forces(&mut law, &mut bonds, &u);
        let strain = largest(law.gradients().map(|h| Elasticity::green_strain(&h).amax()));
        assert!(strain < 1e-12, "{control:?}: {strain:e}");
        // Against the force on one point at unit strain, E h spacing.
        let force = largest(force.into_iter()) / (1e9 * scene.specimen.thickness * SPACING);
        // Springs on the whole relative displacement resist rotation.
        let found = force < 1e-12 && reaction.strain < 1e-20;
        assert_eq!(found, control.0 != Spring, "{control:?}: {force:e}, {} J", reaction.strain);
    }
}

/// Alternating displacements leave F = I at every point with all its neighbours, and no force where all those around have it.
#[test]
fn a_checkerboard_costs_nothing_without_control() {
    let side = 19.0 * SPACING;
    for control in CONTROLS {
        let scene = scene(rectangle(side, side), Plane::Stress, control, SPACING, 3.015);
        let net = net(&scene);
        let (mut law, mut bonds) = (law(&scene, &net), bonds(&net));
        let seat = |x: f64| (x / SPACING).round() as i32;
        let u = field(&net, |[x, y]| {
            let sign = f64::from(1 - 2 * (seat(x) + seat(y)).rem_euclid(2));
            [1e-3 * SPACING * sign, -0.5e-3 * SPACING * sign]
        });
        let (force, _) = forces(&mut law, &mut bonds, &u);
        let within = |i: usize, rows: i32| net.positions[i].iter().all(|&x| seat(x).abs() <= 9 - rows);
        let gradients: Vec<Matrix2<f64>> = law.gradients().collect();
        let gradient = largest((0..net.len()).filter(|&i| within(i, 3)).map(|i| gradients[i].amax()));
        assert!(gradient < 1e-15, "{gradient:e}");
        let force = largest((0..net.len()).filter(|&i| within(i, 6)).map(|i| force[2 * i])) / (1e9 * 6.35e-3 * 1e-3 * SPACING);
        assert_eq!(force < 1e-12, control.0 == ZeroEnergyControl::None, "{control:?}: {force:e}");
    }
}

/// A plate with a random displacement and broken bonds, some points with one bond or none left.
fn torn(scene: &Scene, net: &perilife_points::net::Net) -> (Vec<f64>, perilife_scenes::bonds::BondState) {
    let mut noise = Noise::new(3);
    let u: Vec<f64> = (0..2 * net.len()).map(|_| 0.03 * scene.model.spacing * noise.normal()).collect();
    let mut bonds = bonds(net);
    bonds.share.iter_mut().for_each(|share| *share = if noise.normal() > 1.0 { 0.0 } else { *share });
    for (point, left) in [(40, 0), (90, 1), (150, 2)] {
        net.bonds_of(point).skip(left).for_each(|(b, ..)| bonds.share[b] = 0.0);
    }
    (u, bonds)
}

/// With damage in the influence function; with damage in the force alone there is no energy.
#[test]
fn force_is_the_gradient_of_the_energy() {
    for plane in Plane::ALL {
        for control in CONTROLS {
            let scene = holed(control, *plane);
            let net = net(&scene);
            let mut law = law(&scene, &net);
            let (mut u, mut bonds) = torn(&scene, &net);
            let (force, _) = forces(&mut law, &mut bonds, &u);
            let scale = largest(force.iter().copied());
            let mut worst: f64 = 0.0;
            for i in (0..u.len()).step_by(7).chain([80, 81, 180, 181, 300, 301]) {
                let (at, step) = (u[i], 1e-4 * SPACING);
                let mut energy = |shift: f64| {
                    u[i] = at + shift * step;
                    forces(&mut law, &mut bonds, &u).1.strain
                };
                // Fourth order.
                let slope = (8.0 * (energy(1.0) - energy(-1.0)) - (energy(2.0) - energy(-2.0))) / (12.0 * step);
                u[i] = at;
                worst = worst.max((slope + force[i]).abs() / scale);
            }
            assert!(worst < 1e-8, "{control:?}, {plane}: {worst:e}");
        }
    }
}

/// Forces cancel bond by bond. Moments about the deformed body cancel where the energy knows no rotation, which springs on the
/// whole relative displacement do.
#[test]
fn momentum_and_angular_momentum_are_kept() {
    for enters in DamageEntry::ALL {
        for control in CONTROLS {
            let mut scene = holed(control, Plane::Stress);
            scene.damage.enters = *enters;
            let net = net(&scene);
            let mut law = law(&scene, &net);
            let (u, mut bonds) = torn(&scene, &net);
            let (force, _) = forces(&mut law, &mut bonds, &u);
            let (mut sum, mut moment, mut size) = ([0.0; 2], 0.0, 0.0);
            for (i, x) in net.positions.iter().enumerate() {
                let (y, f) = ([x[0] + u[2 * i], x[1] + u[2 * i + 1]], [force[2 * i], force[2 * i + 1]]);
                sum = [sum[0] + f[0], sum[1] + f[1]];
                moment += y[0] * f[1] - y[1] * f[0];
                size += f[0].abs() + f[1].abs();
            }
            assert!(sum[0].abs().max(sum[1].abs()) < 1e-13 * size, "{enters}, {control:?}: {sum:?}");
            let moment = moment.abs() / (size * 2e-3);
            let kept = control.0 != Spring && *enters == DamageEntry::Influence;
            assert_eq!(moment < 1e-13, kept, "{enters}, {control:?}: {moment:e}");
        }
    }
}

/// Every eigenvalue lies below the bound: u K u ≤ Σ bound u² for random u and for the worst one found by power iteration.
#[test]
fn the_stiffness_stays_below_its_bound() {
    for control in CONTROLS {
        let scene = holed(control, Plane::Stress);
        let net = net(&scene);
        let mut law = law(&scene, &net);
        let (_, mut bonds) = torn(&scene, &net);
        let bound = law.stiffness_bound(&bonds);
        let mut noise = Noise::new(9);
        let mut u: Vec<f64> = (0..2 * net.len()).map(|_| noise.normal()).collect();
        let mut quotient = 0.0;
        for _ in 0..300 {
            let size = u.iter().map(|u| u * u).sum::<f64>().sqrt();
            u.iter_mut().for_each(|u| *u *= 1e-9 * SPACING / size);
            let (force, _) = forces(&mut law, &mut bonds, &u);
            let mass: f64 = u.iter().enumerate().map(|(i, u)| bound[i / 2][0] * u * u).sum();
            quotient = -u.iter().zip(&force).map(|(u, f)| u * f).sum::<f64>() / mass;
            u = force.iter().enumerate().map(|(i, f)| if bound[i / 2][0] > 0.0 { f / bound[i / 2][0] } else { 0.0 }).collect();
        }
        assert!(quotient > 0.1 && quotient <= 1.0, "{control:?}: {quotient}");
    }
}

/// Asked for are an oscillation below 1 and the modulus within 5 %; `none` fails both. The other figures are those of an
/// independent program (theory, section 2), to their last digit.
#[test]
fn the_patch_is_smooth_and_true_with_control_and_neither_without() {
    let published = [
        ((ZeroEnergyControl::None, 0.0), 0.30, 45.0),
        ((Silling, 0.01), 0.92, 13.0),
        ((Silling, 0.1), 1.05, 4.1),
        ((Silling, 1.0), 1.04, 0.8),
        ((Silling, 5.0), 1.06, 0.2),
    ];
    for ((control, factor), modulus, oscillation) in published {
        let patch = patch((control, factor), 3.0);
        assert!((patch.modulus - modulus).abs() < 0.006, "{control} {factor}: E_eff/E {} against {modulus}", patch.modulus);
        let digit = if oscillation > 10.0 { 0.51 } else { 0.051 };
        assert!(
            (patch.oscillation - oscillation).abs() < digit,
            "{control} {factor}: {} against {oscillation}",
            patch.oscillation
        );
        assert_eq!(patch.free_motions, 3, "{control} {factor}: rigid motions and nothing else");
        let accepted = [(patch.modulus - 1.0).abs() < 0.05, patch.oscillation < 1.0];
        match (control, factor) {
            (Silling, 1.0) => assert_eq!(accepted, [true; 2], "{factor}"),
            (ZeroEnergyControl::None, _) => assert_eq!(accepted, [false; 2], "no control, and yet no oscillation"),
            _ => {}
        }
    }
}

/// Springs on the whole relative displacement: too weak they leave oscillations, too strong they stiffen (theory, section 2). They
/// hold the plate against rotation, so that only two motions are free.
#[test]
fn springs_on_the_whole_displacement_soften_or_stiffen_the_patch() {
    for (factor, modulus) in [(0.005e23, 0.33), (0.1e23, 0.68), (0.5e23, 1.04), (2e23, 1.22)] {
        let patch = patch((Spring, factor), 3.0);
        assert!((patch.modulus - modulus).abs() < 0.006, "c_I {factor:e}: E_eff/E {} against {modulus}", patch.modulus);
        assert!(patch.oscillation > 1.0, "c_I {factor:e}: {}", patch.oscillation);
        assert_eq!(patch.free_motions, 2, "c_I {factor:e}");
    }
}

/// In uniform strain the springs add the energy of a modulus: on the lattice `c_I V Σ ξ_x² / 2`, which is the integral's
/// `π c_I h δ⁴/8` but for the few points of a neighbourhood.
#[test]
fn springs_raise_the_modulus_of_uniform_strain_as_their_integral_says() {
    let (factor, strain) = (0.5e23, 1e-6);
    let side = 41.0 * SPACING;
    let stored = |control| {
        let scene = scene(rectangle(side, side), Plane::Stress, control, SPACING, 3.015);
        let net = net(&scene);
        let (mut law, mut bonds) = (law(&scene, &net), bonds(&net));
        // With the strain across that leaves no stress there, the energy without springs is E e²/2.
        let u = field(&net, |[x, y]| [strain * x, -0.35 * strain * y]);
        let volume: f64 = net.volumes.iter().sum();
        2.0 * forces(&mut law, &mut bonds, &u).1.strain / (strain * strain * volume)
    };
    let (plain, with_springs) = (stored((ZeroEnergyControl::None, 0.0)), stored((Spring, factor)));
    assert!((plain / 1e9 - 1.0).abs() < 1e-5, "E = {plain:e}");
    let rise = (with_springs - plain) / (1.0 + 0.35 * 0.35);
    let horizon = 3.0 * SPACING;
    let integral = std::f64::consts::PI * factor * 6.35e-3 * horizon.powi(4) / 8.0;
    // Bonds are missing at the rim (5 to 10 % of all), and the lattice sum is above the integral.
    assert!((rise / integral - 1.0).abs() < 0.15, "{rise:e} against {integral:e}");
}

/// `√(4 π G_c / (9 E δ))` at ν = 1/3 (theory, section 2).
#[test]
fn the_critical_stretch_of_the_plane_is_the_bond_based_one_at_a_third() {
    let mut material = crate::support::correspondence::material(Plane::Stress);
    material.poisson_ratio = 1.0 / 3.0;
    let bond_based = (4.0 * std::f64::consts::PI * 100.0 / (9.0 * 1e9 * 0.75e-3)).sqrt();
    let stretch = perilife_scenes::correspondence::criterion::critical_stretch(&material, 100.0, 0.75e-3);
    assert!((stretch / bond_based - 1.0).abs() < 1e-12, "{stretch} against {bond_based}");
}

/// Where all bonds of a column are broken, its stress vanishes if damage enters the influence function, and is still that of the
/// whole neighbourhood if it enters the force alone. Lone points bear none.
#[test]
fn stress_is_released_only_through_the_influence_function() {
    let side = 21.0 * SPACING;
    let gradient = Matrix2::new(1e-3, 0.0, 0.0, 0.0);
    for enters in DamageEntry::ALL {
        let mut scene = scene(rectangle(side, side), Plane::Stress, (Silling, 1.0), SPACING, 3.015);
        scene.damage.enters = *enters;
        let net = net(&scene);
        let (mut law, mut bonds) = (law(&scene, &net), bonds(&net));
        let in_column = |i: u32| net.positions[i as usize][0].abs() < 0.5 * SPACING;
        for (bond, share) in net.bonds.iter().zip(&mut bonds.share) {
            if in_column(bond.from) || in_column(bond.to) {
                *share = 0.0;
            }
        }
        let u = field(&net, |x| (gradient * nalgebra::Vector2::from(x)).into());
        let (force, _) = forces(&mut law, &mut bonds, &u);
        let whole = Elasticity::of(&scene.material).cauchy(&gradient);
        for (i, stress) in law.stresses().enumerate().filter(|(i, _)| in_column(*i as u32)) {
            let expected = if *enters == DamageEntry::Influence { 0.0 } else { whole[(0, 0)] };
            assert!((stress[(0, 0)] - expected).abs() < 1e-9 * whole[(0, 0)], "{enters}: {}", stress[(0, 0)]);
            assert_eq!([force[2 * i], force[2 * i + 1]], [0.0; 2], "{enters}");
        }
    }
}
