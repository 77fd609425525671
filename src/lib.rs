//! Fatigue-life prediction of cracked plates by peridynamics.
//!
//! A plate is a lattice of points joined by bonds; a crack is a line that cuts them. Under the maximum load of a cycle the points are in
//! equilibrium, `Σ μ f V + b = 0`; a ring around each crack tip gives its K_I, K_II and T; the tip turns to the largest circumferential
//! stress and grows by `da/dN` of its K, all tips over the same cycles; the bonds that the longer lines cross are cut. That is
//! [`predict::increment`], the main page. Where bonds fail one by one instead, `dλ/dN = -A ε^p` spends the remaining life λ of each
//! ([`growth::bond_strain`]); `da/dN = β A δ^(1-p/2) (K/E')^p` ties both. `src/README.md` has the theory room by room.
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
