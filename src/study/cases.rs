//! Cases of the verification, written as the user writes them. Keys that override theirs stand in one text, `section.key=value` with
//! blanks between them.

use std::path::Path;

use perilife_base::error::Result;
use perilife_base::input::Document;
use perilife_growth::case::Case;
use perilife_growth::case::remove_law;
use perilife_growth::predict::{Prediction, Silent, predict};
use perilife_plate::specimen::Point;

/// The key of nodes.
pub const NODES: &str = "model.method=element_free_galerkin";
/// Override for the choice of the program.
pub const AUTO: &str = "model.method=auto";
/// Override for points and bonds.
pub const POINTS: &str = "model.method=peridynamics";

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
/// Its maximum, Pa.
pub const STRESS: f64 = 60e6;

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

/// Ends of a crack about the middle with an angle to the load, degrees.
pub fn slanted(half_length: f64, to_load: f64) -> [Point; 2] {
    let (sin, cos) = to_load.to_radians().sin_cos();
    [-half_length, half_length].map(|half| [half * sin, half * cos])
}

/// A middle tension panel twice as long as wide, mm, with these keys of its model.
pub fn middle_tension(width: f64, half_crack: f64, model: &str) -> String {
    format!(
        "[specimen]\nkind = \"middle_tension\"\nwidth_mm = {width}\nlength_mm = {}\nthickness_mm = 2\ncrack_length_mm = \
         {half_crack}\n{PULL}[model]\n{model}\n{MATERIAL_AND_LAW}",
        2.0 * width
    )
}

/// Overrides from their text.
pub fn overrides(keys: &str) -> Vec<String> {
    keys.split_whitespace().map(str::to_owned).collect()
}

/// A case from its text, with keys overridden.
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

/// The run of a case from its text.
pub fn run(text: &str, keys: &str) -> Result<Prediction> {
    predict(&case(text, keys)?, &Silent)
}

/// The curve of a run as (cycles, crack length in m).
pub fn points(run: &Prediction) -> Vec<(f64, f64)> {
    run.curve.iter().map(|point| (point.cycles, point.crack_length)).collect()
}
