//! Named plates are the plates that `plate` gives for the same drawing, and say by their own keys what does not fit.

use std::path::Path;

use perilife_base::error::Result;
use perilife_base::units::MM;
use perilife_growth::case::Case;
use perilife_plate::specimen::{LengthConvention, Specimen, SpecimenKind};

const TENSION: &str = "stress_max_mpa = 50";
const FORCE: &str = "force_max_n = 1000";
const SIZES: &str = "width_mm = 100\nlength_mm = 200\nthickness_mm = 2\n";

fn read(specimen: &str, loading: &str, more: &str) -> Result<Specimen> {
    read_case(specimen, loading, more).map(|case| case.specimen)
}

fn read_case(specimen: &str, loading: &str, more: &str) -> Result<Case> {
    let text = format!(
        "[specimen]\n{specimen}\n[material]\nname = \"al2024-t3\"\n[loading]\n{loading}\nstress_ratio = 0.1\n{more}\n\
         [fatigue]\nparis_c_mm_per_cycle = 1e-7\nparis_m = 3"
    );
    Case::from_toml(&text, "test", Path::new(""), &[])
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
    let bent = |keys: &str| format!("kind = \"single_edge_bend\"\nwidth_mm = 20\nthickness_mm = 10\ncrack_length_mm = 5\n{keys}");
    let row = |keys: &str| format!("kind = \"row_of_holes\"\n{SIZES}hole_diameter_mm = 5\n{keys}");
    let lug =
        |keys: &str| format!("kind = \"lug\"\nwidth_mm = 50\nlength_mm = 100\nthickness_mm = 5\nhole_diameter_mm = 20\n{keys}");
    let rows = [
        (hole("hole_diameter_mm = 120\ncrack_length_mm = 3"), TENSION, "specimen.hole_diameter_mm = 120"),
        (
            hole("hole_diameter_mm = 10\ncrack_length_mm = 45"),
            TENSION,
            "specimen.crack_length_mm = 45: must be below the distance from the hole edge to the plate edge, 45 mm",
        ),
        (hole("hole_diameter_mm = 10"), TENSION, "specimen.crack_length_mm: is missing"),
        (hole("hole_diameter_mm = 10\ncrack_length_mm = 3\ncracks = 3"), TENSION, "specimen.cracks = 3"),
        (
            hole("hole_diameter_mm = 10\ncrack_length_mm = 3\ncrack_lengths_mm = [1, 2]"),
            TENSION,
            "conflicts with crack_length_mm",
        ),
        (hole("hole_diameter_mm = 10\ncrack_length_mm = 3\nholes = []"), TENSION, "specimen.holes"),
        (row("holes = 1\npitch_mm = 20\ncrack_length_mm = 1"), TENSION, "is not 2 to 100"),
        (row("holes = 6\npitch_mm = 20\ncrack_length_mm = 1"), TENSION, "specimen.pitch_mm = 20"),
        (row("holes = 3\npitch_mm = 20\ncrack_length_mm = 8"), TENSION, "half the ligament, 7.5 mm"),
        (row("holes = 3\npitch_mm = 20\ncrack_lengths_mm = [[1, 1]]"), TENSION, "do not match the number of holes, 3"),
        (row("holes = 2\npitch_mm = 20\ncrack_lengths_mm = [[0, 0], [0, 0]]"), TENSION, "has no crack"),
        (row("holes = 2\npitch_mm = 20\ncrack_lengths_mm = [0, 2]"), TENSION, "is not a list of pairs, such as [[1, 2]"),
        (
            row("holes = 3\npitch_mm = 20\ncrack_lengths_mm = [[0, 10], [16, 0], [0, 0]]"),
            TENSION,
            "specimen.crack_lengths_mm[1][0] = 16: is longer than the ligament to the next hole, 15 mm",
        ),
        // All that was cracked has linked: no tip is left.
        (
            row("holes = 3\npitch_mm = 20\ncrack_lengths_mm = [[0, 10], [10, 0], [0, 0]]"),
            TENSION,
            "specimen.crack_lengths_mm = [[0, 10], [10, 0], [0, 0]]: has no tip inside the material",
        ),
        (
            hole("hole_diameter_mm = 6\ncrack_length_mm = 46.99"),
            TENSION,
            "specimen.crack_length_mm = 46.99: has no tip inside the material (a tip within 1 %",
        ),
        (
            "kind = \"crack_at_hole\"\nwidth_mm = 100\nlength_mm = 30\nthickness_mm = 2\nhole_diameter_mm = 40\ncrack_length_mm = 3".to_owned(),
            TENSION,
            "specimen.hole_diameter_mm = 40: extends past the outline",
        ),
        (
            hole("hole_diameter_mm = 10\ncrack_lengths_mm = [3, 4]\nbeta_file = \"beta.csv\""),
            TENSION,
            "specimen.beta_file = \"beta.csv\": one table cannot serve cracks of different length",
        ),
        (
            format!("kind = \"edge_notch\"\n{SIZES}notch_depth_mm = 8\nnotch_radius_mm = 3"),
            TENSION,
            "specimen.crack_length_mm: is missing",
        ),
        (
            hole("hole_diameter_mm = 10\ncrack_length_mm = 3"),
            "force_max_n = 5000\nedge_bending_ratio = \"pure\"",
            "loading.force_max_n = 5000: is zero in pure bending",
        ),
        (bent("span_mm = 1.5"), FORCE, "specimen.span_mm = 1.5: must be above two contacts, 2 mm"),
        (bent("inner_span_mm = 90"), FORCE, "specimen.inner_span_mm = 90: must be below the span less two contacts, 78 mm"),
        (bent("length_mm = 70"), FORCE, "specimen.length_mm = 70: is too short for the span of 80 mm"),
        (bent("length_mm = 70\nspan_mm = 72"), FORCE, "specimen.span_mm = 72: must be below the length less a contact, 69 mm"),
        (lug("head = \"round\"\nedge_distance_mm = 30\ncrack_length_mm = 3"), FORCE, "specimen.edge_distance_mm = 30"),
        (lug("head = \"square\"\ncrack_length_mm = 3"), FORCE, "use one of: straight, round"),
        (
            lug("head = \"round\"\ncrack_length_mm = 3"),
            "force_max_n = 1000\nedge_bending_ratio = 1",
            "loading.edge_bending_ratio = 1: applies only to loaded edges, and the load is that of the forces of lug",
        ),
        (lug("head = \"round\"\ncrack_length_mm = 3"), TENSION, "is a stress"),
        (
            lug("head = \"round\"\ncrack_length_mm = 3"),
            "force_max_n = 1\nstress_parallel_ratio = 1",
            "cannot be combined with the forces of lug",
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
        assert!(!error.to_string().contains("specimen.cracks["), "{error}");
    }
    // A named plate takes other loads than its own, and then has no formula.
    let keys = lug("head = \"straight\"\ncrack_length_mm = 3");
    let pin = "force_max_n = 1\npins = [{ hole = 0, direction = [0, 1], contact_half_angle_deg = 30 }]";
    assert_eq!(read(&keys, pin, "").unwrap().loads.len(), 1);
    let two = hole("hole_diameter_mm = 10\ncrack_length_mm = 3\ncracks = 2");
    assert!(read(&two, TENSION, "").unwrap().own_formula.is_some());
    assert!(read(&two, "stress_max_mpa = 50\nstress_parallel_ratio = 0.5", "").unwrap().own_formula.is_none());
}

/// A crack from the root of a notch begins there, however short it is, and nothing is said of what nobody drew; one that a `plate` begins
/// within a hole is as long as what lies in the material.
#[test]
fn a_crack_begins_at_the_root_however_short() {
    for length in [0.01, 0.05, 3.0, 40.0] {
        let keys = format!(
            "kind = \"edge_notch\"\nwidth_mm = 60\nlength_mm = 120\nthickness_mm = 2\nnotch_depth_mm = 10\nnotch_radius_mm = 5\n\
             crack_length_mm = {length}"
        );
        let case = read_case(&keys, TENSION, "").unwrap_or_else(|error| panic!("{keys}: {error}"));
        assert!(case.warnings.iter().all(|warning| !warning.contains("crack_length_mm:")), "{:?}", case.warnings);
        assert!(case.warnings.iter().all(|warning| !warning.contains("specimen.cracks")), "{:?}", case.warnings);
        let [tip] = case.specimen.tips[..] else { panic!("{length}: {:?}", case.specimen.tips) };
        assert!((tip.position[0] / MM - (length - 20.0)).abs() < 1e-9, "{length}: {tip:?}");
        let drawn = case.specimen.crack_lines()[0].length();
        assert!((drawn / MM - length).abs() < 1e-9, "{length}: {drawn}");
    }
    // An end that all but reaches the edge is said by the key of the kind.
    let through = format!("kind = \"crack_at_hole\"\n{SIZES}hole_diameter_mm = 10\ncrack_lengths_mm = [10, 44.99]");
    let warnings = read_case(&through, TENSION, "").unwrap().warnings;
    let words = "specimen.crack_lengths_mm: a crack ends 0.01 mm from an edge";
    assert!(warnings.iter().any(|warning| warning.contains(words)), "{warnings:?}");
    let at_hole = format!(
        "kind = \"plate\"\n{SIZES}holes = [{{ x_mm = 0, y_mm = 0, diameter_mm = 10 }}]\ncracks = [{{ from_mm = [0, 0], to_mm = [5.04, 0] }}]"
    );
    let plate = read(&at_hole, TENSION, "").unwrap();
    assert!((plate.crack_length / MM - 0.04).abs() < 1e-9 && plate.tips.len() == 1, "{plate:?}");
}

/// Two lengths that fill a ligament have linked their holes; one may be all of it.
#[test]
fn cracks_that_fill_a_ligament_have_linked() {
    for pair in ["[1, 15], [0, 0]", "[1, 10], [5, 0]", "[1, 10], [9, 0]"] {
        let keys = format!(
            "kind = \"row_of_holes\"\n{SIZES}hole_diameter_mm = 5\nholes = 3\npitch_mm = 20\ncrack_lengths_mm = [{pair}, [0, 0]]"
        );
        let row = read(&keys, TENSION, "").unwrap_or_else(|error| panic!("{keys}: {error}"));
        assert!((row.crack_length / MM - 16.0).abs() < 1e-9 && row.tips.len() == 1, "{pair}: {row:?}");
    }
}
