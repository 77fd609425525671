//! Cracks driven by the K of their tips against remeshing finite elements of the same plates (quadratic triangles, interaction
//! integral, maximum circumferential stress): those of `tests/reference`, right to 0.1 % in life, and those of the shared data,
//! `fe_plates`. The former at default resolution are rows of `perilife verify paths`, and tested with
//! these (`verification::topics`, long).
//!
//! The latter step straight ahead by 0.4 to 1 mm in the direction of the last K, so that a path that curves trails behind
//! by half a step times the turn, and lives are about 1 % long, more where K changes fast. The three compact plates are compared up to where that grows beyond
//! the bound, and not in life: their loads and lives in the shared files do not belong together.

use std::path::Path;

use perilife_base::input::Document;
use perilife_growth::case::Case;
use perilife_growth::predict::{Prediction, Silent, predict};
use perilife_study::cases::{Compared, REFERENCES, compare, tips_of_table};

use crate::support::shared::shared;

fn grown(file: &Path, set: &[String]) -> Prediction {
    predict(&Case::from_document(&Document::read(file, set).unwrap()).unwrap(), &Silent).unwrap()
}

fn print(name: &str, run: &Prediction, compared: &Compared) {
    let Compared { tip, rms, cycles, .. } = compared;
    let (blocks, wall_s) = (run.figures.blocks, run.figures.wall_s);
    println!("{name}, tip {tip}: path {:.3} mm, cycles {cycles:+.1?} %, {blocks} blocks, {wall_s:.2} s", 1e3 * rms);
}

/// Plate, spacing, x beyond which the path is not compared, bounds of the path's rms in mm and of life in percent.
type Plate = (&'static str, f64, f64, f64, Option<f64>);

const QUICK: [Plate; 2] =
    [("slant_45", 1.0, f64::INFINITY, 0.06, Some(2.5)), ("edge_crack_beside_hole", 0.8, 0.0, 0.15, Some(2.0))];
const LONG: [Plate; 5] = [
    ("edge_crack_into_hole", 0.8, f64::INFINITY, 0.02, Some(2.0)),
    ("pin_loaded_lug", 0.5, f64::INFINITY, 0.06, Some(2.0)),
    ("compact_hole_5", 0.3, 15.5, 0.06, None),
    ("compact_hole_6", 0.3, 15.5, 0.06, None),
    ("compact_hole_7_75", 0.3, 15.5, 0.06, None),
];

fn check(plates: &[Plate]) {
    for &(name, spacing, x_end, rms_bound, life_bound) in plates {
        let (Some(file), Some(curve)) = (shared(&format!("fe_plates/{name}.toml")), shared(&format!("fe_plates/{name}.csv")))
        else {
            return;
        };
        // The reference has a cosine over 90° where its file leaves the arc out.
        let arc = (name == "pin_loaded_lug").then(|| "loading.pins[0].contact_half_angle_deg=90".to_owned());
        let set = [
            "fatigue.paris_c_mm_per_cycle=8.95422e-8".to_owned(),
            "fatigue.paris_m=2.874".to_owned(),
            format!("model.spacing_mm={spacing}"),
        ];
        let set: Vec<String> = set.into_iter().chain(arc).collect();
        let run = grown(&file, &set);
        for compared in compare(&run, tips_of_table(&std::fs::read_to_string(&curve).unwrap()).unwrap(), 1e-3 * x_end) {
            print(name, &run, &compared);
            assert!(compared.rms < 1e-3 * rms_bound, "{name}: path off by {}", compared.rms);
            if let Some(bound) = life_bound {
                assert!(compared.cycles.iter().all(|error| error.abs() < bound), "{name}: {:?}", compared.cycles);
            }
        }
    }
}

#[test]
fn paths_and_lives_of_finite_elements() {
    check(&QUICK);
}

#[test]
#[ignore = "long: a minute"]
fn paths_and_lives_of_more_finite_elements() {
    check(&LONG);
}

/// Lattices turned by 22.5 and 45° at half the spacing: as near to the reference as the upright one.
#[test]
#[ignore = "long: eight plates on three lattices at 0.5 mm, some ten minutes"]
fn references_on_turned_lattices() {
    for reference in REFERENCES.iter().filter(|reference| reference.name != "three_cracks") {
        for angle in [0.0, 22.5, 45.0] {
            let angle_key = format!("model.lattice_angle_deg={angle}");
            let case = reference.case(&["model.spacing_mm=0.5".to_owned(), angle_key]).unwrap();
            let run = predict(&case, &Silent).unwrap();
            let tips = compare(&run, reference.tips().unwrap(), f64::INFINITY);
            for compared in tips {
                let name = format!("{}, {angle}°", reference.name);
                print(&name, &run, &compared);
                assert!(compared.rms < 0.15e-3 && compared.length > 0.97, "{name}: {compared:?}");
                assert!(compared.cycles.iter().all(|error| error.abs() < 2.0), "{name}: {compared:?}");
            }
            assert!(reference.ended_alike(&run), "{}: {}", reference.name, run.stop);
        }
    }
}
