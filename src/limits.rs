//! Ends of the safe ranges of methods, as `perilife stability` has measured them.
//!
//! The table is `boundaries.csv` of a whole run, committed with its version and date; what a case is warned of takes its figure from
//! here, so that a figure that is measured anew is one that is told anew.

use std::sync::OnceLock;

use crate::error::{Result, input};

/// The committed table.
const TABLE: &str = include_str!("../data/boundaries.csv");
/// Its columns.
const COLUMNS: [&str; 9] = ["sweep", "method", "parameter", "is_safe", "low", "high", "bound_percent", "version", "date"];

/// The safe range of a method over one parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Limit {
    /// Sweep of `perilife stability`.
    pub sweep: String,
    /// Method in it.
    pub method: String,
    /// What the parameter is.
    pub parameter: String,
    /// Whether there is a safe range around the usual value; `None` where that was not judged.
    pub is_safe: Option<bool>,
    /// Its ends: the last values that keep the bound; `None` where the sweep finds none.
    pub ends: [Option<f64>; 2],
    /// Error that counts as right, percent.
    pub bound_percent: f64,
    /// Version of the program that was measured.
    pub version: String,
    /// Day of the measurement.
    pub date: String,
}

impl Limit {
    /// The end of the safe range that a value lies beyond.
    pub fn passed(&self, value: f64) -> Option<f64> {
        let [low, high] = self.ends;
        low.filter(|low| value < *low).or(high.filter(|high| value > *high))
    }
}

/// Reads a table of limits.
///
/// # Errors
/// [`crate::Error::Input`]: another header, a row of another number of fields, an end that is no number.
pub fn parse(text: &str) -> Result<Vec<Limit>> {
    const FILE: &str = "boundaries.csv";
    let remedy = "write it with `perilife stability --out DIR`";
    let broken = |value: &str, problem: &str| input(FILE, format!("\"{value}\""), problem, remedy);
    let mut reader = csv::ReaderBuilder::new().has_headers(false).from_reader(text.as_bytes());
    let mut limits = Vec::new();
    for (line, row) in reader.records().enumerate() {
        let row = row.map_err(|error| broken(&error.to_string(), "is no row of a table"))?;
        let fields: Vec<&str> = row.iter().collect();
        let &[sweep, method, parameter, is_safe, low, high, bound, version, date] = fields.as_slice() else {
            return Err(broken(&fields.join(","), "has another number of fields"));
        };
        if line == 0 {
            if fields != COLUMNS {
                return Err(broken(&fields.join(","), "is not the header of a table of boundaries"));
            }
            continue;
        }
        let number = |text: &str| text.parse::<f64>().map_err(|_| broken(text, "is not a number"));
        let end = |text: &str| if text.is_empty() { Ok(None) } else { number(text).map(Some) };
        limits.push(Limit {
            sweep: sweep.to_owned(),
            method: method.to_owned(),
            parameter: parameter.to_owned(),
            is_safe: match is_safe {
                "" => None,
                "true" => Some(true),
                "false" => Some(false),
                other => return Err(broken(other, "is neither true nor false")),
            },
            ends: [end(low)?, end(high)?],
            bound_percent: number(bound)?,
            version: version.to_owned(),
            date: date.to_owned(),
        });
    }
    Ok(limits)
}

/// The committed table as text.
pub fn committed() -> &'static str {
    TABLE
}

/// The committed limits, read once. `tests/unit/limits.rs` reads the table with its errors.
pub fn all() -> &'static [Limit] {
    static READ: OnceLock<Vec<Limit>> = OnceLock::new();
    READ.get_or_init(|| parse(TABLE).unwrap_or_default())
}

/// The limit of a method in a sweep, if one was measured.
pub fn of(sweep: &str, method: &str) -> Option<&'static Limit> {
    all().iter().find(|limit| limit.sweep == sweep && limit.method == method)
}
