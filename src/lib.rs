//! Fatigue-life prediction of cracked plates by peridynamics.
//!
//! A plate is a lattice of points joined by bonds, and a crack is a line that cuts them. At the maximum load of a cycle the points are in
//! equilibrium, `Σ μ f + b = 0` ([`solver`]). A ring around each crack tip gives K_I, K_II and T by the interaction integral
//! ([`stress_intensity`]); the tip turns to the largest circumferential stress and grows by `da/dN` of its K, all tips over the same
//! cycles, and the bonds that the longer lines cross are cut: that is [`predict::increment`], the main page.
//!
//! Fatigue of a bond is `dλ/dN = -A ε^p`: its remaining life λ decreases from 1, and at 0 it breaks. Integrated through the zone of a
//! steady tip this is `da/dN = β A δ^(1-p/2) (K/E')^p`, a Paris law with m = p ([`fatigue::rate_constant`]). So A and p drive a tip by its K
//! ([`growth::tip_field`], the default), or every bond by its own strain ([`growth::bond_strain`]). Limits: linear elasticity, small-scale
//! yielding, through cracks in plane stress or plane strain. `src/README.md` has the theory room by room, with symbols, limits and sources.
//!
//! Rooms stand in the order in which data flows; a file uses only rooms listed above its own
//! (kept by `tests/unit/layering.rs`).
#![warn(missing_docs)]

pub mod error;
pub mod kinds;
pub mod units;
#[cfg(feature = "tables")]
pub mod tables;
pub mod parallel;
pub mod monotone;
pub mod quadrature;
pub mod line;
pub mod block_cholesky;
pub mod sealed;
pub mod input;

pub mod specimen;
pub mod loading;
pub mod material;
pub mod williams;
pub mod bond_law;
pub mod body;
pub mod state;
pub mod levels;
pub mod solver;
pub mod element_free;
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
