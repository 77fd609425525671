//! Cases of method `handbook`.

use std::path::Path;

use perilife_base::error::Result;
use perilife_base::input::Folder;
use perilife_growth::case::Case;
use perilife_growth::predict::{Prediction, Silent, predict};

/// Everything but `[specimen]` and `[loading]`.
const REST: &str = "[material]\nyoungs_modulus_gpa = 73.1\npoisson_ratio = 0.33\n[model]\nmethod = \"handbook\"\n\
                    [fatigue]\nparis_c_mm_per_cycle = 8.95422e-8\nparis_m = 2.874\n";

/// The panel of Virkler, Hillberry and Goel (1979).
pub const PANEL: &str =
    "kind = \"middle_tension\"\nwidth_mm = 152.4\nlength_mm = 300\nthickness_mm = 2.54\ncrack_length_mm = 9\n";
/// Specimens of every kind with a handbook formula.
pub const ALL: [&str; 4] = [
    PANEL,
    "kind = \"single_edge_tension\"\nends = \"uniform_stress\"\nwidth_mm = 60\nlength_mm = 180\nthickness_mm = 3\ncrack_length_mm = 8\n",
    "kind = \"double_edge_tension\"\nwidth_mm = 80\nlength_mm = 200\nthickness_mm = 3\ncrack_length_mm = 8\n",
    "kind = \"compact_tension\"\nwidth_mm = 50\nthickness_mm = 12.5\ncrack_length_mm = 12.5\n",
];

/// The case of a `[specimen]` section under a range of 48.28 MPa or 8 kN at R = 0.2.
pub fn try_hand_case(specimen: &str, set: &[&str]) -> Result<Case> {
    try_hand_case_in(specimen, set, Path::new("."))
}

/// [`try_hand_case`] whose files lie in `folder`.
pub fn try_hand_case_in(specimen: &str, set: &[&str], folder: impl Into<Folder>) -> Result<Case> {
    let load = if specimen.contains("compact_tension") { "force_range_n = 8000" } else { "stress_range_mpa = 48.28" };
    let text = format!("[specimen]\n{specimen}[loading]\n{load}\nstress_ratio = 0.2\n{REST}");
    let overrides: Vec<String> = set.iter().map(|key| (*key).to_owned()).collect();
    Case::from_toml(&text, "hand", folder, &overrides)
}

/// [`try_hand_case`] where the input is right.
pub fn hand_case(specimen: &str, set: &[&str]) -> Case {
    try_hand_case(specimen, set).unwrap()
}

pub fn hand_run(specimen: &str, set: &[&str]) -> Prediction {
    predict(&hand_case(specimen, set), &Silent).unwrap()
}
