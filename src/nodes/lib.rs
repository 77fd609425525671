//! Element-free Galerkin method (Belytschko, Lu and Gu 1994, IJNME 37:229) for plates with cracks.
//!
//! Knows: nodes and shape functions, cracks as cuts, integration, sparse factorization, pins in contact, K of tips, stress fields and stress along
//! boundaries.
//! Must not know: points and bonds, laws of growth, cycles, cases.
//!
//! Imports `base` and `plate`. Compiled at full optimization.
//!
//! Nodes without elements: shape functions are moving least squares over the nodes in reach of a point, parted by cracks; around tips
//! the near-tip fields are unknowns of the nodes. Cells serve for integration only. Nodes lie as fine as tips, rims and ligaments ask and
//! are placed anew for every equilibrium, since cracks have grown.

mod assembly;
pub mod basis;
mod boundary;
mod cells;
pub mod contact;
pub mod crack;
pub mod cuts;
mod dilatation;
mod dissection;
pub mod factors;
pub mod field;
mod front;
pub mod grid;
mod linear;
pub mod nodes;
mod part;
mod pin_contact;
mod pins;
pub mod resolution;
pub mod rim_stress;
mod rim_waves;
pub mod rims;
pub mod solve;
pub mod stress_field;
