//! Loads other than a tension of the ends: a direction of the traction on edges, pressure on cracks, cycles of a displacement.

use std::f64::consts::PI;
use std::path::Path;

use perilife_growth::case::Case;
use perilife_growth::cracks::initial_tips;
use perilife_growth::nodes::NodePlate;
use perilife_growth::points::PointPlate;
use perilife_growth::predict::{Prediction, Silent, StopReason, predict};
use perilife_plate::loading::pieces::load_pieces;
use perilife_plate::specimen::handbook::handbook;
use perilife_study::cases::by_name;

use crate::support::shared::shared;

const STEADY: &str = "[material]\nyoungs_modulus_gpa = 70\npoisson_ratio = 0.3\nplane = \"stress\"\n\
                      [fatigue]\nparis_c_mm_per_cycle = 1e-9\nparis_m = 3\n";

fn case(specimen: &str, loading: &str, set: &[&str]) -> Case {
    let text = format!("[specimen]\nthickness_mm = 2\n{specimen}\n[loading]\nstress_ratio = 0\n{loading}\n{STEADY}");
    let set: Vec<String> = set.iter().map(|key| (*key).to_owned()).collect();
    Case::from_toml(&text, "load", Path::new(""), &by_name(&text, &set)).unwrap()
}

fn plate(cracks: &str, loading: &str, spacing: f64) -> Case {
    let specimen = format!("kind = \"plate\"\nwidth_mm = 60\nlength_mm = 120\ncracks = [{cracks}]");
    case(&specimen, loading, &[&format!("model.spacing_mm={spacing}")])
}

/// K_I and K_II in MPa√m, T in MPa.
fn tips(case: &Case) -> Vec<[f64; 3]> {
    let tips = initial_tips::<PointPlate>(case).unwrap().tips;
    tips.iter().map(|tip| [tip.factors.unwrap()[0] / 1e6, tip.factors.unwrap()[1] / 1e6, tip.t_stress.unwrap() / 1e6]).collect()
}

fn run(case: &Case) -> Prediction {
    predict(case, &Silent).unwrap()
}

/// A pressure beside a stress adds its K; a plate on whose crack alone a load acts is severed as any other.
#[test]
fn pressure_adds_to_a_stress_and_follows_the_crack() {
    let crack = "{ from_mm = [-8, 0], to_mm = [8, 0] }";
    let [both, pulled] =
        ["stress_max_mpa = 50\ncrack_pressure_mpa = 25", "stress_max_mpa = 50"].map(|l| tips(&plate(crack, l, 1.0))[0][0]);
    assert!((both / pulled / 1.5 - 1.0).abs() < 0.005, "{both}, {pulled}");
    let [pressed, pulled] = ["crack_pressure_mpa = 50", "stress_max_mpa = 50"].map(|l| run(&plate(crack, l, 1.0)));
    let (life, right) = (pressed.life_cycles(), pulled.life_cycles());
    assert!((life / right - 1.0).abs() < 0.01, "{life}, {right}");
    assert_eq!(pressed.stop, StopReason::Severed);
}

/// A piece of plate that crossing cracks and the edge between them cut off moves freely under the pressure: the plate is severed.
#[test]
fn pressure_parts_a_plate() {
    let cracks = "{ from_mm = [-30, 0], to_mm = [-10, 0] }, { from_mm = [-25, -10], to_mm = [-25, 10] }";
    let parted = run(&plate(cracks, "stress_max_mpa = 40\ncrack_pressure_mpa = 40", 1.0));
    assert_eq!(parted.stop, StopReason::Severed, "{:?}", parted.warnings);
}

/// Edge crack in a plate held at the bottom, sheared at the top: finite elements 34.04 and 4.537 MPa√m; 34.0 and 4.55 by Yau, Wang and
/// Corten (1980). K_II does not depend on the points.
#[test]
fn a_sheared_edge() {
    let Some(path) = shared("field/mechanics/shear_edges/edge_crack_shear.toml") else { return };
    for spacing in ["0.5", "0.7", "1"] {
        let case = Case::from_file(&path, &[format!("model.spacing_mm={spacing}")]).unwrap();
        let [k_i, k_ii, _] = tips(&case)[0];
        println!("{spacing} mm: K_I {k_i:.4}, K_II {k_ii:.4}");
        assert!((k_i / 34.04 - 1.0).abs() < 0.005 && (k_ii / 4.537 - 1.0).abs() < 0.005, "{k_i}, {k_ii}");
    }
}

/// A square under pure shear of all its sides: K_II = τ√(πa) but for the sides, K_I = 0; turned by 45° the same crack opens.
#[test]
fn pure_shear() {
    let sides =
        "edges = [\"top\", \"bottom\", \"right\", \"left\"]\ndirection = [[1, 0], [-1, 0], [0, 1], [0, -1]]\nstress_max_mpa = 50";
    let cracks = [
        ("{ from_mm = [-8, 0], to_mm = [8, 0] }", [0.0, 1.0]),
        ("{ from_mm = [-5.657, 5.657], to_mm = [5.657, -5.657] }", [1.0, 0.0]),
    ];
    for (crack, right) in cracks {
        let case = case(
            &format!("kind = \"plate\"\nwidth_mm = 160\nlength_mm = 160\ncracks = [{crack}]"),
            sides,
            &["model.spacing_mm=0.8"],
        );
        let size = 50.0 * (PI * 8e-3_f64).sqrt();
        for tip in tips(&case) {
            let [k_i, k_ii, _] = tip.map(|k| k / size);
            // Long against the crack, the sides add less than a percent.
            assert!((k_i - right[0]).abs() < 0.015 && (k_ii.abs() - right[1]).abs() < 0.015, "{tip:?}");
        }
    }
}

/// Middle tension under a kept mean displacement of its ends, which bear a uniform stress: `P = δ/C(a)` with the compliance that K says, `C = L/(E W t) + 4t/(E P²) ∫ K² da`.
#[test]
fn cycles_of_a_displacement() {
    let panel = "kind = \"middle_tension\"\nwidth_mm = 100\nlength_mm = 200\ncrack_length_mm = 8";
    let kept = "kind = \"displacement\"\ngrip = \"mean\"\ndisplacement_max_mm = 0.2";
    let [kept, loaded] = [kept, "force_max_n = 13719.7"].map(|loading| run(&case(panel, loading, &["stop.crack_length_mm=40"])));
    let (width, length, thickness, modulus, displacement) = (0.1, 0.2, 2e-3, 70e9, 0.2e-3);
    let factor = |a: f64| (PI * a / (PI * a / width).cos()).sqrt();
    let section = width * thickness;
    let compliance = |squares: f64| length / (modulus * section) + 4.0 * thickness / (modulus * section * section) * squares;
    let (mut squares, mut cycles, step) = (0.0, 0.0, 1e-6);
    let mut a = 0.5 * step;
    while a < 40e-3 {
        squares += factor(a).powi(2) * step;
        if a > 8e-3 {
            let k = displacement / compliance(squares) / section * factor(a) / 1e6;
            cycles += 1e3 * step / (1e-9 * k.powi(3));
        }
        a += step;
    }
    let force = kept.curve.last().unwrap().work / displacement;
    assert!((kept.life_cycles() / cycles - 1.0).abs() < 0.01);
    assert!((force * compliance(squares) / displacement - 1.0).abs() < 0.01);
    // Both begin with the same load.
    assert!((loaded.curve[0].delta_k / kept.curve[0].delta_k - 1.0).abs() < 0.002);
    // And the kept displacement loses load.
    assert!(kept.life_cycles() > 1.1 * loaded.life_cycles());
    assert!(kept.cross_check.unwrap().difference.abs() < 0.05, "{:?}", kept.cross_check);
}

/// Compact tension: the displacement is that of the pins, which press their holes oval besides; what cracks add to the compliance is that
/// of Saxena and Hudak (1978), `E B v/P = ((1+α)/(1-α))² (2.163 + 12.219α - 20.065α² - 0.9925α³ + 20.609α⁴ - 9.9314α⁵)`.
#[test]
fn compliance_of_a_compact_specimen() {
    let specimen = "kind = \"compact_tension\"\nwidth_mm = 50\ncrack_length_mm = 20";
    let kept = run(&case(
        specimen,
        "kind = \"displacement\"\ndisplacement_max_mm = 0.1",
        &["model.spacing_mm=0.5", "stop.crack_length_mm=32"],
    ));
    let handbook = |a: f64| {
        let alpha = a / 50e-3;
        let terms = [2.163, 12.219, -20.065, -0.9925, 20.609, -9.9314];
        ((1.0 + alpha) / (1.0 - alpha)).powi(2) * terms.iter().rev().fold(0.0, |sum, term| sum * alpha + term)
    };
    let found = |work: f64| 70e9 * 2e-3 * 0.1e-3 / (work / 0.1e-3);
    let ends = [&kept.curve[0], kept.curve.last().unwrap()];
    let [less, more] = ends.map(|row| [found(row.work), handbook(row.crack_length)]);
    assert!(((more[0] - less[0]) / (more[1] - less[1]) - 1.0).abs() < 0.015, "{less:?}, {more:?}");
}

/// Rows (crack length, mm, load) with two corners.
const ROWS: [[f64; 2]; 4] = [[5.0, 120.0], [18.0, 80.0], [25.0, 75.0], [40.0, 30.0]];

fn load_at(length: f64) -> f64 {
    let place = ROWS[1..3].iter().filter(|row| row[0] <= length).count();
    let [[a, low], [b, high]] = [ROWS[place], ROWS[place + 1]];
    low + (length - a) / (b - a) * (high - low)
}

/// `∫ da / (C (K(a) F(a))^m)` by K at unit load, in `parts`.
fn quadrature(k: &dyn Fn(f64) -> f64, load: &dyn Fn(f64) -> f64, [from, to]: [f64; 2]) -> f64 {
    let parts = 20_000;
    let of = |i: usize| from + (to - from) * (i as f64 + 0.5) / parts as f64;
    (0..parts).map(|i| (to - from) / parts as f64 / (1e-9 * (k(of(i)) * load(of(i))).powi(3))).sum()
}

/// Cycles under a load that follows the crack are those of K(a) F(a), whichever way K is found, and K at a load does not change by it.
#[test]
fn a_load_that_follows_the_crack_scales_k() {
    let kinds = [
        ("kind = \"middle_tension\"\nwidth_mm = 100\nlength_mm = 200\ncrack_length_mm = 10", "stress_max_mpa", 32.0),
        (
            "kind = \"single_edge_tension\"\nends = \"uniform_stress\"\nwidth_mm = 60\nlength_mm = 180\ncrack_length_mm = 10",
            "stress_max_mpa",
            28.0,
        ),
        ("kind = \"compact_tension\"\nwidth_mm = 60\ncrack_length_mm = 15", "force_max_n", 34.0),
    ];
    for (specimen, key, to) in kinds {
        for (method, bound) in [("handbook", 1e-4), ("element_free_galerkin", 1e-3), ("peridynamics", 1e-3)] {
            let set = [format!("stop.crack_length_mm={to}"), format!("model.method=\"{method}\"")];
            let set = [&*set[0], &*set[1], "stop.cycles_max=1e15", "fatigue.step_error_percent=0.05"];
            let follows = case(specimen, &format!("{key} = {ROWS:?}"), &set);
            let (formula, unit) = (handbook(&follows.specimen).unwrap(), if key == "force_max_n" { 1.0 } else { 1e6 });
            let follows = run(&follows);
            let rows = follows
                .curve
                .iter()
                .filter(|row| row.delta_k.is_finite())
                .map(|row| [row.crack_length / 1e-3, row.delta_k / 1e6]);
            let own: Vec<[f64; 2]> = rows.map(|[length, k]| [length, k / load_at(length)]).collect();
            let between = |a: f64| {
                let next = own.partition_point(|row| row[0] < a).clamp(1, own.len() - 1);
                let [[from, low], [to, high]] = [own[next - 1], own[next]];
                (low.ln() + (a - from) / (to - from) * (high / low).ln()).exp()
            };
            for [length, k] in &own {
                let known = formula.k_i(length * 1e-3, unit) / 1e6;
                assert!((k / known - 1.0).abs() < 0.01, "{specimen}, {method}: K by load {k} for {known} at {length} mm");
            }
            let start = own[0][0];
            let expected = quadrature(&between, &load_at, [start, to]);
            let off = follows.life_cycles() / expected - 1.0;
            println!("{key}, {method}: {:.0} cycles, {off:+.1e} off", follows.life_cycles());
            assert!(off.abs() < bound, "{specimen}, {method}: {} cycles for {expected}", follows.life_cycles());
            assert!(follows.cross_check.is_none_or(|check| check.difference.abs() < 0.015), "{:?}", follows.cross_check);
        }
    }
}

/// Under F(a) = K / K₁(a) the crack grows at one rate: a over N is a straight line, and toughness ends it nowhere below K.
#[test]
fn a_load_that_keeps_k_constant_makes_a_straight_line() {
    let specimen = "kind = \"compact_tension\"\nwidth_mm = 50\ncrack_length_mm = 15";
    let unit = case(specimen, "force_max_n = 1000", &["model.method=\"handbook\""]);
    let formula = handbook(&unit.specimen).unwrap();
    let rows: Vec<[f64; 2]> =
        (0..=200).map(|i| 15.0 + 0.1 * f64::from(i)).map(|a| [a, 15e6 / formula.k_i(a * 1e-3, 1.0)]).collect();
    let load = format!("force_max_n = {rows:?}");
    let set = ["model.method=\"handbook\"", "stop.crack_length_mm=34"];
    for (toughness, stop) in [("15.1", StopReason::CrackLengthReached), ("14.9", StopReason::Toughness)] {
        let of = format!("material.toughness_mpa_sqrt_m={toughness}");
        let done = run(&case(specimen, &load, &[set[0], set[1], &*of]));
        assert_eq!(done.stop, stop);
        let rate = 1e-9 * 15_f64.powi(3);
        for row in &done.curve {
            let straight = (row.crack_length - 0.015) / 1e-3 / rate;
            assert!((row.cycles - straight).abs() < 1e-4 * (0.019 / 1e-3 / rate), "{row:?}");
        }
    }
}

/// Cycles of a displacement break a plate by the load that they make: the same as those of that load.
#[test]
fn a_displacement_yields_the_section_by_its_load() {
    let specimen = "kind = \"middle_tension\"\nwidth_mm = 50\nlength_mm = 100\ncrack_length_mm = 10";
    let set = ["material.yield_strength_mpa=100", "model.method=\"element_free_galerkin\""];
    let moved = |most: f64| run(&case(specimen, &format!("kind = \"displacement\"\ndisplacement_max_mm = {most}"), &set));
    // P δ is the work; the section of 30 mm yields at 60 MPa.
    let gross = |done: &Prediction, most: f64| done.curve[0].work / (most * 1e-3 * 0.05 * 0.002) / 1e6;
    let light = moved(0.05);
    let yields_at = 0.05 * 60.0 / gross(&light, 0.05);
    for (share, is_broken) in [(0.98, false), (1.02, true)] {
        let done = moved(share * yields_at);
        assert_eq!(done.stop == StopReason::NetSectionYield && done.curve.len() == 1, is_broken, "{share}: {:?}", done.stop);
    }
}

/// A load on a side into which a notch opens has its resultant and moment on the material beside the mouth, on nodes as on points; stress along
/// the crack does not open it.
#[test]
fn a_load_over_the_mouth_of_a_notch() {
    let loading = "stress_max_mpa = 60\nstress_parallel_ratio = -0.5";
    let of = |notch: &str, model: &str| {
        let plate = "kind = \"plate\"\nwidth_mm = 60\nlength_mm = 150\ncracks = [{ from_mm = [-5, 0], to_mm = [5, 0] }]";
        case(&format!("{plate}\n{notch}"), loading, &[model])
    };
    let notched = |model| of("notches = [{ from_mm = [30, 34.6], to_mm = [21.5, 34.6], width_mm = 3 }]", model);
    let [on_points, on_nodes] = ["model.spacing_mm=1", "model.method=element_free_galerkin"].map(notched);
    let resultant = |case: &Case| {
        let mut sum = [0.0; 3];
        for piece in load_pieces(&case.specimen, 1e-3) {
            let ([x, y], [fx, fy]) = (piece.facet.at, piece.force);
            [fx.abs(), fy.abs(), x * fy - y * fx].into_iter().zip(&mut sum).for_each(|(part, sum)| *sum += part);
        }
        sum
    };
    let (given, whole) = (resultant(&on_points), resultant(&of("", "model.spacing_mm=1")));
    assert!((0..2).all(|axis| (given[axis] / whole[axis] - 1.0).abs() < 1e-12), "{given:?} {whole:?}");
    assert!(given[2].abs() < 1e-9 * whole[0], "{given:?}");
    let nodes = initial_tips::<NodePlate>(&on_nodes).unwrap().tips;
    for (node, [k_i, _, t]) in nodes.iter().zip(tips(&on_points)) {
        let (factor, stress) = (node.factors.unwrap()[0] / 1e6, node.t_stress.unwrap() / 1e6);
        assert!((factor / k_i - 1.0).abs() < 0.005 && (stress / t - 1.0).abs() < 0.02, "{factor} {k_i}, {stress} {t}");
    }
}
