//! Calibration, verification and reports.
#![warn(missing_docs)]

pub use perilife_engine::*;

#[cfg(feature = "tables")]
pub mod tables;
pub mod measured;
pub mod calibration;
pub mod verify;
pub mod sweep;
pub mod report;
pub mod runner;
pub mod check;
