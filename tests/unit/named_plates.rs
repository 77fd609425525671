//! Named plates are the plates that `plate` gives for the same drawing, and say by their own keys what does not fit.

use std::path::Path;

use perilife_base::error::Result;
use perilife_base::units::MM;
use perilife_growth::case::Case;
use perilife_plate::specimen::{LengthConvention, Specimen, SpecimenKind};

use crate::support::rows::rows;

const TENSION: &str = "stress_max_mpa = 50";
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

#[test]
fn named_plates_are_plates() {
    let mut seen = Vec::new();
    for (kind, plate, loading, more, length) in rows::<Vec<(String, String, String, String, f64)>>("named_plates", "kinds") {
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
    let lug =
        |keys: &str| format!("kind = \"lug\"\nwidth_mm = 50\nlength_mm = 100\nthickness_mm = 5\nhole_diameter_mm = 20\n{keys}");
    for [keys, loading, words] in rows::<Vec<[String; 3]>>("named_plates", "refused") {
        let error = read(&keys, &loading, "").expect_err(&keys);
        assert_eq!(error.exit_code(), 2);
        assert!(error.to_string().contains(&words), "{words} in {error}");
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
