//! A case to go with the run nobody computed.

use std::path::Path;

use perilife_growth::case::record::FittedRecord;
use perilife_growth::case::{Case, LawSource};

use crate::support::rows::rows;

/// A plate of 100 x 300 mm with the slant crack of the made-up run and an inline law; the model names the bond law and a
/// spacing that has to move.
const TEXT: &str = include_str!("../reference/cases/made_up_case.toml");

/// The case, with one warning of its own.
pub fn case() -> Case {
    let mut case = Case::from_toml(TEXT, "made_up", Path::new("."), &[]).unwrap();
    case.warnings = vec!["spacing moved".to_owned()];
    case
}

/// A record fitted between two ΔK in MPa√m.
pub fn fitted(delta_k_min: f64, delta_k_max: f64) -> LawSource {
    let made_up: FittedRecord = rows("records", "made_up");
    LawSource::Fitted(Box::new(FittedRecord {
        delta_k_min_mpa_sqrt_m: delta_k_min,
        delta_k_max_mpa_sqrt_m: delta_k_max,
        ..made_up
    }))
}
