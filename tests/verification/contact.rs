//! Cracks that the load presses together.

use std::f64::consts::PI;
use std::path::Path;

use perilife_growth::case::Case;
use perilife_growth::cracks::initial_tips;
use perilife_growth::points::PointPlate;
use perilife_growth::predict::tip_factors::{StressIntensityMethod, stress_intensity};
use perilife_growth::predict::{Prediction, Silent, predict};
use perilife_growth::record::CurvePoint;
use perilife_plate::specimen::Point;
use perilife_plate::specimen::geometry::segments_touch;
use perilife_points::body::pre_crack::cutting_line;
use perilife_points::crack_tip::TipState;
use perilife_points::solver::{SolverKind, Symmetry};
use perilife_scenes::bonds::BondState;
use perilife_scenes::contact::NetContact;
use perilife_scenes::quasi_static::equilibrium::{Equilibrium, FullLoad, Shape};
use perilife_scenes::{Fracture, Scene, boundary::Boundary};
use perilife_study::cases::POINTS;

use crate::support::plates::cracks;
use crate::support::shared::shared;

// Flanks of cracks that the load presses together: a closed crack is none across itself, and free to slide and to turn.

/// A plate of 60 x 100 mm pressed by 0.07 mm.
const PRESSED: &str = "[specimen]\nkind = \"plate\"\nwidth_mm = 60\nlength_mm = 100\nthickness_mm = 1\nCRACKS\n\
                       [material]\nyoungs_modulus_gpa = 70\npoisson_ratio = 0.2\ndensity_kg_m3 = 2700\nfracture_energy_j_m2 = 500\n\
                       [model]\nbond_law = \"two_parameter\"\nspacing_mm = 1\n\
                       [loading]\nkind = \"displacement\"\ndisplacement_mm = -0.07\nedges = [\"top\"]\n\
                       [supports]\nbottom = { fix = [\"y\"] }\npin = { from_mm = [-1, -50], to_mm = [1, -49], fix = [\"x\"] }\n";

/// The plate with a slit of 20 mm about its middle, turned by so many degrees.
fn slit(degrees: f64) -> String {
    let (sin, cos) = degrees.to_radians().sin_cos();
    PRESSED.replace("CRACKS", &cracks(&[[-10.0, 10.0].map(|x| [x * cos, x * sin])]))
}

fn scene(text: &str, set: &[&str]) -> Scene {
    let overrides: Vec<String> = set.iter().map(|key| (*key).to_owned()).collect();
    Scene::from_toml(text, "pressed", Path::new("."), &overrides).unwrap()
}

fn run(text: &str, set: &[&str]) -> Fracture {
    perilife_scenes::run(&scene(text, set), &Silent).unwrap()
}

fn without(set: &[&str]) -> f64 {
    run(&PRESSED.replace("CRACKS", ""), set).peak_load()
}

/// 2940 N is E ε W t. Faces that pass through each other gave 2667 N.
#[test]
fn a_plate_pressed_across_a_slit_is_as_stiff_as_one_without() {
    let Some(path) = shared("field/mechanics/closed_crack/scene_pressed_slit.toml") else { return };
    let run = perilife_scenes::run(&Scene::from_file(&path, &[]).unwrap(), &Silent).unwrap();
    let flanks = run.figures.touching.unwrap();
    println!("load {} N, {} of {} columns pressed", run.peak_load(), flanks.pressed, flanks.columns);
    let none = "specimen.cracks=[]".to_owned();
    let whole = perilife_scenes::run(&Scene::from_file(&path, &[none]).unwrap(), &Silent).unwrap().peak_load();
    assert!((run.peak_load() / whole - 1.0).abs() < 0.002, "{} N, {whole} N without slit", run.peak_load());
    // Driven and held rows of points lie half a spacing inside the plate, which is so much shorter: 1.8 % with and without slit.
    assert!((run.peak_load() / 2940.0 - 1.0).abs() < 0.02, "{} N", run.peak_load());
    assert!(flanks.share() > 0.95 && run.warnings.is_empty(), "{flanks:?}, {:?}", run.warnings);
    // Faces in touch: between the rows beside the slit there is the strain of the plate, and no more.
    let (grid, last) = (&run.grid, run.snapshots.last().unwrap());
    let of_row = |y: f64| {
        let [c, r] = [0, 1].map(|i| (([0.5e-3, y][i] - grid.origin[i]) / grid.spacing).round() as usize);
        last.displacement[grid.point_at[r * grid.columns + c].unwrap() as usize][1]
    };
    let shortened = of_row(-0.5e-3) - of_row(0.5e-3);
    assert!((0.5..2.0).contains(&(shortened / 0.7e-6)), "{shortened} m between the faces");
}

/// A frictionless slit slides, and the plate is softer by the energy of `K_II = σ √(π a sec(π a cos φ / W)) sin φ cos φ`: at constant
/// load the strain energy rises by `∫ K_II²/E` over both halves, a share of `2 π a² sec sin²φ cos²φ / (W L)`. By every law of springs.
fn slide_without_friction(law: &str, nu: &str, correction: &str, angles: &[f64]) {
    let keys = format!("model.bond_law={law} material.poisson_ratio={nu} model.surface_correction={correction}");
    let set: Vec<&str> = keys.split(' ').collect();
    let whole = without(&set);
    for degrees in angles {
        let (sin, cos) = f64::to_radians(*degrees).sin_cos();
        let widened = 1.0 / (PI * 10.0 * cos / 60.0).cos();
        let right = 1.0 - 2.0 * PI * 100.0 * widened * (sin * cos).powi(2) / (60.0 * 100.0);
        let run = run(&slit(*degrees), &set);
        let share = run.peak_load() / whole;
        println!("{law}, {correction}, {degrees}°: {share:.4}, {right}, {:?}", run.figures.touching);
        assert!((share - right).abs() < 0.002, "{law}, {correction}, {degrees}°: {share} of the plate without slit");
    }
}

/// Laws of springs with a Poisson's ratio that each can represent.
const SPRINGS: [(&str, &str); 3] =
    [("two_parameter", "0.2"), ("one_bond_two_parameter", "0.3"), ("bond_based", "0.3333333333333333")];

#[test]
fn closed_slits_slide_without_friction() {
    for (law, nu) in SPRINGS {
        slide_without_friction(law, nu, "balanced", &[20.0]);
    }
    // Straight and turned the other way.
    slide_without_friction("two_parameter", "0.2", "volume_and_surface", &[0.0, -20.0]);
}

#[test]
#[ignore = "long: half a minute; cargo test contact -- --ignored --nocapture"]
fn all_closed_slits_slide_without_friction() {
    for (law, nu) in SPRINGS {
        for correction in ["volume_and_surface", "balanced"] {
            slide_without_friction(law, nu, correction, &[0.0, 20.0, -20.0]);
        }
    }
}

/// Columns that are all pressed store nothing while the plate turns, or one side of a slit slides along the other.
#[test]
fn contact_is_free_under_turning_and_sliding() {
    for degrees in [0.0, 20.0, -37.0, 90.0] {
        for discretisation in ["lattice", "dual_horizon"] {
            let (sin, cos) = f64::to_radians(degrees).sin_cos();
            let long = cracks(&[[-29.0, 29.0].map(|x| [x * cos, x * sin])]);
            let key = format!("model.discretisation={discretisation}");
            let set = [key.as_str(), "refinement.regions=[{box_mm=[[-20,-20],[20,20]],levels=1}]"];
            let scene = scene(&PRESSED.replace("CRACKS", &long), if discretisation == "lattice" { &[] } else { &set });
            let (net, _) = perilife_scenes::build(&scene).unwrap();
            let bonds = BondState::new(&net, &vec![false; net.len()]);
            let mut contact = NetContact::new(&net, &scene.specimen.cracks);
            contact.press_all(&bonds);
            let columns = contact.touching();
            assert!(columns.columns > 500 && columns.pressed == columns.columns, "{columns:?}");
            let energy = |field: &dyn Fn(Point) -> Point| {
                let of = |&x: &Point| {
                    let [x, y] = field(x);
                    [x, y, 0.0].into_iter().take(net.unknowns)
                };
                let u: Vec<f64> = net.positions.iter().flat_map(of).collect();
                let mut force = vec![0.0; u.len()];
                let energy = contact.push(&u, &mut force);
                let resultant = (0..2).map(|c| force.iter().skip(c).step_by(net.unknowns).sum::<f64>().abs()).fold(0.0, f64::max);
                let most = force.iter().fold(0.0, |a: f64, f| a.max(f.abs()));
                assert!(resultant <= 1e-9 * most || energy < 1e-20, "{resultant} N");
                energy
            };
            let above = |[x, y]: Point| y * cos - x * sin > 0.0;
            let pressed = energy(&|[x, y]| [1e-3 * sin * (y * cos - x * sin), -1e-3 * cos * (y * cos - x * sin)]);
            let turned = energy(&|[x, y]| [-1e-3 * y, 1e-3 * x]);
            let slid = energy(&|x| if above(x) { [1e-4 * cos, 1e-4 * sin] } else { [0.0, 0.0] });
            assert!(turned < 1e-18 * pressed, "{degrees}°, {discretisation}: {turned:e}, {slid:e}, {pressed:e} J");
            assert!(slid < 1e-18 * pressed, "{degrees}°, {discretisation}: {turned:e}, {slid:e}, {pressed:e} J");
        }
    }
}

/// Bonds that broke across a line are a crack that grew: its plane is found, and contact is that of a slit that was there.
fn closes_alike(angles: &[f64]) {
    for degrees in angles.iter().copied() {
        let load = |scene: &Scene, broken: &dyn Fn(Point, Point) -> bool| {
            let (net, _) = perilife_scenes::build(scene).unwrap();
            let boundary = Boundary::of(scene, &net).unwrap();
            let full = FullLoad::of(&net, &boundary).unwrap();
            let mut bonds = BondState::new(&net, &boundary.no_fail);
            for (b, bond) in net.bonds.iter().enumerate() {
                if broken(net.positions[bond.from as usize], net.positions[bond.to as usize]) {
                    bonds.share[b] = 0.0;
                }
            }
            let mut shape = Shape::at_rest(full.held.len());
            let mut equilibrium = Equilibrium::new(&net, &scene.specimen.cracks, &full).unwrap();
            equilibrium.solve(&mut bonds, &mut shape).unwrap();
            (boundary.measure(net.unknowns, 1.0, &shape.u, &shape.force).1, equilibrium.touching())
        };
        let was_there = load(&scene(&slit(degrees), &[]), &|_, _| false);
        let (sin, cos) = f64::to_radians(degrees).sin_cos();
        let [p, q] = cutting_line(1e-3, [-1e-2 * cos, -1e-2 * sin], [1e-2 * cos, 1e-2 * sin]);
        let grew = load(&scene(&PRESSED.replace("CRACKS", ""), &[]), &|a, b| segments_touch(a, b, p, q));
        assert!((grew.0 / was_there.0 - 1.0).abs() < 0.002, "{degrees}°: {grew:?}, {was_there:?}");
        assert!(grew.1.pressed as f64 > 0.95 * was_there.1.pressed as f64, "{degrees}°: {grew:?}, {was_there:?}");
    }
}

#[test]
fn a_crack_that_grew_closes_as_one_that_was_there() {
    closes_alike(&[20.0]);
}

#[test]
#[ignore = "long: ten seconds; cargo test contact -- --ignored --nocapture"]
fn a_crack_that_grew_straight_closes_as_one_that_was_there() {
    closes_alike(&[0.0]);
}

/// Open cracks have no pressed column, and where there is no contact overlap is told.
#[test]
fn overlap_is_told_where_nothing_keeps_flanks_apart() {
    // Coarse points: nothing here is compared but words.
    const COARSE: &str = "model.spacing_mm=2";
    let pulled = run(&slit(20.0), &[COARSE, "loading.displacement_mm=0.07"]);
    assert!(pulled.figures.touching.unwrap().pressed == 0 && pulled.warnings.is_empty(), "{:?}", pulled.warnings);
    let ways: [(&[&str], &str); 3] = [
        (&["loading.steps=1", "model.solver=adaptive_dynamic_relaxation"], "solver = \"adaptive_dynamic_relaxation\""),
        (&["model.bond_law=correspondence"], "bond_law = \"correspondence\""),
        (&["loading.duration_s=1e-4", "loading.ramp_s=1e-4"], "motion in time"),
    ];
    for (way, words) in ways {
        let told = |run: &Fracture| run.warnings.iter().any(|w| w.contains("crack faces overlap") && w.contains(words));
        let way = &[&[COARSE][..], way].concat();
        let pressed = run(&slit(0.0), way);
        assert!(told(&pressed) && pressed.figures.touching.is_none(), "{way:?}: {:?}", pressed.warnings);
        let set = [&way[..], &["loading.displacement_mm=0.07"]].concat();
        assert!(!told(&run(&slit(0.0), &set)), "{way:?}, pulled");
    }
}

// Cracks that the load presses together: they do not grow, and carry as if they were not there.
//
// Plates of `../shared/data/field/mechanics/closed_crack`, exact by symmetry or finite elements as said there.

fn pressed(name: &str) -> Option<Case> {
    shared(&format!("field/mechanics/closed_crack/{name}.toml")).map(|path| Case::from_file(&path, &[POINTS.to_owned()]).unwrap())
}

fn last(run: &Prediction) -> &CurvePoint {
    run.curve.last().unwrap()
}

/// On the middle line of a plate with a level crack there is no shear and only pressure across: a crack there changes nothing.
#[test]
fn a_closed_crack_above_an_open_one_changes_nothing() {
    let (Some(one), Some(both)) = (pressed("one"), pressed("closed_above")) else { return };
    let (one, both) = (predict(&one, &Silent).unwrap(), predict(&both, &Silent).unwrap());
    assert!((last(&both).cycles / last(&one).cycles - 1.0).abs() < 0.005);
    for (tip, alone) in both.curve[0].tips.iter().zip(&one.curve[0].tips) {
        let [k_i, k_ii] = tip.factors.unwrap();
        assert!((k_i / alone.factors.unwrap()[0] - 1.0).abs() < 0.002 && (k_ii / k_i).abs() < 0.002, "{tip:?}");
    }
    let tips = &last(&both).tips;
    assert!(tips[..2].iter().all(|tip| tip.position[1].abs() < 0.05e-3 && tip.growth > 39e-3), "{tips:?}");
    // When next to nothing is left of the plate, a lower tip may open.
    for point in &both.curve {
        assert!(point.tips[2..].iter().all(|tip| tip.growth < 1e-6), "{point:?}");
        assert!(point.crack_length > 0.1 || point.tips[2..].iter().all(|tip| tip.state == TipState::Closed), "{point:?}");
    }
    assert!(both.warnings.iter().any(|warning| warning.contains("tip 2, 3 is closed by the load")), "{:?}", both.warnings);
}

/// By the part of the plate that stands for it and by the whole.
#[test]
fn contact_is_the_same_by_every_solver() {
    let Some(path) = shared("field/mechanics/closed_crack/closed_above.toml") else { return };
    let case = Case::from_file(&path, &["model.spacing_mm=2".to_owned()]).unwrap();
    let factors = |solver: SolverKind, symmetry: Symmetry| {
        let mut case = case.clone();
        let points = case.model.points_mut().unwrap();
        (points.solver, points.symmetry, points.residual) = (solver, symmetry, 1e-9);
        let tips = stress_intensity(&case, &[StressIntensityMethod::Ring]).unwrap();
        tips.iter().map(|tip| [tip.methods[0].intensity.k_i.unwrap(), tip.methods[0].intensity.k_ii.unwrap()]).collect::<Vec<_>>()
    };
    let reference = factors(SolverKind::Multigrid, Symmetry::Off);
    for (solver, symmetry) in [(SolverKind::Window, Symmetry::Auto), (SolverKind::Window, Symmetry::Off)] {
        for (tip, reference) in factors(solver, symmetry).iter().zip(&reference) {
            let differs = (0..2).map(|mode| (tip[mode] - reference[mode]).abs()).fold(0.0, f64::max);
            assert!(differs < 1e-5 * reference[0].max(1e6), "{solver}, {symmetry}: {tip:?}, {reference:?}");
        }
    }
}

/// A crack on the pressed side of a beam that has begun to grow aside has one K wherever the nodes are: on their lines and beside them. With fine
/// nodes next to ones four times as far apart the flanks carried a fifth less at the mouth, and K was 5 % lower.
#[test]
fn flanks_are_pressed_alike_wherever_the_nodes_are() {
    let at = |x: f64| {
        let text = format!(
            "[specimen]\nkind = \"plate\"\nwidth_mm = 200\nlength_mm = 50\nthickness_mm = 5\n\
             cracks = [{{ path_mm = [[{x}, 25], [{x}, 10], [{}, 9.435]] }}]\n\
             [material]\nyoungs_modulus_gpa = 70\npoisson_ratio = 0.3\nplane = \"stress\"\n\
             [loading]\nforce_max_n = 5000\nstress_ratio = 0.1\nrollers = [{{ at_mm = [0, 25], contact_width_mm = 6, share = 1 }}, \
             {{ at_mm = [-80, -25], contact_width_mm = 6, share = 0.5 }}, {{ at_mm = [80, -25], contact_width_mm = 6, share = 0.5 }}]\n\
             [fatigue]\nparis_c_mm_per_cycle = 1e-7\nparis_m = 3\n",
            x + 2.9
        );
        let case = Case::from_toml(&text, "pressed", Path::new("."), &[]).unwrap();
        let tip = stress_intensity(&case, &[StressIntensityMethod::ElementFreeGalerkin]).unwrap().remove(0);
        assert_eq!(tip.methods[0].note, None);
        tip.methods[0].intensity.k_i.unwrap() / 1e6
    };
    let [left, on, right] = [19.87, 20.0, 20.13].map(at);
    println!("K_I {left}, {on}, {right} MPa√m");
    // Over this distance K is linear.
    assert!((2.0 * on / (left + right) - 1.0).abs() < 0.0015, "{left}, {on}, {right}");
}

/// An open crack towards a closed one: it lives as long as right, and the closed one stands until it has come to the edge.
#[test]
fn a_closed_crack_ahead_stands_still() {
    let Some(case) = pressed("closed_ahead") else { return };
    let run = predict(&case, &Silent).unwrap();
    // Until a tip of the open crack has left the plate.
    let through = run.curve.iter().find(|point| point.tips.iter().any(|tip| tip.state == TipState::LeftPlate)).unwrap();
    assert!(through.tips[2..].iter().all(|tip| tip.growth < 0.01e-3), "{:?}", through.tips);
    assert!((through.cycles / 86e3 - 1.0).abs() < 0.01, "{}", through.cycles);
}

/// K of `sif` is that of the first row of `predict`, with closed tips too.
#[test]
fn sif_reads_what_predict_reads() {
    let folder = Path::new("data/cases");
    let names = ["slant_crack_plate", "compact_tension", "two_cracks_plate"];
    let cases = names.map(|name| Case::from_file(&folder.join(format!("{name}.toml")), &[]).unwrap());
    for mut case in cases.into_iter().chain(pressed("closed_above")) {
        let tips = stress_intensity(&case, &[StressIntensityMethod::Ring]).unwrap();
        case.stop.cycles_max = 1.0;
        let run = predict(&case, &Silent).unwrap();
        for (tip, row) in tips.iter().zip(&run.curve[0].tips) {
            let result = &tip.methods[0];
            let [k_i, k_ii] = row.factors.unwrap();
            let found = [result.intensity.k_i, result.intensity.k_ii, result.t_stress];
            assert_eq!(found, [Some(k_i), Some(k_ii), row.t_stress], "{}", case.name);
            assert_eq!(result.is_closed, row.state == TipState::Closed, "{}", case.name);
        }
    }
}

/// A crack along a pull of 50 MPa that a pressure of 50 MPa holds shut: faces in contact carry that pressure, K_I is zero, and T is the pull.
#[test]
fn t_along_a_pressed_crack() {
    let Some(case) = pressed("closed_tilted") else { return };
    for tip in initial_tips::<PointPlate>(&case).unwrap().tips {
        let (factors, t_stress) = (tip.factors.unwrap(), tip.t_stress.unwrap());
        assert!(factors[0] == 0.0 && (t_stress / 50e6 - 1.0).abs() < 0.01, "{factors:?}, {t_stress}");
    }
}
