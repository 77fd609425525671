//! Shapes, tips, lengths and the questions the body asks.

use std::path::Path;

use perilife_growth::case::Case;
use perilife_plate::specimen::geometry::{distance, point_in_polygon, segments_touch, self_intersection};
use perilife_plate::specimen::{Load, LoadMeasure, PART_THROUGH, Specimen, SpecimenKind, Support};
use proptest::prelude::*;

use crate::support::plates::cracks;
use crate::support::rows::assert_refusal;

/// A plate of 100 x 200 mm with these keys besides.
fn plate(keys: &str) -> Result<Specimen, perilife_base::error::Error> {
    case(&format!("kind = \"plate\"\nwidth_mm = 100\nlength_mm = 200\nthickness_mm = 2\n{keys}"), "stress_max_mpa = 10")
}

fn case(specimen: &str, load: &str) -> Result<Specimen, perilife_base::error::Error> {
    let text = format!(
        "[specimen]\n{specimen}\n[material]\nname = \"al2024-t3\"\n[loading]\n{load}\nstress_ratio = 0\n\
         [model]\nspacing_mm = 0.5\n[fatigue]\na = 1\np = 2\nhorizon_mm = 1"
    );
    Case::from_toml(&text, "test", Path::new(""), &[]).map(|case| case.specimen)
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-9
}

#[test]
fn every_standard_kind_has_its_cracks_on_y_0() {
    let sizes = "width_mm = 100\nthickness_mm = 2\ncrack_length_mm = 20";
    let is_standard = |kind: &&SpecimenKind| !kind.is_plate() && kind.part_through().is_none();
    for kind in SpecimenKind::ALL.iter().filter(is_standard) {
        let (extra, load) = match kind {
            SpecimenKind::CompactTension => ("", "force_max_n = 1000"),
            SpecimenKind::SingleEdgeTension => ("length_mm = 300\nends = \"pinned\"", "stress_max_mpa = 10"),
            _ => ("length_mm = 300", "stress_max_mpa = 10"),
        };
        let specimen = case(&format!("kind = \"{kind}\"\n{sizes}\n{extra}"), load).unwrap();
        assert_eq!(specimen.kind, *kind);
        assert_eq!(specimen.crack_plane_y, Some(0.0));
        assert!(near(specimen.crack_length, 0.02), "{kind}");
        assert!(!specimen.loads.is_empty());
        for tip in &specimen.tips {
            let ahead = [tip.position[0] + 1e-3 * tip.direction[0], 1e-4];
            assert!(specimen.contains(ahead), "{kind}: the tip looks into the material");
            assert!(specimen.cracks.iter().any(|crack| crack.to == tip.position || crack.from == tip.position), "{kind}");
        }
        // Mean of the tips: each growing by 1 mm is 1 mm of crack length.
        let growth = vec![1e-3; specimen.tips.len()];
        assert!(near(specimen.crack_length_after(&growth), 0.021), "{kind}");
    }
}

#[test]
fn compact_tension_has_the_proportions_of_e647() {
    let specimen =
        case("kind = \"compact_tension\"\nwidth_mm = 50\nthickness_mm = 10\ncrack_length_mm = 20", "force_max_kn = 4").unwrap();
    assert!(near(specimen.gross_width, 0.0625) && near(specimen.length(), 0.06) && near(specimen.width, 0.05));
    assert_eq!(specimen.load_measure, LoadMeasure::Force);
    assert_eq!(specimen.cracks[0].from, [-0.0125, 0.0]);
    for (hole, sign) in specimen.holes.iter().zip([1.0, -1.0]) {
        assert!(near(hole.centre[0], 0.0) && near(hole.centre[1], sign * 0.01375) && near(hole.radius, 0.00625));
    }
    let pull = |load: &Load| if let Load::Pin { direction, force, .. } = load { direction[1] * force } else { 1.0 };
    assert!(near(specimen.loads.iter().map(pull).sum(), 0.0), "the pins pull against each other");
}

#[test]
fn ends_become_supports() {
    let ends = |ends: &str| {
        let keys = format!(
            "kind = \"single_edge_tension\"\nwidth_mm = 50\nlength_mm = 200\nthickness_mm = 2\ncrack_length_mm = 10\nends = \"{ends}\""
        );
        case(&keys, "stress_max_mpa = 10").unwrap().supports
    };
    assert_eq!(ends("pinned"), [Support::RigidEnds]);
    assert_eq!(ends("clamped"), [Support::ClampedEnds]);
    assert_eq!(ends("uniform_stress"), []);
}

#[test]
fn a_crack_is_cut_off_where_it_leaves_the_material() {
    let hole = "holes = [{ x_mm = 0, y_mm = 0, diameter_mm = 10 }]";
    let slot = "notches = [{ from_mm = [-55, 0], to_mm = [-40, 0], width_mm = 2 }]";
    let [at_hole, at_slot] = [(hole, [[0.0, 0.0], [9.0, 0.0]]), (slot, [[-41.0, 0.0], [-37.0, 0.0]])]
        .map(|(keys, ends)| format!("{keys}\n{}", cracks(&[ends])));
    // (keys, crack length mm, tips as x, y mm)
    let rows: [(&str, f64, &[[f64; 2]]); 6] = [
        ("cracks = [{ from_mm = [-5, 0], to_mm = [5, 0] }]", 10.0, &[[-5.0, 0.0], [5.0, 0.0]]),
        ("cracks = [{ from_mm = [-50, 3], to_mm = [-40, 3] }]", 10.0, &[[-40.0, 3.0]]),
        // From the middle of the hole: only what lies beyond its edge counts.
        (&at_hole, 4.0, &[[9.0, 0.0]]),
        // Slot alone: the middle of its end face in the material.
        ("notches = [{ from_mm = [-50, 0], to_mm = [-40, 0], width_mm = 2 }]", 10.0, &[[-40.0, 0.0]]),
        // Closed slot: both faces.
        ("notches = [{ from_mm = [-5, 0], to_mm = [5, 0], width_mm = 2 }]", 10.0, &[[5.0, 0.0], [-5.0, 0.0]]),
        // A crack from the end face takes the place of the slot's seed; it is cut off at the face.
        (&at_slot, 13.0, &[[-37.0, 0.0]]),
    ];
    for (keys, length, tips) in rows {
        let specimen = plate(keys).unwrap_or_else(|error| panic!("{keys}: {error}"));
        assert!((specimen.crack_length * 1e3 - length).abs() < 1e-6, "{keys}: {}", specimen.crack_length);
        assert_eq!(specimen.tips.len(), tips.len(), "{keys}");
        for wanted in tips {
            let place = [wanted[0] * 1e-3, wanted[1] * 1e-3];
            assert!(specimen.tips.iter().any(|tip| distance(tip.position, place) < 1e-9), "{keys}: {:?}", specimen.tips);
        }
        // Sum of tips: each growing by 1 mm adds up.
        let growth = vec![1e-3; specimen.tips.len()];
        assert!(near(specimen.crack_length_after(&growth), specimen.crack_length + 1e-3 * growth.len() as f64));
    }
}

#[test]
fn contains_and_cuts() {
    let keys = "holes = [{ x_mm = 20, y_mm = 30, diameter_mm = 10 }]\ncracks = [{ from_mm = [-5, 0], to_mm = [5, 0] }]\n\
                notches = [{ from_mm = [-50, 50], to_mm = [-30, 50], width_mm = 2 }]";
    let specimen = plate(keys).unwrap();
    let inside = [[0.0, 0.0], [20.0, 35.1], [-40.0, 51.1]];
    let outside = [[20.0, 30.0], [-40.0, 50.5], [51.0, 0.0], [0.0, -101.0]];
    for at in inside.iter().chain(&outside) {
        assert_eq!(specimen.contains(at.map(|x| x * 1e-3)), inside.contains(at), "{at:?}");
    }
    // 100 x 200 less hole and slot, mm².
    let area = 20_000.0 - std::f64::consts::PI * 25.0 - 40.0;
    assert!((specimen.area() * 1e6 - area).abs() < 1e-6);
}

#[test]
fn other_names_of_part_through_flaws_lead_to_the_kinds() {
    for kind in PART_THROUGH {
        assert_refusal(case(&format!("kind = \"{kind}\""), "stress_max_mpa = 10"), &[kind, "surface_crack, corner_crack"]);
    }
    for key in ["depth_mm", "crack_depth_mm", "aspect_ratio"] {
        let refused = plate(&format!("{key} = 2\ncracks = [{{ from_mm = [-5, 0], to_mm = [5, 0] }}]"));
        assert_refusal(refused, &[key, "use one of surface_crack"]);
    }
}

#[test]
fn an_outline_runs_counter_clockwise() {
    let keys = |corners: &str| {
        format!(
            "kind = \"plate\"\noutline_mm = {corners}\nthickness_mm = 2\ncracks = [{{ from_mm = [10, 50], to_mm = [20, 50] }}]"
        )
    };
    let one = case(&keys("[[0, 0], [60, 0], [60, 100], [0, 100]]"), "stress_max_mpa = 10").unwrap();
    let other = case(&keys("[[0, 0], [0, 100], [60, 100], [60, 0], [0, 0]]"), "stress_max_mpa = 10").unwrap();
    assert!(perilife_plate::specimen::geometry::polygon_area(&other.outline) > 0.0);
    assert!(near(one.area(), other.area()) && near(one.width, 0.06) && other.outline.len() == 4);
    assert_eq!(one.loads.len(), 2);
}

proptest! {
    /// A point is inside a convex polygon exactly if it lies left of every edge.
    #[test]
    fn inside_means_left_of_every_edge(x in -1.5f64..1.5, y in -1.5f64..1.5, n in 3usize..12) {
        let polygon: Vec<[f64; 2]> = (0..n).map(|i| (i as f64 / n as f64 * std::f64::consts::TAU).sin_cos()).map(|(s, c)| [c, s]).collect();
        let left = (0..n).all(|i| perilife_plate::specimen::geometry::turn(polygon[i], polygon[(i + 1) % n], [x, y]) > 0.0);
        prop_assert_eq!(point_in_polygon([x, y], &polygon), left);
        prop_assert!(self_intersection(&polygon).is_none());
    }

    /// Touching does not depend on the order of segments or ends.
    #[test]
    fn touching_is_symmetric(p in prop::array::uniform8(-3i32..4)) {
        let q = |i: usize| [f64::from(p[2 * i]), f64::from(p[2 * i + 1])];
        let first = segments_touch(q(0), q(1), q(2), q(3));
        prop_assert_eq!(first, segments_touch(q(2), q(3), q(0), q(1)));
        prop_assert_eq!(first, segments_touch(q(1), q(0), q(2), q(3)));
        // Agrees with a dense search of the first segment.
        let closest = (0..=2000).map(|i| perilife_plate::specimen::geometry::along(q(0), q(1), f64::from(i) / 2000.0))
            .map(|point| perilife_plate::specimen::geometry::distance_to_segment(point, q(2), q(3))).fold(f64::INFINITY, f64::min);
        prop_assert!(!first || closest < 5e-3, "they touch, yet keep {closest} apart");
        prop_assert!(first || closest > 1e-9, "they keep apart, yet come within {closest}");
    }
}
