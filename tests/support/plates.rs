//! Cases of cracked plates as tests of the engine want them: short text, coarse spacing.

use std::path::Path;

use perilife_base::error::Result;
use perilife_growth::case::Case;
use perilife_growth::predict::Prediction;
use perilife_plate::specimen::Point;
use perilife_study::cases::by_name;

/// Sections that most tests do not care about.
const REST: &str = r#"
[material]
youngs_modulus_gpa = 72.0
poisson_ratio = 0.3
plane = "stress"
[model]
spacing_mm = 2.0
[fatigue]
a = 6450.0
p = 2.86
horizon_mm = 3.015
"#;

const STRESS: &str = "[loading]\nstress_max_mpa = 70.0\nstress_ratio = 0.1\n";
const FORCE: &str = "[loading]\nforce_max_n = 4000.0\nstress_ratio = 0.1\n";

/// What drives cracks: K of their tips, the default, and strains of bonds.
pub const TIP_FIELD: &str = "fatigue.driver=tip_field";
pub const BOND_STRAIN: &str = "fatigue.driver=bond_strain";

/// The panel of Virkler, Hillberry and Goel (1979).
pub const PANEL: &str =
    "kind = \"middle_tension\"\nwidth_mm = 152.4\nlength_mm = 300.0\nthickness_mm = 2.54\ncrack_length_mm = 20.0\n";

/// The case of a `[specimen]` section, and of a `[loading]` section where one follows it, with other keys set by
/// `section.key=value`.
pub fn try_case(specimen: &str, set: &[&str]) -> Result<Case> {
    let overrides: Vec<String> = set.iter().map(|text| (*text).to_owned()).collect();
    let loading = match specimen {
        given if given.contains("[loading]") => "",
        pins if pins.contains("compact_tension") => FORCE,
        _ => STRESS,
    };
    let text = format!("[specimen]\n{specimen}{loading}{REST}");
    Case::from_toml(&text, "plate", Path::new("."), &by_name(&text, &overrides))
}

/// [`try_case`] where the input is right.
pub fn case(specimen: &str, set: &[&str]) -> Case {
    try_case(specimen, set).unwrap()
}

/// A run whose curve and pictures are in order.
#[track_caller]
pub fn sound(name: &str, run: &Prediction) {
    for pair in run.curve.windows(2) {
        assert!(pair[1].cycles >= pair[0].cycles && pair[1].crack_length >= pair[0].crack_length, "{name}");
        assert!(pair[1].cycles.is_finite() && pair[1].crack_length.is_finite(), "{name}");
    }
    assert!(run.snapshots.iter().flat_map(|s| &s.displacement).flatten().all(|u| u.is_finite()), "{name}");
}

/// Material and law of plates whose cracks go by K.
const MATERIAL_AND_LAW: &str = "
[material]
youngs_modulus_gpa = 70.0
poisson_ratio = 0.3
plane = \"stress\"
[fatigue]
paris_c_mm_per_cycle = 1e-8
paris_m = 3.0
[stop]
cycles_max = 1e14
";

/// Loading of all that is pulled at its ends.
const PULL: &str = "[loading]\nstress_max_mpa = 60\nstress_ratio = 0.1\n";

/// Two millimetres thick, of these keys, pulled at its ends.
pub fn pulled_plate(keys: &str) -> String {
    format!("[specimen]\nkind = \"plate\"\nthickness_mm = 2\n{keys}\n{PULL}{MATERIAL_AND_LAW}")
}

/// A pulled plate with these straight cracks, given by their ends; mm.
pub fn cracked_plate(width: f64, length: f64, ends: &[[Point; 2]]) -> String {
    pulled_plate(&format!("width_mm = {width}\nlength_mm = {length}\n{}", cracks(ends)))
}

/// The key of straight cracks, mm.
pub fn cracks(ends: &[[Point; 2]]) -> String {
    let all: Vec<String> = ends.iter().map(|[from, to]| format!("{{ from_mm = {from:?}, to_mm = {to:?} }}")).collect();
    format!("cracks = [{}]", all.join(", "))
}
