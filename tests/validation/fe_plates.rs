//! Cracks driven by the K of their tips against remeshing finite elements of the same plates (quadratic triangles, interaction
//! integral, maximum circumferential stress; shared data, `fe_plates`).
//!
//! The finite elements step straight ahead by 0.4 to 1 mm in the direction of the last K, so that a path that curves trails behind
//! by half a step times the turn, and lives are about 1 % long. The three compact plates are compared up to where that grows beyond
//! the bound, and not in life: their loads and lives in the shared files do not belong together.

use std::path::Path;

use perilife::case::Case;
use perilife::input::Document;
use perilife::predict::{Prediction, Silent, predict};
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

/// Plate, spacing, x beyond which the path is not compared, bounds of the path's rms in mm and of life in percent.
const PLATES: [(&str, f64, f64, f64, Option<f64>); 7] = [
    ("slant_45", 1.0, f64::INFINITY, 0.1, Some(4.0)),
    ("edge_crack_beside_hole", 0.8, 0.0, 0.1, Some(5.0)),
    ("edge_crack_into_hole", 0.8, f64::INFINITY, 0.05, Some(5.0)),
    ("pin_loaded_lug", 0.5, f64::INFINITY, 0.1, Some(5.0)),
    ("compact_hole_5", 0.3, 15.5, 0.1, None),
    ("compact_hole_6", 0.3, 15.5, 0.1, None),
    ("compact_hole_7_75", 0.3, 15.5, 0.1, None),
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
        let case = Case::from_document(&Document::read(&file, &set).unwrap()).unwrap();
        let run = predict(&case, &Silent).unwrap();
        for (tip, reference) in reference(&curve).into_iter().enumerate() {
            let path = ours(&run, reference[0].1);
            let off = |at: Point| {
                let pieces = path.windows(2).map(|pair| distance_to_segment(at, pair[0].1, pair[1].1));
                pieces.fold(f64::INFINITY, f64::min)
            };
            let kept: Vec<(f64, Point)> = reference.into_iter().filter(|(_, at)| at[0] < 1e-3 * x_end).collect();
            let rms = (kept.iter().map(|(_, at)| off(*at).powi(2)).sum::<f64>() / kept.len() as f64).sqrt();
            // Beyond half of the way: the first step of the reference is as long as it is coarse.
            let errors = [0.5, 0.75, 0.95].map(|share| {
                let way = share * length(&kept).min(length(&path));
                100.0 * (cycles_at(&path, way) / cycles_at(&kept, way) - 1.0)
            });
            println!(
                "{name}, tip {tip}: path {:.3} mm, cycles {errors:+.1?} %, {} blocks, {:.2} s",
                1e3 * rms,
                run.figures.blocks,
                run.figures.wall_s
            );
            assert!(rms < 1e-3 * rms_bound, "{name}: path off by {rms}");
            if let Some(bound) = life_bound {
                assert!(errors.iter().all(|error| error.abs() < bound), "{name}: {errors:?}");
            }
        }
    }
}
