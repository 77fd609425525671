//! Fatigue-life prediction of cracked plates by peridynamics.
//!
//! Rooms stand in the order in which data flows; a file uses only rooms listed above its own
//! (kept by `tests/unit/layering.rs`).
#![warn(missing_docs)]

pub mod error;
pub mod kinds;
#[cfg(feature = "tables")]
pub mod tables;
pub mod units;
pub mod parallel;
pub mod quadrature;
pub mod line;
pub mod block_cholesky;
pub mod sealed;
pub mod input;

pub mod specimen;
pub mod loading;
pub mod material;
pub mod bond_law;
pub mod body;
pub mod state;
pub mod levels;
pub mod solver;
pub mod fatigue;
pub mod case;
pub mod stress_intensity;
pub mod growth;
pub mod predict;
pub mod fracture;
pub mod calibration;
pub mod verify;
pub mod bench;
pub mod sweep;
pub mod report;
pub mod check;
#[cfg(feature = "service")]
pub mod service;
pub mod commands;

pub use error::{Error, Result};
