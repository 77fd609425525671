//! The load at which cracks of scenes grow, and what lattices ask for it. Griffith's loads have rows in `perilife verify scene_strength`.

use std::path::Path;

use perilife_growth::predict::Silent;
use perilife_points::bond_law::{BondLaw, BondLawKind, Kernel, Rotation, SurfaceCorrection};
use perilife_scenes::Scene;
use perilife_scenes::assembly::preview;
use perilife_scenes::trapping::trapping;
use perilife_study::cases::overrides;
use perilife_study::moving::growth_load;

use crate::support::shared::shared;

/// Values of the topic: the square, and Griffith's load on it, N.
fn value(name: &str) -> toml::Value {
    let text = include_str!("../../data/studies/scene_strength.toml");
    text.parse::<toml::Table>().unwrap()["set"][name].clone()
}

/// τ of a law from its own lattice: square of the mean, over three angles of the rows, of the largest load of a growing crack whose
/// bonds store the fracture energy, over Griffith's.
fn found(kind: BondLawKind, spacing: f64) -> f64 {
    let keys = |angle: i32| {
        format!(
            "model.bond_law={kind} model.spacing_mm={spacing} supports.bottom.rows_mm={spacing} model.lattice_angle_deg={angle} \
             damage.calibration=bond_energy"
        )
    };
    let loads = [0, 20, 45].map(|angle| growth_load(value("square").as_str().unwrap(), &overrides(&keys(angle))).unwrap());
    println!("{kind}, {spacing} mm: {loads:.1?} N");
    (loads.iter().sum::<f64>() / 3.0 / value("griffith")[0].as_float().unwrap()).powi(2)
}

fn assert_table(kind: BondLawKind, spacing: f64, percent: f64) {
    let kernel = if kind == BondLawKind::BondBased { Kernel::Constant } else { Kernel::Conical };
    let law = BondLaw { kind, kernel, rotation: Rotation::Free, surface_correction: SurfaceCorrection::VolumeAndSurface };
    let (found, table) = (found(kind, spacing), trapping(&law, 3.015));
    let error = 100.0 * (found / table - 1.0);
    println!("{kind}: {found:.3}, table {table}, {error:+.1} %");
    assert!(error.abs() < percent, "{kind}: {found:.3} for {table}");
}

/// At 25 spacings a crack the tip is on its way to its full resistance.
#[test]
fn the_trapping_of_the_default_law_is_that_of_its_lattice() {
    assert_table(BondLawKind::TwoParameter, 0.02, 8.0);
}

#[test]
#[ignore = "long: two minutes; cargo test scene_strength -- --ignored --nocapture"]
fn trapping_is_that_of_the_lattice_at_fifty_spacings() {
    for kind in [BondLawKind::TwoParameter, BondLawKind::BondBased] {
        assert_table(kind, 0.01, 6.0);
    }
}

/// Griffith's load by finite elements is 636 N; it was 815 N at 0.02 mm and 792 N at 0.01 mm.
fn field_load(set: &[&str]) -> Option<f64> {
    let path = shared("field/mechanics4/scene_strength/sent_tension.toml")?;
    let overrides: Vec<String> = set.iter().map(|key| (*key).to_owned()).collect();
    let run = perilife_scenes::run(&Scene::from_file(&path, &overrides).unwrap(), &Silent).unwrap();
    println!("{set:?}: {:.1} N", run.peak_load());
    Some(run.peak_load())
}

#[test]
#[ignore = "long: half a minute and two minutes; cargo test scene_strength -- --ignored --nocapture"]
fn a_notched_square_bears_what_its_fracture_energy_says() {
    for spacing in ["model.spacing_mm=0.02", "model.spacing_mm=0.01"] {
        let Some(load) = field_load(&[spacing]) else { return };
        assert!((load / 636.0 - 1.0).abs() < 0.06, "{spacing}: {load} N");
    }
}

/// Published: two branches. It was one crack to the far side.
#[test]
fn a_plate_under_1_mpa_branches() {
    let Some(path) = shared("field/mechanics4/scene_strength/branching_1mpa.toml") else { return };
    let run = perilife_scenes::run(&Scene::from_file(&path, &[]).unwrap(), &Silent).unwrap();
    let rows = perilife_study::moving::cracked_rows(&run, 0.04);
    assert!(rows.iter().any(|y| *y > 5e-3) && rows.iter().any(|y| *y < -5e-3), "cracked rows {rows:?}");
    assert!(rows.iter().all(|y| y.abs() > 2e-3), "nothing between the branches: {rows:?}");
}

/// The remedy for cracks of few spacings is told, and no more from the length on from which Griffith's load is met.
#[test]
fn a_crack_of_few_spacings_is_told() {
    let lines = |set: &str| {
        let scene = Scene::from_toml(value("square").as_str().unwrap(), "square", Path::new("."), &[set.to_owned()]).unwrap();
        preview(&scene).unwrap().warnings
    };
    assert!(lines("model.spacing_mm=0.02").iter().any(|line| line.contains("25 spacings") && line.contains("0.0100")));
    assert!(lines("model.spacing_mm=0.01").is_empty());
    assert!(lines("damage.calibration=bond_energy").is_empty());
}
