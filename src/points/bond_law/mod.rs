//! Force in a bond: micromodulus kernels and the springs they feed.

pub mod stencil;

use perilife_plate::material::Material;

perilife_base::kinds! {
    /// Constitutive laws of a bond.
    pub enum BondLawKind for "model.bond_law" {
        BondBased = "bond_based": "one normal spring per bond; Poisson's ratio fixed at 1/3 (plane stress) or 1/4 (plane strain)",
        TwoParameter = "two_parameter": "normal and tangential spring per bond; Poisson's ratio up to 1/3 (plane stress) or 1/4 (plane strain)",
        OneBondTwoParameter = "one_bond_two_parameter": "as two_parameter, on bond stretch and shear angle (Zhu and Ni 2017)",
        StateBased = "state_based": "linear ordinary state-based (Silling et al. 2007); any Poisson's ratio",
    }
}

perilife_base::kinds! {
    /// How the micromodulus falls with bond length r.
    pub enum Kernel for "model.kernel" {
        Constant = "constant": "micromodulus independent of bond length",
        Conical = "conical": "micromodulus times 1 - r/horizon",
    }
}

perilife_base::kinds! {
    /// Whether the tangential spring resists rigid rotation.
    pub enum Rotation for "model.rotation" {
        Free = "free": "points rotate freely (third unknown): no energy of rigid rotation",
        Resisted = "resisted": "tangential spring as published: resists rigid rotation",
    }
}

perilife_base::kinds! {
    /// Correction for points whose horizon is cut off by the boundary.
    pub enum SurfaceCorrection for "model.surface_correction" {
        None = "none": "no correction",
        VolumeAndSurface = "volume_and_surface": "partial volumes and energy factors of Madenci and Oterkus 2014",
        Balanced = "balanced": "bond multipliers that balance uniform strain with its boundary traction",
    }
}

impl BondLawKind {
    /// The law for a material where a case leaves it open: two-parameter as far as its springs reach, else state-based.
    pub fn for_material(material: &Material) -> Self {
        if stencil::is_within_springs(material) { BondLawKind::TwoParameter } else { BondLawKind::StateBased }
    }

    /// Whether a bond has a tangential spring beside the normal one.
    pub fn is_two_parameter(self) -> bool {
        match self {
            BondLawKind::BondBased | BondLawKind::StateBased => false,
            BondLawKind::TwoParameter | BondLawKind::OneBondTwoParameter => true,
        }
    }

    /// Whether the micromodulus acts on stretch and shear angle instead of on relative displacement.
    pub fn is_stretch_form(self) -> bool {
        match self {
            BondLawKind::TwoParameter | BondLawKind::StateBased => false,
            BondLawKind::BondBased | BondLawKind::OneBondTwoParameter => true,
        }
    }
}

/// What a case says about the bonds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BondLaw {
    pub kind: BondLawKind,
    pub kernel: Kernel,
    /// Tangential spring and rotation (two-parameter law).
    pub rotation: Rotation,
    pub surface_correction: SurfaceCorrection,
}
