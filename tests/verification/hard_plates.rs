//! Plates on which growth by K of the tips was wrong by 2 to 12 % of life, against remeshing finite elements
//! (`../shared/data/hard_plates`): mouths on holes, kinks of short cracks, gaps and rims near a tip.

use std::collections::BTreeMap;
use std::path::Path;

use perilife_growth::case::Case;
use perilife_growth::predict::{Silent, predict};
use perilife_plate::specimen::Point;
use perilife_plate::specimen::geometry::{distance, distance_to_segment};

use crate::support::shared::shared;

/// Cycles and place (mm) of a tip with its growth, mm.
type Row = (f64, f64, Point);

/// A plate with the largest errors of its cycles at half and at 95 % of the growth of a tip, %, and of its path (rms), mm.
type Plate = (&'static str, f64, f64);

/// Three miss 1.5 %: a sliver between crack and edge, a rim passed within a horizon (2.7 % and 0.02 mm with points of 0.33 mm), and a crack
/// of 1.2 horizons of half length, whose K_II is read 5 % high at the start.
const POINTS: [Plate; 8] = [
    ("hole_crack_43", 1.5, 0.15),
    ("hole_crack_45", 1.5, 0.15),
    ("short_slant_45", 1.5, 0.2),
    ("short_slant_68", 3.0, 0.3),
    ("three_parallel", 1.5, 0.15),
    ("slant_edge_75", 2.6, 0.33),
    ("between_holes_4mm", 5.4, 0.25),
    ("beside_edge_2mm", 1.5, 0.05),
];

/// By nodes without elements, which are placed as fine as tips, rims and kinks ask. Not among them is `hole_crack_70`: its reference lets
/// flanks overlap, and with flanks in contact points and nodes live 6.0 and 6.5 % shorter.
const NODES_QUICK: [Plate; 1] = [("hole_crack_43", 0.6, 0.05)];
const NODES_LONG: [Plate; 7] = [
    ("short_slant_45", 0.6, 0.05),
    ("hole_crack_45", 0.6, 0.05),
    ("three_parallel", 0.6, 0.05),
    ("short_slant_68", 0.6, 0.05),
    ("slant_edge_75", 0.6, 0.05),
    ("between_holes_4mm", 0.6, 0.05),
    ("beside_edge_2mm", 0.6, 0.05),
];

fn reference(path: &Path) -> BTreeMap<usize, Vec<Row>> {
    let mut tips: BTreeMap<usize, Vec<Row>> = BTreeMap::new();
    for record in csv::Reader::from_path(path).unwrap().deserialize() {
        let (cycles, tip, x, y): (f64, usize, f64, f64) = record.unwrap();
        let rows = tips.entry(tip).or_default();
        let growth = rows.last().map_or(0.0, |(_, growth, at)| growth + distance(*at, [x, y]));
        rows.push((cycles, growth, [x, y]));
    }
    tips
}

fn cycles_at(rows: &[Row], growth: f64) -> Option<f64> {
    let pair = rows.windows(2).find(|pair| (pair[0].1..=pair[1].1).contains(&growth))?;
    let share = (growth - pair[0].1) / (pair[1].1 - pair[0].1).max(f64::MIN_POSITIVE);
    Some(pair[0].0 + share * (pair[1].0 - pair[0].0))
}

/// A case with what its plate asks for.
fn case(path: &Path, overrides: &dyn Fn(&Case) -> Vec<String>) -> Case {
    let given = Case::from_file(path, &[]).unwrap();
    Case::from_file(path, &overrides(&given)).unwrap()
}

fn check(plates: &[Plate], overrides: &dyn Fn(&Case) -> Vec<String>) {
    for (name, bound, bound_of_path) in plates {
        let Some(path) = shared(&format!("hard_plates/{name}.toml")) else { return };
        let right = reference(&path.with_extension("csv"));
        let run = predict(&case(&path, overrides), &Silent).unwrap();
        let leading = right.iter().max_by(|a, b| a.1.last().unwrap().1.total_cmp(&b.1.last().unwrap().1)).unwrap().0;
        let tip = &right[leading];
        let row = |row: &perilife_growth::predict::CurvePoint| {
            let record = &row.tips[*leading];
            (row.cycles, 1e3 * record.growth, record.position.map(|metres| 1e3 * metres))
        };
        let found: Vec<Row> = run.curve.iter().map(row).collect();
        let whole = tip.last().unwrap().1;
        let error = |share: f64| {
            let [found, right] = [&found, tip].map(|rows| cycles_at(rows, share * whole).unwrap());
            100.0 * (found / right - 1.0)
        };
        let [half, late] = [0.5, 0.95].map(error);
        let away =
            |at: Point| tip.windows(2).map(|pair| distance_to_segment(at, pair[0].2, pair[1].2)).fold(f64::INFINITY, f64::min);
        let places: Vec<Point> = found.iter().filter(|row| row.1 <= whole).map(|row| row.2).collect();
        let off = (places.iter().map(|at| away(*at).powi(2)).sum::<f64>() / places.len() as f64).sqrt();
        println!("{name}: cycles {half:+.2}, {late:+.2} %, path {off:.3} mm");
        assert!(
            half.abs() < *bound && late.abs() < *bound && off < *bound_of_path,
            "{name}: {half:+.2}, {late:+.2} %, {off:.3} mm"
        );
    }
}

/// The spacing of some files is that of points: nodes are refined by themselves.
fn on_nodes(case: &Case) -> Vec<String> {
    let far = 1e3 * case.specimen.width / 14.0;
    let keys = ["model.method=element_free_galerkin", "model.tolerance_percent=0.5"];
    keys.map(str::to_owned).into_iter().chain([format!("model.spacing_mm={far}")]).collect()
}

#[test]
fn a_mouth_on_a_hole_on_nodes() {
    check(&NODES_QUICK, &on_nodes);
}

#[test]
#[ignore = "long: cargo test hard_plates -- --ignored (two minutes)"]
fn hard_plates_on_nodes_without_elements() {
    check(&NODES_LONG, &on_nodes);
}

#[test]
#[ignore = "long: cargo test hard_plates -- --ignored (three minutes)"]
fn hard_plates_on_points() {
    check(&POINTS, &|_| vec!["model.method=peridynamics".to_owned()]);
}
