//! Points of several levels, each split in four where a scene asks for it, and equilibrium on them.

pub mod dual_horizon;
pub mod equilibrium;
pub mod stiffness;
