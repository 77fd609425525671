//! Scenes by their default law where material turns: bending, shear, flanks of a crack. References are finite elements of the same
//! plates (`mechanics/scene_default_law` of the shared data).

use perilife_growth::predict::Silent;
use perilife_scenes::{Fracture, Scene};

use crate::support::shared::shared;

fn scene(file: &str, set: &[&str]) -> Option<Scene> {
    let path = shared(&format!("field/mechanics/scene_default_law/{file}.toml"))?;
    let overrides: Vec<String> = set.iter().map(|key| (*key).to_owned()).collect();
    Some(Scene::from_file(&path, &overrides).unwrap())
}

fn run(file: &str, set: &[&str]) -> Option<Fracture> {
    scene(file, set).map(|scene| perilife_scenes::run(&scene, &Silent).unwrap())
}

fn assert_within(what: &str, found: f64, reference: f64, percent: f64) {
    let error = 100.0 * (found / reference - 1.0);
    println!("{what}: {found:.5}, reference {reference}, {error:+.2} %");
    assert!(error.abs() <= percent, "{what}: {found} is {error:+.2} % from {reference}, bound {percent} %");
}

/// Arms 40 x 10 mm whose ends go apart by 0.1 mm each: 19.9 N by finite elements; beam theory with the root correction of 0.67 h/a
/// about 20 N. Springs that resist a turn gave 795 N.
#[test]
fn arms_bend_as_beams_do() {
    let Some(run) = run("double_cantilever", &[]) else { return };
    assert!(run.warnings.is_empty(), "{:?}", run.warnings);
    assert_within("double cantilever, N", run.peak_load(), 19.9, 10.0);
}

/// Opening at the middle of a crack of 10 mm in a square of 50 mm under 50 MPa, mm: displacement of the rows beside it.
#[test]
fn a_crack_opens_as_by_finite_elements() {
    let Some(run) = run("crack_opening", &[]) else { return };
    let (grid, last) = (&run.grid, run.snapshots.last().unwrap());
    let mean_of = |side: f64| {
        let at = |x: f64| {
            let place = [x, 0.25e-3 * side].map(|x| x);
            let [c, r] = [0, 1].map(|i| ((place[i] - grid.origin[i]) / grid.spacing).round() as usize);
            last.displacement[grid.point_at[r * grid.columns + c].unwrap() as usize][1]
        };
        0.5 * (at(-0.25e-3) + at(0.25e-3))
    };
    assert_within("opening, mm", 1e3 * (mean_of(1.0) - mean_of(-1.0)), 0.01464, 6.0);
}

/// A square of 1 mm with an edge crack, its top moved sideways: the crack turns down as the largest circumferential stress has it.
/// Path and load of finite elements with linear fracture mechanics.
fn sheared_square(spacing: f64, path: &[[f64; 2]]) {
    let Some(run) = run("shear_notched_square", &[&format!("model.spacing_mm={spacing}")]) else { return };
    let first = run.history.iter().find(|row| (row.displacement - 1e-6).abs() < 1e-12).expect("a row at 0.001 mm");
    assert_within("sheared square at 0.001 mm, N", first.load, 46.8, 4.0);
    let fronts: Vec<_> = run.path.iter().filter(|at| at.tip == 0).collect();
    let way: Vec<[f64; 2]> = fronts.iter().map(|at| at.position.map(|x| 1e3 * x)).collect();
    let mut last = 0;
    for &[y, x] in path {
        let after = way.iter().position(|at| at[1] <= y).unwrap_or_else(|| panic!("the path ends above {y}: {way:?}"));
        let (a, b) = (way[after - 1], way[after]);
        let found = a[0] + (b[0] - a[0]) * (y - a[1]) / (b[1] - a[1]);
        println!("path at y = {y} mm: {found:.4}, {x}");
        last = fronts[after].step;
        assert!((found - x).abs() <= 0.03, "path at y = {y} mm: {found} instead of {x}");
    }
    // Beyond, the plate hangs by its held rows, and the load rises again.
    let loads = || run.history.iter().filter(|row| row.step <= last).map(|row| row.load);
    let (peak, fallen) = (loads().fold(0.0, f64::max), loads().next_back().unwrap());
    assert!(fallen < 0.95 * peak, "load {fallen} N at the last place, {peak} N at the most");
}

const PATH: [[f64; 2]; 5] = [[-0.11, 0.035], [-0.19, 0.071], [-0.27, 0.114], [-0.33, 0.152], [-0.39, 0.197]];

/// Points coarser than those of the file, by which the last place is not reached.
#[test]
fn a_sheared_square_cracks_as_by_finite_elements() {
    sheared_square(0.025, &PATH[..4]);
}

#[test]
#[ignore = "long: half a minute; cargo test scene_default_law -- --ignored --nocapture"]
fn a_sheared_square_of_finer_points_cracks_as_by_finite_elements() {
    sheared_square(0.02, &PATH);
}
