//! Choices of a case that have one built value so far, and what a case chose by itself.

use crate::bond_law::{BondLawKind, Kernel, Rotation, SurfaceCorrection};
use crate::fatigue::Ageing;

crate::kinds! {
    /// Numerical methods.
    pub enum Method for "model.method" {
        Peridynamics = "peridynamics": "points and bonds",
        ElementFreeGalerkin = "element_free_galerkin": "nodes without elements, near-tip fields as unknowns; cracks driven by the K of their tips",
        Handbook = "handbook": "hand calculation: handbook K(a) of a standard specimen, Paris law, quadrature",
    }
}

crate::kinds! {
    /// What spends the life of a bond.
    pub enum Failure for "fatigue.failure" {
        Stretch = "stretch": "bond stretch range",
    }
}

/// What the input file chose explicitly. A fitted record supplies the rest and must agree with these.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Choices {
    /// `model.bond_law`.
    pub bond_law: Option<BondLawKind>,
    /// `model.kernel`.
    pub kernel: Option<Kernel>,
    /// `model.rotation`.
    pub rotation: Option<Rotation>,
    /// `model.surface_correction`.
    pub surface_correction: Option<SurfaceCorrection>,
    /// `model.horizon_ratio`.
    pub horizon_ratio: Option<f64>,
    /// `fatigue.ageing`.
    pub ageing: Option<Ageing>,
    /// `fatigue.zone_radius_horizons`.
    pub zone_radius_horizons: Option<f64>,
    /// `fatigue.walker_gamma`.
    pub walker_gamma: Option<f64>,
}
