//! Cracks driven by the K of their tips against remeshing finite elements of the same plates (quadratic triangles, interaction
//! integral, maximum circumferential stress): those of `tests/reference`, right to 0.1 % in life, and those of the shared data,
//! `fe_plates`.
//!
//! The latter step straight ahead by 0.4 to 1 mm in the direction of the last K, so that a path that curves trails behind
//! by half a step times the turn, and lives are about 1 % long, more where K changes fast. The three compact plates are compared up to where that grows beyond
//! the bound, and not in life: their loads and lives in the shared files do not belong together.

use std::path::{Path, PathBuf};

use perilife::case::Case;
use perilife::input::Document;
use perilife::predict::{Prediction, Silent, StopReason, predict};
use perilife::specimen::Point;
use perilife::specimen::geometry::{distance, distance_to_segment};

use crate::shared::shared;

/// A tip of the reference: cycles and positions, m.
type Path_ = Vec<(f64, Point)>;

fn reference(file: &Path) -> Vec<Path_> {
    let mut tips: Vec<Path_> = Vec::new();
    for record in csv::Reader::from_path(file).unwrap().records() {
        let record = record.unwrap();
        let number = |i: usize| record[i].parse::<f64>().unwrap();
        let tip = number(1) as usize;
        tips.resize(tips.len().max(tip + 1), Vec::new());
        tips[tip].push((number(0), [1e-3 * number(2), 1e-3 * number(3)]));
    }
    tips
}

fn ours(run: &Prediction, start: Point) -> Path_ {
    let tips = run.curve[0].tips.len();
    let gap = |tip: &usize| distance(run.curve[0].tips[*tip].position, start);
    let tip = (0..tips).min_by(|a, b| gap(a).total_cmp(&gap(b))).unwrap();
    run.curve.iter().map(|row| (row.cycles, row.tips[tip].position)).collect()
}

/// Cycles at a length of way along a path.
fn cycles_at(path: &Path_, way: f64) -> f64 {
    let mut done = 0.0;
    for pair in path.windows(2) {
        let step = distance(pair[0].1, pair[1].1);
        if step > 0.0 && done + step >= way {
            return pair[0].0 + (way - done) / step * (pair[1].0 - pair[0].0);
        }
        done += step;
    }
    path[path.len() - 1].0
}

fn length(path: &Path_) -> f64 {
    path.windows(2).map(|pair| distance(pair[0].1, pair[1].1)).sum()
}

/// How a tip went against a reference.
struct Compared {
    tip: usize,
    /// Distance of the reference's places from the path, rms, m.
    rms: f64,
    /// Cycles at half, three quarters and 95 % of the way, over those of the reference less 1, percent.
    cycles: [f64; 3],
    /// Way over that of the reference.
    way: f64,
}

/// Every tip of a run against its reference, up to an x, m.
fn compare(run: &Prediction, reference: Vec<Path_>, x_end: f64) -> Vec<Compared> {
    let tip = |(tip, reference): (usize, Path_)| {
        let path = ours(run, reference[0].1);
        let off = |at: Point| {
            let pieces = path.windows(2).map(|pair| distance_to_segment(at, pair[0].1, pair[1].1));
            pieces.fold(f64::INFINITY, f64::min)
        };
        let whole = length(&reference);
        let kept: Path_ = reference.into_iter().filter(|(_, at)| at[0] < x_end).collect();
        let way = length(&kept).min(length(&path));
        // What lies beyond the end of the path is no distance from it.
        let passed = (2..=kept.len()).filter(|&n| length(&kept[..n].to_vec()) <= way).max().unwrap_or(1);
        let rms = (kept[..passed].iter().map(|(_, at)| off(*at).powi(2)).sum::<f64>() / passed as f64).sqrt();
        // Beyond half of the way: the first step of a reference is as long as it is coarse.
        let cycles = [0.5, 0.75, 0.95].map(|share| 100.0 * (cycles_at(&path, share * way) / cycles_at(&kept, share * way) - 1.0));
        Compared { tip, rms, cycles, way: length(&path) / whole }
    };
    reference.into_iter().enumerate().map(tip).collect()
}

fn grown(file: &Path, set: &[String]) -> Prediction {
    predict(&Case::from_document(&Document::read(file, set).unwrap()).unwrap(), &Silent).unwrap()
}

fn print(name: &str, run: &Prediction, compared: &Compared) {
    let Compared { tip, rms, cycles, .. } = compared;
    let (blocks, wall_s) = (run.figures.blocks, run.figures.wall_s);
    println!("{name}, tip {tip}: path {:.3} mm, cycles {cycles:+.1?} %, {blocks} blocks, {wall_s:.2} s", 1e3 * rms);
}

/// Plate, spacing, x beyond which the path is not compared, bounds of the path's rms in mm and of life in percent.
const PLATES: [(&str, f64, f64, f64, Option<f64>); 7] = [
    ("slant_45", 1.0, f64::INFINITY, 0.06, Some(2.5)),
    ("edge_crack_beside_hole", 0.8, 0.0, 0.15, Some(2.0)),
    ("edge_crack_into_hole", 0.8, f64::INFINITY, 0.02, Some(2.0)),
    ("pin_loaded_lug", 0.5, f64::INFINITY, 0.06, Some(2.0)),
    ("compact_hole_5", 0.3, 15.5, 0.06, None),
    ("compact_hole_6", 0.3, 15.5, 0.06, None),
    ("compact_hole_7_75", 0.3, 15.5, 0.06, None),
];

#[test]
fn paths_and_lives_of_finite_elements() {
    for (name, spacing, x_end, rms_bound, life_bound) in PLATES {
        let (Some(file), Some(curve)) = (shared(&format!("fe_plates/{name}.toml")), shared(&format!("fe_plates/{name}.csv")))
        else {
            return;
        };
        let set = [
            "fatigue.paris_c_mm_per_cycle=8.95422e-8".to_owned(),
            "fatigue.paris_m=2.874".to_owned(),
            format!("model.spacing_mm={spacing}"),
        ];
        let run = grown(&file, &set);
        for compared in compare(&run, reference(&curve), 1e-3 * x_end) {
            print(name, &run, &compared);
            assert!(compared.rms < 1e-3 * rms_bound, "{name}: path off by {}", compared.rms);
            if let Some(bound) = life_bound {
                assert!(compared.cycles.iter().all(|error| error.abs() < bound), "{name}: {:?}", compared.cycles);
            }
        }
    }
}

/// Plate, spacing in mm where the default does not resolve its holes, whether its cracks end in holes, bound of life in percent.
const REFERENCES: [(&str, Option<f64>, bool, f64); 9] = [
    ("slant_severance", None, false, 2.0),
    ("hole_attracts", None, true, 2.0),
    ("hole_missed", None, false, 2.0),
    ("compact_one_hole_a", None, true, 2.0),
    ("compact_one_hole_b", None, false, 2.0),
    ("offset_edge_cracks", None, false, 2.0),
    // K rises as a tip grazes its hole, and there it is read 20 to 40 % high over the last 1.5 mm.
    ("double_edge_notched", None, true, 2.5),
    ("three_point_bending", Some(0.5), true, 2.0),
    ("three_cracks", None, false, 2.0),
];

fn reference_file(name: &str, ending: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/reference").join(format!("{name}.{ending}"))
}

/// A run of a reference, and how its tips went. Paths are right to 0.15 mm or 0.3 spacings.
fn run_reference(name: &str, set: &[String], ends_in_hole: bool, life_bound: f64) -> Prediction {
    let run = grown(&reference_file(name, "toml"), set);
    let rms_bound = f64::max(0.15e-3, 0.3 * run.figures.spacing);
    for compared in compare(&run, reference(&reference_file(name, "csv")), f64::INFINITY) {
        print(&format!("{name} {set:?}"), &run, &compared);
        assert!(compared.rms < rms_bound, "{name} {set:?}: path off by {}", compared.rms);
        assert!(compared.way > 0.97, "{name} {set:?}: {} of the way", compared.way);
        assert!(compared.cycles.iter().all(|error| error.abs() < life_bound), "{name} {set:?}: {:?}", compared.cycles);
    }
    // A run goes on where the reference stops short of an edge or of the other crack.
    assert!(run.stop == StopReason::EnteredHole || !ends_in_hole, "{name} {set:?}: {}", run.stop);
    run
}

#[test]
fn nine_reference_plates() {
    for (name, spacing, ends_in_hole, life_bound) in REFERENCES {
        let set: Vec<String> = spacing.map(|mm| format!("model.spacing_mm={mm}")).into_iter().collect();
        run_reference(name, &set, ends_in_hole, life_bound);
    }
}

/// Lattices turned by 22.5 and 45° at half the spacing: as near to the reference as the upright one.
#[test]
#[ignore = "long: eight plates on three lattices at 0.5 mm, some ten minutes"]
fn references_on_turned_lattices() {
    for (name, _, ends_in_hole, _) in REFERENCES.into_iter().filter(|plate| plate.0 != "three_cracks") {
        for angle in [0.0, 22.5, 45.0] {
            let set = ["model.spacing_mm=0.5".to_owned(), format!("model.lattice_angle_deg={angle}")];
            run_reference(name, &set, ends_in_hole, 2.0);
        }
    }
}
