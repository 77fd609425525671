//! A plate in uniform tension: is its strain that of the continuum, up to its edges and corners?
//!
//! 1 m along the load, 0.5 m across, 100 x 50 points, horizon ratio 3.015. Exact: `u = p x / E` along and `-ν p y / E`
//! across. The published figures put the load on the last column of points; the balanced correction brings its own,
//! consistent loads.

use super::dual_horizon::laws;
use super::table::Table;
use super::uniform_tension::{Errors, shapes, strip, uniform_tension};
use perilife_base::error::Result;
use perilife_base::units::MM;
use perilife_points::bond_law::{BondLaw, BondLawKind, Kernel, Rotation, SurfaceCorrection};

/// Size along the load and across it, and spacing, m.
const SIZE: [f64; 2] = [1.0, 0.5];
const SPACING: f64 = 0.01;
const HORIZON_RATIO: f64 = 3.015;

/// Poisson's ratios of the study; 1/3 is the limit of two-parameter laws.
const POISSON_RATIOS: [f64; 6] = [0.1, 0.15, 0.2, 0.25, 0.3, 1.0 / 3.0];

/// The default law with the balanced correction.
pub const BALANCED: BondLaw = BondLaw {
    kind: BondLawKind::TwoParameter,
    kernel: Kernel::Conical,
    rotation: Rotation::Free,
    surface_correction: SurfaceCorrection::Balanced,
};

const LI: &str = "Li, Lü, Huang and Yang 2024, J. Ship Mech. 28:103, figures 2 and 3";
const HUANG: &str = "Huang, Li, Jin, He and Wang (after Zhu and Ni 2017), example 1";

/// The largest errors along the load that the literature gives, percent: bond law and kernel with the classical corrections, tangential
/// springs resist rotation; Poisson's ratio; source.
const PUBLISHED: [(BondLawKind, Kernel, f64, f64, &str); 4] = [
    (BondLawKind::TwoParameter, Kernel::Conical, 0.3, 1.85, LI),
    (BondLawKind::TwoParameter, Kernel::Conical, 1.0 / 3.0, 2.54, LI),
    (BondLawKind::TwoParameter, Kernel::Constant, 0.3, 2.44, LI),
    (BondLawKind::OneBondTwoParameter, Kernel::Constant, 1.0 / 3.0, WORST, HUANG),
];
/// The largest of them.
const WORST: f64 = 3.25;

/// The state-based law with its default choices, for Poisson's ratios that springs alone cannot have.
const STATE_BASED: BondLaw = BondLaw {
    kind: BondLawKind::StateBased,
    kernel: Kernel::Conical,
    rotation: Rotation::Free,
    surface_correction: SurfaceCorrection::VolumeAndSurface,
};

/// Shapes that the balanced correction does not serve within its bound, why, and the errors that are known, percent.
const KNOWN_MISSES: [(&str, &str, f64); 2] = [
    (
        "edge slot of 2 mm",
        "a residual of 5e-4 round the whole rim opens the thin slot; wider bounds of the multipliers do not help",
        0.862,
    ),
    ("rows at 15 degrees", "two corner points off the lattice find no balance with multipliers within 0.2 and 5", 0.742),
];

/// Rows of the topic.
pub fn rows(table: &mut Table) -> Result<()> {
    for (kind, kernel, nu, published, source) in PUBLISHED {
        let law = BondLaw { kind, kernel, rotation: Rotation::Resisted, surface_correction: SurfaceCorrection::VolumeAndSurface };
        let name = format!("{kind}, {kernel} kernel, nu {nu:.3}: max |e_x| in percent");
        // Within 0.1 points of the published figure.
        table.compare(name, plate(&law, nu)?.along, published, 100.0 * 0.1 / published, source);
    }
    for nu in [0.34, 0.4] {
        let quantity = format!("state_based, nu {nu}: max |e_x| of a tension plate, all points");
        let source = "u = p x / E; bound: the worst published figure of a correction of this kind";
        table.error(quantity, plate(&STATE_BASED, nu)?.along, WORST, source);
    }
    for nu in POISSON_RATIOS {
        let errors = plate(&BALANCED, nu)?;
        let exact = "u = p x / E, v = -nu p y / E";
        table.error(format!("balanced, nu {nu:.3}: max |e_x|, all points"), errors.along, 0.01, exact);
        table.error(format!("balanced, nu {nu:.3}: max |e_x|, interior"), errors.along_inside, 0.01, exact);
        table.error(format!("balanced, nu {nu:.3}: max |e_y|, all points"), errors.across, 0.1, exact);
    }
    let springs: Vec<BondLaw> = laws().filter(|law| law.surface_correction == SurfaceCorrection::Balanced).collect();
    let (mut along, mut across) = (0.0_f64, 0.0_f64);
    for law in &springs {
        let nu = if law.kind == BondLawKind::BondBased { 1.0 / 3.0 } else { 0.1 };
        let errors = plate(law, nu)?;
        (along, across) = (along.max(errors.along), across.max(errors.across));
    }
    let name = format!("balanced, worst of all {} laws, kernels and rotations", springs.len());
    table.error(format!("{name}: max |e_x|, all points"), along, 0.01, "u = p x / E");
    table.error(format!("{name}: max |e_y|, all points"), across, 0.1, "v = -nu p y / E");
    for shape in shapes() {
        let errors = uniform_tension(&shape.specimen, &BALANCED, 0.3, MM, HORIZON_RATIO, shape.angle)?;
        let quantity = format!("balanced, {}: largest error over largest displacement", shape.name);
        table.error(quantity, errors.overall, 0.5, "uniform tension, voids loaded by the stress of what was cut out");
        if let Some((_, reason, known)) = KNOWN_MISSES.iter().find(|(name, ..)| *name == shape.name) {
            table.known_miss(reason, *known);
        }
    }
    Ok(())
}

/// Errors of the plate of the study.
fn plate(law: &BondLaw, poisson_ratio: f64) -> Result<Errors> {
    uniform_tension(&strip(SIZE[1], SIZE[0]), law, poisson_ratio, SPACING, HORIZON_RATIO, 0.0)
}
