//! Displacements and K of the state-based law, at Poisson's ratios that springs alone cannot have.

use super::stress_intensity::{MIDDLE, over_handbook, scene};
use super::table::Table;
use super::tension_plate::plate;
use crate::bond_law::{BondLaw, BondLawKind, Kernel, Rotation, SurfaceCorrection};
use crate::error::Result;

/// The law with its default choices.
const LAW: BondLaw = BondLaw {
    kind: BondLawKind::StateBased,
    kernel: Kernel::Conical,
    rotation: Rotation::Free,
    surface_correction: SurfaceCorrection::VolumeAndSurface,
};
const STATE_BASED: &str = "model.bond_law=state_based";
/// Largest published error of a plate with the classical correction, percent (one-bond two-parameter law, ν = 1/3).
const PUBLISHED_WORST: f64 = 3.25;

/// Rows of the topic.
pub fn rows(table: &mut Table) -> Result<()> {
    for nu in [0.34, 0.4] {
        let errors = plate(&LAW, nu)?;
        let quantity = format!("state_based, nu {nu}: max |e_x| of a tension plate, all points");
        table.error(
            quantity,
            errors.along,
            PUBLISHED_WORST,
            "u = p x / E; bound: the worst published figure of a correction of this kind",
        );
    }
    for (plane, nu) in [("stress", 0.2), ("stress", 0.34), ("stress", 0.4), ("strain", 0.2), ("strain", 0.3), ("strain", 0.34)] {
        let (plane_set, nu_set) = (format!("material.plane={plane}"), format!("material.poisson_ratio={nu}"));
        for (method, ratio) in over_handbook(&scene(MIDDLE, &[STATE_BASED, &plane_set, &nu_set])?)? {
            let quantity = format!("state_based, plane {plane}, nu {nu}: K_I of M(T) a/W 0.19 by {method} over handbook");
            table.compare(quantity, ratio, 1.0, 1.5, "Feddersen 1966 (0.3 %)");
        }
    }
    Ok(())
}
