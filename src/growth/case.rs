//! One input file: one choice from each room, checked as a whole before anything runs.

mod boundaries;
pub mod needs;
mod choose;
mod fatigue;
mod fatigue_keys;
mod fleet;
mod law;
mod law_source;
pub mod model;
mod model_keys;
mod pins;
mod read;
pub mod record;
mod residual;

pub use boundaries::{first_load, suits_points};
pub use fatigue_keys::{Lot, remove_law};
pub use fleet::{Fleet, InitialLength};
pub(crate) use law_source::ratio_line;
pub use law_source::{fitted_record, library_law};
pub use model::coarse_points;
pub use model_keys::{REFINED, finer_nodes, usual_nodes};
pub use pins::initial_plate;
pub use read::{RECORD, SECTIONS, keys};

use crate::case::record::{FittedRecord, LawRecord};
use perilife_base::error::Result;
use perilife_base::input::{Output, Provenance};
use perilife_laws::growth_law::FactorLaw;
use perilife_laws::paris::ParisLaw;
use perilife_laws::retardation::Retardation;
use perilife_laws::{Ageing, FatigueLaw, FatigueSettings};
use perilife_nodes::resolution::ElementFreeSettings;
use perilife_plate::loading::Loading;
use perilife_plate::material::Material;
use perilife_plate::specimen::Specimen;
use perilife_points::body::Body;
use perilife_points::body::lattice::fitting_spacing;
use perilife_points::bond_law::{BondLaw, BondLawKind, Kernel, Rotation, SurfaceCorrection};
use perilife_points::solver::{SolverKind, Symmetry};

/// Residual over load at which an equilibrium ends whose K drives a crack: lives are those at 1e-9 to 2.4e-5 on 17 plates of `data/cases`
/// and `tests/reference`. What differs most is the length of steps, which follows from the second difference of ln da/dN: near tips that
/// join, K of a row stands at another gap then, and is the same at an equal one.
pub const RESIDUAL: f64 = 1e-5;

perilife_base::kinds! {
    /// Numerical methods.
    pub enum Method for "model.method" {
        Auto = "auto": "automatic: handbook within its range, else element-free Galerkin nodes; peridynamics if a peridynamics key is set",
        Peridynamics = "peridynamics": "points and bonds",
        ElementFreeGalerkin = "element_free_galerkin": "element-free Galerkin with near-tip enrichment; growth driven by K",
        Handbook = "handbook": "handbook K (standard specimen, part-through crack, or beta table), life by quadrature",
    }
}

/// What computes the growth of a case: method and driver in one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Engine {
    /// K(a) of a handbook.
    Handbook,
    /// K of a crack that does not go through; once it does, nodes.
    PartThrough,
    /// Nodes without elements, and the K of their tips.
    Nodes,
    /// Points and bonds, and the K of their tips.
    Points,
    /// Points and bonds that spend their lives to the end.
    Bonds,
    /// Bonds that begin a crack at a slot, and hand it over to the K of its tips.
    BondsThenPoints,
}

perilife_base::kinds! {
    /// What spends the life of a bond.
    pub enum Failure for "fatigue.failure" {
        Stretch = "stretch": "bond stretch range",
    }
}

/// What the input file chose explicitly. A fitted record supplies the rest and must agree with these.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Choices {
    pub bond_law: Option<BondLawKind>,
    pub kernel: Option<Kernel>,
    pub rotation: Option<Rotation>,
    pub surface_correction: Option<SurfaceCorrection>,
    pub horizon_ratio: Option<f64>,
    pub ageing: Option<Ageing>,
    pub zone_radius_horizons: Option<f64>,
    pub walker_gamma: Option<f64>,
}

/// What computes the mechanics of a case, with its settings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Model {
    /// K(a) of a handbook; with the points by which `perilife sif` compares it.
    Handbook(PointSettings),
    Nodes(ElementFreeSettings),
    Points(PointSettings),
}

/// Points and bonds of a plate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointSettings {
    pub bond_law: BondLaw,
    /// Spacing asked for, m; the body takes the nearest one that fits.
    pub spacing: f64,
    /// Horizon over spacing, m = δ/Δ.
    pub horizon_ratio: f64,
    /// Angle of the lattice rows against x, radians.
    pub lattice_angle: f64,
    pub solver: SolverKind,
    pub symmetry: Symmetry,
    /// Residual over load at which an equilibrium ends whose K drives a crack ([`RESIDUAL`]); no key of a case.
    pub residual: f64,
}

impl Model {
    /// The key of a case that names it.
    pub fn method(&self) -> Method {
        match self {
            Model::Handbook(_) => Method::Handbook,
            Model::Nodes(_) => Method::ElementFreeGalerkin,
            Model::Points(_) => Method::Peridynamics,
        }
    }

    /// Its points, to be changed; `None` of nodes.
    pub fn points_mut(&mut self) -> Option<&mut PointSettings> {
        match self {
            Model::Handbook(points) | Model::Points(points) => Some(points),
            Model::Nodes(_) => None,
        }
    }

    /// The surface correction that gives K of a tip best where the case leaves it open: what a rim at an angle to the rows does to
    /// the plate is 1 % of K with `volume_and_surface` and 0.3 % with `balanced`, which knows one lattice. What of a dilatation is uniform is then in equilibrium, too
    /// ([`perilife_points::solver::dilatation`]).
    fn take_most_accurate_rim(&mut self) {
        if let Some(points) = self.points_mut() {
            points.bond_law.surface_correction = SurfaceCorrection::Balanced;
        }
    }
}

impl PointSettings {
    /// The spacing that the body will have, m: the nearest one that divides the gross width.
    pub fn fitting_spacing(&self, specimen: &Specimen) -> f64 {
        fitting_spacing(specimen, self.spacing, self.lattice_angle)
    }

    /// Spacing asked for times horizon ratio, m.
    pub fn horizon(&self) -> f64 {
        self.horizon_ratio * self.spacing
    }

    /// The plate as points and bonds.
    pub fn body(&self, specimen: &Specimen, material: &Material) -> Result<Body> {
        Body::build(specimen, material, &self.bond_law, self.spacing, self.horizon_ratio, self.lattice_angle)
    }
}

impl Case {
    /// Its points and bonds; of nodes those that the program would take for K of the plate.
    pub fn points(&self) -> PointSettings {
        match self.model {
            Model::Handbook(points) | Model::Points(points) => points,
            Model::Nodes(_) => model::points_for_factors(self),
        }
    }

    /// Its nodes; of another model those that the program would take for the plate.
    pub fn nodes(&self) -> ElementFreeSettings {
        match self.model {
            Model::Nodes(nodes) => nodes,
            Model::Handbook(_) | Model::Points(_) => model_keys::usual_nodes(&self.specimen),
        }
    }
}

/// When a run stops at the latest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stop {
    /// Crack length, m; infinite = none.
    pub crack_length: f64,
    /// Depth of a crack that does not go through, m; infinite = none.
    pub crack_depth: f64,
    /// Whether the life ends where such a crack is through.
    pub at_break_through: bool,
    /// Run-out.
    pub cycles_max: f64,
    /// Load that the plate has to bear over the largest of a cycle, at least 1: the life ends where it no longer does.
    pub required: Option<f64>,
    /// Whether the life ends where K_max is the toughness of the material.
    pub by_toughness: bool,
    /// Whether it ends where a section of the plate is fully plastic at the yield strength.
    pub by_net_section: bool,
}

/// Where the constants of the fatigue law come from.
#[derive(Debug, Clone, PartialEq)]
pub enum LawSource {
    /// Given in the case: `a`, `p`, `horizon_mm`.
    Inline(FatigueLaw),
    /// Given in the case for growth by K: `paris_c_mm_per_cycle`, `paris_m`.
    Paris(ParisLaw),
    /// Given in the case for growth by K, and no power of it.
    Factor(FactorLaw),
    /// A record written by `perilife calibrate`.
    Fitted(Box<FittedRecord>),
    /// A record that does not exist yet (only `check` accepts this), or, with an empty path, no law at all (a calibration).
    Missing(std::path::PathBuf),
}

/// A checked case, SI inside.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    pub name: String,
    pub specimen: Specimen,
    /// Elastic constants and strengths.
    pub material: Material,
    pub loading: Loading,
    pub model: Model,
    /// Why the program chose it; `None` where the case names it.
    pub chosen: Option<String>,
    pub fatigue: FatigueSettings,
    /// How the cycles of a spectrum act on those after them; `None` where they do not.
    pub retardation: Option<Retardation>,
    pub law: LawSource,
    pub stop: Stop,
    /// Plates beside the one that is run.
    pub fleet: Option<Fleet>,
    /// What is written beside tables and pictures.
    pub output: Output,
    /// What the program chose for the case and what the user should know.
    pub warnings: Vec<String>,
    /// The input as given, overrides applied; echoed in `result.json`.
    pub echo: serde_json::Value,
    /// Files that were read for it, and overrides.
    pub provenance: Provenance,
    /// Whether growth far outside the calibrated range of ΔK is accepted.
    pub allow_extrapolation: bool,
    /// Lot that its plate is of, for the band of its life.
    pub lot: Lot,
    /// What the file chose explicitly; a fitted record must agree with it.
    pub choices: Choices,
    /// The record that its law over K comes from.
    pub law_record: Option<Box<LawRecord>>,
    /// What the growth law of the library is that it takes.
    pub growth_data: Option<String>,
}
