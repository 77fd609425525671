//! What is done with the engine: laboratory tables, calibration, verification, sweeps, reports. `perilife` has all of it.
#![warn(missing_docs)]

#[doc(inline)]
pub use perilife_engine::*;

pub mod calibration;
pub mod verify;
pub mod sweep;
pub mod report;
pub mod runner;
pub mod check;
