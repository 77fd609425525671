//! Scenes without time: the nonlinear law, both solvers, falling displacement, energies.

use std::path::Path;

use perilife_growth::predict::Silent;
use perilife_scenes::scene::{Procedure, SceneSolver, Softening};
use perilife_scenes::{Fracture, Scene, SceneEnd};

/// Law of Q345 with a final stretch of so many times the one of the largest force.
fn q345(ratio: f64) -> Softening {
    Softening { elastic: 345e6 / 203e9, peak: 572e6 / 203e9, last: ratio * 572e6 / 203e9, printed: false }
}

/// Law of Li, Lü, Huang and Yang 2024, J. Ship Mech. 28:103, equation 19: D(s_nt) = 0.328, largest (1-D) s = 1.895e-3 at s_nt exactly, share left at s_t.
#[test]
fn nonlinear_law_has_the_curve_of_the_theory() {
    let law = q345(3.0);
    assert!((1.0 - law.share(law.peak) - 0.328).abs() < 5e-4);
    let force = |s: f64| law.share(s) * s;
    assert!((force(law.peak) - 1.895e-3).abs() < 5e-7);
    for step in 1..1000 {
        let s = law.last * f64::from(step) / 1000.0;
        assert!(force(s) <= force(law.peak) * (1.0 + 1e-12));
    }
    // Continuous at the end of the linear part; its slope there is 1, just beyond it 1 - s_et/s_nt.
    assert!((force(law.elastic * (1.0 + 1e-9)) - force(law.elastic)).abs() < 1e-11);
    for (ratio, left) in [(2.0, 0.247), (3.0, 0.091), (5.0, 0.012)] {
        let law = q345(ratio);
        assert!((law.share(law.last) - left).abs() < 6e-4, "{}", law.share(law.last));
        assert_eq!(law.share(law.last * 1.000_001), 0.0);
        // The curve backwards, and the energy under it by a fine sum.
        for share in [0.9, 0.5, 0.3] {
            assert!((law.share(law.stretch_at(share)) - share).abs() < 1e-12);
        }
        let (mut sum, mut before) = (0.0, 1.0);
        for i in 1..=200_000 {
            let s = law.last * f64::from(i) / 200_000.0;
            let after = law.share(s);
            sum += s * s * (before - after);
            before = after;
        }
        let curve = law.square_sum([1.0, law.share(law.last)]);
        assert!((sum / curve - 1.0).abs() < 1e-4, "{sum} {curve}");
    }
}

/// As printed, equations (20) and (21) let the force drop to 0 just above s_et and jump again at s_nt.
#[test]
fn printed_law_drops_where_the_source_has_it() {
    let law = Softening { printed: true, ..q345(3.0) };
    assert_eq!(law.share(law.elastic), 1.0);
    assert!(law.share(law.elastic * 1.000_001) < 1e-5);
    assert!((law.share(law.peak) - 0.328).abs() < 5e-4);
    assert!((law.share(law.peak * 1.000_001) - 0.672).abs() < 5e-4);
}

/// A plate of `width` x `length` mm with two notches of a quarter of its width, points 1 mm apart, pulled at both ends in 100 steps.
fn notched([width, length]: [f64; 2], pull: f64, more: &str) -> Scene {
    let (rim, root) = (0.5 * width, 0.25 * width);
    let text = format!(
        "[specimen]\nkind = \"plate\"\nwidth_mm = {width}\nlength_mm = {length}\nthickness_mm = 4.0\n\
         notches = [{{ from_mm = [-{rim}, 0.0], to_mm = [-{root}, 0.0], width_mm = 2.0 }}, {{ from_mm = [{rim}, 0.0], to_mm = [{root}, 0.0], \
         width_mm = 2.0 }}]\n[material]\nyoungs_modulus_gpa = 203.0\npoisson_ratio = 0.3\nyield_strength_mpa = 345.0\n\
         tensile_strength_mpa = 572.0\n[model]\nbond_law = \"two_parameter\"\nrotation = \"resisted\"\nkernel = \"conical\"\nspacing_mm = 1.0\n\
         [loading]\nkind = \"displacement\"\nedges = [\"top\", \"bottom\"]\ntransverse = \"held\"\ndisplacement_mm = {pull}\nsteps = 100\n\
         [damage]\nlaw = \"nonlinear_two_parameter\"\nfinal_ratio = 3.0\n{more}"
    );
    Scene::from_toml(&text, "notched", Path::new("."), &[]).unwrap()
}

fn run(scene: &Scene, solver: SceneSolver) -> Fracture {
    let scene = Scene { model: perilife_scenes::scene::SceneModel { solver, ..scene.model.clone() }, ..scene.clone() };
    perilife_scenes::run(&scene, &Silent).unwrap()
}

/// Load of a history at a displacement on its way up to the peak.
fn load_at(history: &Fracture, displacement: f64) -> f64 {
    let rows = &history.history;
    let after = rows.iter().position(|row| row.displacement >= displacement).unwrap();
    let (a, b) = (if after == 0 { Default::default() } else { rows[after - 1] }, rows[after]);
    a.load + (b.load - a.load) * (displacement - a.displacement) / (b.displacement - a.displacement)
}

/// Before the peak both solvers give one curve, within 1e-3; the path then snaps back (the displacement falls by more than a
/// tenth with the load), where relaxation, which only goes forward, has to stop or jump.
fn agree_before_the_peak(scene: &Scene) {
    let secant = run(scene, SceneSolver::Secant);
    assert_eq!(secant.end, SceneEnd::Separated);
    let peak = secant.history.iter().max_by(|a, b| a.load.total_cmp(&b.load)).unwrap();
    let after: Vec<_> = secant.history.iter().filter(|row| row.step > peak.step).collect();
    let least = after.iter().map(|row| row.displacement).fold(f64::INFINITY, f64::min);
    assert!(least < 0.9 * peak.displacement, "{least} {}", peak.displacement);
    for row in &secant.history {
        let nowhere = row.work - row.strain - row.fracture;
        assert!(nowhere.abs() <= 5e-3 * row.work.max(1e-12), "step {}: {nowhere:e} of {:e}", row.step, row.work);
    }
    let relaxed = run(scene, SceneSolver::AdaptiveDynamicRelaxation);
    for row in relaxed.history.iter().filter(|row| row.displacement < 0.98 * peak.displacement) {
        let other = load_at(&secant, row.displacement);
        assert!((row.load / other - 1.0).abs() < 1e-3, "at {} m: {} and {other} N", row.displacement, row.load);
    }
    assert!((relaxed.peak_load() / secant.peak_load() - 1.0).abs() < 0.01);
    // Beyond the peak no rest is near: the run ends there by name, histories kept.
    assert_ne!(relaxed.end, SceneEnd::Done);
}

#[test]
fn both_solvers_agree_before_the_peak_and_the_path_survives_snap_back() {
    agree_before_the_peak(&notched([12.0, 42.0], 0.05, ""));
}

#[test]
#[ignore = "long: half a minute; cargo test quasi_static -- --ignored --nocapture"]
fn both_solvers_agree_on_a_larger_plate() {
    agree_before_the_peak(&notched([20.0, 70.0], 0.06, ""));
}

/// The damage of a plate that is its own mirror image is mirrored, point by point, at least until the load has fallen to half
/// its peak; the last bonds of a torn ligament break one by one, and round-off decides which is first.
#[test]
fn symmetric_plates_are_damaged_symmetrically() {
    let found = run(&notched([20.0, 30.0], 0.03, ""), SceneSolver::Secant);
    let grid = &found.grid;
    let is_mirrored = |damage: &[f64]| {
        let at = |column: usize, row: usize| grid.point_at[row * grid.columns + column].map(|p| damage[p as usize]);
        let twins = |column: usize, row: usize| [at(grid.columns - 1 - column, row), at(column, grid.rows - 1 - row)];
        (0..grid.rows).all(|row| (0..grid.columns).all(|column| twins(column, row) == [at(column, row); 2]))
    };
    let peak = found.history.iter().max_by(|a, b| a.load.total_cmp(&b.load)).unwrap();
    let first = found.history.iter().find(|row| row.step > peak.step && row.load < 0.5 * peak.load).unwrap();
    let early = found.snapshots.iter().filter(|state| state.cycles <= first.step as f64);
    assert!(early.clone().any(|state| state.damage.iter().any(|d| *d > 0.0)), "something is broken");
    for state in early {
        assert!(is_mirrored(&state.damage), "step {}", state.cycles);
    }
}

/// A plate that hangs by its last bonds alone has no equilibrium that flanks could hold: pulled on, it is severed, whatever its peak
/// was before. With columns that pull it stood as stiff as without a crack (6.09 instead of 3.41 kN).
#[test]
fn pulled_on_beyond_severing_the_plate_is_severed() {
    let pulled = |displacement: f64| {
        let text = format!(
            "[specimen]\nkind = \"plate\"\nwidth_mm = 20\nlength_mm = 40\nthickness_mm = 1\n\
             cracks = [{{ from_mm = [-4, 0], to_mm = [4, 0] }}]\n\
             [material]\nyoungs_modulus_gpa = 192\npoisson_ratio = 0.3\nfracture_energy_j_m2 = 2000\n\
             [model]\nspacing_mm = 1\nsolver = \"secant\"\n\
             [loading]\nkind = \"displacement\"\nedges = [\"top\", \"bottom\"]\ndisplacement_mm = {displacement}\nsteps = 16\n\
             [damage]\nlaw = \"critical_stretch\"\n"
        );
        perilife_scenes::run(&Scene::from_toml(&text, "pulled", Path::new("."), &[]).unwrap(), &Silent).unwrap()
    };
    let [short, long] = [0.1, 0.15].map(pulled);
    assert!((long.peak_load() / short.peak_load() - 1.0).abs() < 1e-6, "{} {}", long.peak_load(), short.peak_load());
    assert_eq!(long.end, SceneEnd::Separated);
    let last = long.history.last().unwrap();
    assert!(last.load < 1e-3 * long.peak_load(), "{}", last.load);
    // What neither strain nor fracture took has become motion: none came from nowhere.
    assert!(long.history.iter().all(|row| row.work - row.strain - row.fracture > -1e-3 * row.work.abs()));
}

#[test]
fn loads_out_of_balance_are_refused() {
    let text = "[specimen]\nkind = \"plate\"\nwidth_mm = 20.0\nlength_mm = 40.0\nthickness_mm = 4.0\n[material]\nyoungs_modulus_gpa = \
                203.0\npoisson_ratio = 0.3\n[model]\nbond_law = \"two_parameter\"\nspacing_mm = 1.0\n[loading]\nkind = \"traction\"\nedges = \
                [\"top\", \"bottom\"]\nstress_mpa = 10.0\n";
    let mut scene = Scene::from_toml(text, "pulled", Path::new("."), &[]).unwrap();
    assert_eq!(scene.procedure, Procedure::Static);
    perilife_scenes::run(&scene, &Silent).unwrap();
    // The reader sees to balance; a scene made otherwise may lack it.
    scene.specimen.loads.pop();
    let refusal = perilife_scenes::run(&scene, &Silent).unwrap_err().to_string();
    assert!(refusal.contains("balance"), "{refusal}");
}
