//! The law of bonds as a growth law: what a case says of [`crate::FatigueLaw`].

use super::description::{Constant, GrowthLawSpec, UNSAID};
use perilife_base::input::{LENGTH, Quantity, number};

/// The law, of A, p and the horizon.
pub static LAW: GrowthLawSpec = GrowthLawSpec {
    name: "bond_law",
    meaning: "A and p of bonds, dλ/dN = -A ε^p: set in the case, or fitted",
    constants: &[
        Constant::new("a", "a", Quantity { unit: "1/cycle", ..number("a bond constant A", 1e-60, 1e100) }),
        Constant::exponent("p", "p", "a bond exponent p"),
        Constant::new("horizon_mm", "horizon", Quantity { what: "a horizon of A", ..LENGTH }),
    ],
    read: None,
    complete: "give a, p and horizon_mm together, or fitted",
    ..UNSAID
};
