//! Cases of the verification, written as the user writes them. Keys that override theirs stand in one text, `section.key=value` with
//! blanks between them.

use std::path::Path;

use perilife_base::error::Result;
use perilife_base::input::Document;
use perilife_growth::case::Case;
use perilife_growth::case::remove_law;

pub const NODES: &str = "model.method=element_free_galerkin";
/// Override for the choice of the program.
pub const AUTO: &str = "model.method=auto";
/// Override for points and bonds.
pub const POINTS: &str = "model.method=peridynamics";

pub fn overrides(keys: &str) -> Vec<String> {
    keys.split_whitespace().map(str::to_owned).collect()
}

pub fn case(text: &str, keys: &str) -> Result<Case> {
    case_of(text, &overrides(keys))
}

/// The same with the keys one by one.
pub fn case_of(text: &str, set: &[String]) -> Result<Case> {
    Case::from_toml(text, "verification", Path::new("."), &by_name(text, set))
}

/// The keys with a method among them: that of points where neither they nor the text name one. What is compared is a method, not the choice
/// of the program.
pub fn by_name(text: &str, set: &[String]) -> Vec<String> {
    let is_named = text.contains("method = ") || set.iter().any(|key| key.starts_with("model.method="));
    (!is_named).then(|| POINTS.to_owned()).into_iter().chain(set.iter().cloned()).collect()
}

/// A plate from the text of a case, which need not have a crack; its fatigue law is not read.
pub fn plate_alone(text: &str, set: &[String]) -> Result<Case> {
    let mut document = Document::parse(text, "verification", Path::new("."), &by_name(text, set))?;
    remove_law(&mut document.table);
    Case::without_growth(document.table.clone(), &document.name, &document.folder)
}
