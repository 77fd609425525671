//! Named plates are the plates that `plate` gives for the same drawing, and say by their own keys what does not fit.

use std::path::Path;

use perilife::Result;
use perilife::case::Case;
use perilife::specimen::{LengthConvention, Specimen, SpecimenKind};
use perilife::units::MM;

const TENSION: &str = "stress_max_mpa = 50";
const FORCE: &str = "force_max_n = 1000";
const SIZES: &str = "width_mm = 100\nlength_mm = 200\nthickness_mm = 2\n";

fn read(specimen: &str, loading: &str, more: &str) -> Result<Specimen> {
    let text = format!(
        "[specimen]\n{specimen}\n[material]\nname = \"al2024-t3\"\n[loading]\n{loading}\nstress_ratio = 0.1\n{more}\n\
         [fatigue]\nparis_c_mm_per_cycle = 1e-7\nparis_m = 3"
    );
    Case::from_toml(&text, "test", Path::new(""), &[]).map(|case| case.specimen)
}

/// Every kind: its keys, then those of the same plate beside the outline, its loads and supports, and its crack length in mm.
fn rows() -> [(String, String, String, String, f64); 12] {
    let rectangle = |keys: &str| format!("{SIZES}{keys}");
    let row = |kind: &str, plate: &str, loading: &str, more: &str, length: f64| {
        (kind.to_owned(), plate.to_owned(), loading.to_owned(), more.to_owned(), length)
    };
    let hole = "holes = [{ x_mm = 0, y_mm = 0, diameter_mm = 10 }]\n";
    let right = "{ from_mm = [5, 0], to_mm = [8, 0] }";
    let left = "{ from_mm = [-5, 0], to_mm = [-8, 0] }";
    let compact = |y: f64| {
        format!("holes = [{{ x_mm = 0, y_mm = {y}, diameter_mm = 10 }}, {{ x_mm = 0, y_mm = -{y}, diameter_mm = 10 }}]\n")
    };
    let beam = "rollers = [{ at_mm = [0, -40], contact_width_mm = 1, share = 0.5 }, { at_mm = [0, 40], contact_width_mm = 1, share = 0.5 }, ";
    let pins = "force_max_n = 1000\npins = [{ hole = 0, direction = [0, 1] }, { hole = 1, direction = [0, -1] }]";
    [
        row(
            &rectangle("kind = \"crack_at_hole\"\nhole_diameter_mm = 10\ncrack_length_mm = 3"),
            &format!("{hole}cracks = [{right}]"),
            TENSION,
            "",
            3.0,
        ),
        row(
            &rectangle("kind = \"crack_at_hole\"\nhole_diameter_mm = 10\ncrack_length_mm = 3\ncracks = 2"),
            &format!("{hole}cracks = [{right}, {left}]"),
            TENSION,
            "",
            3.0,
        ),
        row(
            &rectangle("kind = \"crack_at_hole\"\nhole_diameter_mm = 10\nhole_offset_mm = -20\ncrack_lengths_mm = [2, 4]"),
            "holes = [{ x_mm = -20, y_mm = 0, diameter_mm = 10 }]\n\
             cracks = [{ from_mm = [-15, 0], to_mm = [-11, 0] }, { from_mm = [-25, 0], to_mm = [-27, 0] }]",
            TENSION,
            "",
            6.0,
        ),
        row(
            &rectangle(
                "kind = \"row_of_holes\"\nholes = 2\npitch_mm = 40\nhole_diameter_mm = 20\ncrack_lengths_mm = [[4, 12], [8, 0]]",
            ),
            // The ligament of 20 mm is cracked through, as of linked_holes.
            "holes = [{ x_mm = -20, y_mm = 0, diameter_mm = 20 }, { x_mm = 20, y_mm = 0, diameter_mm = 20 }]\n\
             cracks = [{ from_mm = [-30, 0], to_mm = [-34, 0] }, { from_mm = [-10, 0], to_mm = [10, 0] }]",
            TENSION,
            "",
            24.0,
        ),
        row(
            "kind = \"lug\"\nwidth_mm = 50\nlength_mm = 100\nthickness_mm = 5\nhead = \"straight\"\nhole_diameter_mm = 20\ncrack_length_mm = 3",
            "holes = [{ x_mm = 0, y_mm = 0, diameter_mm = 20 }]\ncracks = [{ from_mm = [10, 0], to_mm = [13, 0] }]",
            "force_max_n = 1000\npins = [{ hole = 0, direction = [0, 1] }]",
            "[supports]\nbottom = { fix = [\"x\", \"y\"] }",
            3.0,
        ),
        row(
            "kind = \"lug\"\nwidth_mm = 50\nlength_mm = 100\nthickness_mm = 5\nhead = \"round\"\nhole_diameter_mm = 20\ncrack_length_mm = 3\ncracks = 2",
            "holes = [{ x_mm = 0, y_mm = 0, diameter_mm = 20 }]\n\
             cracks = [{ from_mm = [10, 0], to_mm = [13, 0] }, { from_mm = [-10, 0], to_mm = [-13, 0] }]",
            "force_max_n = 1000\npins = [{ hole = 0, direction = [0, 1] }]",
            "[supports]\nbottom = { fix = [\"x\", \"y\"] }",
            3.0,
        ),
        row(
            &rectangle("kind = \"edge_notch\"\nnotch_depth_mm = 8\nnotch_radius_mm = 3\ncrack_length_mm = 4"),
            "cracks = [{ from_mm = [-45, 0], to_mm = [-38, 0] }]",
            TENSION,
            "",
            4.0,
        ),
        row(
            &rectangle("kind = \"stop_hole\"\nstopped_crack_length_mm = 15\nhole_diameter_mm = 6\nformed_length_mm = 1"),
            "holes = [{ x_mm = -15, y_mm = 0, diameter_mm = 6 }, { x_mm = 15, y_mm = 0, diameter_mm = 6 }]\n\
             cracks = [{ from_mm = [-12, 0], to_mm = [12, 0] }, { from_mm = [18, 0], to_mm = [19, 0] }, { from_mm = [-18, 0], to_mm = [-19, 0] }]",
            TENSION,
            "[fatigue.initiation]\nrange_mpa = 200\ncycles = 1e6\nslope = 5",
            19.0,
        ),
        row(
            "kind = \"single_edge_bend\"\nwidth_mm = 20\nthickness_mm = 10\ncrack_length_mm = 10",
            "cracks = [{ from_mm = [0, 0], to_mm = [10, 0] }]",
            &format!("force_max_n = 1000\n{beam}{{ at_mm = [20, 0], contact_width_mm = 1 }}]"),
            "",
            10.0,
        ),
        row(
            "kind = \"eccentric_single_edge_tension\"\nwidth_mm = 40\nthickness_mm = 4\ncrack_length_mm = 10",
            "holes = [{ x_mm = 8, y_mm = 60, diameter_mm = 8 }, { x_mm = 8, y_mm = -60, diameter_mm = 8 }]\ncracks = [{ from_mm = [0, 0], to_mm = [10, 0] }]",
            pins,
            "",
            10.0,
        ),
        row(
            "kind = \"wedge_opening\"\nwidth_mm = 50\nthickness_mm = 10\ncrack_length_mm = 20",
            &format!("{}cracks = [{{ from_mm = [-12.75, 0], to_mm = [20, 0] }}]", compact(12.5)),
            pins,
            "",
            20.0,
        ),
        row(
            "kind = \"cruciform\"\nlength_mm = 200\narm_width_mm = 60\nfillet_radius_mm = 10\nthickness_mm = 2\ncrack_length_mm = 10\ncrack_angle_deg = 90",
            "cracks = [{ from_mm = [0, -10], to_mm = [0, 10] }]",
            "stress_max_mpa = 50\nstress_parallel_ratio = 0.5",
            "",
            10.0,
        ),
    ]
}

#[test]
fn named_plates_are_plates() {
    let mut seen = Vec::new();
    for (kind, plate, loading, more, length) in rows() {
        // What a named plate brings along is left out beside its name.
        let own: Vec<&str> = loading.lines().filter(|line| !line.starts_with("pins") && !line.starts_with("rollers")).collect();
        let of_name = if more.starts_with("[supports]") { "" } else { more.as_str() };
        let named = read(&kind, &own.join("\n"), of_name).unwrap_or_else(|error| panic!("{kind}: {error}"));
        let corners: Vec<String> = named.outline.iter().map(|[x, y]| format!("[{:?}, {:?}]", x / MM, y / MM)).collect();
        let keys = format!(
            "kind = \"plate\"\noutline_mm = [{}]\nthickness_mm = {:?}\n{plate}",
            corners.join(", "),
            named.thickness / MM
        );
        let drawn = read(&keys, &loading, &more).unwrap_or_else(|error| panic!("{keys}: {error}"));
        assert!((named.crack_length / MM - length).abs() < 1e-9, "{kind}: {}", named.crack_length);
        seen.push(named.kind);
        let as_plate = Specimen {
            kind: SpecimenKind::Plate,
            own_formula: None,
            crack_length: drawn.crack_length,
            convention: LengthConvention::SumOfTips,
            ..named
        };
        let words = |plate: &Specimen| format!("{plate:.7?}").replace("-0.0000000", "0.0000000");
        assert_eq!(words(&as_plate), words(&drawn), "{kind}");
    }
    let named = SpecimenKind::ALL.iter().filter(|kind| kind.named().is_some());
    named.for_each(|kind| assert!(seen.contains(kind), "{kind} is new: of which plate is it?"));
}

/// Sizes, then the words of the refusal.
#[test]
fn what_does_not_fit_is_said_by_its_keys() {
    let hole = |keys: &str| format!("kind = \"crack_at_hole\"\n{SIZES}{keys}");
    let row = |keys: &str| format!("kind = \"row_of_holes\"\n{SIZES}hole_diameter_mm = 5\n{keys}");
    let lug =
        |keys: &str| format!("kind = \"lug\"\nwidth_mm = 50\nlength_mm = 100\nthickness_mm = 5\nhole_diameter_mm = 20\n{keys}");
    let rows = [
        (hole("hole_diameter_mm = 120\ncrack_length_mm = 3"), TENSION, "specimen.hole_diameter_mm = 120"),
        (
            hole("hole_diameter_mm = 10\ncrack_length_mm = 45"),
            TENSION,
            "specimen.crack_length_mm = 45: is not below the way from the rim to the edge, 45 mm",
        ),
        (hole("hole_diameter_mm = 10"), TENSION, "specimen.crack_length_mm: is missing"),
        (hole("hole_diameter_mm = 10\ncrack_length_mm = 3\ncracks = 3"), TENSION, "specimen.cracks = 3"),
        (
            hole("hole_diameter_mm = 10\ncrack_length_mm = 3\ncrack_lengths_mm = [1, 2]"),
            TENSION,
            "stands beside crack_lengths_mm",
        ),
        (hole("hole_diameter_mm = 10\ncrack_length_mm = 3\nholes = []"), TENSION, "specimen.holes"),
        (row("holes = 1\npitch_mm = 20\ncrack_length_mm = 1"), TENSION, "is no row"),
        (row("holes = 6\npitch_mm = 20\ncrack_length_mm = 1"), TENSION, "specimen.pitch_mm = 20"),
        (row("holes = 3\npitch_mm = 20\ncrack_length_mm = 8"), TENSION, "half the ligament, 7.5 mm"),
        (row("holes = 3\npitch_mm = 20\ncrack_lengths_mm = [[1, 1]]"), TENSION, "are not those of 3 holes"),
        (lug("head = \"round\"\nedge_distance_mm = 30\ncrack_length_mm = 3"), FORCE, "specimen.edge_distance_mm = 30"),
        (lug("head = \"square\"\ncrack_length_mm = 3"), FORCE, "use one of straight, round"),
        (lug("head = \"round\"\ncrack_length_mm = 3"), TENSION, "is a stress"),
        (
            lug("head = \"round\"\ncrack_length_mm = 3"),
            "force_max_n = 1\nstress_parallel_ratio = 1",
            "does not go with the forces of lug",
        ),
        (
            format!("kind = \"edge_notch\"\n{SIZES}notch_depth_mm = 2\nnotch_radius_mm = 3"),
            TENSION,
            "specimen.notch_radius_mm = 3",
        ),
        (
            format!("kind = \"stop_hole\"\n{SIZES}stopped_crack_length_mm = 15\nhole_diameter_mm = 6\nformed_length_mm = 1"),
            TENSION,
            "fatigue.initiation",
        ),
    ];
    for (keys, loading, words) in rows {
        let error = read(&keys, loading, "").expect_err(&keys);
        assert_eq!(error.exit_code(), 2);
        assert!(error.to_string().contains(words), "{words} in {error}");
    }
    // A named plate takes other loads than its own, and then has no formula.
    let keys = lug("head = \"straight\"\ncrack_length_mm = 3");
    let pin = "force_max_n = 1\npins = [{ hole = 0, direction = [0, 1], contact_half_angle_deg = 30 }]";
    assert_eq!(read(&keys, pin, "").unwrap().loads.len(), 1);
    let two = hole("hole_diameter_mm = 10\ncrack_length_mm = 3\ncracks = 2");
    assert!(read(&two, TENSION, "").unwrap().own_formula.is_some());
    assert!(read(&two, "stress_max_mpa = 50\nstress_parallel_ratio = 0.5", "").unwrap().own_formula.is_none());
}
