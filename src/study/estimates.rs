//! The bounds that the program states for the error of its lives, against what the lives are wrong by.

use super::cases::AUTO;
use super::references::{REFERENCES, compare, largest};
use super::table::Table;
use perilife_base::error::{Error, Result};
use perilife_growth::predict::error_estimate::error_estimate;
use perilife_growth::predict::{Silent, predict};

const SOURCE: &str = "finite elements, tests/reference";
/// Error of the references, percent of life.
const OF_REFERENCE: f64 = 0.1;

/// Errors of the lives that `auto` gives at two tolerances, each with the bound that it states: the true one over it is its effectivity.
pub fn rows(table: &mut Table) -> Result<()> {
    for percent in ["5", "2", "0.5"] {
        for reference in &REFERENCES {
            let case = reference.case(&[AUTO.to_owned(), format!("model.tolerance_percent={percent}")])?;
            let run = predict(&case, &Silent)?;
            let stated = error_estimate(&case, &run).map_err(Error::Mechanics)?.life_percent;
            let tips = compare(&run, reference.tips()?, f64::INFINITY);
            let found = largest(tips.iter().flat_map(|tip| tip.cycles));
            let effectivity = (found.abs() - OF_REFERENCE).max(0.0) / stated;
            let what = format!(
                "{}, {percent} % asked, {stated:.2} % stated: life over the reference, effectivity {effectivity:.2}",
                reference.name
            );
            table.compare(what, 1.0 + 0.01 * found, 1.0, stated + OF_REFERENCE, SOURCE);
        }
    }
    Ok(())
}
