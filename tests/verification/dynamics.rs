//! Motion in time: the fast kernel against the list, energy, symmetry, waves.

use perilife::body::Body;
use perilife::bond_law::stencil::{plane_stiffness, spring_material};
use perilife::bond_law::{BondLaw, BondLawKind, Rotation, SurfaceCorrection};
use perilife::fracture::bonds::BondState;
use perilife::fracture::boundary::Boundary;
use perilife::fracture::failure::{Failure, critical_stretch};
use perilife::fracture::interaction::{Damaging, Interaction};
use perilife::fracture::lattice_springs::LatticeSprings;
use perilife::fracture::net::Net;
use perilife::fracture::scene::{DamageLaw, Procedure, SceneLaw};
use perilife::fracture::springs::Springs;
use perilife::fracture::{self, SceneEnd};
use perilife::predict::Silent;

use crate::noise::Noise;
use crate::scenes::{law, pulled};

/// Forces, energies and breaks of the lattice kernel are those of the list, for every law, limit and kinematics, on a plate
/// with a crack, two threads or one.
#[test]
fn lattice_kernel_gives_what_the_list_gives() {
    for (kind, angle) in [BondLawKind::BondBased, BondLawKind::OneBondTwoParameter, BondLawKind::TwoParameter]
        .into_iter()
        .flat_map(|kind| [(kind, 0.0), (kind, 0.3)])
    {
        for (failure, finite) in [
            (Failure::Never, false),
            (Failure::Stretch(vec![2e-3]), false),
            (Failure::Energy(vec![2e-3]), false),
            (Failure::Stretch(vec![2e-3]), true),
        ] {
            if finite && kind != BondLawKind::BondBased {
                continue;
            }
            let mut scene = pulled(law(kind, Rotation::Resisted), DamageLaw::None, 1e-3, 20.0, 1e-6);
            scene.model.lattice_angle = angle;
            let SceneLaw::Bonds(bond_law) = scene.model.law else { panic!("springs") };
            let body = Body::build(&scene.specimen, &scene.material, &bond_law, 1e-3, 3.015, angle).unwrap();
            let net = Net::of_body(&body);
            let boundary = Boundary::of(&scene, &net).unwrap();
            let failure = match failure.clone() {
                Failure::Stretch(limit) => Failure::Stretch(vec![limit[0]; net.len()]),
                Failure::Energy(limit) => Failure::Energy(vec![limit[0]; net.len()]),
                other => other,
            };
            // Displacements of 1e-3 of a spacing from point to point: some bonds are beyond the limit.
            let mut noise = Noise::new(7);
            let u: Vec<f64> = (0..2 * net.len()).map(|_| 1e-6 * noise.normal()).collect();
            let start = BondState::new(&net, &boundary.no_fail);
            let (mut a, mut b) = (start.clone(), start.clone());
            let mut list = Springs::new(&net, failure.clone(), finite);
            let mut fast = LatticeSprings::new(&net, &body, &start, &failure, finite).unwrap();
            let (mut f, mut g) = (vec![0.0; u.len()], vec![0.0; u.len()]);
            let what = format!("{kind} {failure:.0?} finite {finite} angle {angle}").chars().take(90).collect::<String>();
            for damaging in [Damaging::Frozen, Damaging::Allowed, Damaging::Allowed] {
                let of_list = list.react(&u, &mut a, damaging, &mut f);
                let of_lattice = fast.react(&u, &mut b, damaging, &mut g);
                assert_eq!(of_list.broken, of_lattice.broken, "{what}");
                assert!((of_list.strain / of_lattice.strain - 1.0).abs() < 1e-12, "{what}");
                assert!((of_list.released - of_lattice.released).abs() <= 1e-12 * of_list.strain, "{what}");
                assert!(a.share == b.share, "{what}: other bonds broke");
                let scale = f.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
                let apart = f.iter().zip(&g).fold(0.0, |m: f64, (x, y)| m.max((x - y).abs()));
                assert!(apart < 1e-12 * scale, "{what}: forces {apart:.2e} of {scale:.2e} apart");
            }
            assert_eq!(failure == Failure::Never, a.broken(&net) == 0, "{what}: the limits are reached");
        }
    }
}

/// Energy put in by the driven ends is kinetic, strain and fracture energy, to 0.5 %, while a plate is torn in two; the crack
/// starts at both tips at once and the damage stays symmetric.
#[test]
fn energy_is_kept_while_a_plate_is_torn() {
    for (kind, rotation, damage, finite) in [
        (BondLawKind::BondBased, Rotation::Resisted, DamageLaw::CriticalStretch, true),
        (BondLawKind::OneBondTwoParameter, Rotation::Resisted, DamageLaw::CriticalEnergy, false),
        (BondLawKind::TwoParameter, Rotation::Free, DamageLaw::CriticalEnergy, false),
    ] {
        let mut scene = pulled(law(kind, rotation), damage, 1e-3, 8.0, 80e-6);
        scene.model.finite = finite;
        let run = fracture::run(&scene, &Silent).unwrap();
        assert_eq!(run.end, SceneEnd::Done, "{kind}");
        assert!(
            run.separated_step.is_some(),
            "{kind}: {} bonds broke, onset {:?}",
            run.history.last().unwrap().broken_bonds,
            run.onset_step
        );
        let largest = run.history.iter().fold(0.0, |m: f64, row| m.max(row.work));
        for row in &run.history {
            let lost = (row.kinetic + row.strain + row.fracture - row.work).abs() / largest;
            assert!(lost < 5e-3, "{kind}: {lost:.2e} of the energy is lost at step {}", row.step);
        }
        // Both tips are symmetric about x = 0: the plate, the lattice and the loads are.
        let last = run.snapshots.last().unwrap();
        let grid = &run.grid;
        for row in 0..grid.rows {
            for column in 0..grid.columns / 2 {
                let at = |column: usize| last.damage[grid.point_at[row * grid.columns + column].unwrap() as usize];
                assert!((at(column) - at(grid.columns - 1 - column)).abs() < 1e-9, "{kind}: row {row}, column {column}");
            }
        }
    }
}

/// A time step above the stable one is refused; one at the bound keeps its energy, and a denser plate may take longer ones.
#[test]
fn stable_step_is_the_bound() {
    let mut scene = pulled(law(BondLawKind::BondBased, Rotation::Resisted), DamageLaw::None, 1e-3, 1.0, 20e-6);
    let own = fracture::run(&scene, &Silent).unwrap();
    let stable = own.figures.time_step / 0.7;
    for (share, fine) in [(0.999, true), (1.001, false)] {
        scene.procedure = Procedure::Dynamic { duration: 20e-6, time_step: Some(share * stable) };
        let run = fracture::run(&scene, &Silent);
        assert_eq!(run.is_ok(), fine, "{share} of the stable step");
        if let Err(error) = run {
            assert!(error.to_string().contains("stable"), "{error}");
        }
    }
}

/// A crack that cuts all bonds across a line inside a plate, each at the critical stretch, takes the fracture energy: with every law
/// and correction, the springs being those the body has.
#[test]
fn cut_bonds_take_the_fracture_energy() {
    for kind in [BondLawKind::BondBased, BondLawKind::OneBondTwoParameter, BondLawKind::TwoParameter] {
        for &surface_correction in SurfaceCorrection::ALL {
            let bond_law = BondLaw { surface_correction, ..law(kind, Rotation::Resisted) };
            let scene = pulled(bond_law, DamageLaw::CriticalStretch, 1e-3, 20.0, 1e-6);
            let (net, body) = fracture::build(&scene).unwrap();
            let (energy, thickness) = (scene.material.fracture_energy.unwrap(), scene.specimen.thickness);
            let stiffness = plane_stiffness(&spring_material(&bond_law, &scene.material))[0];
            let limit = critical_stretch(&body.unwrap().stencil, stiffness, energy, thickness);
            // A horizontal line through the middle of the plate, between two rows, over ten columns far from the sides.
            let above = |p: u32| net.positions[p as usize][1] > 10e-3;
            let inside = |p: u32| (net.positions[p as usize][0] - 5e-3).abs() < 5e-3;
            let crossing = net.bonds.iter().filter(|bond| above(bond.from) != above(bond.to) && inside(bond.from));
            let taken: f64 = crossing.map(|bond| 0.5 * bond.k_n * (limit * bond.length).powi(2)).sum();
            let share = taken / (energy * thickness * 10e-3);
            assert!((share - 1.0).abs() < 5e-3, "{kind} {surface_correction}: {share:.4} of the fracture energy");
        }
    }
}
