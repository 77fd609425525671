//! Sweeps: many cases of one base case, by a design that a file describes.
//!
//! A sweep file gives the base case, the keys that vary and how ([`design`]); [`draw`] makes the cases of it, each whole in itself
//! (text and the files it names), so that they can be run anywhere, and reads all of them before anything is run. Random designs
//! are hypercubes ([`distribution`]); laws that scatter as specimens do come from [`scatter`].

pub mod design;
pub mod detection;
pub mod distribution;
pub mod draw;
pub mod fleet;
pub mod scatter;
mod vary;

pub use design::{Design, DesignKeys, Scatter, Sweep};
pub use draw::DrawnCase;
pub use vary::{DesignKind, DistributionKind, Scale, Spread, Vary, VaryKeys};
