//! What all members share: errors, units, named choices, input documents, tables of text, numerics without mechanics.
//!
//! Knows: the three kinds of errors; TOML, its keys and overrides; tables cut into cells, the words of their column names and their decimal sign; SI and US units; quadrature,
//! monotone cubics and straight lines; sealed checkpoints; the raster of pictures; free memory; limits that `perilife stability` measured.
//! Must not know: plates, laws of growth, equations of mechanics, files of results.
//!
//! Imports no member; all others import it.

pub mod error;
pub mod keys;
pub mod kinds;
pub mod units;
pub mod cells;
pub mod columns;
pub mod parallel;
pub mod watch;
pub mod machine;
pub mod monotone;
pub mod blended;
pub mod quadrature;
pub mod linear_fit;
pub mod sealed;
pub mod raster;
pub mod input;
pub mod limits;
pub mod table;

pub use error::{Error, Result};
