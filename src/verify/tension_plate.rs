//! A plate in uniform tension: is its strain that of the continuum, up to its edges and corners?
//!
//! 1 m along the load, 0.5 m across, 100 x 50 points, horizon ratio 3.015. Exact: `u = p x / E` along and `-ν p y / E`
//! across. The published figures put the load on the last column of points; the balanced correction brings its own,
//! consistent loads.

use super::dual_horizon::laws;
use super::table::Table;
use super::uniform_tension::{Errors, shapes, strip, uniform_tension};
use crate::bond_law::{BondLaw, BondLawKind, Kernel, Rotation, SurfaceCorrection};
use crate::error::Result;
use crate::units::MM;

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

/// Published figure of a bond law with the classical corrections.
#[derive(Debug, Clone, Copy)]
struct Published {
    /// Bond law.
    kind: BondLawKind,
    /// Kernel.
    kernel: Kernel,
    /// Poisson's ratio.
    poisson_ratio: f64,
    /// Largest error along the load, percent.
    along: f64,
    /// Who published it.
    source: &'static str,
}

const LI: &str = "Li, Lü, Huang and Yang 2024, J. Ship Mech. 28:103, figures 2 and 3";
const HUANG: &str = "Huang, Li, Jin, He and Wang (after Zhu and Ni 2017), example 1";

/// The maxima that the literature gives.
const PUBLISHED: [Published; 4] = [
    Published { kind: BondLawKind::TwoParameter, kernel: Kernel::Conical, poisson_ratio: 0.3, along: 1.85, source: LI },
    Published { kind: BondLawKind::TwoParameter, kernel: Kernel::Conical, poisson_ratio: 1.0 / 3.0, along: 2.54, source: LI },
    Published { kind: BondLawKind::TwoParameter, kernel: Kernel::Constant, poisson_ratio: 0.3, along: 2.44, source: LI },
    Published {
        kind: BondLawKind::OneBondTwoParameter,
        kernel: Kernel::Constant,
        poisson_ratio: 1.0 / 3.0,
        along: 3.25,
        source: HUANG,
    },
];

impl Published {
    /// The law as published: tangential springs resist rotation, volume and surface correction.
    fn law(&self) -> BondLaw {
        BondLaw {
            kind: self.kind,
            kernel: self.kernel,
            rotation: Rotation::Resisted,
            surface_correction: SurfaceCorrection::VolumeAndSurface,
        }
    }
}

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
    for published in &PUBLISHED {
        let (law, nu) = (published.law(), published.poisson_ratio);
        let errors = plate(&law, nu)?;
        let name = format!("{}, {} kernel, nu {nu:.3}: max |e_x| in percent", law.kind, law.kernel);
        // Within 0.1 points of the published figure.
        table.compare(name, errors.along, published.along, 100.0 * 0.1 / published.along, published.source);
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
pub fn plate(law: &BondLaw, poisson_ratio: f64) -> Result<Errors> {
    uniform_tension(&strip(SIZE[1], SIZE[0]), law, poisson_ratio, SPACING, HORIZON_RATIO, 0.0)
}
