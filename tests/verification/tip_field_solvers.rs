//! Growth by K of the tips is one growth, whatever solves the equilibrium: every solver by every bond law, on a part of the plate or on
//! the whole, on points of one or two levels. (That a run goes on from a checkpoint bit for bit: `checkpoint.rs`.)

use std::path::Path;

use perilife::bond_law::BondLawKind;
use perilife::case::Case;
use perilife::predict::{Prediction, Silent, predict};
use perilife::solver::SolverKind;
use perilife::specimen::geometry::{distance, distance_to_segment};

const REST: &str = "
[material]
youngs_modulus_gpa = 70.0
poisson_ratio = 0.3
plane = \"stress\"
[loading]
stress_max_mpa = 60
stress_ratio = 0.1
[model]
spacing_mm = 2
[fatigue]
paris_c_mm_per_cycle = 1e-8
paris_m = 3.0
step_error_percent = 0.1
";

/// Name, `[specimen]`, crack length at which the run ends, mm, and whether the plate has a mirror image.
const PLATES: [(&str, &str, &str, bool); 3] = [
    (
        "slant crack",
        "kind = \"plate\"\nwidth_mm = 60\nlength_mm = 80\nthickness_mm = 2\ncracks = [{ from_mm = [-7.2, -5.1], to_mm = [7.2, 5.1] }]",
        "stop.crack_length_mm=36",
        false,
    ),
    (
        "edge crack beside a hole",
        "kind = \"plate\"\nwidth_mm = 60\nlength_mm = 80\nthickness_mm = 2\nholes = [{ x_mm = 8, y_mm = 9, diameter_mm = 10 }]\n\
         cracks = [{ from_mm = [-30, 0.4], to_mm = [-15, 0.4] }]",
        "stop.crack_length_mm=28",
        false,
    ),
    (
        "middle tension",
        "kind = \"middle_tension\"\nwidth_mm = 60\nlength_mm = 80\nthickness_mm = 2\ncrack_length_mm = 8",
        "stop.crack_length_mm=20",
        true,
    ),
];
/// Points of one level, and of two.
const LATTICES: [(&str, &[&str]); 2] = [
    ("lattice", &[]),
    (
        "levels",
        &[
            "model.discretisation=dual_horizon",
            "model.spacing_mm=3",
            "refinement.regions=[{box_mm=[[-30,-26],[30,28]],levels=1}]",
        ],
    ),
];
/// Relative difference of lives, and of paths over a spacing.
const EQUAL: f64 = 1e-6;
/// The same where dynamic relaxation solves, whose residual counts the load of grips too.
const EQUAL_RELAXED: [f64; 2] = [2e-6, 1e-4];

fn grow(specimen: &str, set: &[&str]) -> Prediction {
    let set: Vec<String> = set.iter().map(|text| (*text).to_owned()).collect();
    let mut case = Case::from_toml(&format!("[specimen]\n{specimen}\n{REST}"), "plate", Path::new("."), &set).unwrap();
    // Runs by default stop at a residual that shows in K; here solvers are compared.
    case.model.residual = 1e-9;
    predict(&case, &Silent).unwrap()
}

/// Difference of lives, relative, and the largest one of the places of tips, over a spacing: at equal rows, or, where the length of steps
/// may differ, from the other path.
fn differences(a: &Prediction, b: &Prediction, at_equal_rows: bool) -> (f64, f64) {
    let mut path = 0.0_f64;
    for (row, (here, there)) in a.curve.iter().zip(&b.curve).enumerate() {
        for (tip, (here, there)) in here.tips.iter().zip(&there.tips).enumerate() {
            let near = &b.curve[row.saturating_sub(1)..(row + 2).min(b.curve.len())];
            let to_path = near
                .windows(2)
                .map(|pair| distance_to_segment(here.position, pair[0].tips[tip].position, pair[1].tips[tip].position))
                .fold(f64::INFINITY, f64::min);
            path = path.max(if at_equal_rows { distance(here.position, there.position) } else { to_path });
        }
    }
    ((a.life_cycles() / b.life_cycles() - 1.0).abs(), path / a.figures.spacing)
}

/// The settings of a law; bond-based springs have one Poisson's ratio only.
fn of_law(law: BondLawKind) -> [String; 2] {
    let ratio = if law == BondLawKind::BondBased { "0.333333333333333333" } else { "0.3" };
    [format!("model.bond_law={law}"), format!("material.poisson_ratio={ratio}")]
}

#[test]
fn every_solver_by_every_law_gives_one_life_and_one_path() {
    let (mut runs, mut faults) = (0, Vec::new());
    for (plate, specimen, stop, is_symmetric) in PLATES {
        for (lattice, of_lattice) in LATTICES {
            // Points of several levels are joined by springs only.
            let has_law = |law: &&BondLawKind| of_lattice.is_empty() || **law != BondLawKind::StateBased;
            for &law in BondLawKind::ALL.iter().filter(has_law) {
                let law_keys = of_law(law);
                let common: Vec<&str> =
                    [stop].into_iter().chain(of_lattice.iter().copied()).chain(law_keys.iter().map(|key| &**key)).collect();
                let reference = grow(specimen, &common);
                assert!(reference.curve.len() > 4 && reference.life_cycles() > 0.0, "{plate}, {lattice}, {law}: a run");
                // Points of several levels have two ways of solving.
                let solvers = if of_lattice.is_empty() { SolverKind::ALL } else { &[SolverKind::Window, SolverKind::Direct][..] };
                let symmetries: &[&str] = if is_symmetric { &["auto", "off"] } else { &["auto"] };
                for &solver in solvers {
                    for symmetry in symmetries {
                        let keys = [format!("model.solver={solver}"), format!("model.symmetry={symmetry}")];
                        let set: Vec<&str> = common.iter().copied().chain(keys.iter().map(|key| &**key)).collect();
                        let run = grow(specimen, &set);
                        runs += 1;
                        let relaxes = solver == SolverKind::AdaptiveDynamicRelaxation;
                        let (life, path) = differences(&run, &reference, !relaxes);
                        let what =
                            format!("{plate}, {lattice}, {law}, {solver}, symmetry {symmetry}: life {life:.1e}, path {path:.1e}");
                        println!("{what}");
                        let bounds = if relaxes { EQUAL_RELAXED } else { [EQUAL; 2] };
                        if !(life < bounds[0] && path < bounds[1]) {
                            faults.push(what.clone());
                        }
                        assert_eq!((run.stop, run.curve.len()), (reference.stop, reference.curve.len()), "{what}");
                    }
                }
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    let laws = BondLawKind::ALL.len();
    assert_eq!(runs, (laws * SolverKind::ALL.len() + 2 * (laws - 1)) * (PLATES.len() + 1));
}

#[test]
fn one_thread_and_two_give_the_same_bits() {
    for (plate, specimen, stop, _) in PLATES {
        for (lattice, of_lattice) in LATTICES {
            let set: Vec<&str> = [stop].into_iter().chain(of_lattice.iter().copied()).collect();
            let by = |threads: usize| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                pool.install(|| grow(specimen, &set).curve)
            };
            assert_eq!(by(1), by(2), "{plate}, {lattice}");
        }
    }
}

/// The law of a bond is kept as a field: λ of the bonds ahead of a tip lies between 0 and 1, is spent near the tip alone, and never rises.
#[test]
fn bonds_ahead_of_a_tip_lose_remaining_life() {
    let (_, specimen, stop, _) = PLATES[1];
    let run = grow(specimen, &[stop, "model.spacing_mm=1"]);
    assert!(run.snapshots.len() > 2);
    let mut before: Option<&[f64]> = None;
    for snapshot in &run.snapshots {
        let lives = &snapshot.remaining_life;
        assert_eq!(lives.len(), run.figures.points);
        let spent = lives.iter().filter(|life| **life < 1.0).count();
        assert!(spent > 3 && spent < run.figures.points / 20, "{spent} points with bonds ahead of the tip");
        assert!(lives.iter().all(|life| (0.0..=1.0).contains(life)) && lives.iter().any(|life| *life < 0.5));
        if let Some(before) = before {
            // A point may come to more life only by losing the bond that had the least.
            let risen =
                lives.iter().zip(before).zip(&snapshot.damage).filter(|((now, then), damage)| now > then && **damage == 0.0);
            assert_eq!(risen.count(), 0);
        }
        before = Some(lives);
    }
}
