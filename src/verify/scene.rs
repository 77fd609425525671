//! Cases of the verification, written as the user writes them.

use std::path::Path;

use crate::case::Case;
use crate::case::record::FittedRecord;
use crate::case::remove_law;
use crate::error::Result;
use crate::input::Document;
use crate::predict::{Prediction, Silent, predict};

/// Material and law of plates whose cracks go by K.
pub const MATERIAL_AND_LAW: &str = "
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
pub const PULL: &str = "[loading]\nstress_max_mpa = 60\nstress_ratio = 0.1\n";

/// Two millimetres thick, of these keys, pulled at its ends.
pub fn pulled_plate(keys: &str) -> String {
    format!("[specimen]\nkind = \"plate\"\nthickness_mm = 2\n{keys}\n{PULL}{MATERIAL_AND_LAW}")
}

/// A case from its text, with keys overridden by `section.key=value`.
pub fn case(text: &str, set: &[&str]) -> Result<Case> {
    let overrides: Vec<String> = set.iter().map(|key| (*key).to_owned()).collect();
    Case::from_toml(text, "verification", Path::new("."), &overrides)
}

/// A plate from the text of a case, which need not have a crack; its fatigue law is not read.
pub fn plate_alone(text: &str, set: &[&str]) -> Result<Case> {
    let overrides: Vec<String> = set.iter().map(|key| (*key).to_owned()).collect();
    let mut document = Document::parse(text, "verification", Path::new("."), &overrides)?;
    remove_law(&mut document.table);
    Case::without_growth(document.table.clone(), &document.name, &document.folder)
}

/// A case from text without fatigue law, with a fitted one and keys overridden.
pub fn case_with_law(text: &str, set: &[String], record: &FittedRecord) -> Result<Case> {
    let document = Document::parse(text, "verification", Path::new("."), set)?;
    Case::from_table(document.table.clone(), &document.name, &document.folder)?.with_law(record.clone())
}

/// The curve of a run as (cycles, crack length in m).
pub fn points(run: &Prediction) -> Vec<(f64, f64)> {
    run.curve.iter().map(|point| (point.cycles, point.crack_length)).collect()
}

/// Life of a case from its text, cycles.
pub fn life(text: &str, set: &[&str]) -> Result<f64> {
    Ok(predict(&case(text, set)?, &Silent)?.life_cycles())
}
