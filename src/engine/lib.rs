//! The engine: from a case to its life, and scenes of fracture without cycles. `perilife` has all of it.
#![warn(missing_docs)]

pub mod error;
pub mod kinds;
pub mod units;
pub mod cells;
#[cfg(feature = "tables")]
pub mod tables;
pub mod parallel;
pub mod watch;
pub mod monotone;
pub mod blended;
pub mod quadrature;
pub mod line;
pub mod block_cholesky;
pub mod sealed;
pub mod input;
pub mod limits;
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
pub mod measured;
pub mod fatigue;
pub mod case;
pub mod stress_intensity;
pub mod growth;
pub mod stress_concentration;
pub mod predict;
pub mod fracture;

pub use error::{Error, Result};
