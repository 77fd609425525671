//! `residual_strength.csv` and its picture.

use std::fmt::Write as _;
use std::path::Path;

use super::chart::{self, Mark, Series};
use super::csv::number;
use super::output::write_file;
use crate::case::Case;
use crate::error::Result;
use crate::predict::residual_strength::Strength;
use crate::specimen::LoadMeasure;
use crate::units::{KN, MM, MPA};

/// Name of the table.
pub const RESIDUAL_STRENGTH_FILE: &str = "residual_strength.csv";

/// Unit of the load in columns and in the picture, its name there, and its size.
fn unit(case: &Case) -> (&'static str, &'static str, f64) {
    match case.specimen.load_measure {
        LoadMeasure::Stress => ("mpa", "Residual strength (gross stress), MPa", MPA),
        LoadMeasure::Force => ("kn", "Residual strength (force), kN", KN),
    }
}

/// `crack_length_mm,residual_strength_*,by_toughness_*,by_net_section_*,governed_by` with `mpa` of gross stress or `kn` of force;
/// empty where a strength is not known.
pub fn table(case: &Case, curve: &[Strength]) -> String {
    let (unit, _, size) = unit(case);
    let mut text = format!("crack_length_mm,residual_strength_{unit},by_toughness_{unit},by_net_section_{unit},governed_by\n");
    let field = |load: Option<f64>| load.map_or_else(String::new, |load| number(load / size));
    for strength in curve {
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "{},{},{},{},{}",
            number(strength.crack_length / MM),
            number(strength.load() / size),
            field(strength.by_toughness),
            field(strength.by_net_section),
            strength.governed_by()
        );
    }
    text
}

/// Writes table and picture into a folder.
pub fn write(folder: &Path, case: &Case, curve: &[Strength]) -> Result<()> {
    write_file(&folder.join(RESIDUAL_STRENGTH_FILE), table(case, curve).as_bytes())?;
    let (_, axis, size) = unit(case);
    let series = |name: &str, mark, pick: &dyn Fn(&Strength) -> Option<f64>| Series {
        name: name.to_owned(),
        mark,
        points: curve.iter().filter_map(|s| Some((s.crack_length / MM, pick(s)? / size))).collect(),
    };
    let all = [
        series("residual strength", Mark::Line, &|s| Some(s.load())),
        series("by toughness", Mark::Dashes, &|s| s.by_toughness),
        series("by net-section yield", Mark::Dashes, &|s| s.by_net_section),
        series("maximum load of the cycle", Mark::Dots, &|_| Some(case.loading.maximum)),
    ];
    let known: Vec<Series> = all.into_iter().filter(|series| !series.points.is_empty()).collect();
    chart::over_crack_length(&folder.join("residual_strength.svg"), &format!("{}: residual strength", case.name), axis, &known)
}
