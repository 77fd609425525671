//! Edges that cycles of a displacement move straight, on points and on nodes.

use std::path::Path;

use perilife_growth::case::Case;
use perilife_growth::predict::{Prediction, Silent, predict};

/// Points by default, then nodes.
const ENGINES: [&str; 2] = ["model.method=peridynamics", "model.method=element_free_galerkin"];

fn case(specimen: &str, more: &str, set: &[&str]) -> Case {
    let text = format!(
        "[specimen]\nthickness_mm = 1\n{specimen}\n[material]\nyoungs_modulus_gpa = 70\npoisson_ratio = 0.3\nplane = \"stress\"\n\
         [fatigue]\nparis_c_mm_per_cycle = 1e-8\nparis_m = 3\n[loading]\nkind = \"displacement\"\nstress_ratio = 0\n{more}"
    );
    let set: Vec<String> = set.iter().map(|key| (*key).to_owned()).collect();
    Case::from_toml(&text, "grips", Path::new(""), &set).unwrap()
}

fn plate(size: [f64; 2], crack: [[f64; 2]; 2], more: &str, set: &[&str]) -> Case {
    let ([width, length], [from, to]) = (size, crack);
    let cracks = format!("cracks = [{{ from_mm = {from:?}, to_mm = {to:?} }}]");
    case(&format!("kind = \"plate\"\nwidth_mm = {width}\nlength_mm = {length}\n{cracks}"), more, set)
}

/// K_I and K_II of the first tip in MPa√m at N = 0.
fn factors(mut case: Case) -> [f64; 2] {
    case.stop.cycles_max = 1.0;
    let run = predict(&case, &Silent).unwrap();
    run.curve[0].tips[0].factors.unwrap().map(|k| k / 1e6)
}

fn cycles_at(run: &Prediction, length: f64) -> f64 {
    let pair = run.curve.windows(2).find(|pair| pair[1].crack_length >= length - 1e-9).unwrap();
    let share = (length - pair[0].crack_length) / (pair[1].crack_length - pair[0].crack_length);
    pair[0].cycles + share * (pair[1].cycles - pair[0].cycles)
}

const BOTTOM: &str = "[supports]\nbottom = { fix = [\"x\", \"y\"] }";

/// A long strip between grips that move apart by v: far behind the tip it is at rest, far ahead it is stretched by v/H along y alone, so that
/// `G = H/2 E/(1-ν²) (v/H)²` and `K = E v / √(2 H (1-ν²))` at every length (Rivlin and Thomas 1953).
#[test]
fn a_strip_between_grips() {
    for (size, v, apart) in [([200.0, 40.0], 0.04, false), ([120.0, 24.0], 0.01, true)] {
        let right = 70.0 * v / (2e-3 * size[1] * 0.91_f64).sqrt();
        for share in [0.3, 0.5, 0.65] {
            let crack = [[-size[0] / 2.0, 0.0], [(share - 0.5) * size[0], 0.0]];
            let held = if apart { "" } else { BOTTOM };
            let more = format!("displacement_max_mm = {v}\ntransverse = \"held\"\n{held}");
            for engine in ENGINES {
                let [k_i, k_ii] = factors(plate(size, crack, &more, &[engine]));
                println!("{size:?} {share} {engine}: {k_i:.4}, {k_ii:.4}, right {right:.4}");
                assert!((k_i / right - 1.0).abs() < 0.005 && k_ii.abs() < 0.005 * right, "{engine}: {k_i}, {k_ii}, {right}");
            }
        }
    }
}

/// The same with an edge that slides in its grip: finite elements 10.20 and 1.32 MPa√m, and 10.20 upside down.
#[test]
fn a_strip_that_slides_in_its_grip() {
    let crack = [[-100.0, 0.0], [0.0, 0.0]];
    let top = "[supports]\ntop = { fix = [\"x\", \"y\"] }";
    for (held, sign) in [(BOTTOM, 1.0), (top, -1.0)] {
        for engine in ENGINES {
            let [k_i, k_ii] = factors(plate([200.0, 40.0], crack, &format!("displacement_max_mm = 0.04\n{held}"), &[engine]));
            println!("{held} {engine}: {k_i:.4}, {k_ii:.4}");
            assert!((k_i / 10.20 - 1.0).abs() < 0.005 && (sign * k_ii - 1.32).abs() < 0.1, "{engine}: {k_i}, {k_ii}");
        }
    }
}

/// An edge crack to the middle of a short plate: finite elements 16.29 MPa√m where the moved edge slides, 16.38 where it does not, which is
/// what clamped ends of a standard specimen do. On its side it is the same plate.
#[test]
fn a_clamped_edge_crack() {
    let across = [[-25.0, 0.0], [0.0, 0.0]];
    let moved = |words: &str| format!("displacement_max_mm = 0.1\n{words}");
    let turned = "edges = [\"right\"]\ntransverse = \"held\"\n[supports]\nleft = { fix = [\"x\", \"y\"] }";
    let single = "kind = \"single_edge_tension\"\nwidth_mm = 50\nlength_mm = 100\ncrack_length_mm = 25\nends = \"clamped\"";
    for engine in ENGINES {
        let found = [
            (factors(plate([50.0, 100.0], across, &moved(BOTTOM), &[engine])), 16.29),
            (factors(plate([50.0, 100.0], across, &moved(&format!("transverse = \"held\"\n{BOTTOM}")), &[engine])), 16.38),
            (factors(plate([100.0, 50.0], [[0.0, -25.0], [0.0, 0.0]], &moved(turned), &[engine])), 16.38),
            (factors(case(single, &moved(""), &[engine])), 16.38),
        ];
        for ([k_i, _], right) in found {
            assert!((k_i / right - 1.0).abs() < 0.01, "{engine}: {k_i}, {right}");
        }
    }
}

/// From 100 to 120 mm at 10.377 MPa√m: 20 mm / (1e-8 · 10.377³) = 1.79e6 cycles; the force of the grip falls with the length that bears,
/// `P δ = 2 G` times what the crack has grown.
#[test]
fn a_life_between_grips() {
    let more = format!("displacement_max_mm = 0.04\ntransverse = \"held\"\n{BOTTOM}");
    for engine in ENGINES {
        let crack = [[-100.0, 0.0], [0.0, 0.0]];
        let run = predict(&plate([200.0, 40.0], crack, &more, &[engine, "stop.crack_length_mm=120"]), &Silent).unwrap();
        let cycles = cycles_at(&run, 0.12);
        let (first, last) = (&run.curve[0], run.curve.last().unwrap());
        let lost = (first.work - last.work) / (last.crack_length - first.crack_length);
        let released = 2.0 * 1e-3 * 10.377e6_f64.powi(2) / 70e9;
        assert!((cycles / 1.79e6 - 1.0).abs() < 0.02, "{engine}: {cycles}");
        assert!((lost / released - 1.0).abs() < 0.02, "{engine}: {lost}, {released}");
    }
}

/// Slanted cracks between ends that move apart, and sheared sides: points and nodes agree, and every solver of points gives the same where sides are sheared.
#[test]
fn engines_agree_between_grips() {
    let slant = [[-8.0, -5.0], [8.0, 5.0]];
    let sheared = "edges = [\"top\"]\ndirection = [-1, 0]\ntransverse = \"held\"\n[supports]\nbottom = { fix = [\"x\", \"y\"] }";
    let plates = [
        ("slides", slant, ""),
        ("held", slant, "transverse = \"held\""),
        ("sides", [[2.0, -10.0], [-4.0, 8.0]], "edges = [\"left\", \"right\"]"),
        ("sheared", [[-20.0, 0.0], [-2.0, 4.0]], sheared),
    ];
    for (name, crack, words) in plates {
        let of = |set: &[&str]| factors(plate([40.0, 50.0], crack, &format!("displacement_max_mm = 0.05\n{words}"), set));
        let [points, nodes] = ENGINES.map(|engine| of(&[engine]));
        let size = nodes[0].hypot(nodes[1]);
        assert!((0..2).all(|i| (points[i] - nodes[i]).abs() < 0.015 * size), "{name}: {points:?}, {nodes:?}");
        // Sheared, every part of the edge is moved and held: one plate for all solvers.
        for set in if name == "sheared" { ["model.solver=\"multigrid\""].as_slice() } else { &[] } {
            let other = of(&[*set]);
            assert!((0..2).all(|i| (points[i] - other[i]).abs() < 1e-4 * size), "{name} {set}: {points:?}, {other:?}");
        }
    }
}
