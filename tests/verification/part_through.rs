//! Cracks that do not go through: K of every kind, branch and end, lives of both ends of a front, and what comes after break-through.

use std::f64::consts::{FRAC_2_PI, PI};

use perilife_base::quadrature::integrate;
use perilife_base::units::MM;
use perilife_growth::case::Case;
use perilife_growth::predict::checkpoint::Checkpoint;
use perilife_growth::predict::part_through::PartThroughLife;
use perilife_growth::predict::tip_factors::{StressIntensityMethod, stress_intensity};
use perilife_growth::predict::{CurvePoint, Prediction, Silent, StopReason, predict, resume};
use perilife_plate::specimen::{FrontTip, PartThrough, SpecimenKind};

use crate::support::hand_cases::{hand_case, hand_run};
use crate::support::plates::cracks;
use crate::verification::checkpoint::Keeping;

const KINDS: [SpecimenKind; 4] =
    [SpecimenKind::SurfaceCrack, SpecimenKind::CornerCrack, SpecimenKind::EmbeddedCrack, SpecimenKind::CornerCrackAtHole];

/// `[specimen]` of a crack with a in mm at these a/c, a/t and c/b, t and b in the letters of the report.
fn keys(kind: SpecimenKind, [aspect, depth, width]: [f64; 3], hole: &str) -> String {
    let (a, embedded) = (2.0, kind == SpecimenKind::EmbeddedCrack);
    let c = a / aspect;
    let thickness = a / depth * if embedded { 2.0 } else { 1.0 };
    // b of a crack at an edge is the whole width.
    let b = c / width * if kind == SpecimenKind::CornerCrack { 1.0 } else { 2.0 };
    format!(
        "kind = \"{kind}\"\nwidth_mm = {b:?}\nthickness_mm = {thickness:?}\ncrack_depth_mm = {a:?}\ncrack_half_length_mm = {c:?}\n{hole}"
    )
}

fn flaw(keys: &str, set: &[&str]) -> PartThrough {
    hand_case(keys, &[&["model.method=auto"], set].concat()).specimen.part_through.unwrap()
}

/// K/(σ √(πa)) at the depth and on the face.
fn factors(flaw: &PartThrough) -> [f64; 2] {
    FrontTip::ALL.map(|tip| flaw.k_i(flaw.start(), 1.0, tip) / (PI * flaw.depth).sqrt())
}

fn assert_near(found: [f64; 2], wanted: [f64; 2], what: &str) {
    for (found, wanted) in found.into_iter().zip(wanted) {
        assert!((found / wanted - 1.0).abs() < 2e-4 + 0.5e-4 / wanted, "{what}: {found} for {wanted}");
    }
}

/// `../shared/data/retardation.md`, in which the figures of 1984 are computed from the formulas.
#[test]
fn tension_has_the_factors_of_newman_and_raju() {
    let rows: [([f64; 3], [[f64; 2]; 3]); 4] = [
        ([1.0, 0.2, 0.05], [[0.6678, 0.7439], [0.7366, 0.7433], [0.6386, 0.6383]]),
        ([1.0, 0.5, 0.1], [[0.6926, 0.8224], [0.8246, 0.8707], [0.6556, 0.6453]]),
        ([0.5, 0.5, 0.1], [[1.0311, 0.8658], [1.1964, 0.8933], [0.8764, 0.6034]]),
        ([2.0, 0.5, 0.1], [[0.4240, 0.6859], [0.5046, 0.7238], [0.4201, 0.5889]]),
    ];
    for (sizes, wanted) in rows {
        for (kind, wanted) in KINDS.into_iter().zip(wanted) {
            assert_near(factors(&flaw(&keys(kind, sizes, ""), &[])), wanted, &format!("{kind} {sizes:?}"));
        }
    }
    // At a hole: a/c, a/t, R/t, R/b; [a, c] of two cracks and of one. The shared row of a/c = 0.5 lacks g4 = 1 - 0.7 (1 - a/t)(a/c - 0.2)(1 - a/c),
    // 0.9475 there, and is put right by it.
    let g4 = 0.9475;
    let rows: [([f64; 4], [[f64; 2]; 2]); 4] = [
        ([1.0, 0.2, 1.0, 0.1], [[2.0030, 1.6407], [1.9872, 1.6277]]),
        ([1.0, 0.5, 1.0, 0.1], [[1.9219, 1.4593], [1.8378, 1.3955]]),
        ([0.5, 0.5, 0.5, 0.05], [[g4 * 2.0044, g4 * 1.0644], [g4 * 1.7640, g4 * 0.9368]]),
        ([2.0, 0.5, 1.0, 0.1], [[1.3374, 1.5368], [1.3061, 1.5009]]),
    ];
    for ([aspect, depth, radius, share], wanted) in rows {
        let r = radius * 2.0 / depth;
        for (cracks, wanted) in [2, 1].into_iter().zip(wanted) {
            let hole = format!("hole_diameter_mm = {:?}\ncracks = {cracks}\n", 2.0 * r);
            let sizes = [aspect, depth, 2.0 / aspect / (r / share)];
            let found = factors(&flaw(&keys(SpecimenKind::CornerCrackAtHole, sizes, &hole), &[]));
            assert_near(found, wanted, &format!("hole {aspect} {cracks}"));
        }
    }
}

/// K of bending over K of as much tension, computed by a program of its own from the formulas of 1984 (H; at a hole H F_b/F).
#[test]
fn bending_has_the_factors_of_newman_and_raju() {
    let sizes = [[1.0, 0.2, 0.05], [1.0, 0.5, 0.1], [0.5, 0.5, 0.1], [2.0, 0.5, 0.1]];
    let wanted: [(SpecimenKind, [[f64; 2]; 4]); 3] = [
        (KINDS[0], [[0.73080, 0.91], [0.32250, 0.775], [0.38296, 0.80250], [0.18035, 0.85008]]),
        (KINDS[1], [[0.73440, 0.91], [0.34500, 0.775], [0.40546, 0.80250], [0.20285, 0.85008]]),
        (KINDS[3], [[0.49168, 0.75016], [0.19800, 0.70375], [0.26104, 0.78219], [0.15374, 0.70250]]),
    ];
    for (kind, wanted) in wanted {
        for (sizes, wanted) in sizes.into_iter().zip(wanted) {
            let r = if sizes[0] == 0.5 { 0.5 } else { 1.0 } * 2.0 / sizes[1];
            let hole = format!("hole_diameter_mm = {:?}\ncracks = 2\n", 2.0 * r);
            let hole = if kind == KINDS[3] { &*hole } else { "" };
            let keys = keys(kind, sizes, hole);
            let [tension, both] = ["loading.bending_ratio=0", "loading.bending_ratio=1"].map(|set| factors(&flaw(&keys, &[set])));
            assert_near([0, 1].map(|i| both[i] / tension[i] - 1.0), wanted, &format!("bending {kind} {sizes:?}"));
        }
    }
}

/// Both branches meet at a/c = 1; limits of small, flat and wide; the correction of a corner crack for width is that of an edge crack.
#[test]
fn factors_have_their_limits() {
    for kind in KINDS {
        let hole = if kind == KINDS[3] { "hole_diameter_mm = 8\ncracks = 1\n" } else { "" };
        let bent: &[&str] = if kind == KINDS[2] { &[] } else { &["loading.bending_ratio=1"] };
        for depth in [0.2, 0.5, 0.8] {
            let [below, above] =
                [1.0 - 1e-9, 1.0 + 1e-9].map(|aspect| factors(&flaw(&keys(kind, [aspect, depth, 0.02], hole), bent)));
            // H1 at a hole has 4.45 (a/t)² below and 4.51 above in the source itself, of 1 + H1 > 1.5.
            let jump = 3e-3 + if kind == KINDS[3] { (4.51 - 4.45) * depth * depth / 1.5 } else { 0.0 };
            (0..2).for_each(|i| assert!((below[i] / above[i] - 1.0).abs() < jump, "{kind} {depth}: {below:?} and {above:?}"));
        }
    }
    let small = |kind, set: &[&str]| factors(&flaw(&keys(kind, [1.0, 1e-3, 1e-3], ""), set));
    assert!((small(KINDS[0], &[])[0] - 0.6625).abs() < 1e-4);
    assert!((small(KINDS[2], &[])[0] / FRAC_2_PI - 1.0).abs() < 1e-3);
    for kind in [KINDS[0], KINDS[1]] {
        let [tension, both] = [small(kind, &[]), small(kind, &["loading.bending_ratio=1"])];
        (0..2).for_each(|i| assert!((both[i] / tension[i] - 2.0).abs() < 5e-3, "a small crack sees no gradient"));
    }
    // Q is E(k)² within 0.13 %, on both sides of a/c = 1.
    for x in (1..=20).map(|i| 0.05 * f64::from(i)) {
        let e = integrate(|angle| (1.0 - (1.0 - x * x) * angle.sin().powi(2)).sqrt(), 0.0, PI / 2.0, 1e-12).value;
        let flaw = flaw(&keys(KINDS[0], [1.0, 0.2, 0.05], ""), &[]);
        for axes in [[x, 1.0], [1.0, x]] {
            let q = flaw.front(axes).shape_factor();
            assert!((q / (e * e) - 1.0).abs() < 1.4e-3, "a/c {x}: {q} for {}", e * e);
        }
    }
    for width in [0.1, 0.3, 0.5] {
        let of = |width: f64| factors(&flaw(&keys(KINDS[1], [1.0, 1.0 - 1e-9, width], ""), &[]))[1];
        let edge = |x: f64| 1.12 - 0.231 * x + 10.55 * x * x - 21.72 * x.powi(3) + 30.39 * x.powi(4);
        assert!((of(width) / of(1e-4) / (edge(width) / edge(0.0)) - 1.0).abs() < 0.01, "c over width {width}");
    }
}

fn surface(a: f64, c: f64, set: &[&str]) -> Prediction {
    let keys = format!(
        "kind = \"surface_crack\"\nwidth_mm = 100\nlength_mm = 300\nthickness_mm = 6.35\ncrack_depth_mm = {a:?}\ncrack_half_length_mm = {c:?}\n"
    );
    hand_run(&keys, &[&["loading.stress_range_mpa=100", "model.method=auto"], set].concat())
}

fn same(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-9
}

fn depth(row: &CurvePoint) -> f64 {
    row.depth.unwrap().depth / MM
}

/// Lives of `../shared/data/retardation.md`, both ends growing.
#[test]
fn both_ends_of_a_front_grow() {
    for ([a, c], cycles, shape) in [([1.27, 1.27], 179_823.0, 0.7885), ([0.5, 2.5], 189_291.0, 0.7573)] {
        let run = surface(a, c, &["stop.crack_depth_mm=5.08"]);
        assert_eq!(run.stop, StopReason::CrackDepthReached);
        let last = run.curve.last().unwrap();
        println!("{a} {c}: {} cycles, c {}, {} rows", last.cycles, last.crack_length / MM, run.curve.len());
        assert!((last.cycles / cycles - 1.0).abs() < 1e-3 && same(depth(last), 5.08), "{last:?}");
        assert!((depth(last) / (last.crack_length / MM) / shape - 1.0).abs() < 1e-3);
        for rows in run.curve.windows(2) {
            assert!(rows[1].cycles > rows[0].cycles && rows[1].crack_length >= rows[0].crack_length);
        }
        // Straight lines between rows are off by little: a run to the middle of two rows in depth.
        let rows = &run.curve[run.curve.len() / 2..][..2];
        let middle = 0.5 * (depth(&rows[0]) + depth(&rows[1]));
        let exact = surface(a, c, &[&format!("stop.crack_depth_mm={middle:?}")]).life_cycles();
        assert!((0.5 * (rows[0].cycles + rows[1].cycles) - exact).abs() < 1e-4 * last.cycles);
    }
    let c = surface(1.27, 1.27, &["stop.crack_depth_mm=5.08"]).crack_length_final_mm();
    assert!((c / 6.4425 - 1.0).abs() < 1e-3);
}

/// What ends a run before the crack is through.
#[test]
fn fronts_end_as_they_should() {
    let life = surface(1.27, 1.27, &["stop.at_break_through=true"]);
    assert!(life.stop == StopReason::BrokenThrough && same(depth(life.curve.last().unwrap()), 6.35));
    let half = surface(1.27, 1.27, &[&format!("stop.cycles_max={:?}", 0.5 * life.life_cycles())]);
    assert_eq!((half.stop, half.life_cycles()), (StopReason::RunOut, 0.5 * life.life_cycles()));
    let length = surface(1.27, 1.27, &["stop.crack_length_mm=3"]);
    assert!(length.stop == StopReason::CrackLengthReached && same(length.crack_length_final_mm(), 3.0));
    // K of the first row: a little more toughness than that, and none.
    let k_max = life.curve[0].delta_k / 0.8 / 1e6;
    let tough = |factor: f64| {
        surface(1.27, 1.27, &[&format!("material.toughness_mpa_sqrt_m={:?}", factor * k_max), "stop.at_break_through=true"])
    };
    let broken = tough(1.2);
    assert_eq!(broken.stop, StopReason::Toughness);
    assert!((broken.curve.last().unwrap().delta_k / life.curve[0].delta_k / 1.2 - 1.0).abs() < 1e-9);
    assert_eq!((tough(0.9).stop, tough(0.9).curve.len()), (StopReason::Toughness, 1));
    // The section less half an ellipse bears 125 MPa by this strength at the start.
    let strength = 125.0 * 635.0 / (635.0 - 0.5 * PI * 1.27 * 1.27);
    let yields = |factor: f64| surface(1.27, 1.27, &[&format!("material.yield_strength_mpa={:?}", factor * strength)]);
    assert_eq!((yields(0.999).stop, yields(0.999).curve.len()), (StopReason::NetSectionYield, 1));
    assert!(yields(1.001).curve.len() > 1);
    // Above the highest ΔK of both ends nothing grows; between them one end does, until the other joins in.
    let row = &life.curve[0];
    let [low, high] = [row.depth.unwrap().k_i.unwrap(), row.tips[0].factors.unwrap()[0]].map(|k| 0.8 * k / 1e6);
    let with = |threshold: f64| {
        surface(1.27, 1.27, &[&format!("fatigue.delta_k_threshold_mpa_sqrt_m={threshold:?}"), "stop.at_break_through=true"])
    };
    assert_eq!((with(1.001 * high).stop, with(1.001 * high).life()), (StopReason::NothingAges, None));
    let between = with(0.5 * (low + high));
    assert!(same(depth(&between.curve[1]), 1.27) && between.stop == StopReason::BrokenThrough);
    assert!(between.life_cycles() > life.life_cycles());
    // K up and down by 5 %: at m = 2.874 the life is that many times.
    let keys =
        "kind = \"surface_crack\"\nwidth_mm = 100\nthickness_mm = 6.35\ncrack_depth_mm = 1.27\ncrack_half_length_mm = 1.27\n";
    let case = hand_case(keys, &["model.method=auto"]);
    let found = PartThroughLife::of(&case, &life.curve).unwrap();
    for (factor, error) in found.life_factors.into_iter().zip([1.05_f64, 0.95]) {
        assert!((factor / error.powf(-2.874) - 1.0).abs() < 1e-9, "{found:?}");
    }
    let beyond = life.curve.iter().find(|row| depth(row) > 0.8 * 6.35).unwrap().cycles;
    let (_, outside) = found.outside.iter().find(|(limit, _)| limit.name == "a/t").unwrap();
    assert!((outside / (life.life_cycles() - beyond) - 1.0).abs() < 0.05);
}

#[test]
fn a_through_crack_goes_on_as_that_of_a_plate() {
    let sizes = "width_mm = 40\nlength_mm = 80\nthickness_mm = 4\n";
    let flaw = |kind: SpecimenKind, hole: &str| {
        format!("kind = \"{kind}\"\n{sizes}crack_depth_mm = 1.5\ncrack_half_length_mm = 2\n{hole}")
    };
    let hole = "holes = [{ x_mm = 0, y_mm = 0, diameter_mm = 6 }]\n";
    let at_hole = |count: usize| format!("hole_diameter_mm = 6\ncracks = {count}\n");
    type Ends = fn(f64) -> Vec<[f64; 2]>;
    let rows: [(String, &str, Ends, f64); 4] = [
        (flaw(KINDS[0], ""), "", |c| vec![[-c, c]], 2.0),
        (flaw(KINDS[1], ""), "", |c| vec![[-20.0, -20.0 + c]], 1.0),
        (flaw(KINDS[3], &at_hole(1)), hole, |c| vec![[3.0, 3.0 + c]], 1.0),
        (flaw(KINDS[3], &at_hole(2)), hole, |c| vec![[3.0, 3.0 + c], [-3.0, -3.0 - c]], 1.0),
    ];
    for (keys, holes, ends, tips) in rows {
        let set = ["model.method=auto", "stop.crack_length_mm=9"];
        let run = hand_run(&keys, &set);
        assert_eq!(run.stop, StopReason::CrackLengthReached, "{keys}");
        let through = run.curve.iter().position(|row| row.depth.unwrap().k_i.is_none()).unwrap();
        let start = &run.curve[through];
        assert!(through > 10 && run.curve[..through].iter().all(|row| row.depth.unwrap().k_i.is_some()));
        let level: Vec<_> = ends(start.crack_length / MM).iter().map(|[from, to]| [[*from, 0.0], [*to, 0.0]]).collect();
        let plate = format!("kind = \"plate\"\n{sizes}{holes}{}\n", cracks(&level));
        let length = format!("stop.crack_length_mm={:?}", 9.0 * tips);
        let alone = hand_run(&plate, &["model.method=element_free_galerkin", &length]);
        let left = run.life_cycles() - start.cycles;
        println!("{}: {left} cycles left, {} alone, {} before", keys.lines().next().unwrap(), alone.life_cycles(), start.cycles);
        assert!((left / alone.life_cycles() - 1.0).abs() < 2e-3, "{keys}");
        assert!((run.curve.last().unwrap().crack_length / MM - 9.0).abs() < 1e-6);
        let grown = run.curve.last().unwrap().tips[0].growth / MM;
        assert!((grown - 7.0).abs() < 0.05, "growth counts from the start: {grown}");
    }
    // An embedded crack goes through both faces at once, half of the thickness deep; bending ends with break-through.
    let embedded = hand_run(&flaw(KINDS[2], ""), &["model.method=auto", "stop.at_break_through=true"]);
    assert!(embedded.stop == StopReason::BrokenThrough && same(depth(embedded.curve.last().unwrap()), 2.0));
    let bent = hand_run(&flaw(KINDS[0], ""), &["model.method=auto", "loading.bending_ratio=0.5"]);
    assert!(bent.stop == StopReason::BrokenThrough && bent.warnings.iter().any(|line| line.contains("bending out of the plane")));
}

/// A section in tension with bending: of a rectangle `(σ/σ_Y)² + ρ σ/(1.5 σ_Y) = 1` (fully plastic under force and moment), 0.7208 at ρ = 1 and
/// 0.5352 at ρ = 2; without bending all of it. The crack takes its share of the section in each.
#[test]
fn bending_lowers_the_limit_load() {
    for kind in [KINDS[0], KINDS[1], KINDS[3]] {
        let hole = if kind == KINDS[3] { "hole_diameter_mm = 4\ncracks = 1\n" } else { "" };
        let limit = |set: &[&str]| {
            let flaw = flaw(&keys(kind, [1.0, 0.4, 0.1], hole), set);
            flaw.limit_stress(flaw.start(), 1.0)
        };
        let alone = limit(&[]);
        for (set, share) in [("loading.bending_ratio=1", 0.7208), ("loading.bending_ratio=2", 0.5352)] {
            assert!((limit(&[set]) / alone / share - 1.0).abs() < 1e-3, "{kind} {set}: {} of {alone}", limit(&[set]));
        }
    }
}

/// A run that is stopped after break-through and taken up again is the same run.
#[test]
fn a_checkpoint_behind_break_through_goes_on() {
    let keys = "kind = \"surface_crack\"\nwidth_mm = 40\nlength_mm = 80\nthickness_mm = 4\ncrack_depth_mm = 3.5\ncrack_half_length_mm = 3\n";
    let case: Case = hand_case(keys, &["model.method=auto"]);
    let keeping = Keeping::default();
    let whole = predict(&case, &keeping).unwrap();
    let again = resume(&case, Checkpoint::from_bytes(&keeping.kept()[0].0).unwrap(), &Silent).unwrap();
    assert_eq!((again.stop, again.life_cycles()), (whole.stop, whole.life_cycles()));
    assert_eq!(format!("{:?}", again.curve), format!("{:?}", whole.curve));
}

const AT_HOLE: &str = "kind = \"corner_crack_at_hole\"\nwidth_mm = 100\nlength_mm = 200\nthickness_mm = 5\nhole_diameter_mm = 8\ncracks = 1\n\
                       crack_depth_mm = 1.5\ncrack_half_length_mm = 1.5\n";

/// K beside other holes is that of the crack alone times what they do to a through crack: the ratio of two plates of kind `plate`; far away they
/// do nothing.
#[test]
fn further_holes_raise_k_as_they_raise_that_of_a_through_crack() {
    let start = |holes: &str| {
        let case = hand_case(&format!("{AT_HOLE}{holes}"), &["model.method=auto"]);
        stress_intensity(&case, StressIntensityMethod::ALL).unwrap()[0].handbook_k_i.unwrap()
    };
    let through = |holes: &str| {
        let plate = format!(
            "kind = \"plate\"\nwidth_mm = 100\nlength_mm = 200\nthickness_mm = 5\ncracks = [{{ from_mm = [4, 0], to_mm = [5.5, 0] }}]\n\
             holes = [{{ x_mm = 0, y_mm = 0, diameter_mm = 8 }}{holes}]\n"
        );
        let case = hand_case(&plate, &["model.method=element_free_galerkin"]);
        stress_intensity(&case, &[StressIntensityMethod::ElementFreeGalerkin]).unwrap()[0].methods[0].intensity.k_i.unwrap()
    };
    let near = "{ x_mm = 20, y_mm = 0, diameter_mm = 8 }";
    let [found, wanted] = [start(&format!("holes = [{near}]\n")) / start(""), through(&format!(", {near}")) / through("")];
    assert!((found / wanted - 1.0).abs() < 2e-3 && wanted > 1.01, "{found} against {wanted}");
    let far = start("holes = [{ x_mm = 40, y_mm = 80, diameter_mm = 8 }]\n") / start("");
    assert!((far - 1.0).abs() < 0.01, "{far}");
}
