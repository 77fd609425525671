//! Growth by K of the tips is one growth, whatever solves the equilibrium: every solver by every bond law, on a part of the plate or on
//! the whole. (That a run goes on from a checkpoint bit for bit: `checkpoint.rs`.)

use std::path::Path;

use perilife_growth::case::Case;
use perilife_growth::predict::{Prediction, Silent, predict};
use perilife_plate::specimen::geometry::distance;
use perilife_points::bond_law::BondLawKind;
use perilife_points::solver::SolverKind;
use perilife_study::cases::by_name;

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
/// Relative difference of lives, and of paths over a spacing.
const EQUAL: f64 = 1e-6;
fn grow(specimen: &str, set: &[&str]) -> Prediction {
    let set: Vec<String> = set.iter().map(|text| (*text).to_owned()).collect();
    let text = format!("[specimen]\n{specimen}\n{REST}");
    let mut case = Case::from_toml(&text, "plate", Path::new("."), &by_name(&text, &set)).unwrap();
    // Runs by default stop at a residual that shows in K; here solvers are compared.
    case.model.points_mut().unwrap().residual = 1e-9;
    predict(&case, &Silent).unwrap()
}

/// Difference of lives, relative, and the largest one of the places of tips at equal rows, over a spacing.
fn differences(a: &Prediction, b: &Prediction) -> (f64, f64) {
    let pairs = a.curve.iter().zip(&b.curve).flat_map(|(here, there)| here.tips.iter().zip(&there.tips));
    let path = pairs.map(|(here, there)| distance(here.position, there.position)).fold(0.0, f64::max);
    ((a.life_cycles() / b.life_cycles() - 1.0).abs(), path / a.figures.spacing)
}

/// The settings of a law; bond-based springs have one Poisson's ratio only.
fn of_law(law: BondLawKind) -> [String; 2] {
    let ratio = if law == BondLawKind::BondBased { "0.333333333333333333" } else { "0.3" };
    [format!("model.bond_law={law}"), format!("material.poisson_ratio={ratio}")]
}

/// On plates with laws of these numbers; how many runs were compared.
fn one_life_and_one_path(is_chosen: impl Fn(usize, usize) -> bool) -> usize {
    let (mut runs, mut faults) = (0, Vec::new());
    for (p, (plate, specimen, stop, is_symmetric)) in PLATES.into_iter().enumerate() {
        for (_, &law) in BondLawKind::ALL.iter().enumerate().filter(|(l, _)| is_chosen(p, *l)) {
            let law_keys = of_law(law);
            let common: Vec<&str> = [stop].into_iter().chain(law_keys.iter().map(|key| &**key)).collect();
            let reference = grow(specimen, &common);
            assert!(reference.curve.len() > 4 && reference.life_cycles() > 0.0, "{plate}, {law}: a run");
            let symmetries: &[&str] = if is_symmetric { &["auto", "off"] } else { &["auto"] };
            for solver in SolverKind::ALL {
                for symmetry in symmetries {
                    let keys = [format!("model.solver={solver}"), format!("model.symmetry={symmetry}")];
                    let set: Vec<&str> = common.iter().copied().chain(keys.iter().map(|key| &**key)).collect();
                    let run = grow(specimen, &set);
                    runs += 1;
                    let (life, path) = differences(&run, &reference);
                    let what = format!("{plate}, {law}, {solver}, symmetry {symmetry}: life {life:.1e}, path {path:.1e}");
                    if !(life < EQUAL && path < EQUAL) {
                        faults.push(what.clone());
                    }
                    assert_eq!((run.stop, run.curve.len()), (reference.stop, reference.curve.len()), "{what}");
                }
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    runs
}

#[test]
fn every_solver_by_every_law_gives_one_life_and_one_path() {
    let runs = one_life_and_one_path(|plate, law| law % PLATES.len() == plate);
    assert!(runs >= BondLawKind::ALL.len() * SolverKind::ALL.len(), "{runs}");
}

#[test]
#[ignore = "long: half a minute; cargo test tip_field_solvers -- --ignored --nocapture"]
fn every_solver_by_every_law_on_every_plate_gives_one_life_and_one_path() {
    let runs = one_life_and_one_path(|_, _| true);
    assert_eq!(runs, BondLawKind::ALL.len() * SolverKind::ALL.len() * (PLATES.len() + 1));
}

#[test]
fn one_thread_and_two_give_the_same_bits() {
    for (plate, specimen, stop, _) in PLATES {
        let by = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| grow(specimen, &[stop]).curve)
        };
        assert_eq!(by(1), by(2), "{plate}");
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
