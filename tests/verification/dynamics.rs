//! Motion in time: the fast kernel against the list, energy, symmetry, waves.

use perilife_growth::predict::Silent;
use perilife_points::body::Body;
use perilife_points::bond_law::stencil::{plane_stiffness, spring_material};
use perilife_points::bond_law::{BondLaw, BondLawKind, Rotation, SurfaceCorrection};
use perilife_points::net::Net;
use perilife_scenes::SceneEnd;
use perilife_scenes::bonds::BondState;
use perilife_scenes::boundary::Boundary;
use perilife_scenes::failure::{Failure, critical_stretch};
use perilife_scenes::interaction::{Damaging, Interaction};
use perilife_scenes::lattice_springs::LatticeSprings;
use perilife_scenes::scene::{DamageLaw, Procedure, Scene, SceneLaw, SceneSolver};
use perilife_scenes::springs::Springs;

use crate::support::noise::Noise;
use crate::support::scenes::{law, torn};

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
            let mut scene = torn(law(kind, Rotation::Resisted), DamageLaw::None, 1e-3, 20.0, 1e-6);
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
                let of_list = list.internal_force(&u, &mut a, damaging, &mut f);
                let of_lattice = fast.internal_force(&u, &mut b, damaging, &mut g);
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
        let mut scene = torn(law(kind, rotation), damage, 1e-3, 8.0, 80e-6);
        scene.model.finite = finite;
        let run = perilife_scenes::run(&scene, &Silent).unwrap();
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
    let mut scene = torn(law(BondLawKind::BondBased, Rotation::Resisted), DamageLaw::None, 1e-3, 1.0, 20e-6);
    let own = perilife_scenes::run(&scene, &Silent).unwrap();
    let stable = own.figures.time_step / 0.7;
    for (share, fine) in [(0.999, true), (1.001, false)] {
        scene.procedure = Procedure::Dynamic { duration: 20e-6, time_step: Some(share * stable) };
        let run = perilife_scenes::run(&scene, &Silent);
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
            let scene = torn(bond_law, DamageLaw::CriticalStretch, 1e-3, 20.0, 1e-6);
            let (net, body) = perilife_scenes::build(&scene).unwrap();
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

/// A plate of 40 mm x 20 mm that nothing breaks, moved in time by loads.
fn moved(loading: &str) -> Scene {
    let text = format!(
        "[specimen]\nkind = \"plate\"\nwidth_mm = 40\nlength_mm = 20\nthickness_mm = 2\n[material]\nyoungs_modulus_gpa = 65\n\
         poisson_ratio = 0.2\ndensity_kg_m3 = 2235\n[model]\nspacing_mm = 1\n[loading]\nduration_s = 3e-5\ntime_step_s = 4e-8\n{loading}\n"
    );
    Scene::from_toml(&text, "moved", std::path::Path::new("."), &[]).unwrap()
}

/// A traction that rises from nothing moves the plate before it has worked on it, by a step; that is no energy from nowhere.
#[test]
fn a_slow_traction_is_no_blow_up() {
    for (step, ramp) in [(4e-8, 4e-6), (1e-8, 2e-5), (4e-8, 0.0)] {
        let mut scene = moved(&format!(
            "kind = \"traction\"\nstress_mpa = 5\nedges = [\"left\", \"right\"]\nramp_s = {}",
            f64::max(ramp, 1e-12)
        ));
        scene.procedure = Procedure::Dynamic { duration: 1e-5, time_step: Some(step) };
        assert_eq!(perilife_scenes::run(&scene, &Silent).unwrap().end, SceneEnd::Done, "ramp {ramp} s, steps of {step} s");
    }
}

/// Tractions that rise one after another do what each does alone, added up: springs without damage are linear. Their forces at
/// full size are those of all tractions at once.
#[test]
fn loads_that_rise_one_after_another_add_up() {
    let part = |edges: &str, stress: f64, times: &str| {
        format!("{{ kind = \"traction\", stress_mpa = {stress}, edges = [{edges}], {times} }}")
    };
    let first = part("\"top\", \"bottom\"", 5.0, "ramp_s = 4e-6");
    let second = part("\"left\", \"right\"", -3.0, "ramp_s = 2e-6, from_s = 1e-5");
    let run = |parts: &str| {
        let scene = moved(&format!("parts = [{parts}]"));
        perilife_scenes::run(&scene, &Silent).unwrap().snapshots.last().unwrap().displacement.clone()
    };
    let [both, a, b] = [format!("{first}, {second}"), first.clone(), second.clone()].map(|parts| run(&parts));
    let largest = both.iter().flatten().fold(0.0, |m: f64, u| m.max(u.abs()));
    for ((u, a), b) in both.iter().zip(&a).zip(&b) {
        for axis in 0..2 {
            assert!((u[axis] - a[axis] - b[axis]).abs() < 1e-12 * largest, "{u:?} is not {a:?} and {b:?}");
        }
    }
    assert!(b.iter().flatten().any(|u| u.abs() > 0.1 * largest), "the second load counts");

    let scene = moved(&format!("parts = [{first}, {second}]"));
    let net = perilife_scenes::build(&scene).unwrap().0;
    let boundary = Boundary::of(&scene, &net).unwrap();
    assert_eq!(boundary.pushes.len(), 2);
    let mut sum = vec![[0.0; 2]; net.len()];
    for (point, force) in boundary.pushes.iter().flat_map(|push| &push.forces) {
        let at = &mut sum[*point as usize];
        *at = [at[0] + force[0], at[1] + force[1]];
    }
    for (point, force) in &net.forces {
        let at = sum[*point as usize];
        assert!((at[0] - force[0]).hypot(at[1] - force[1]) < 1e-12 * 5e6 * 2e-6, "{at:?} and {force:?}");
    }
    // Of each of the four loads the force on its side.
    let forces: Vec<f64> = boundary.groups.iter().map(|group| group.force.unwrap()).collect();
    for (force, whole) in forces.iter().zip([5e6 * 0.04 * 2e-3, 5e6 * 0.04 * 2e-3, 3e6 * 0.02 * 2e-3, 3e6 * 0.02 * 2e-3]) {
        assert!((force / whole - 1.0).abs() < 1e-9, "{force} N, {whole} N");
    }
}

/// A traction is brought up and held, then a velocity follows (Nooru-Mohamed, load path 4a): until then its points stand still. The
/// energy that both bring is what the plate has.
#[test]
fn a_velocity_follows_a_traction() {
    let scene = moved(
        "parts = [{ kind = \"traction\", stress_mpa = 5, edges = [\"left\", \"right\"], ramp_s = 4e-6 }, \
         { kind = \"velocity\", velocity_mm_s = 500, edges = [\"top\", \"bottom\"], from_s = 1e-5, ramp_s = 5e-6 }]",
    );
    let run = perilife_scenes::run(&scene, &Silent).unwrap();
    assert_eq!(run.end, SceneEnd::Done);
    let largest = run.history.iter().fold(0.0, |m: f64, row| m.max(row.work.abs()));
    let mut worst = 0.0_f64;
    for row in &run.history {
        // Both ends at 0.5 m/s, rising over 5 µs from 10 µs on.
        let since = (row.time - 1e-5).max(0.0);
        let way = 2.0 * 0.5 * if since < 5e-6 { 0.5 * since * since / 5e-6 } else { since - 2.5e-6 };
        assert!((row.displacement - way).abs() < 1e-15, "{} m at {} s, not {way}", row.displacement, row.time);
        worst = worst.max((row.kinetic + row.strain - row.work).abs() / largest);
    }
    assert!(run.history.iter().any(|row| row.time < 1e-5 && row.work > 1e-3 * largest), "the traction acts before");
    assert!(worst < 5e-3, "{worst:.2e}");
}

/// Platens press in time as well, each when it is due: way and energy are those that they bring, and after a slow pressing the load
/// is that of rest.
#[test]
fn platens_press_in_time() {
    let platens = |times: &str| {
        format!(
            "parts = [{{ kind = \"platens\", displacement_mm = 0.01, edges = [\"top\"], {times} }}, {{ kind = \"platens\", displacement_mm = 0.02, edges = [\"bottom\"], ramp_s = 1e-4 }}]"
        )
    };
    let mut scene = moved(&platens("ramp_s = 1e-4, from_s = 1e-5"));
    scene.procedure = Procedure::Dynamic { duration: 1.5e-4, time_step: Some(4e-8) };
    let run = perilife_scenes::run(&scene, &Silent).unwrap();
    let last = run.history.last().unwrap();
    assert!((last.displacement / 0.03e-3 - 1.0).abs() < 1e-12, "{}", last.displacement);
    let largest = run.history.iter().fold(0.0, |m: f64, row| m.max(row.work.abs()));
    let lost = run.history.iter().map(|row| (row.kinetic + row.strain - row.work).abs() / largest).fold(0.0, f64::max);
    let mut still = scene.clone();
    still.procedure = Procedure::Static;
    still.model.solver = SceneSolver::AdaptiveDynamicRelaxation;
    let rest = perilife_scenes::run(&still, &Silent).unwrap().history.last().unwrap().load;
    // Mean over the time after the way is done, over the waves that are left.
    let after: Vec<f64> = run.history.iter().filter(|row| row.time > 1.1e-4).map(|row| row.load).collect();
    let mean = after.iter().sum::<f64>() / after.len() as f64;
    assert!(lost < 5e-3, "{lost:.2e}");
    assert!((mean / rest - 1.0).abs() < 0.02, "{mean} N, at rest {rest} N");
}
