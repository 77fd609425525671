//! The service as a client sees it.

mod crashes;
mod denial;
mod deploy;
mod description;
mod doors;
mod fuzzed;
pub mod jobs;
mod limits;
mod long_use;
mod named;
mod page;
mod page_figures;
mod page_axe;
mod page_forms;
mod queue;
mod reader;
mod refusals;
mod results;
mod tokens;

use serde_json::{Value, json};

/// A plate of some thousand points that takes a tenth of a second.
pub const QUICK: &str = "[specimen]\nkind = \"middle_tension\"\nwidth_mm = 60\nlength_mm = 120\nthickness_mm = 2\n\
    crack_length_mm = 9\n[material]\nname = \"al2024-t3\"\n[loading]\nstress_range_mpa = 60\nstress_ratio = 0.1\n\
    [model]\nspacing_mm = 1.5\n[fatigue]\na = 6450.0\np = 2.86\nhorizon_mm = 3.015\n[stop]\ncrack_length_mm = 20\n";

/// Section of a document that asks for ParaView files.
pub const FOR_PARAVIEW: &str = "[output]\nparaview = true\n";

/// A slant crack that takes seconds and can be taken up at several places.
pub const SLOW: &str = "[specimen]\nkind = \"plate\"\nwidth_mm = 70.0\nlength_mm = 100.0\nthickness_mm = 2.0\n\
    cracks = [{ from_mm = [-9.0, -5.0], to_mm = [9.0, 5.0] }]\n[material]\nyoungs_modulus_gpa = 72.0\npoisson_ratio = 0.3\n\
    [loading]\nstress_max_mpa = 70.0\nstress_ratio = 0.1\n[model]\nspacing_mm = 0.8\n\
    [fatigue]\na = 6450.0\np = 2.86\nhorizon_mm = 3.015\ndriver = \"bond_strain\"\n";

/// The quick plate by hand: a job of milliseconds.
pub fn tiny() -> String {
    const PARIS: &str = "growth_law = \"paris\"\nparis_c_mm_per_cycle = 1e-8\nparis_m = 2.86";
    QUICK.replace("spacing_mm = 1.5", "method = \"handbook\"").replace("a = 6450.0\np = 2.86\nhorizon_mm = 3.015", PARIS)
}

/// A calibration of the quick plate by the readings of `curve.csv`, with this model.
pub fn test_of_quick(model: &str) -> String {
    format!("[measured]\nfiles = [\"curve.csv\"]\n{}[model]\n{model}\n", QUICK.split_once("[model]").unwrap().0)
}

/// The body of a submission of TOML text.
pub fn of(name: &str, text: &str) -> Value {
    json!({ "name": name, "input": text })
}
