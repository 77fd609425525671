//! Pins that touch beside the mouth of a crack (`field/mechanics5/pin_at_mouth` of the shared data): K by finite elements with contact.

use perilife_base::units::MPA_SQRT_M;
use perilife_growth::case::Case;
use perilife_growth::cracks::initial_tips;
use perilife_growth::nodes::NodePlate;
use perilife_plate::specimen::{Bearing, Load};

use crate::interface::cli::{perilife, texts};
use crate::support::shared::shared;

/// Error of K over K_I where the pin touches at the mouth, and elsewhere.
const AT_MOUTH: f64 = 0.005;
const ELSEWHERE: f64 = 0.0025;

/// File, K_I and K_II in MPa√m, error over K_I. Of `pin90_crack90` the elements have contact of the flanks (tests/reference/pin_contact.py), which
/// the pin presses together at the mouth; with flanks that overlap they have 1.778.
const ROWS: [(&str, f64, f64, f64); 7] = [
    ("pin0_crack90", 8.625, -2.966, AT_MOUTH),
    ("pin0_crack90_short", 8.026, -1.379, AT_MOUTH),
    ("pin45_crack0", 8.918, 4.462, AT_MOUTH),
    ("pin90_crack90", 1.9505, 0.0, AT_MOUTH),
    ("guard_pin90_crack0", 16.336, -1.942, ELSEWHERE),
    ("guard_pin90_crack60", 5.068, 2.565, AT_MOUTH),
    ("guard_loose", 10.865, -2.250, ELSEWHERE),
];

/// K of a file, MPa√m, and the residual of its contact.
fn found(file: &str, others: &[&str]) -> Option<([f64; 2], f64)> {
    let path = shared(&format!("field/mechanics5/pin_at_mouth/{file}.toml"))?;
    let text = std::fs::read_to_string(&path).unwrap();
    let overrides: Vec<String> =
        ["model.method=\"element_free_galerkin\""].iter().chain(others).map(|&one| one.to_owned()).collect();
    let case = Case::from_toml(&text, file, path.parent().unwrap(), &overrides).unwrap();
    let k = initial_tips::<NodePlate>(&case).unwrap().tips[0].factors.unwrap();
    let Load::Pin { contact: Bearing::Elastic(pin), .. } = &case.specimen.loads[0] else { panic!("{file}: no pin") };
    Some((k.map(|k| k / MPA_SQRT_M), pin.found.as_ref().unwrap().residual))
}

#[test]
fn pins_lean_on_mouths_of_cracks() {
    for (file, k_i, k_ii, share) in ROWS {
        for finer in [&[][..], &["model.tolerance_percent=0.5"]] {
            let Some((k, residual)) = found(file, finer) else { return };
            let off = [k[0] - k_i, k[1] - k_ii].map(|off| off / k_i);
            println!("{file} {finer:?}: {k:.3?}, off {off:.4?} of K_I, residual {residual:.5}");
            assert!(off.iter().all(|off| off.abs() < share), "{file} {finer:?}: {k:?}");
            assert!(residual < 0.006, "{file} {finer:?}: {residual}");
        }
    }
}

/// The remedy keeps the crack.
#[test]
fn part_through_cracks_beside_pins_are_refused() {
    let Some(path) = shared("field/mechanics5/refusals/corner_pin.toml") else { return };
    let output = perilife(path.parent().unwrap(), &["check", "corner_pin.toml"]);
    let (_, stderr) = texts(&output);
    assert_eq!(output.status.code(), Some(2), "{stderr}");
    assert!(stderr.contains("loading.pins") && stderr.contains("through crack as long as its larger axis"), "{stderr}");
}
