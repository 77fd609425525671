//! A plate in uniform tension: is its strain that of the continuum, up to its edges and corners?
//!
//! 1 m along the load, 0.5 m across, 100 x 50 points, horizon ratio 3.015. Exact: `u = p x / E` along and `-ν p y / E`
//! across. The published figures put the load on the last column of points; the balanced correction brings its own,
//! consistent loads.

use super::dual_horizon::laws;
use super::figures::{Figures, Keys};
use super::uniform_tension::{Errors, shapes, strip, uniform_tension};
use perilife_base::error::{Error, Result};
use perilife_base::units::MM;
use perilife_points::bond_law::{BondLaw, BondLawKind, Kernel, Rotation, SurfaceCorrection};

/// Size along the load and across it, and spacing, m.
const SIZE: [f64; 2] = [1.0, 0.5];
const SPACING: f64 = 0.01;
const HORIZON_RATIO: f64 = 3.015;

/// The default law with the balanced correction.
pub const BALANCED: BondLaw = BondLaw {
    kind: BondLawKind::TwoParameter,
    kernel: Kernel::Conical,
    rotation: Rotation::Free,
    surface_correction: SurfaceCorrection::Balanced,
};

fn errors(law: &BondLaw, poisson_ratio: f64) -> Result<Errors> {
    uniform_tension(&strip(SIZE[1], SIZE[0]), law, poisson_ratio, SPACING, HORIZON_RATIO, 0.0)
}

/// Errors of the plate by the law of some keys.
pub fn plate(keys: &Keys<'_>) -> Result<Figures> {
    let law = BondLaw {
        kind: keys.get("law")?,
        kernel: keys.get("kernel")?,
        rotation: keys.get("rotation")?,
        surface_correction: keys.get("correction")?,
    };
    let found = errors(&law, keys.get("nu")?)?;
    Ok(vec![("along", found.along), ("along_inside", found.along_inside), ("across", found.across)])
}

/// The worst of all laws of springs with the balanced correction.
pub fn worst() -> Result<Figures> {
    let (mut along, mut across, mut count) = (0.0_f64, 0.0_f64, 0.0);
    for law in laws().filter(|law| law.surface_correction == SurfaceCorrection::Balanced) {
        let found = errors(&law, if law.kind == BondLawKind::BondBased { 1.0 / 3.0 } else { 0.1 })?;
        (along, across, count) = (along.max(found.along), across.max(found.across), count + 1.0);
    }
    Ok(vec![("along", along), ("across", across), ("laws", count)])
}

/// A plate with holes, slots or slanted edges, by its place among [`shapes`].
pub fn shape(keys: &Keys<'_>) -> Result<Figures> {
    let place: usize = keys.get("shape")?;
    let shape = shapes().into_iter().nth(place).ok_or_else(|| Error::Mechanics(format!("no shape {place}")))?;
    let found = uniform_tension(&shape.specimen, &BALANCED, 0.3, MM, HORIZON_RATIO, shape.angle)?;
    Ok(vec![("overall", found.overall)])
}
