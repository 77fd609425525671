//! Ends of the safe ranges of methods, as `perilife stability` has measured them.
//!
//! The table is `boundaries.csv` of a whole run, committed with its version and date; what a case is warned of takes its figure from
//! here, so that a figure that is measured anew is one that is told anew.

use std::sync::OnceLock;

use crate::error::{Result, fail_if, input};

pub const TABLE: &str = include_str!("../../data/boundaries.csv");
pub const COLUMNS: &str = "sweep,method,parameter,is_safe,low,high,bound_percent,version,date";

/// The safe range of a method over one parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Limit {
    pub sweep: String,
    pub method: String,
    pub parameter: String,
    /// Whether there is a safe range around the usual value; `None` where that was not judged.
    pub is_safe: Option<bool>,
    /// Its ends: the last values that keep the bound; `None` where the sweep finds none.
    pub ends: [Option<f64>; 2],
    /// Error that counts as right, percent.
    pub bound_percent: f64,
    pub version: String,
    pub date: String,
}

impl Limit {
    /// The end of the safe range that a value lies beyond.
    pub fn passed(&self, value: f64) -> Option<f64> {
        let [low, high] = self.ends;
        low.filter(|low| value < *low).or(high.filter(|high| value > *high))
    }
}

/// Fields of a row in the order of [`COLUMNS`].
type LimitRow = (String, String, String, Option<bool>, Option<f64>, Option<f64>, f64, String, String);

/// Reads a table of limits; a header or a row of another form is refused.
pub fn parse(text: &str) -> Result<Vec<Limit>> {
    let broken = |what: &dyn std::fmt::Display, problem: &str| {
        input("boundaries.csv", format!("\"{what}\""), problem, "write it with `perilife stability --out DIR`")
    };
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let header = reader.headers().map_err(|error| broken(&error, "is not a header"))?.iter().collect::<Vec<_>>().join(",");
    fail_if!(header != COLUMNS, broken(&header, "is not the header of a table of boundaries"));
    let limit = |row: csv::Result<LimitRow>| {
        let (sweep, method, parameter, is_safe, low, high, bound_percent, version, date) =
            row.map_err(|error| broken(&error, "is not a row of a table of boundaries"))?;
        Ok(Limit { sweep, method, parameter, is_safe, ends: [low, high], bound_percent, version, date })
    };
    reader.into_deserialize().map(limit).collect()
}

/// The committed limits, read once. `tests/unit/limits.rs` reads the table with its errors.
pub fn all() -> &'static [Limit] {
    static READ: OnceLock<Vec<Limit>> = OnceLock::new();
    READ.get_or_init(|| parse(TABLE).unwrap_or_default())
}

pub fn of(sweep: &str, method: &str) -> Option<&'static Limit> {
    all().iter().find(|limit| limit.sweep == sweep && limit.method == method)
}
