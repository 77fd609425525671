//! Eigenfunctions of a crack, and where a crack cut into bonds ends.

use std::f64::consts::PI;

use perilife_plate::material::{Material, Plane};
use perilife_plate::specimen::CrackLine;
use perilife_plate::williams::{Eigenfunction, Elasticity, Symmetry, coefficient_of_unit_factor};
use perilife_points::body::severed::represented_excess;

use crate::support::plates::{PANEL, case};
use crate::support::statics::body;

fn elasticity(plane: Plane) -> Elasticity {
    Elasticity::of(&Material::elastic(72e9, 0.3, plane))
}

fn functions() -> impl Iterator<Item = Eigenfunction> {
    [Symmetry::Opening, Symmetry::Sliding]
        .into_iter()
        .flat_map(|symmetry| (-3..=8).map(move |order| Eigenfunction { order, symmetry }))
}

/// Gradient of u (not of 2G u) at a place of the frame.
fn gradient(f: &Eigenfunction, e: &Elasticity, [x, y]: [f64; 2]) -> [[f64; 2]; 2] {
    f.gradient(e.kappa, x.hypot(y), y.atan2(x)).map(|row| row.map(|g| g / (2.0 * e.shear_modulus)))
}

#[test]
fn gradients_are_the_slopes_of_displacements() {
    let e = elasticity(Plane::Stress);
    for f in functions() {
        let (at, step) = ([0.6, -0.5], 1e-5);
        let u = |[x, y]: [f64; 2]| f.displacement(e.kappa, f64::hypot(x, y), y.atan2(x));
        let given = f.gradient(e.kappa, f64::hypot(0.6, 0.5), (-0.5_f64).atan2(0.6));
        for j in 0..2 {
            let [mut ahead, mut behind] = [at; 2];
            ahead[j] += step;
            behind[j] -= step;
            for (i, row) in given.iter().enumerate() {
                let slope = (u(ahead)[i] - u(behind)[i]) / (2.0 * step);
                assert!((row[j] - slope).abs() < 1e-6 * (1.0 + slope.abs()), "{f:?} {i}{j}: {} {slope}", row[j]);
            }
        }
    }
}

#[test]
fn eigenfunctions_are_in_equilibrium_and_leave_the_faces_free() {
    for e in [elasticity(Plane::Stress), elasticity(Plane::Strain)] {
        for f in functions() {
            let stress = |at: [f64; 2]| e.stress(&gradient(&f, &e, at));
            let size = stress([0.6, 0.5]).iter().fold(1.0, |m: f64, s| m.max(s.abs()));
            let step = 1e-4;
            let slope = |axis: usize, component: usize| {
                let [mut a, mut b] = [[0.6, 0.5]; 2];
                a[axis] += step;
                b[axis] -= step;
                (stress(a)[component] - stress(b)[component]) / (2.0 * step)
            };
            // xx, yy, xy.
            assert!((slope(0, 0) + slope(1, 2)).abs() < 1e-5 * size, "{f:?}");
            assert!((slope(0, 2) + slope(1, 1)).abs() < 1e-5 * size, "{f:?}");
            for theta in [PI, -PI] {
                let on_face = e.stress(&f.gradient(e.kappa, 0.7, theta).map(|row| row.map(|g| g / (2.0 * e.shear_modulus))));
                assert!(on_face[1].abs() < 1e-9 * size && on_face[2].abs() < 1e-9 * size, "{f:?} at {theta}: {on_face:?}");
            }
        }
    }
}

/// `σ_22 = K_I/√(2πr)` and `σ_12 = K_II/√(2πr)` ahead of the tip; `G = K²/E'` by the energy needed to close the crack again:
/// opening over r behind the tip `8 K/E' √(r/2π)`.
#[test]
fn the_singular_functions_have_unit_factors() {
    for e in [elasticity(Plane::Stress), elasticity(Plane::Strain)] {
        for (symmetry, component, axis) in [(Symmetry::Opening, 1, 1), (Symmetry::Sliding, 2, 0)] {
            let f = Eigenfunction { order: 1, symmetry };
            let unit = coefficient_of_unit_factor(symmetry);
            let stress = unit * e.stress(&gradient(&f, &e, [0.3, 0.0]))[component];
            assert!((stress * (2.0 * PI * 0.3).sqrt() - 1.0).abs() < 1e-12, "{symmetry:?}");
            let face = |theta: f64| unit * f.displacement(e.kappa, 0.3, theta)[axis] / (2.0 * e.shear_modulus);
            let jump = (face(PI) - face(-PI)) * e.plane_modulus / (8.0 * (0.3 / (2.0 * PI)).sqrt());
            assert!((jump - 1.0).abs() < 1e-12, "{symmetry:?}: {jump}");
        }
    }
}

/// The end that the bonds represent swings about the one asked for: with the period of the lattice for a crack along its rows,
/// with no short one for others, hence the many spacings.
#[test]
fn the_represented_length_swings_about_the_requested_one() {
    let body = body(&case(PANEL, &[]));
    let spacing = body.lattice.spacing;
    for angle in [0.0_f64, 90.0, 20.0, 37.0] {
        let (sin, cos) = angle.to_radians().sin_cos();
        let (spacings, samples) = (20, 200);
        let mut excess: Vec<f64> = Vec::new();
        for i in 0..samples {
            let a = 20e-3 + spacing * f64::from(spacings * i) / f64::from(samples);
            let crack = CrackLine::straight([-a * cos, -a * sin], [a * cos, a * sin]);
            let [here, there] = [true, false].map(|at_last| represented_excess(&body, &crack, at_last, a));
            // The lattice is symmetric under half a turn, and so is a crack through its centre.
            if angle == 20.0 || angle == 37.0 {
                assert!((here - there).abs() < 1e-6 * spacing);
            }
            excess.push(here / spacing);
        }
        let mean = excess.iter().sum::<f64>() / f64::from(samples);
        let most = excess.iter().fold(0.0_f64, |m, e| m.max(e.abs()));
        println!("{angle}°: mean {mean:.4}, most {most:.3}");
        assert!(mean.abs() < 0.05 && most > 0.1 && most < 0.6, "{angle}°: mean {mean}, most {most}");
    }
}
