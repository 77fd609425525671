//! Cases of cracked plates as tests of the engine want them: short text, coarse spacing.

use std::path::Path;

use perilife_base::error::Result;
use perilife_growth::case::Case;
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
