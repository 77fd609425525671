//! Points of several levels with horizon and dual horizon.

use std::path::Path;

use perilife_growth::predict::Silent;
use perilife_plate::specimen::Point;
use perilife_points::bond_law::stencil::{Stencil, plane_stiffness};
use perilife_points::bond_law::{BondLaw, BondLawKind, Kernel, Rotation, SurfaceCorrection};
use perilife_points::net::Net;
use perilife_scenes::failure::critical_stretch;
use perilife_scenes::fronts::CRACKED;
use perilife_scenes::scene::{Action, DamageLaw, Discretisation, RefinedRegion, Scene};
use perilife_scenes::{Fracture, SceneEnd};
use perilife_study::dual_horizon::{PUBLISHED, Patch, forces, material, patch};
use perilife_study::uniform_tension::laws;

use crate::support::noise::Noise;
use crate::support::scenes::{a_box, law, plate, refined, torn};

/// A plate with all that a bond can meet: hole, notch and slant crack.
const FLAWED: &str = "width_mm = 40\nlength_mm = 50\nholes = [{ x_mm = 8, y_mm = 12, diameter_mm = 9 }]\n\
                      notches = [{ from_mm = [-20, -5], to_mm = [-12, -5], width_mm = 2 }]\n\
                      cracks = [{ from_mm = [0, -14], to_mm = [9, -10] }]\n";
/// A plate with nothing but a small crack, as a plate has to have one, in a corner.
const PLAIN: &str = "width_mm = 100\nlength_mm = 60\ncracks = [{ from_mm = [49.9, 29.9], to_mm = [49.99, 29.99] }]\n";

fn disorder(net: &Net) -> Vec<f64> {
    let mut noise = Noise::new(5);
    (0..net.len() * net.unknowns).map(|_| 1e-6 * noise.normal()).collect()
}

/// All laws, of the balanced ones one a kind: they take a second each.
fn laws_in_seconds() -> impl Iterator<Item = BondLaw> {
    let one = |law: &BondLaw| law.kernel == Kernel::Conical && law.rotation == Rotation::Resisted;
    laws().filter(move |law| law.surface_correction != SurfaceCorrection::Balanced || one(law))
}

/// Largest difference over the largest value.
fn difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let largest = a.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    a.iter().zip(b).fold(0.0, |m: f64, (a, b)| m.max((a - b).abs())) / largest
}

#[test]
fn equal_horizons_give_the_ordinary_net() {
    for law in laws_in_seconds() {
        let balanced = law.surface_correction == SurfaceCorrection::Balanced;
        for angle in [0.0, 0.3].into_iter().filter(|&angle| !balanced || angle > 0.0) {
            let mut scene = plate(FLAWED, law, 2e-3, &[]);
            scene.model.lattice_angle = angle;
            let dual = perilife_scenes::build(&scene).unwrap().0;
            scene.model.arrangement = Discretisation::Lattice;
            let lattice = perilife_scenes::build(&scene).unwrap().0;
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

/// Uniform strain is in no equilibrium where levels meet (rows of `perilife verify dual_horizon`). The balanced correction takes that
/// away with every law; where points turn freely, but for what couples of unequal bonds leave.
#[test]
fn uniform_strain_across_a_change_of_level() {
    for law in laws().filter(|law| law.surface_correction == SurfaceCorrection::Balanced) {
        let Patch { strains: [low, high], off } = patch(law).unwrap();
        assert!(off < 2e-4 && low > 0.995 && high < 1.005, "{law:?}: displacement {off:.2e}, strain {low:.4} to {high:.4}");
    }
}

/// Limits follow each point's own horizon as `√(4 π G_c / (9 E δ))`, exactly from level to level. The lattice at this ratio has 3 %
/// more than the integral: partial volumes take from the longest bonds, which carry most of the fracture energy.
#[test]
fn critical_stretch_of_every_level() {
    let (law, fracture_energy, thickness) = (PUBLISHED, 110.0, 2e-3);
    let material = material(&law);
    let over_integral = [1.25e-3, 2.5e-3, 5e-3].map(|spacing| {
        let stencil = Stencil::new(&law, &material, spacing, 3.015, thickness).unwrap();
        let known = (4.0 * std::f64::consts::PI * fracture_energy / (9.0 * material.youngs_modulus * 3.015 * spacing)).sqrt();
        critical_stretch(&stencil, plane_stiffness(&material)[0], fracture_energy, thickness) / known
    });
    for ratio in over_integral {
        assert!((ratio / over_integral[0] - 1.0).abs() < 1e-12 && (ratio - 1.03).abs() < 5e-3, "{over_integral:?}");
    }
}

/// A plate torn in two on two levels: energy is kept to 0.5 %, damage is symmetric, and cracking at a damage of 0.5 is logged.
#[test]
fn a_plate_is_torn_on_two_levels() {
    for (kind, rotation, damage) in [
        (BondLawKind::BondBased, Rotation::Resisted, DamageLaw::CriticalStretch),
        (BondLawKind::OneBondTwoParameter, Rotation::Free, DamageLaw::CriticalEnergy),
    ] {
        let band = RefinedRegion::Band { from: [-25e-3, 0.0], to: [25e-3, 0.0], width: 16e-3 };
        let run = perilife_scenes::run(&refined(torn(law(kind, rotation), damage, 2.5e-3, 8.0, 100e-6), &[(band, 1)]), &Silent)
            .unwrap();
        assert_eq!(run.end, SceneEnd::Done, "{kind}");
        assert!(run.separated_step.is_some(), "{kind}: onset {:?}", run.onset_step);
        let largest = run.history.iter().fold(0.0, |m: f64, row| m.max(row.work));
        let lost = run.history.iter().map(|r| (r.kinetic + r.strain + r.fracture - r.work).abs() / largest).fold(0.0, f64::max);
        assert!(lost < 5e-3, "{kind}: {lost:.2e} of the energy is lost");
        let last = run.snapshots.last().unwrap();
        let (grid, columns) = (&run.grid, run.grid.columns);
        let mut cracked = 0;
        for place in 0..columns * grid.rows {
            let (row, column) = (place / columns, place % columns);
            let at = |column: usize, row: usize| last.damage[grid.point_at[row * columns + column].unwrap() as usize];
            let (here, mirrored) = (at(column, row), at(columns - 1 - column, row));
            assert!((here - mirrored).abs() < 1e-9, "{kind}: column {column}, row {row}: {here} against {mirrored}");
            cracked += usize::from(here > 0.3);
        }
        assert!(cracked > columns, "{kind}: {cracked}");
        assert!(run.path.iter().any(|p| p.time > 0.0 && p.speed > 0.0), "{kind}: {:?}", run.path);
        assert!(run.cracking.iter().all(|p| p.time == 0.0 || p.damage >= 0.5), "{kind}");
    }
}

/// A refined region that cannot be is refused by name.
#[test]
fn wrong_refinements_are_refused() {
    let around = |distance| RefinedRegion::AroundFlaws { distance };
    for (regions, ratio, words) in [
        (vec![(a_box([60e-3, 0.0], [70e-3, 5e-3]), 1)], 3.015, "outside the plate"),
        (vec![(a_box([10e-3, 0.0], [0.0, 5e-3]), 1)], 3.015, "not a box"),
        (vec![(a_box([0.1e-3, 0.1e-3], [0.2e-3, 0.2e-3]), 1)], 3.015, "no point"),
        (vec![(around(5e-3), 0)], 3.015, "levels"),
        (vec![(around(5e-3), 9)], 3.015, "levels"),
        (vec![(around(5e-3), 1)], 1.5, "do not overlap"),
        (vec![(RefinedRegion::Band { from: [0.0, 0.0], to: [1e-3, 0.0], width: 0.0 }, 1)], 3.015, "without width"),
    ] {
        let mut scene = plate(PLAIN, PUBLISHED, 2e-3, &regions);
        scene.model.horizon_ratio = ratio;
        let error = perilife_scenes::build(&scene).unwrap_err();
        assert_eq!(error.exit_code(), 2, "{error}");
        assert!(error.to_string().contains(words), "{error}");
    }
    let scene =
        plate(PLAIN, BondLaw { surface_correction: SurfaceCorrection::Balanced, ..PUBLISHED }, 2e-3, &[(around(5e-3), 1)]);
    assert!(perilife_scenes::build(&scene).is_ok());
}

/// Regions two levels deep get a ring between, so that no horizon reaches over more than one level; it is said.
#[test]
fn levels_are_graded() {
    let net = perilife_scenes::build(&plate(PLAIN, PUBLISHED, 4e-3, &[(a_box([-4e-3, -4e-3], [4e-3, 4e-3]), 3)])).unwrap().0;
    assert!(net.warnings.iter().any(|line| line.contains("extra points")), "{:?}", net.warnings);
    let finest = net.spacings.iter().filter(|&&s| s < 0.6e-3).count();
    assert_eq!(finest, 256);
    for (x, (at, horizon)) in net.positions.iter().zip(&net.horizons).enumerate() {
        for (there, spacing) in net.positions.iter().zip(&net.spacings) {
            let levels = (net.spacings[x] / spacing).log2().abs().round();
            let away = (at[0] - there[0]).hypot(at[1] - there[1]);
            assert!(away > *horizon || levels <= 1.0, "{at:?} of {:.2e} reaches {there:?} of {spacing:.2e}", net.spacings[x]);
        }
    }
    // Volumes fill the plate.
    let volume: f64 = net.volumes.iter().sum();
    assert!((volume / (0.1 * 0.06 * 2e-3) - 1.0).abs() < 1e-12, "{volume}");
}

fn mixed_mode(name: &str, set: &[&str]) -> Scene {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("data/cases/fracture/mixed_mode_{name}.toml"));
    Scene::from_file(&file, &set.iter().map(|key| (*key).to_owned()).collect::<Vec<_>>()).unwrap()
}

/// Points whose damage says that a crack runs through them.
fn cracked(run: &Fracture) -> Vec<Point> {
    let (grid, last) = (&run.grid, run.snapshots.last().unwrap());
    let is_cracked = |place: &usize| grid.point_at[*place].is_some_and(|p| last.damage[p as usize] >= CRACKED);
    let at = |place: usize| {
        let (column, row) = (place % grid.columns, place / grid.columns);
        [grid.origin[0] + column as f64 * grid.spacing, grid.origin[1] + row as f64 * grid.spacing]
    };
    (0..grid.point_at.len()).filter(is_cracked).map(at).collect()
}

/// Farthest that a point of one set lies from the other, m.
fn apart(a: &[Point], b: &[Point]) -> f64 {
    let away = |p: &Point| b.iter().map(|q| (p[0] - q[0]).hypot(p[1] - q[1])).fold(f64::INFINITY, f64::min);
    a.iter().map(away).fold(0.0, f64::max)
}

/// Two cracks from the notches that bend away from the ligament, mirror images under half a turn: the left one below, the right
/// one above. Coarser and faster pulled than the scene itself, in seconds.
#[test]
fn mixed_mode_cracks_bend_away_from_the_ligament() {
    let set = ["model.spacing_mm=5", "loading.duration_s=0.9e-3"];
    let mut scene = mixed_mode("two_levels", &set);
    for drive in &mut scene.drives {
        if let Action::Velocity([_, Some(velocity)]) = &mut drive.action {
            *velocity *= 6.0;
        }
    }
    let run = perilife_scenes::run(&scene, &Silent).unwrap();
    let cracks = cracked(&run);
    let turned: Vec<Point> = cracks.iter().map(|p| [-p[0], -p[1]]).collect();
    println!("{} points, half a turn {:.2e}, steps {}", cracks.len(), apart(&cracks, &turned), run.figures.evaluations);
    assert!(cracks.len() > 40, "{}", cracks.len());
    // As far as two paths may lie apart, two fine horizons: sums over a point and over its twin run in other orders, and fast
    // cracks amplify the difference. The scenes at their own velocity are their own images exactly.
    let off = apart(&cracks, &turned);
    assert!(off <= 2.0 * 3.015 * run.grid.spacing, "{off:.2e}");
    let mean = |from: f64, to: f64| {
        let heights: Vec<f64> = cracks.iter().filter(|p| p[0] > from && p[0] < to).map(|p| p[1]).collect();
        heights.iter().sum::<f64>() / heights.len() as f64
    };
    let (left, right) = (mean(-40e-3, -15e-3), mean(15e-3, 40e-3));
    assert!(right > 2e-3 && left < -2e-3, "left {left:.2e}, right {right:.2e}");
}

/// The crack on refined points lies within two fine horizons of that on fine points everywhere.
#[test]
#[ignore = "long: three runs of about a minute"]
fn mixed_mode_crack_paths_agree() {
    let runs =
        ["uniform", "two_levels", "three_levels"].map(|name| perilife_scenes::run(&mixed_mode(name, &[]), &Silent).unwrap());
    let [uniform, refined @ ..] = &runs;
    let reference = cracked(uniform);
    for run in refined {
        let cracks = cracked(run);
        let off = apart(&cracks, &reference).max(apart(&reference, &cracks));
        println!("{} points: peak {:.1} kN, {:.2} mm off", run.figures.points, run.peak_load() / 1e3, 1e3 * off);
        assert!(off <= 2.0 * 3.015 * 1.25e-3, "{:.2} mm", 1e3 * off);
    }
}
