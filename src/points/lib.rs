//! A plate as points and bonds, in equilibrium at maximum load, and K of its tips: peridynamics.
//!
//! Knows: bond laws and their springs, bodies on a lattice, nets of points of several spacings, surface corrections, solvers, the interaction
//! integral on a ring around a tip, the tip that follows broken bonds, the memory that a body takes.
//! Must not know: nodes, laws of growth, cycles, cases, results.
//!
//! Imports `base` and `plate`. Compiled at full optimization: what it lends to inner loops of other members needs `#[inline]`.

pub mod bond_law;
pub mod body;
pub mod state;
pub mod net;
pub mod refinement;
pub mod spacing;
pub mod budget;
pub mod solver;
pub mod crack_tip;
pub mod pieces;
pub mod stress_intensity;
