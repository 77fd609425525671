//! Both phases of a life that begins at a drilled hole; K and lives of named plates beside their references are the topic `named_plates`.

use std::path::Path;

use perilife_base::units::{MPA, MPA_SQRT_M};
use perilife_growth::case::Case;
use perilife_growth::cracks::initial_tips;
use perilife_growth::nodes::NodePlate;
use perilife_growth::predict::{Prediction, Silent, StopReason, predict};

/// The law of the finite elements.
const LAW: &str = "paris_c_mm_per_cycle = 8.95422e-8\nparis_m = 2.874";

fn case(specimen: &str, loading: &str, more: &str) -> Case {
    let text = format!(
        "[specimen]\n{specimen}\n[material]\nyoungs_modulus_gpa = 73.1\npoisson_ratio = 0.33\nplane = \"stress\"\n\
         [loading]\n{loading}\nstress_ratio = 0.2\n[fatigue]\n{LAW}\n{more}"
    );
    Case::from_toml(&text, "named", Path::new(""), &[]).unwrap()
}

fn run(case: &Case) -> Prediction {
    predict(case, &Silent).unwrap()
}

/// Phase I of a hole in a wide plate: the local stress is that of Howland (1930), K_tg = 3.008 at d/W = 0.05 (Heywood's form), and N_I that of the line by
/// hand; phase II is the life without phase I.
#[test]
fn cracks_form_by_the_line_and_then_grow() {
    let keys = "kind = \"crack_at_hole\"\nwidth_mm = 200\nlength_mm = 300\nthickness_mm = 2\nhole_diameter_mm = 10\ncrack_length_mm = 0.5\ncracks = 2";
    let life = |more: &str| run(&case(keys, "stress_max_mpa = 100", more));
    let line = |more: &str| format!("[fatigue.initiation]\nrange_mpa = 300\ncycles = 1e5\nslope = 5\n{more}");
    let (grown, whole) = (life(""), life(&line("")));
    let phase = whole.phase_one.unwrap();
    let first = phase.cycles.unwrap();
    assert!((phase.concentration.unwrap() / 3.008 - 1.0).abs() < 0.01, "{phase:?}");
    assert!((first / (1e5 * (300.0 / (0.8 * 3.008 * 100.0_f64)).powi(5)) - 1.0).abs() < 0.05, "{first}");
    assert!(((whole.life_cycles() - first) / grown.life_cycles() - 1.0).abs() < 1e-9);
    assert_eq!((whole.curve[0].cycles, whole.stop), (first, grown.stop));
    // Of bent edges σ is the mean; at the hole of radius r a gradient adds 2 ρ r/(W/2).
    let bent = run(&case(keys, "stress_max_mpa = 100\nedge_bending_ratio = 1.0", &line("[stop]\ncycles_max = 1e3")));
    let concentration = bent.phase_one.unwrap().concentration.unwrap();
    assert!((concentration / 3.108 - 1.0).abs() < 0.01, "{concentration}");
    // The line is one of elastic stress: 300.8 MPa at the rim.
    let told = |strength: f64| {
        let mut case = case(keys, "stress_max_mpa = 100", &line("[stop]\ncycles_max = 1e5"));
        case.material.yield_strength = Some(strength * MPA);
        run(&case).warnings.into_iter().filter(|line| line.starts_with("initiation: ")).collect::<Vec<_>>()
    };
    let yields = |lines: &[String]| lines.iter().any(|line| line.contains("exceeds the yield strength 290.0 MPa"));
    assert!(yields(&told(290.0)) && told(310.0).iter().all(|line| !line.contains("yield strength")), "{:?}", told(290.0));
    assert!(told(310.0).iter().any(|line| line.ends_with("assumed valid at R = 0.2")));
    // Below the limit nothing forms; a run may end before anything has formed.
    let none = life(&line("limit_mpa = 250"));
    assert_eq!((none.life(), none.stop), (None, StopReason::NothingAges));
    let short = life(&line("[stop]\ncycles_max = 1e5"));
    assert_eq!((short.life_cycles(), short.stop), (1e5, StopReason::RunOut));
}

/// A crack that was stopped: the stress at the holes is 6.424 of the gross one by own finite elements (quadratic triangles; the same with rims of 360 and 720
/// sides). An ellipse as long as crack and holes with their radius has `1 + 2 √(a/ρ)` (Inglis 1913), in the width by Feddersen 6.12.
#[test]
fn stopped_crack_starts_again() {
    let keys = "kind = \"stop_hole\"\nwidth_mm = 200\nlength_mm = 300\nthickness_mm = 2\nstopped_crack_length_mm = 20\nhole_diameter_mm = 8\nformed_length_mm = 0.5";
    let run = run(&case(keys, "stress_max_mpa = 50", "[fatigue.initiation]\nrange_mpa = 240\ncycles = 1e5\nslope = 5"));
    let phase = run.phase_one.unwrap();
    assert!((phase.concentration.unwrap() / 6.424 - 1.0).abs() < 0.01, "{phase:?}");
    assert!(phase.at[0].abs() > 23.9e-3 && phase.at[1].abs() < 1e-3, "{phase:?}");
    assert!(phase.cycles.unwrap() < run.life_cycles());
}

/// A crack of 3 mm from the root of a notch with a radius of 5 mm, however finely its arc is drawn; 14.09 MPa√m by own finite elements (quadratic
/// triangles, quarter points at the tip).
#[test]
fn cracks_begin_at_arcs_of_any_sides() {
    let k = |specimen: &str| {
        let case = case(specimen, "stress_max_mpa = 50", "[model]\nmethod = \"element_free_galerkin\"");
        initial_tips::<NodePlate>(&case).unwrap().tips[0].factors.unwrap()[0] / MPA_SQRT_M
    };
    let sizes = "width_mm = 60\nlength_mm = 120\nthickness_mm = 2";
    let mut found =
        vec![k(&format!("kind = \"edge_notch\"\n{sizes}\nnotch_depth_mm = 10\nnotch_radius_mm = 5\ncrack_length_mm = 3"))];
    for sides in [24, 360] {
        let arc = (0..=sides).map(|side| (0.5 - f64::from(side) / f64::from(sides)) * std::f64::consts::PI);
        let arc: String = arc.map(|angle| format!("[{:?}, {:?}], ", -25.0 + 5.0 * angle.cos(), 5.0 * angle.sin())).collect();
        let outline = format!("[[-30, -60], [30, -60], [30, 60], [-30, 60], [-30, 5], {arc}[-30, -5]]");
        let crack = "cracks = [{ from_mm = [-20, 0], to_mm = [-17, 0] }]";
        found.push(k(&format!("kind = \"plate\"\noutline_mm = {outline}\nthickness_mm = 2\n{crack}")));
    }
    assert!(found.iter().all(|k| (k / 14.09 - 1.0).abs() < 0.005), "{found:?}");
}

/// A crack of 0.01 mm leaves the hole at which it begins, and grows through.
#[test]
fn a_crack_far_shorter_than_its_hole_leaves_it() {
    for length in [0.01, 0.1] {
        let keys = format!(
            "kind = \"crack_at_hole\"\nwidth_mm = 100\nlength_mm = 200\nthickness_mm = 2\nhole_diameter_mm = 8\ncrack_length_mm = {length}"
        );
        let run = run(&case(&keys, "stress_max_mpa = 100", "[model]\nmethod = \"element_free_galerkin\""));
        let last = run.curve.last().unwrap().tips[0].position[0];
        assert!(![StopReason::EnteredHole, StopReason::NothingAges].contains(&run.stop) && last > 0.02, "{length}: {}", run.stop);
    }
}
