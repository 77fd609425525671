//! Fields: eigenfunctions of a crack, and stress over a plate in pieces.

use std::f64::consts::PI;

use perilife_base::units::{MM, MPA};
use perilife_growth::predict::moment::stress_field;
use perilife_growth::predict::{Silent, predict};
use perilife_nodes::stress_field::Corner;
use perilife_plate::material::{Material, Plane};
use perilife_plate::specimen::geometry::{distance, polygon_area};
use perilife_plate::specimen::{CrackLine, Point};
use perilife_plate::williams::{Eigenfunction, Elasticity, Symmetry, coefficient_of_unit_factor};
use perilife_points::body::severed::represented_excess;

use crate::support::plates;
use crate::support::plates::{PANEL, case};
use crate::support::statics::body;

// Eigenfunctions of a crack, and where a crack cut into bonds ends.

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
        assert!(mean.abs() < 0.05 && most > 0.1 && most < 0.6, "{angle}°: mean {mean}, most {most}");
    }
}

// Stress over a plate in pieces: they tile it, its loaded edges carry the load, flanks carry nothing and are open.

const PLATE: &str =
    "kind = \"plate\"\nwidth_mm = 60\nlength_mm = 100\nthickness_mm = 2\ncracks = [{ from_mm = [-9, 0], to_mm = [9, 0] }]\n";

#[test]
fn pieces_tile_the_plate_and_flanks_are_open() {
    let case = plates::case(PLATE, &["model.method=element_free_galerkin", "stop.crack_length_mm=24"]);
    let field = stress_field(&case, &predict(&case, &Silent).unwrap()).unwrap().unwrap();
    let half = 0.5 * field.cracks[0].length();
    assert!(half > 9.0 * MM && half < 12.0 * MM, "the crack of a row late in the life");
    let places = |piece: &[Corner]| piece.iter().map(|corner| corner.at).collect::<Vec<Point>>();
    let area: f64 = field.pieces.iter().map(|piece| polygon_area(&places(piece))).sum();
    assert!((area / (60.0 * MM * 100.0 * MM) - 1.0).abs() < 1e-6, "{area}");
    let sides = |piece: &Vec<Corner>| {
        let side = |k: usize| distance(piece[k].at, piece[(k + 1) % piece.len()].at);
        (0..piece.len()).filter(|k| piece[*k].is_free).map(side).sum::<f64>()
    };
    let free: f64 = field.pieces.iter().map(sides).sum();
    assert!((free / (320.0 * MM + 4.0 * half) - 1.0).abs() < 1e-3, "rims and both flanks: {} mm", free / MM);
    // The stress of the load at the loaded edges.
    let corners = || field.pieces.iter().flatten();
    let loaded: Vec<f64> = corners().filter(|corner| corner.at[1] > 49.9999 * MM).map(|corner| corner.stress.y / MPA).collect();
    let mean = loaded.iter().sum::<f64>() / loaded.len() as f64;
    assert!(loaded.len() > 20 && (mean / 70.0 - 1.0).abs() < 0.02, "{mean}");
    // Flanks are 4 σ a V(2a/W) / E apart in the middle (Tada, Paris and Irwin, stress analysis of cracks, 0.6 %); no stress across them.
    let opening = |side: f64| -> Vec<(f64, f64)> {
        let is_above = |piece: &&Vec<Corner>| side * piece.iter().map(|corner| corner.at[1]).sum::<f64>() > 0.0;
        let on_flank = |corner: &&Corner| corner.at[1].abs() < 1e-9 && corner.at[0].abs() < 0.5 * half;
        let own = field.pieces.iter().filter(is_above).flatten().filter(on_flank);
        own.inspect(|corner| assert!(corner.stress.y.abs() < 0.1 * 70.0 * MPA, "{corner:?}"))
            .map(|corner| (corner.at[0], corner.displacement[1]))
            .collect()
    };
    let (above, below) = (opening(1.0), opening(-1.0));
    let middle = |side: &[(f64, f64)]| side.iter().min_by(|a, b| a.0.abs().total_cmp(&b.0.abs())).unwrap().1;
    let open = (middle(&above) - middle(&below)) / (4.0 * 70.0 * MPA * half / 72e9);
    let x = half / (30.0 * MM);
    let expected = -0.071 - 0.535 * x + 0.169 * x * x + 0.020 * x.powi(3) - 1.071 / x * (1.0 - x).ln();
    assert!(above.len() > 4 && (open / expected - 1.0).abs() < 0.02, "{open} for {expected}");
}
