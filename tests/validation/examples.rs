//! Every example of `data/cases` runs to its end and gives its number.

use std::path::{Path, PathBuf};

use perilife_base::quadrature::integrate;
use perilife_base::units::MM;
use perilife_calibration::median::cycles_of_run;
use perilife_growth::case::Case;
use perilife_growth::predict::{Prediction, Silent, StopReason, predict};
use perilife_plate::specimen::Point;
use perilife_plate::specimen::handbook::delta_k;

use crate::support::rows::rows;

fn example(name: &str, set: &[&str]) -> (Case, Prediction) {
    let overrides: Vec<String> = set.iter().map(|key| (*key).to_owned()).collect();
    let case = Case::from_file(&folder().join(format!("{name}.toml")), &overrides).unwrap();
    let run = predict(&case, &Silent).unwrap();
    println!("{name}: {} after {:.1} cycles, {:.3} mm", run.stop, run.life_cycles(), run.crack_length_final() / MM);
    (case, run)
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("data/cases")
}

/// Examples whose number is compared with a calculation by hand; all others have their own.
const BY_HAND: [&str; 4] = ["compact_tension", "double_edge", "single_edge", "virkler_panel"];
const SLANT: &str = "slant_crack_plate";

#[test]
fn every_example_has_a_number() {
    let mut files: Vec<String> = std::fs::read_dir(folder())
        .unwrap()
        .map(|entry| entry.unwrap().path())
        // Fracture scenes have a folder of their own.
        .filter(|path| path.extension().is_some_and(|end| end == "toml"))
        .map(|path| path.file_stem().unwrap().to_str().unwrap().to_owned())
        .collect();
    files.sort();
    let own = ["quick", "slow"].into_iter().flat_map(own).map(|(name, ..)| name);
    let mut known: Vec<String> = BY_HAND.into_iter().chain([SLANT]).map(str::to_owned).chain(own).collect();
    known.sort();
    assert_eq!(files, known);
}

/// One law in four specimens of three alloys: lives are those of handbook K and `da/dN = β A δ^(1-p/2) (ΔK/E)^p` with one β,
/// taken from the panel between 20 and 45 mm (theory of steady growth, Silling and Askari 2014).
#[test]
fn standard_specimens_live_as_hand_calculation_says() {
    let runs = BY_HAND.map(|name| (name, example(name, &[])));
    let constant_over_elasticity = {
        let (case, run) = &runs.iter().find(|(name, _)| *name == "virkler_panel").unwrap().1;
        let curve: Vec<(f64, f64)> = run.curve.iter().map(|point| (point.cycles, point.crack_length)).collect();
        let cycles = cycles_of_run(&curve, &[20.0 * MM, 45.0 * MM]).unwrap();
        integral(case, 20.0 * MM, 45.0 * MM) / cycles[1] * case.material.plane_modulus().powf(2.86)
    };
    for (name, (case, run)) in &runs {
        assert_eq!(run.stop, StopReason::CrackLengthReached, "{name}");
        let constant = constant_over_elasticity / case.material.plane_modulus().powf(2.86);
        // A is rescaled to each horizon so that C stays.
        let by_hand = integral(case, case.specimen.crack_length, case.stop.crack_length) / constant;
        // Reached: 1.3 %.
        assert!((run.life_cycles() / by_hand - 1.0).abs() < 0.03, "{name}: {}", run.life_cycles() / by_hand);
    }
}

/// ∫ da / ΔK^p with the handbook's ΔK and the p = 2.86 of the examples.
fn integral(case: &Case, from: f64, to: f64) -> f64 {
    let range = |length: f64| delta_k(&case.specimen, length, case.loading.maximum, case.loading.range_share()).unwrap();
    integrate(|length| range(length).powf(-2.86), from, to, 1e-9).value
}

fn own(which: &str) -> Vec<(String, f64, String)> {
    rows("examples", which)
}

/// Lives of plates that no handbook knows.
fn keep_their_lives(which: &str) {
    for (name, life, stop) in own(which) {
        let (_, run) = example(&name, &[]);
        assert_eq!(run.stop.name(), stop, "{name}");
        assert!((run.life_cycles() / life - 1.0).abs() < 0.01, "{name}: {} against {life}", run.life_cycles());
    }
}

#[test]
fn the_other_examples_keep_their_lives() {
    keep_their_lives("quick");
}

#[test]
#[ignore = "long: half a minute; cargo test examples -- --ignored --nocapture"]
fn slow_examples_keep_their_lives() {
    keep_their_lives("slow");
}

/// Start of the slant cracks on nodes. K of a crack at β to the load in an infinite plate: `σ √(π a) (sin²β, sin β cos β)`; the
/// plates are twenty and twelve half cracks wide. First kink by the largest circumferential stress (Erdogan and Sih 1963):
/// `tan θ/2 = (K_I - √(K_I² + 8 K_II²)) / (4 K_II)`; the first step ends within a tenth of a millimetre of growth.
#[test]
fn slant_examples_start_as_in_an_infinite_plate() {
    for (name, length) in [("ti_slant_30", 14.3), ("ti_slant_43", 13.6), ("slant_crack_nodes", 10.1)] {
        let (case, run) = example(name, &[&format!("stop.crack_length_mm={length}")]);
        assert_eq!(run.stop, StopReason::CrackLengthReached, "{name}");
        let [first, last] = [&run.curve[0], run.curve.last().unwrap()].map(|row| row.tips[1]);
        let [x, y] = first.position;
        let beta = x.atan2(y);
        let size = 1e-6 * case.loading.maximum * (0.5 * std::f64::consts::PI * case.specimen.crack_length).sqrt();
        let right = [size * beta.sin().powi(2), size * beta.sin() * beta.cos()];
        let found = first.factors.unwrap().map(|k| k / 1e6);
        let off = (found[0] - right[0]).hypot(found[1].abs() - right[1]);
        assert!(off < 0.01 * right[0].hypot(right[1]), "{name}: {found:?}, {right:?}");
        let kink = 2.0 * ((right[0] - (right[0].powi(2) + 8.0 * right[1].powi(2)).sqrt()) / (4.0 * right[1])).atan();
        let direction = |from: Point, to: Point| (to[1] - from[1]).atan2(to[0] - from[0]);
        let turned = direction(first.position, last.position) - direction([0.0, 0.0], first.position);
        println!("{name}: first kink {:.2}°, {:.2}°", turned.to_degrees(), kink.to_degrees());
        assert!((turned - kink).abs() < f64::to_radians(1.0), "{name}: {turned}, {kink}");
    }
}

/// The notched plate on points of twice the spacing: from the middle of the slot's end straight across, by bonds and by K.
#[test]
fn a_coarse_notched_plate_grows_straight_ahead() {
    let (_, run) = example("notched_plate", &["model.spacing_mm=1.5"]);
    assert_eq!(run.stop, StopReason::NetSectionYield);
    assert!(run.curve.iter().flat_map(|row| &row.tips).all(|tip| tip.position[1].abs() < 0.1 * MM));
    assert!(run.crack_length_final() > 35.0 * MM, "{} mm", run.crack_length_final() / MM);
}

/// Li, Lü, Huang and Yang 2024, section 4.4: the crack turns across the load at once.
#[test]
fn the_slant_crack_turns_across_the_load() {
    let (_, run) = example(SLANT, &[]);
    assert_eq!(run.stop, StopReason::Severed);
    for point in &run.curve {
        for tip in &point.tips {
            assert!(tip.position[1].abs() < 4.0 * MM, "y = {} mm", tip.position[1] / MM);
        }
    }
    let turned = run.curve.iter().find(|point| point.tips.iter().all(|tip| tip.growth > 2.0 * MM)).unwrap();
    let last = &run.curve[run.curve.len() / 2];
    for (a, b) in turned.tips.iter().zip(&last.tips) {
        let slope = (b.position[1] - a.position[1]) / (b.position[0] - a.position[0]);
        assert!(slope.abs() < 0.1, "slope {slope} after 2 mm");
    }
}

/// Its extent is 46 mm after 70 000 to 85 000 cycles in their trials with several kernels, all from a clean cut and with strains as computed.
#[test]
#[ignore = "long: ten seconds"]
fn the_slant_crack_lives_as_long_as_in_trials() {
    let as_tried = ["fatigue.driver=bond_strain"];
    let file = folder().join(format!("{SLANT}.toml"));
    let case = Case::from_file(&file, &as_tried.map(str::to_owned)).unwrap();
    let clean_cut = predict(&case, &Silent).unwrap();
    let long = clean_cut.curve.iter().find(|point| point.crack_length >= 46.0 * MM).unwrap();
    println!("46 mm after {:.0} cycles", long.cycles);
    assert!((70e3..85e3).contains(&long.cycles), "{}", long.cycles);
}
