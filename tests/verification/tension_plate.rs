//! A plate in uniform tension.

use perilife::bond_law::{BondLaw, BondLawKind, Kernel, Rotation, SurfaceCorrection};
use perilife::verify;
use perilife::verify::tension_plate::{BALANCED, POISSON_RATIOS, PUBLISHED, plate};
use perilife::verify::uniform_tension::{shapes, strip, uniform_tension};

use crate::statics::laws;

/// Scenes without time and points of several levels: every row of their topics holds or carries its reason, and no more carry one than
/// the few that are known.
#[test]
fn short_topics_hold() {
    for (name, known) in [("static_scenes", 5), ("dual_horizon", 3)] {
        let rows = verify::rows(&verify::topics(&[name.to_owned()]).unwrap(), &|_, _| {}).unwrap();
        let failing: Vec<_> = rows.iter().filter(|row| row.fails()).collect();
        assert!(rows.len() > 10 && failing.is_empty(), "{failing:#?}");
        assert_eq!(rows.iter().filter(|row| !row.ok()).count(), known, "{name}");
    }
}

#[test]
fn the_published_errors_come_out_with_the_classical_corrections() {
    for published in &PUBLISHED {
        let errors = plate(&published.law(), published.poisson_ratio).unwrap();
        println!("{published:?}: {errors:.3?}");
        assert!((errors.along - published.along).abs() < 0.1, "{published:?}: {errors:?}");
    }
}

/// Asked for are 0.5 % along the load over all points, 0.1 % inside and 2 % across; reached 0.004, 0.004 and 0.05 %.
#[test]
fn the_balanced_correction_is_exact_to_a_hundredth_of_a_percent_for_every_poissons_ratio() {
    let of_default = POISSON_RATIOS.iter().map(|&nu| (BALANCED, nu));
    let of_springs = laws().filter(|law| law.0 != BondLawKind::StateBased);
    let of_all = of_springs.map(|(kind, kernel, rotation)| {
        let nu = if kind == BondLawKind::BondBased { 1.0 / 3.0 } else { 0.1 };
        (BondLaw { kind, kernel, rotation, surface_correction: SurfaceCorrection::Balanced }, nu)
    });
    for (law, nu) in of_default.chain(of_all) {
        let errors = plate(&law, nu).unwrap();
        println!("{law:?}, nu {nu:.3}: {errors:.4?}");
        assert!(errors.along < 0.01 && errors.along_inside < 0.01 && errors.across < 0.1, "{law:?}, nu {nu}: {errors:?}");
    }
}

/// A small plate, 20 x 36 points. Asked for are 0.5 %, 0.1 % is the aim; twelve neighbours (horizon ratio below 2.2) are too few for
/// all equations at once.
#[test]
fn the_balanced_correction_serves_every_horizon() {
    for kernel in Kernel::ALL {
        for (ratio, bound) in [(1.5, 0.5), (2.015, 0.5), (2.5, 0.1), (3.015, 0.1), (4.015, 0.1), (5.015, 0.1), (6.015, 0.1)] {
            for nu in [0.1, 1.0 / 3.0] {
                let law = BondLaw { kernel: *kernel, ..BALANCED };
                let errors = uniform_tension(&strip(0.02, 0.036), &law, nu, 1e-3, ratio, 0.0).unwrap();
                println!("{kernel}, ratio {ratio}, nu {nu:.3}: {errors:.4?}");
                assert!(errors.along < bound, "{kernel}, ratio {ratio}, nu {nu}: {errors:?}");
            }
        }
    }
}

/// Holes, slots, slanted edges and turned lattices.
#[test]
fn the_balanced_correction_serves_every_rim_and_beats_the_classical_one() {
    for shape in shapes() {
        for nu in [0.1, 0.3] {
            let [balanced, classical] = [SurfaceCorrection::Balanced, SurfaceCorrection::VolumeAndSurface].map(|correction| {
                let law = BondLaw { rotation: Rotation::Free, surface_correction: correction, ..BALANCED };
                uniform_tension(&shape.specimen, &law, nu, 1e-3, 3.015, shape.angle).unwrap().overall
            });
            println!("{}, nu {nu}: {balanced:.4} % balanced, {classical:.3} % classical", shape.name);
            // Reached: 0.03 % on holes and slanted edges, 0.1 % with slots, 0.9 % with the thinnest edge slot and with corners off the lattice.
            let bound = match shape.name {
                "edge slot of 2 mm" | "rows at 15 degrees" => 1.0,
                name if name.contains("slot") => 0.2,
                _ => 0.06,
            };
            assert!(balanced < bound && balanced < 0.5 * classical, "{}: {balanced} against {classical}", shape.name);
        }
    }
}
