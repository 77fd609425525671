//! What is varied in a scene, one choice at a time.

use super::scene::Scene;
use super::speed_accuracy::WHOLE_PLATE;
use crate::bond_law::{BondLawKind, Kernel, Rotation, SurfaceCorrection};
use crate::case::Case;
use crate::solver::{SolverKind, Symmetry};

/// What is varied, in the order of the legend.
pub const VARIED: [&str; 6] = [DEFAULT, "bond law", "solver", "spacing", "horizon ratio", "surface correction or symmetry"];
/// The name of what is not varied.
pub const DEFAULT: &str = "default";

/// Spacings over the default one.
const SPACINGS: [f64; 4] = [2.0, 1.5, 0.75, 0.5];
const SPACINGS_QUICK: [f64; 2] = [1.25, 0.75];
/// Horizon ratios beside the default one.
const HORIZON_RATIOS: [f64; 4] = [2.015, 2.515, 4.015, 5.015];
const HORIZON_RATIOS_QUICK: [f64; 1] = [2.515];

/// One choice other than the default.
#[derive(Debug, Clone, PartialEq)]
pub struct Variant {
    /// What is varied.
    pub varied: &'static str,
    /// The choice, in words for table and chart.
    pub choice: String,
    /// Keys that make it.
    pub set: Vec<String>,
    /// The solver where it is the choice: it then solves after every break.
    pub solver: Option<SolverKind>,
}

impl Variant {
    fn new(varied: usize, choice: impl Into<String>, set: &[String]) -> Self {
        Variant { varied: VARIED[varied], choice: choice.into(), set: set.to_vec(), solver: None }
    }
}

/// The variants of a scene, whose default is `case`; `quick` leaves most of them out.
#[must_use]
pub fn variants(scene: &Scene, case: &Case, quick: bool) -> Vec<Variant> {
    let mut all = bond_laws(case);
    all.extend(solvers(case));
    all.extend(pick(quick, &SPACINGS, &SPACINGS_QUICK).iter().map(|share| {
        let spacing = share * scene.spacing_mm;
        Variant::new(3, format!("{spacing} mm"), &[format!("model.spacing_mm={spacing}")])
    }));
    all.extend(
        pick(quick, &HORIZON_RATIOS, &HORIZON_RATIOS_QUICK)
            .iter()
            .map(|ratio| Variant::new(4, format!("horizon {ratio}"), &[format!("model.horizon_ratio={ratio}")])),
    );
    all.extend(others(case));
    all
}

fn pick<'a, T>(quick: bool, full: &'a [T], few: &'a [T]) -> &'a [T] {
    if quick { few } else { full }
}

fn bond_laws(case: &Case) -> Vec<Variant> {
    let default = case.model.bond_law;
    let kinds = BondLawKind::ALL.iter().filter(|kind| **kind != default.kind);
    let law = |kind: &BondLawKind| {
        let mut set = vec![format!("model.bond_law={kind}")];
        if *kind == BondLawKind::BondBased {
            // The only one it can have.
            set.push("material.poisson_ratio=0.3333".to_owned());
        }
        Variant::new(1, kind.name(), &set)
    };
    let mut all: Vec<Variant> = kinds.map(law).collect();
    let kernels = Kernel::ALL.iter().filter(|kernel| **kernel != default.kernel);
    all.extend(kernels.map(|kernel| Variant::new(1, format!("{kernel} kernel"), &[format!("model.kernel={kernel}")])));
    let rotations = Rotation::ALL.iter().filter(|rotation| **rotation != default.rotation);
    all.extend(rotations.map(|r| Variant::new(1, format!("rotation {r}"), &[format!("model.rotation={r}")])));
    all
}

/// Every solver but the default; where a crack grows, each solves after every break.
fn solvers(case: &Case) -> Vec<Variant> {
    let variant = |kind: &SolverKind| {
        let set = [format!("model.solver={kind}"), WHOLE_PLATE.to_owned()];
        Variant { solver: Some(*kind), ..Variant::new(2, kind.name(), &set) }
    };
    SolverKind::ALL.iter().filter(|kind| **kind != case.model.solver).map(variant).collect()
}

fn others(case: &Case) -> Vec<Variant> {
    let corrections = SurfaceCorrection::ALL.iter().filter(|kind| **kind != case.model.bond_law.surface_correction);
    let mut all: Vec<Variant> = corrections
        .map(|kind| Variant::new(5, format!("correction {kind}"), &[format!("model.surface_correction={kind}")]))
        .collect();
    let symmetries = Symmetry::ALL.iter().filter(|kind| **kind != case.model.symmetry);
    all.extend(symmetries.map(|kind| Variant::new(5, format!("symmetry {kind}"), &[format!("model.symmetry={kind}")])));
    all
}
