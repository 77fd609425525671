//! A plate in uniform tension where `perilife verify tension_plate` has no row: every horizon, and the classical correction beside
//! the balanced one.

use perilife_points::bond_law::{BondLaw, Kernel, SurfaceCorrection};
use perilife_study::uniform_tension::{BALANCED, Shape, shapes, strip, uniform_tension};

/// A small plate, 20 x 36 points. Asked for are 0.5 %, 0.1 % is the aim; twelve neighbours (horizon ratio below 2.2) are too few for
/// all equations at once.
fn serves_horizons(both: bool) {
    for (k, kernel) in Kernel::ALL.iter().enumerate() {
        let ratios = [(1.5, 0.5), (2.015, 0.5), (2.5, 0.1), (3.015, 0.1), (4.015, 0.1), (5.015, 0.1), (6.015, 0.1)];
        for (i, (ratio, bound)) in ratios.into_iter().enumerate() {
            for (_, nu) in [0.1, 1.0 / 3.0].into_iter().enumerate().filter(|(n, _)| both || (i + k) % 2 == *n) {
                let law = BondLaw { kernel: *kernel, ..BALANCED };
                let errors = uniform_tension(&strip(0.02, 0.036), &law, nu, 1e-3, ratio, 0.0).unwrap();
                assert!(errors.along < bound, "{kernel}, ratio {ratio}, nu {nu}: {errors:?}");
            }
        }
    }
}

/// Poisson's ratios take turns.
#[test]
fn the_balanced_correction_serves_every_horizon() {
    serves_horizons(false);
}

#[test]
#[ignore = "long: ten seconds; cargo test tension_plate -- --ignored --nocapture"]
fn the_balanced_correction_serves_every_horizon_at_every_poissons_ratio() {
    serves_horizons(true);
}

/// Holes, slots, slanted edges and turned lattices.
fn serves_rims(shapes: impl Iterator<Item = Shape>) {
    for shape in shapes {
        let [balanced, classical] = [SurfaceCorrection::Balanced, SurfaceCorrection::VolumeAndSurface].map(|correction| {
            let law = BondLaw { surface_correction: correction, ..BALANCED };
            uniform_tension(&shape.specimen, &law, 0.1, 1e-3, 3.015, shape.angle).unwrap().overall
        });
        println!("{}: {balanced:.4} % balanced, {classical:.3} % classical", shape.name);
        // Reached: 0.03 % on holes and slanted edges, 0.1 % with slots, 0.9 % with the thinnest edge slot and with corners off the lattice.
        let bound = match shape.name {
            "edge slot of 2 mm" | "rows at 15 degrees" => 1.0,
            name if name.contains("slot") => 0.2,
            _ => 0.06,
        };
        assert!(balanced < bound && balanced < 0.5 * classical, "{}: {balanced} against {classical}", shape.name);
    }
}

/// Every third shape.
#[test]
fn the_balanced_correction_serves_rims_and_beats_the_classical_one() {
    serves_rims(shapes().into_iter().step_by(3));
}

#[test]
#[ignore = "long: half a minute; cargo test tension_plate -- --ignored --nocapture"]
fn the_balanced_correction_serves_every_rim_and_beats_the_classical_one() {
    serves_rims(shapes().into_iter());
}
