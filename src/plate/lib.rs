//! A plate and what acts on it.
//!
//! Knows: specimens, named plates, drawings, holes, slots, through and part-through cracks, pins; handbook K, tables of β and plastic collapse
//! loads; loads, supports, spectra and their counting, residual stress; elastic constants and the library of materials; the near-tip field
//! of Williams.
//! Must not know: how a plate is discretized, how cracks grow, cases, results.
//!
//! Imports `base`.

pub mod specimen;
pub mod loading;
pub mod material;
pub mod williams;
