//! Stress intensity factors K_I and K_II and the stress T of a crack tip in a plate of points and bonds in equilibrium, by an interaction
//! integral over a ring around it ([`ring`]).

mod crack_faces;
mod gradient;
pub mod ring;

pub use gradient::{Derivatives, TipFrame, derivatives_at};
