//! A symmetric plate solved on its half or quarter against the whole, and mirror images.

use perilife_growth::case::Case;
use perilife_growth::cracks::initial_tips;
use perilife_growth::points::PointPlate;
use perilife_growth::predict::{Silent, predict};
use perilife_points::body::pre_crack::bonds_across;
use perilife_points::solver::{Equilibrium, SolverKind, Symmetry};
use perilife_points::state::Bonds;

use crate::support::plates::{BOND_STRAIN, TIP_FIELD, case, try_case};
use crate::support::shared::shared;
use crate::support::statics::{Loaded, body, loaded, loaded_with};

// A symmetric plate solved on its half or quarter against the whole.

/// Share of the plate that is left where columns and rows are even in number; a line through a row of points leaves half a row more.
struct Scene {
    name: &'static str,
    specimen: String,
    set: &'static [&'static str],
    copies: usize,
}

fn scenes() -> Vec<Scene> {
    let tension = |kind: &str, width: f64, rest: &str| {
        format!("kind=\"{kind}\"\nwidth_mm={width}\nlength_mm=120\nthickness_mm=2\ncrack_length_mm=16\n{rest}")
    };
    let plate = |rest: &str| format!("kind=\"plate\"\nwidth_mm=60\nlength_mm=100\nthickness_mm=2\n{rest}\n");
    let scene = |name, specimen, set, copies| Scene { name, specimen, set, copies };
    let bottom: &[&str] = &["supports.bottom={ rows_mm = 3.0, fix = [\"x\", \"y\"] }"];
    vec![
        scene("even columns", tension("middle_tension", 80.0, ""), &[], 4),
        scene("odd columns", tension("middle_tension", 82.0, ""), &[], 4),
        scene("clamped", tension("single_edge_tension", 60.0, "ends=\"clamped\"\n"), &[], 2),
        scene("pinned", tension("single_edge_tension", 60.0, "ends=\"pinned\"\n"), &[], 2),
        scene("two edges", tension("double_edge_tension", 62.0, ""), &[], 4),
        scene("compact", "kind=\"compact_tension\"\nwidth_mm=50\nthickness_mm=5\ncrack_length_mm=20\n".to_owned(), &[], 2),
        scene("bottom held", plate("cracks=[{from_mm=[-10,1],to_mm=[10,1]}]"), bottom, 2),
        scene("crack along the load", plate("cracks=[{from_mm=[0,-13],to_mm=[0,13]}]"), &[], 4),
        scene(
            "hole, crack one side",
            plate("holes=[{x_mm=0,y_mm=0,diameter_mm=16}]\ncracks=[{from_mm=[8,0],to_mm=[16,0]}]"),
            &[],
            2,
        ),
        scene(
            "hole off the middle",
            plate("holes=[{x_mm=5,y_mm=8,diameter_mm=16}]\ncracks=[{from_mm=[-10,-7],to_mm=[-2,-7]}]"),
            &[],
            1,
        ),
        scene("slant crack", plate("cracks=[{from_mm=[-10,-7],to_mm=[10,7]}]"), &[], 1),
    ]
}

/// One scene of each kind of symmetry, support and specimen.
const QUICK: [&str; 6] = ["even columns", "odd columns", "clamped", "compact", "bottom held", "hole, crack one side"];

/// Settings of the laws that differ for the part: with three unknowns a point, with two, with dilatation beside them.
const LAWS: &[(&str, &[&str])] = &[
    ("free", &[]),
    ("resisted", &["model.rotation=resisted"]),
    ("balanced", &["model.surface_correction=balanced"]),
    ("state-based", &["model.bond_law=state_based", "material.poisson_ratio=0.4"]),
];

fn stretch_difference(a: &Loaded, b: &Loaded) -> f64 {
    let (a, b) = (a.stretches(), b.stretches());
    let size = b.iter().fold(0.0_f64, |m, s| m.max(s.abs()));
    a.iter().zip(&b).fold(0.0_f64, |m, (a, b)| m.max((a - b).abs())) / size
}

/// Strains and work of the part are those of the whole plate. Multipliers in single precision carry the order of sums of the
/// surface correction: 1e-7 of a bond, of which the fields keep a part.
/// Solvers take turns unless each law is asked for by both.
fn says_everything(scenes: impl Iterator<Item = Scene>, by_both: bool) {
    let mut faults = Vec::new();
    for (s, scene) in scenes.enumerate() {
        for (l, &(law, choices)) in LAWS.iter().enumerate() {
            for (_, solver) in
                [None, Some(SolverKind::Multigrid)].into_iter().enumerate().filter(|(i, _)| by_both || (s + l) % 2 == *i)
            {
                let of = |symmetry: &str| {
                    let all: Vec<&str> =
                        [symmetry].into_iter().chain(choices.iter().copied()).chain(scene.set.iter().copied()).collect();
                    loaded(&try_case(&scene.specimen, &all).unwrap(), solver).unwrap()
                };
                let (part, whole) = (of("model.symmetry=auto"), of("model.symmetry=off"));
                let (columns, rows) = (whole.body.lattice.columns, whole.body.lattice.rows);
                let strained = stretch_difference(&part, &whole);
                let work = (part.work / whole.work - 1.0).abs();
                let copies = whole.body.points.len() as f64 / part.solved as f64;
                println!(
                    "{:>22} {law:>12} {solver:>10?} {columns:>4} x {rows:<4} copies {copies:.2} strain {strained:.1e} work {work:.1e} iterations {} of {}",
                    scene.name, part.iterations, whole.iterations
                );
                // A state-based law wants its lines of symmetry between points.
                let odd = law == "state-based" && (columns % 2 == 1 || rows % 2 == 1);
                let expected = if odd && scene.copies > 1 { 1.0..=2.0 } else { 0.93 * scene.copies as f64..=scene.copies as f64 };
                if !(strained < 2e-7 && work < 2e-7 && expected.contains(&copies)) {
                    faults.push(format!("{}, {law}, {solver:?}: {copies} {strained:e} {work:e}", scene.name));
                }
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn a_part_of_a_symmetric_plate_says_everything() {
    says_everything(scenes().into_iter().filter(|scene| QUICK.contains(&scene.name)), false);
}

#[test]
#[ignore = "long: ten seconds"]
fn a_part_of_every_symmetric_plate_says_everything() {
    says_everything(scenes().into_iter(), true);
}

/// The same bonds break at the same cycles whether the plate is solved as a whole or on its part.
fn grows_alike(driver: &str, scenes: impl Iterator<Item = Scene>) {
    for scene in scenes {
        for &(law, choices) in LAWS.iter().filter(|(law, _)| matches!(*law, "free" | "state-based")) {
            // Each law by one of both; every law by every solver: `tip_field_solvers.rs`.
            let solver = if law == "free" { SolverKind::Window } else { SolverKind::Multigrid };
            let chosen = format!("model.solver={solver}");
            let grown = |symmetry: &str| {
                let fixed = [symmetry, &*chosen, driver, "stop.cycles_max=1e6"];
                let all: Vec<&str> = fixed.into_iter().chain(choices.iter().copied()).chain(scene.set.iter().copied()).collect();
                let mut case = case(&scene.specimen, &all);
                case.stop.crack_length = case.specimen.crack_length + 3e-3;
                // Runs by default stop at a residual that shows in K.
                case.model.points_mut().unwrap().residual = 1e-9;
                predict(&case, &Silent).unwrap()
            };
            let (part, whole) = (grown("model.symmetry=auto"), grown("model.symmetry=off"));
            // Of a crack along the load nothing grows.
            let life =
                if whole.life_cycles() == 0.0 { part.life_cycles() } else { part.life_cycles() / whole.life_cycles() - 1.0 };
            println!(
                "{:>22} {law:>12} {solver:>10} life {:.6e} {life:+.1e}, {} of {} points",
                scene.name,
                part.life_cycles(),
                part.figures.points_solved,
                part.figures.points
            );
            assert!(life.abs() < 1e-6, "{}, {law}, {solver}: {life:e}", scene.name);
            assert_eq!(part.stop, whole.stop, "{}, {law}, {solver}", scene.name);
            let (a, b) = (part.curve.last().unwrap(), whole.curve.last().unwrap());
            assert_eq!(a.broken_bonds, b.broken_bonds, "{}, {law}, {solver}", scene.name);
        }
    }
}

#[test]
fn a_part_grows_the_crack_of_the_whole() {
    const GROWN: [&str; 3] = ["odd columns", "clamped", "hole, crack one side"];
    grows_alike(TIP_FIELD, scenes().into_iter().filter(|scene| GROWN.contains(&scene.name)));
}

#[test]
#[ignore = "long: a minute"]
fn a_part_grows_the_crack_of_the_whole_in_every_scene_by_every_driver() {
    for driver in [TIP_FIELD, BOND_STRAIN] {
        grows_alike(driver, scenes().into_iter());
    }
}

/// A bond that breaks on one side only ends the symmetry: from then on the whole plate is solved, and rightly.
#[test]
fn a_break_on_one_side_ends_the_symmetry() {
    for solver in [SolverKind::Window, SolverKind::Multigrid] {
        let case = case(&scenes()[0].specimen, &[]);
        let body = body(&case);
        let mut bonds = Bonds::new(&body);
        let mut displacement = Vec::new();
        let mut equilibrium = Equilibrium::new(solver, Symmetry::Auto, &body, &bonds, case.loading.maximum);
        equilibrium.solve(&body, &bonds, &mut displacement).unwrap();
        let ahead = |side: f64| bonds_across(&body, [side * 16e-3, 0.0], [side * 19e-3, 0.0]);
        let one_side = bonds_across(&body, [19e-3, 0.0], [22e-3, 0.0]);
        for (broken, is_symmetric) in [([ahead(1.0), ahead(-1.0)].concat(), true), (one_side, false)] {
            let broken: Vec<_> = broken.into_iter().filter(|&bond| bonds.is_intact(bond)).collect();
            assert!(!broken.is_empty());
            broken.iter().for_each(|&bond| bonds.cut(&body, bond));
            equilibrium.bonds_changed(&body, &bonds, &broken);
            equilibrium.solve(&body, &bonds, &mut displacement).unwrap();
            let whole = loaded_with(body.clone(), bonds.clone(), case.loading.maximum, None).unwrap();
            assert!((equilibrium.work() / whole.work - 1.0).abs() < 1e-9, "{solver}");
            assert_eq!(equilibrium.points(&body) < body.points.len(), is_symmetric, "{solver}");
            let part = Loaded { displacement: displacement.clone(), ..whole.clone() };
            assert!(stretch_difference(&part, &whole) < 1e-7, "{solver}");
        }
    }
}

// A plate and its mirror image have the same life, and a plate that is its own has no K_II, wherever its rims lie between points.

/// Heights around odd and even numbers of spacings of 1 mm, and the same but for round-off.
fn heights() -> impl Iterator<Item = f64> {
    (78..=82).flat_map(|rows| [-1e-12, 0.0, 1e-12].map(|by| f64::from(rows) + by))
}

fn plate(height: f64, rest: &str) -> Case {
    let text = format!("kind=\"plate\"\nwidth_mm=40\nlength_mm={height:.12}\nthickness_mm=2\n{rest}\n");
    let mut case = case(&text, &["fatigue.driver=tip_field", "model.spacing_mm=1"]);
    case.model.points_mut().unwrap().residual = 1e-11;
    case
}

#[test]
fn a_level_crack_has_no_sliding_mode() {
    let mut last = None;
    for height in heights() {
        for crack in ["[-20,0],to_mm=[-8,0]", "[20,0],to_mm=[8,0]", "[-9,0],to_mm=[9,0]"] {
            let tips = initial_tips::<PointPlate>(&plate(height, &format!("cracks=[{{from_mm={crack}}}]"))).unwrap().tips;
            for tip in tips {
                let [k_i, k_ii] = tip.factors.unwrap();
                assert!((k_ii / k_i).abs() < 1e-6, "{height}, {crack}: K_II {:e} of K_I", k_ii / k_i);
                last = Some((height, k_i));
            }
        }
    }
    println!("{last:?}");
}

/// A crack along a column, on the middle line and beside it.
#[test]
fn an_upright_crack_in_bending_has_no_sliding_mode() {
    for (width, x) in [(60.0, 0.0), (61.0, 0.0), (60.0, 7.3)] {
        let holes = format!("holes=[{{x_mm={},y_mm=0,diameter_mm=6}},{{x_mm={},y_mm=0,diameter_mm=6}}]", x - 12.0, x + 12.0);
        let pins = "[loading]\nforce_max_n=1000\nstress_ratio=0.1\npins=[{hole=0,direction=[-1,0]},{hole=1,direction=[1,0]}]";
        let text = format!(
            "kind=\"plate\"\noutline_mm=[[{a},-20],[{b},-20],[{b},20],[{a},20]]\nthickness_mm=2\n{holes}\n\
             cracks=[{{from_mm=[{x},-20],to_mm=[{x},-8]}}]\n{pins}\n",
            a = x - 0.5 * width,
            b = x + 0.5 * width
        );
        let case = case(&text, &["fatigue.driver=tip_field", "model.spacing_mm=1"]);
        let tips = initial_tips::<PointPlate>(&case).unwrap().tips;
        let [k_i, k_ii] = tips[0].factors.unwrap();
        assert!((k_ii / k_i).abs() < 1e-6, "width {width}, x {x}: K_II {:e} of K_I", k_ii / k_i);
    }
}

fn live_as_long(heights: impl Iterator<Item = f64>) {
    for height in heights {
        let life = |sign: f64| {
            let hole = format!("holes=[{{x_mm=4,y_mm={},diameter_mm=10}}]", sign * 14.0);
            let run = predict(&plate(height, &format!("{hole}\ncracks=[{{from_mm=[-20,0],to_mm=[-10,0]}}]")), &Silent).unwrap();
            (run.curve.last().unwrap().cycles, run.stop)
        };
        let (above, below) = (life(1.0), life(-1.0));
        assert!((above.0 / below.0 - 1.0).abs() < 1e-9 && above.1 == below.1, "{height}: {above:?}, {below:?}");
    }
}

/// An odd number of spacings, and an even one but for round-off.
#[test]
fn the_mirror_image_of_a_plate_lives_as_long() {
    live_as_long(heights().skip(4).step_by(4).take(2));
}

#[test]
#[ignore = "long: ten seconds"]
fn the_mirror_image_of_a_plate_of_any_height_lives_as_long() {
    live_as_long(heights().step_by(2));
}

/// Double cantilevers of 79 and 80 rows against finite elements (`../shared/data/field/mechanics/odd_rows`): K and life; the arms of the
/// former were of 39 and 40 rows, and the crack left by its side after 0.57 of the life.
fn keeps_its_middle_line(name: &str) {
    let (k_i, life) = (2.295, 16.00e6);
    let Some(path) = shared(&format!("field/mechanics/odd_rows/{name}.toml")) else { return };
    let run = predict(&Case::from_file(&path, &["model.spacing_mm=1".to_owned()]).unwrap(), &Silent).unwrap();
    let at = |length: f64| run.curve.iter().find(|point| point.crack_length >= length).unwrap().cycles;
    let first = run.curve[0].tips[0].factors.unwrap()[0] / 1e6;
    assert!((first / k_i - 1.0).abs() < 0.006 && (at(0.1) / life - 1.0).abs() < 0.015, "{name}: {first}, {}", at(0.1));
    assert!(run.curve.iter().all(|point| point.tips[0].position[1].abs() < 0.05e-3), "{name}: off the middle line");
}

#[test]
fn a_double_cantilever_keeps_its_middle_line() {
    keeps_its_middle_line("dcb_39.5");
}

#[test]
#[ignore = "long: ten seconds"]
fn a_double_cantilever_in_plane_strain_keeps_its_middle_line() {
    keeps_its_middle_line("dcb_39.5_plane_strain_1mm");
}
