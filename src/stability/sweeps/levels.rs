//! Points of several levels side by side.

use super::super::{Method, Run, Sweep};
use crate::bond_law::{BondLaw, BondLawKind, Kernel, Rotation, SurfaceCorrection};
use crate::error::Result;
use crate::verify::dual_horizon::{self, PUBLISHED};

/// The law whose changes of level are balanced.
const BALANCED: BondLaw = BondLaw {
    kind: BondLawKind::TwoParameter,
    kernel: Kernel::Conical,
    rotation: Rotation::Free,
    surface_correction: SurfaceCorrection::Balanced,
};

/// Coarsest over finest spacing.
pub const LEVEL_JUMP: Sweep = Sweep {
    name: "level_jump",
    about: "plate of two spacings in uniform strain: resultant of all forces over their sizes, which is zero, and largest error of a \
            displacement over strain times length",
    parameter: "coarsest over finest spacing",
    unit: "",
    values: &[2.0, 4.0, 8.0],
    usual: 2.0,
    is_continuous: false,
    bound_percent: 1.0,
    methods: &[
        Method { name: "dual_horizon: resultant", measure: |jump, _: &Run| resultant(jump) },
        Method { name: "dual_horizon as published: displacement", measure: |jump, _: &Run| displacement(jump, PUBLISHED) },
        Method { name: "dual_horizon balanced: displacement", measure: |jump, _: &Run| displacement(jump, BALANCED) },
    ],
};

fn levels(jump: f64) -> usize {
    jump.log2().round() as usize
}

fn resultant(jump: f64) -> Result<f64> {
    Ok(100.0 * dual_horizon::ghost(PUBLISHED, levels(jump))?)
}

fn displacement(jump: f64, law: BondLaw) -> Result<f64> {
    Ok(100.0 * dual_horizon::patch_of(law, levels(jump))?.off)
}
