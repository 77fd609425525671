//! A symmetric plate solved on its half or quarter against the whole.

use perilife_growth::predict::{Silent, predict};
use perilife_points::body::pre_crack::bonds_across;
use perilife_points::solver::{Equilibrium, SolverKind, Symmetry};
use perilife_points::state::Bonds;

use crate::support::plates::{BOND_STRAIN, TIP_FIELD, case, try_case};
use crate::support::statics::{Loaded, body, loaded, loaded_with};

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
            let life = part.life_cycles() / whole.life_cycles() - 1.0;
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
            println!("{solver}: symmetric {is_symmetric}, work {:.12e} and {:.12e}", equilibrium.work(), whole.work);
            assert!((equilibrium.work() / whole.work - 1.0).abs() < 1e-9, "{solver}");
            assert_eq!(equilibrium.points(&body) < body.points.len(), is_symmetric, "{solver}");
            let part = Loaded { displacement: displacement.clone(), ..whole.clone() };
            assert!(stretch_difference(&part, &whole) < 1e-7, "{solver}");
        }
    }
}
