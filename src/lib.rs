//! Fatigue-life prediction of cracked plates by peridynamics.
#![warn(missing_docs)]

pub mod error;
pub mod input;
pub mod kinds;
#[cfg(feature = "tables")]
pub mod tables;
pub mod units;

pub mod bond_law;
pub mod calibration;
pub mod case;
pub mod fatigue;
pub mod loading;
pub mod material;
pub mod predict;
pub mod solver;
pub mod specimen;

pub use error::{Error, Result};
