//! The Brazilian disc of PBX 9501 between rigid platens (Li, Hao, Liu and Zhen), by correspondence.

use std::f64::consts::PI;
use std::path::Path;

use perilife_growth::predict::Silent;
use perilife_scenes::outcome::Fracture;
use perilife_scenes::scene::ZeroEnergyControl;
use perilife_scenes::{Scene, SceneEnd, run};
use perilife_study::computations::{
    CONTROL, DIAMETER, ElasticDisc, SPACING, TENSILE_STRENGTH, THICKNESS, TRAVEL, elastic, hondros, hondros_displacement, scene,
};

/// Damage from which the source takes a point out.
const GONE: f64 = 0.99;

fn file(set: &[&str]) -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/cases/fracture/pbx_disc.toml");
    let overrides: Vec<String> = set.iter().map(|text| (*text).to_owned()).collect();
    Scene::from_file(&path, &overrides).unwrap()
}

/// π D t f_t / 2, N.
fn brazilian_load() -> f64 {
    0.5 * PI * DIAMETER * THICKNESS * TENSILE_STRENGTH
}

/// Points that are gone at the end, by the columns of the lattice from left to right.
fn gone_by_columns(fracture: &Fracture) -> Vec<usize> {
    let damage = &fracture.snapshots.last().unwrap().damage;
    let mut gone = vec![0; fracture.grid.columns];
    for (place, point) in fracture.grid.point_at.iter().enumerate() {
        if point.is_some_and(|point| damage[point as usize] >= GONE) {
            gone[place % fracture.grid.columns] += 1;
        }
    }
    gone
}

fn summary(name: &str, fracture: &Fracture) -> Vec<usize> {
    let gone = gone_by_columns(fracture);
    let middle = gone.len() / 2;
    let onset = &fracture.history[fracture.onset_step.unwrap() - 1];
    println!(
        "{name}: {}, onset at {:.4} mm and {:.1} N, peak {:.1} N = {:.4} of the Brazilian load, gone {} points, by columns about the middle {:?}, {} rows, {} evaluations, {:.0} s",
        fracture.end,
        onset.displacement * 1e3,
        onset.load,
        fracture.peak_load(),
        fracture.peak_load() / brazilian_load(),
        gone.iter().sum::<usize>(),
        &gone[middle - 5..=middle + 5],
        fracture.history.len(),
        fracture.figures.evaluations,
        fracture.figures.wall_s
    );
    gone
}

/// Row of the peak, counted like the onset.
fn peak_step(fracture: &Fracture) -> usize {
    fracture.history.iter().position(|row| row.load == fracture.peak_load()).unwrap() + 1
}

#[test]
fn the_file_is_the_disc_of_the_verification() {
    let (file, built) = (file(&[]), scene(CONTROL, SPACING, TRAVEL));
    assert_eq!(file.model.law, built.model.law);
    assert_eq!(file.damage.law, built.damage.law);
    assert!((file.model.spacing / built.model.spacing - 1.0).abs() < 1e-4, "{}", file.model.spacing);
    let constants = |scene: &Scene| {
        let (m, strength) = (&scene.material, scene.material.tensile_strength.unwrap());
        [m.youngs_modulus, m.poisson_ratio, strength, scene.specimen.thickness, scene.drives.len() as f64]
    };
    for (a, b) in constants(&file).into_iter().zip(constants(&built)) {
        assert!((a / b - 1.0).abs() < 1e-12, "{a} and {b}");
    }
    assert_eq!(file.material.plane, built.material.plane);
}

/// Hondros' stresses at the centre for a narrow contact, and equilibrium of his field: σ_y over the horizontal diameter carries what the
/// even pressure `p = P/(D t α)` on the rim has along y, `P sin α / α`.
#[test]
fn hondros_field_carries_its_load() {
    for half_angle in [0.01, 0.05, 0.2] {
        let nominal = 2.0 * 100.0 / (PI * DIAMETER * THICKNESS);
        let [along, across] = hondros(0.0, 100.0, half_angle);
        assert!((along / nominal - 1.0).abs() < 1.5 * half_angle * half_angle, "{along} {nominal}");
        assert!((across / nominal + 3.0).abs() < 1.5 * half_angle * half_angle, "{across} {nominal}");
        let half = 0.5 * DIAMETER;
        let load =
            -perilife_base::quadrature::integrate(|x| hondros(x, 100.0, half_angle)[1], -half, half, 1e-10).value * THICKNESS;
        let expected = 100.0 * half_angle.sin() / half_angle;
        assert!((load / expected - 1.0).abs() < 1e-8, "{load} N at {half_angle}, {expected} N");
    }
}

/// At twice the spacing of the scene: symmetric to the tolerance of the solution; the field away from the contact is that of
/// Hondros for the load that was found within 5 % (3 % is asked for at the scene's own spacing, see the long test).
#[test]
fn a_coarse_disc_lies_symmetric_between_platens_and_stretches_as_hondros_says() {
    let disc = elastic(CONTROL, DIAMETER / 51.0, TRAVEL).unwrap();
    let (x, u) = *disc.row.last().unwrap();
    for ((a, u_a), (b, u_b)) in disc.row.iter().zip(disc.row.iter().rev()) {
        assert!((a + b).abs() < 1e-9 * DIAMETER && (u_a + u_b).abs() < 1e-4 * u, "{a}: {u_a} and {u_b}");
    }
    let reference = hondros_displacement(x, disc.load, disc.half_angle);
    println!("coarse: P {:.1} N, u_x {:.3e} m against {reference:.3e}, penetration {:.1e} m", disc.load, u, disc.penetration);
    assert!((u / reference - 1.0).abs() < 0.05, "{u} against {reference}");
    // One point bears twice what it does at the scene's own spacing, where it is 0.5 % of the way.
    assert!(disc.penetration < 0.005 * DIAMETER / 51.0, "{}", disc.penetration);
}

/// The load of the platens within a share of π D t f_t/2, and one column of points gone.
fn splits_along_one_column(spacing: &str, share: f64) {
    let fracture = run(&file(&[spacing, "loading.steps=20"]), &Silent).unwrap();
    let gone = summary("coarse, influence", &fracture);
    assert_eq!(fracture.end, SceneEnd::LoadFallen);
    assert!((fracture.peak_load() / brazilian_load() - 1.0).abs() < share, "{} N", fracture.peak_load());
    assert!(fracture.onset_step.unwrap() <= peak_step(&fracture), "onset before the peak");
    let (middle, all) = (gone[gone.len() / 2], gone.iter().sum::<usize>());
    assert!(middle >= gone.len() / 2 && all - middle <= middle / 5, "{gone:?}");
}

/// At nearly three times the spacing of the scene, by which the load is 16 % too high.
#[test]
fn a_coarse_disc_splits_along_one_column() {
    splits_along_one_column("model.spacing_mm=0.7257", 0.2);
}

/// At twice the spacing of the scene.
#[test]
#[ignore = "long: a quarter of a minute"]
fn a_disc_of_twice_the_spacing_splits_at_the_brazilian_load() {
    splits_along_one_column("model.spacing_mm=0.498", 0.1);
}

/// The other criterion of the source, stretch, on a disc of nearly three times the spacing, with the stretch that the strength means at the centre:
/// `(σ_x - ν σ_y)/E = (1 + 3ν) f_t/E` for `σ_y = -3 σ_x`. No crack runs: bonds across the loaded diameter break in a wide band, a fifth of
/// those of a point, and the load goes on as if nothing were broken. What is left of a neighbourhood still measures the whole strain and
/// carries the whole stress, as long as its bonds do not all lie on one line; only `principal_stress` breaks all bonds of a point.
#[test]
fn a_coarse_disc_is_not_split_by_a_critical_stretch() {
    let (strength, scene) = (TENSILE_STRENGTH, file(&[]));
    let stretch = (1.0 + 3.0 * scene.material.poisson_ratio) * strength / scene.material.youngs_modulus;
    let law = ["model.spacing_mm=0.7257", "loading.steps=20", "damage.law=critical_stretch"];
    let limit = format!("damage.critical_stretch={stretch}");
    let fracture = run(&file(&[&law[..], &[&limit]].concat()), &Silent).unwrap();
    let gone = summary("coarse, stretch", &fracture);
    assert_eq!((fracture.end, gone.iter().sum::<usize>()), (SceneEnd::Done, 0));
    let (last, grid) = (fracture.snapshots.last().unwrap(), &fracture.grid);
    let worst = last.damage.iter().copied().fold(0.0, f64::max);
    let middle = (grid.rows / 2) * grid.columns..(grid.rows / 2 + 1) * grid.columns;
    let band = grid.point_at[middle].iter().flatten().filter(|&&point| last.damage[point as usize] > 0.1).count();
    let end = fracture.history.last().unwrap();
    let whole = elastic(CONTROL, DIAMETER / 35.0, 0.5 * end.displacement).unwrap().load;
    assert!(end.broken_bonds > 500 && (0.1..0.35).contains(&worst), "{} bonds, {worst}", end.broken_bonds);
    assert!(band >= 7, "a crack would be one to three points wide: {band}");
    assert!((0.98..1.001).contains(&(end.load / whole)), "{} N, {whole} N without damage", end.load);
}

/// The source: one column of points is gone with damage in the influence function, three with damage in the force alone. Up to the
/// first break both are one computation, so that their onset is the same; the source reports 0.1345 mm for the one and
/// 1212 x 1.5e-4 = 0.182 mm for the other, from different runs.
#[test]
#[ignore = "long: a disc of 8000 points splits twice, some minutes each"]
fn the_disc_splits_along_one_column_or_several() {
    let new = run(&file(&[]), &Silent).unwrap();
    let gone_new = summary("influence", &new);
    let old = run(&file(&["damage.enters=force"]), &Silent).unwrap();
    let gone_old = summary("force", &old);
    for fracture in [&new, &old] {
        assert_eq!(fracture.end, SceneEnd::LoadFallen);
        assert!((fracture.peak_load() / brazilian_load() - 1.0).abs() < 0.1, "{} N", fracture.peak_load());
        assert!(fracture.onset_step.unwrap() <= peak_step(fracture), "onset before the peak");
    }
    assert_eq!(new.onset_step, old.onset_step);
    let (middle, all) = (gone_new[50], gone_new.iter().sum::<usize>());
    assert!(middle >= 60 && all - middle <= middle / 5, "{gone_new:?}");
    // Columns on a side of the middle that are gone over half of its length.
    let wide = gone_old.iter().filter(|&&gone| 2 * gone > gone_old[50]).count();
    assert!((3..=5).contains(&wide), "{gone_old:?}");
}

/// Constants of the springs that the source tries, c_I in N/m⁷.
const SPRINGS: [f64; 7] = [0.0, 0.005e23, 0.1e23, 0.25e23, 0.5e23, 1e23, 2e23];

/// How far a displacement along the diameter is from another: of its end and of the load, relative; root mean square and largest second
/// difference over the displacement of the end.
#[derive(Debug)]
struct Deviation {
    end: f64,
    load: f64,
    rms: f64,
    oscillation: f64,
}

fn deviation(disc: &ElasticDisc, from: &ElasticDisc) -> Deviation {
    let end = disc.row.last().unwrap().0;
    let size = from.displacement(end).abs();
    let squares: f64 = disc.row.iter().map(|(x, u)| (u - from.displacement(*x)).powi(2)).sum();
    let second = disc.row.windows(3).map(|w| (w[2].1 - 2.0 * w[1].1 + w[0].1).abs()).fold(0.0, f64::max);
    Deviation {
        end: disc.displacement(end) / from.displacement(end) - 1.0,
        load: disc.load / from.load - 1.0,
        rms: (squares / disc.row.len() as f64).sqrt() / size,
        oscillation: second / size,
    }
}

/// The source: without springs the displacement oscillates, with weak ones it is too small and still oscillates a little, between
/// 0.1 and 0.5e23 it is best, stronger ones lead away.
#[test]
#[ignore = "long: ten elastic discs"]
fn springs_against_zero_energy_modes_are_good_in_a_narrow_range_only() {
    let fine = elastic((CONTROL.0, 0.5 * CONTROL.1), DIAMETER / 201.0, TRAVEL).unwrap();
    let springs = SPRINGS.map(|c| elastic((ZeroEnergyControl::Spring, c), SPACING, TRAVEL).unwrap());
    let deviations: Vec<Deviation> = springs.iter().map(|disc| deviation(disc, &fine)).collect();
    SPRINGS.iter().zip(&deviations).for_each(|(c, deviation)| println!("c_I = {c:e}: {deviation:.4?}"));
    println!("silling: {:.4?}", deviation(&elastic(CONTROL, SPACING, TRAVEL).unwrap(), &fine));
    let at = |i: usize| &deviations[i];
    assert!(at(0).oscillation > 0.1 && at(1).oscillation > 0.01, "too weak: {deviations:?}");
    assert!((2..7).all(|i| at(i).oscillation < 0.005), "{deviations:?}");
    assert!(at(1).end < -0.1, "0.005e23: displacement too small: {deviations:?}");
    let best = (0..7).min_by(|&a, &b| at(a).rms.total_cmp(&at(b).rms)).unwrap();
    assert!((2..=4).contains(&best), "best between 0.1 and 0.5e23: {deviations:?}");
    assert!(at(4).rms < at(5).rms && at(5).rms < at(6).rms, "stronger ones lead away: {deviations:?}");
    assert!((3..7).all(|i| at(i).load > at(i - 1).load), "and stiffen: {deviations:?}");
}
