//! Stress intensity factors K_I and K_II and the stress T of a crack tip in a plate of points and bonds in equilibrium, by an interaction
//! integral over a ring around it ([`ring`]).

mod crack_faces;
mod cut_cells;
mod gradient;
pub mod ring;
mod tip_frame;

pub use gradient::{Derivatives, derivatives_at};
pub use tip_frame::TipFrame;
