//! Pictures of a run and of a fit as vector drawings, for the folder of a run and for a report alike.
//!
//! They are drawn from what `result.json` and the tables of a folder hold, so that a report of an earlier run has the same pictures.

pub mod curves;
pub mod fit;
pub mod plate;
pub mod section;
pub mod spectrum;
pub mod stress;
