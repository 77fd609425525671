//! The law of bonds as a growth law: what a case says of [`crate::FatigueLaw`].

use super::description::{Constant, GrowthLawSpec, UNSAID};
use perilife_base::input::{LENGTH, number};

/// The law, of A, p and the horizon.
pub static LAW: GrowthLawSpec = GrowthLawSpec {
    name: "bond_law",
    meaning: "A and p of bonds, dλ/dN = -A ε^p: set in the case, or fitted",
    constants: &[
        Constant::new("a", "a", number("a constant in 1/cycle", 1e-60, 1e100)),
        Constant::exponent("p", "p"),
        Constant::new("horizon_mm", "horizon", LENGTH),
    ],
    read: None,
    complete: "give a, p and horizon_mm together, or fitted",
    ..UNSAID
};
