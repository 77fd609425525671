//! Fatigue-life prediction of cracked plates by peridynamics.
#![warn(missing_docs)]

pub mod error;
pub mod input;
pub mod kinds;
pub mod units;

pub mod specimen;
pub mod loading;
pub mod material;
pub mod bond_law;
pub mod body;
pub mod state;
pub mod solver;
pub mod fatigue;
pub mod calibration;
pub mod case;
pub mod predict;

pub use error::{Error, Result};
