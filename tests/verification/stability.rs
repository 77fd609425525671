//! Scenes at the rim of what a fatigue run can be asked: each ends in a right answer, or in a warning that says how wrong.

use perilife_base::units::MM;
use perilife_growth::predict::{Prediction, Silent, StopReason, predict};

use crate::support::plates::{BOND_STRAIN, TIP_FIELD, case, sound};

const PANEL: &str = "kind=\"middle_tension\"\nwidth_mm=48\nlength_mm=60\nthickness_mm=2\ncrack_length_mm=9\n";
const PLATE: &str = "kind=\"plate\"\nwidth_mm=40\nlength_mm=48\nthickness_mm=2\n";

const DRIVERS: [&str; 2] = [TIP_FIELD, BOND_STRAIN];

fn grow(specimen: &str, set: &[&str]) -> Prediction {
    predict(&case(specimen, &[&["stop.cycles_max=1e12", "model.spacing_mm=1"], set].concat()), &Silent).unwrap()
}

/// The same by strains of bonds.
fn grow_by_bonds(specimen: &str, set: &[&str]) -> Prediction {
    grow(specimen, &[&[BOND_STRAIN], set].concat())
}

fn is_through(run: &Prediction) -> bool {
    matches!(run.stop, StopReason::Severed | StopReason::LeftPlate)
}

/// The far field eats life at low p: points lose most of their bonds, some all, and the plate comes apart earlier than where
/// only the tips age.
#[test]
fn ageing_everywhere_ends_though_points_detach() {
    for (p, spacing) in
        [("fatigue.p=1", "model.spacing_mm=2"), ("fatigue.p=1.5", "model.spacing_mm=2"), ("fatigue.p=2", "model.spacing_mm=1")]
    {
        let run = grow_by_bonds(PANEL, &[spacing, "fatigue.ageing=everywhere", p]);
        sound(p, &run);
        assert!(is_through(&run), "{p}: {}", run.stop);
        // A straight crack leaves its points 61 % of their bonds.
        let damage = run.snapshots.last().unwrap().damage.iter().copied().fold(0.0, f64::max);
        assert!(damage > 0.6, "{p}: {damage}, so this scene tests nothing");
        // Tips cannot be followed through that; no crack is longer than half the plate.
        assert!(run.crack_length_final() <= 24.0 * MM * (1.0 + 1e-9), "{p}: {}", run.crack_length_final() / MM);
        let told = run.warnings.iter().any(|line| line.contains("use the life, not the length"));
        assert!(told || p != "fatigue.p=2", "{:?}", run.warnings);
        let at_tips = grow_by_bonds(PANEL, &[spacing, p]);
        assert!(run.life_cycles() < at_tips.life_cycles(), "{p}: {} and {}", run.life_cycles(), at_tips.life_cycles());
    }
}

#[test]
fn a_tip_at_an_edge_ends_and_the_other_goes_on() {
    for driver in DRIVERS {
        // A low stress: the last ligament is then as small as the lattice resolves, not what overload leaves.
        let low = [driver, "loading.stress_max_mpa=5", "stop.cycles_max=1e15"];
        let run = grow(&format!("{PLATE}cracks=[{{from_mm=[-15,0],to_mm=[-5,0]}}]\n"), &low);
        sound("edge", &run);
        assert!(is_through(&run), "{}", run.stop);
        let [left, right] = run.curve.last().unwrap().tips[..] else { panic!("two tips") };
        assert!((left.position[0] + 20.0 * MM).abs() < run.figures.horizon, "{}", left.position[0] / MM);
        assert!((right.position[0] - 20.0 * MM).abs() < 1.5 * run.figures.horizon, "{}", right.position[0] / MM);
        assert!(run.curve.iter().all(|point| point.tips.iter().all(|tip| tip.position[1].abs() < run.figures.spacing)));
        // The edge crack left behind is longer than the crack was, so the other tip runs faster than before.
        let at_edge = run.curve.iter().position(|point| point.tips[0].growth >= left.growth - 0.1 * MM).unwrap();
        assert!(run.curve[at_edge].tips[1].growth + 10.0 * MM < right.growth, "the other tip goes on");
        let rate = |from: usize, to: usize| {
            let (a, b) = (&run.curve[from], &run.curve[to]);
            (b.tips[1].growth - a.tips[1].growth) / (b.cycles - a.cycles)
        };
        let later = at_edge + (run.curve.len() - at_edge) / 2;
        assert!(rate(at_edge, later) > rate(0, at_edge));
    }
}

#[test]
fn tips_end_in_holes() {
    for driver in DRIVERS {
        let between =
            "holes=[{x_mm=-12,y_mm=0,diameter_mm=8},{x_mm=12,y_mm=0,diameter_mm=8}]\ncracks=[{from_mm=[-3,0],to_mm=[3,0]}]\n";
        let run = grow(&format!("{PLATE}{between}"), &[driver]);
        sound("between two holes", &run);
        assert_eq!(run.stop, StopReason::EnteredHole);
        let [left, right] = run.curve.last().unwrap().tips[..] else { panic!("two tips") };
        assert!((left.position[0] + right.position[0]).abs() < 1e-9 && (left.position[1] - right.position[1]).abs() < 1e-9);
        // The ligament that was severed is that between the rims, 16 mm.
        assert!((run.crack_length_final() / MM - 16.0).abs() < run.figures.horizon / MM, "{}", run.crack_length_final() / MM);

        let one = "holes=[{x_mm=12,y_mm=0,diameter_mm=8}]\ncracks=[{from_mm=[-8,0],to_mm=[2,0]}]\n";
        let run = grow(&format!("{PLATE}{one}"), &[driver, "loading.stress_max_mpa=5", "stop.cycles_max=1e15"]);
        sound("hole on one side", &run);
        assert!(run.stop == StopReason::EnteredHole || is_through(&run), "{}", run.stop);
        let [left, right] = run.curve.last().unwrap().tips[..] else { panic!("two tips") };
        assert!((right.position[0] - 8.0 * MM).abs() < run.figures.horizon, "{}", right.position[0] / MM);
        assert!((left.position[0] + 20.0 * MM).abs() < 1.5 * run.figures.horizon, "{}", left.position[0] / MM);
    }
}

#[test]
fn collinear_cracks_join_as_mirror_twins() {
    for driver in DRIVERS {
        let two = "cracks=[{from_mm=[-13,0],to_mm=[-5,0]},{from_mm=[5,0],to_mm=[13,0]}]\n";
        let run = grow(&format!("{PLATE}{two}"), &[driver]);
        sound("two cracks", &run);
        assert!(is_through(&run), "{}", run.stop);
        for point in &run.curve {
            // A bond as near to one inner tip as to the other is one's or the other's, and what K of the outer ones is read by is that crack.
            let meeting = (point.tips[1].position[0] - point.tips[2].position[0]).abs() < 3.0 * run.figures.horizon;
            for (a, b) in [(0, 3), (1, 2)] {
                let (a, b) = (point.tips[a], point.tips[b]);
                let slack = if meeting { run.figures.spacing } else { 1e-9 };
                assert!((a.position[0] + b.position[0]).abs() < slack && (a.growth - b.growth).abs() < slack);
                assert!(a.position[1].abs() < 1e-9);
            }
        }
        let joined = run.curve.last().unwrap();
        assert!(joined.tips[1].position[0].abs() < run.figures.horizon, "{}", joined.tips[1].position[0] / MM);
        // Alone, each would live longer: the other one raises its K.
        let half = joined.cycles;
        let one = grow(&format!("{PLATE}cracks=[{{from_mm=[-13,0],to_mm=[-5,0]}}]\n"), &[driver]);
        assert!(one.life_cycles() > half, "{} and {half}", one.life_cycles());
    }
}

/// A crack half a spacing aside stands on a row of points instead of between two: the same plate to half a spacing.
#[test]
fn a_crack_along_a_row_grows_as_one_between_rows() {
    let life = |x: f64| {
        let crack =
            format!("kind=\"plate\"\nwidth_mm=48\nlength_mm=60\nthickness_mm=2\ncracks=[{{from_mm=[{x},-9],to_mm=[{x},9]}}]\n");
        let run = grow(&crack, &["loading.edges=[\"left\",\"right\"]", "stop.crack_length_mm=30"]);
        sound(&format!("crack at x = {x}"), &run);
        for tip in &run.curve.last().unwrap().tips {
            assert!((tip.position[0] - x * MM).abs() < run.figures.spacing, "x = {x}: {}", tip.position[0] / MM);
        }
        run.life_cycles()
    };
    let (between, along) = (life(0.0), life(0.5));
    assert!((along / between - 1.0).abs() < 0.08, "{along} along a row, {between} between rows");
}

/// Along the diagonal many bonds bridge the wake for long; breaking late, they must not turn the tip round.
#[test]
fn a_crack_along_the_diagonal_grows_forward() {
    let x = 24.0 * 0.5_f64.sqrt();
    let crack =
        format!("kind=\"plate\"\nwidth_mm=90\nlength_mm=90\nthickness_mm=2\ncracks=[{{from_mm=[-{x},-{x}],to_mm=[{x},{x}]}}]\n");
    for nu in ["material.poisson_ratio=0.1", "material.poisson_ratio=0.3"] {
        let run = grow_by_bonds(&crack, &[nu, "stop.crack_length_mm=60"]);
        sound(nu, &run);
        let tips = &run.curve.last().unwrap().tips;
        // Across the load: forward and, for the tip at the upper right, to the right.
        for (tip, sign) in tips.iter().zip([-1.0, 1.0]) {
            assert!(sign * tip.position[0] > x * MM + 3.0 * MM, "{nu}: {:?}", tip.position);
        }
    }
}

#[test]
fn any_size_of_a_ends_well() {
    let life = |a: &str| {
        let run = grow_by_bonds(PANEL, &["model.spacing_mm=2", &format!("fatigue.a={a}"), "stop.cycles_max=1e9"]);
        sound(a, &run);
        run
    };
    // Lives go with 1/A over any range.
    let (usual, large) = (life("6450"), life("6.45e33"));
    assert_eq!(usual.stop, large.stop);
    assert!((usual.life_cycles() / large.life_cycles() / 1e30 - 1.0).abs() < 1e-9);
    // Nothing happens before the run-out.
    for small in ["6.45e-4", "1e-60"] {
        let run = life(small);
        assert_eq!((run.stop, run.life_cycles(), run.figures.blocks), (StopReason::RunOut, 1e9, 1), "{small}");
        assert_eq!(run.crack_length_final(), run.curve[0].crack_length, "{small}");
    }
}

/// s_min = max(s_min, 0): a closed crack takes no part of the compression.
#[test]
fn compression_does_not_count() {
    let life = |ratio: &str| {
        let run = grow(PANEL, &["model.spacing_mm=2", &format!("loading.stress_ratio={ratio}"), "stop.crack_length_mm=14"]);
        assert_eq!(run.stop, StopReason::CrackLengthReached, "{ratio}");
        run.life_cycles()
    };
    let zero = life("0");
    for ratio in ["-0.5", "-1", "-5"] {
        assert_eq!(life(ratio), zero, "{ratio}");
    }
    // At equal maximum the range is (1-R) s_max.
    let half = life("0.5");
    assert!((half / zero / 2.0_f64.powf(2.86) - 1.0).abs() < 1e-6, "{half} and {zero}");
}

#[test]
fn low_and_high_exponents_follow_the_load() {
    for p in [1.0, 12.0] {
        let life = |stress: f64| {
            let load = format!("loading.stress_max_mpa={stress}");
            let a = format!("fatigue.a={:e}", 200.0_f64.powf(p));
            let run = grow_by_bonds(PANEL, &["model.spacing_mm=2", &load, &format!("fatigue.p={p}"), &a, "stop.cycles_max=1e15"]);
            sound(&format!("p = {p}, {stress} MPa"), &run);
            assert!(is_through(&run), "p = {p}: {}", run.stop);
            run.life_cycles()
        };
        // 1 % keeps the overload at the very end at the same length.
        let ratio = life(70.0) / life(70.7);
        assert!((ratio.ln() / 1.01_f64.ln() / p - 1.0).abs() < 1e-3, "p = {p}: life ratio {ratio}");
    }
}

/// Bonds below three spacings have too few neighbours for one A: the warning says 40 % at 1.5 and up to 15 % at 2.
#[test]
fn horizon_ratios_agree_or_say_how_wrong_they_are() {
    let panel = "kind=\"middle_tension\"\nwidth_mm=56\nlength_mm=56\nthickness_mm=2\ncrack_length_mm=14\n";
    let run = |ratio: f64| {
        let set = ["model.spacing_mm=1", &format!("model.horizon_ratio={ratio}"), "stop.crack_length_mm=20"];
        let told = case(panel, &[&[BOND_STRAIN], &set[..]].concat()).warnings.iter().any(|line| line.contains("is too small"));
        let run = grow_by_bonds(panel, &set);
        sound(&format!("ratio {ratio}"), &run);
        assert_eq!(run.stop, StopReason::CrackLengthReached, "{ratio}");
        (run.life_cycles(), told)
    };
    let (reference, told) = run(3.015);
    assert!(!told);
    for (ratio, expected, bound) in [(1.5, 0.6, 0.1), (2.0, 1.0, 0.15)] {
        let (life, told) = run(ratio);
        assert!((life / reference - expected).abs() < bound, "{ratio}: {}", life / reference);
        assert!(told, "{ratio}");
    }
}

#[test]
fn a_spacing_is_moved_to_one_that_fits() {
    let run = |spacing: &str| {
        let run = grow(PANEL, &[&format!("model.spacing_mm={spacing}"), "stop.crack_length_mm=14"]);
        sound(spacing, &run);
        run
    };
    // 48 mm hold 28 spacings of 12/7 mm and 62 of 24/31 mm.
    for (given, columns) in [("1.7", 28.0), ("0.77", 62.0)] {
        let moved = run(given);
        let spacing = 48.0 * MM / columns;
        assert!((moved.figures.spacing / spacing - 1.0).abs() < 1e-12, "{}", moved.figures.spacing);
        assert!((moved.figures.horizon / (3.015 * spacing) - 1.0).abs() < 1e-12, "{}", moved.figures.horizon);
        // A belongs to the horizon that is there: the life is that of the spacing itself.
        let exact = run(&format!("{}", spacing / MM));
        assert!((moved.life_cycles() / exact.life_cycles() - 1.0).abs() < 1e-9);
        assert_eq!(moved.figures.points, exact.figures.points);
    }
}
