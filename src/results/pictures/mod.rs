//! Pictures of a run and of a fit, drawn from `result.json` or `fit.json` and the tables: in the results folder and in a report alike.

pub mod curves;
pub mod fit;
pub mod plate;
pub mod section;
pub mod stress;
