//! What a fracture scene is: plate, material, model, loads, damage, procedure. Fixed once read; SI inside.

use perilife_base::input::{Output, Provenance};
use perilife_plate::material::Material;
use perilife_plate::specimen::{Edge, Point, Specimen};
use perilife_points::bond_law::BondLaw;
pub use perilife_points::refinement::{Discretisation, RefinedRegion, Refinement};
use perilife_points::spacing::HORIZON_RATIO;

perilife_base::kinds! {
    /// Laws that act on a point's whole neighbourhood, beside the bond laws.
    pub enum PointLaw for "model.bond_law" {
        Correspondence = "correspondence": "non-ordinary state-based: deformation gradient, Green strain, first Piola-Kirchhoff stress (Silling et al. 2007); fracture scenes",
    }
}

perilife_base::kinds! {
    /// What keeps a correspondence law from its zero-energy modes.
    pub enum ZeroEnergyControl for "model.zero_energy_control" {
        None = "none": "no control: checkerboard modes have no energy",
        Spring = "spring": "springs on the full relative displacement (Breitenfeld et al. 2014); stiffens uniform strain too",
        Silling = "silling": "springs on the nonuniform part of the relative displacement (Silling 2017)",
    }
}

perilife_base::kinds! {
    /// Solvers of fracture scenes.
    pub enum SceneSolver for "model.solver" {
        VelocityVerlet = "velocity_verlet": "explicit motion in time; fracture scenes with duration_s",
        AdaptiveDynamicRelaxation = "adaptive_dynamic_relaxation": "damped motion to rest in every load step",
        Secant = "secant": "secant stiffness by sparse Cholesky in every load step, controlled by dissipation where the load falls; bond laws; fracture scenes",
    }
}

perilife_base::kinds! {
    /// Laws of damage and failure of a bond.
    pub enum DamageLaw for "damage.law" {
        None = "none": "no damage",
        NonlinearTwoParameter = "nonlinear_two_parameter": "exponential softening beyond the elastic limit, broken at the final stretch (Li, Lü, Huang and Yang 2024, equation 19)",
        CriticalStretch = "critical_stretch": "broken at the critical stretch of the fracture energy",
        CriticalEnergy = "critical_energy": "broken at the critical energy of the fracture energy, normal and tangential together, in tension only",
        PrincipalStress = "principal_stress": "broken where the mean first principal stress of both ends reaches the tensile strength (correspondence)",
    }
}

perilife_base::kinds! {
    /// Where broken bonds enter a correspondence law.
    pub enum DamageEntry for "damage.enters" {
        Force = "force": "in the bond force only: the stress of the point is not released",
        Influence = "influence": "in the influence function, hence in shape tensor and deformation gradient too",
    }
}

perilife_base::kinds! {
    /// How the critical stretch follows from the fracture energy.
    pub enum Calibration for "damage.calibration" {
        Growth = "growth": "a crack grows when the body releases the fracture energy (Griffith 1921); lattice trapping is corrected",
        BondEnergy = "bond_energy": "cut bonds store the fracture energy, as published (Silling and Askari 2005): growth needs up to 1.5 times as much",
    }
}

/// Law between displacement and force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SceneLaw {
    Bonds(BondLaw),
    /// Correspondence, with its zero-energy control and that control's factor: H of `silling` (no unit), c_I of `spring` (N/m⁷).
    Correspondence {
        control: ZeroEnergyControl,
        factor: f64,
    },
}

/// Points and law.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneModel {
    pub law: SceneLaw,
    /// True stretch and direction of the deformed bond instead of the linearised ones (bond-based law, explicit motion).
    pub finite: bool,
    /// Spacing asked for, m (of the coarsest level).
    pub spacing: f64,
    /// Horizon over spacing.
    pub horizon_ratio: f64,
    /// Angle of the lattice rows against x, rad.
    pub lattice_angle: f64,
    pub arrangement: Discretisation,
    pub solver: SceneSolver,
}

/// Points that a load or support takes hold of.
#[derive(Debug, Clone, PartialEq)]
pub enum Region {
    /// Points within `depth` of a side, at least one row, m.
    Edge {
        edge: Edge,
        /// Depth, m.
        depth: f64,
        /// Part of the side: coordinates along it, m; infinite where it has no end.
        range: [f64; 2],
    },
    /// Points in an upright box.
    Box {
        /// Lower left corner, m.
        low: Point,
        /// Upper right corner, m.
        high: Point,
    },
}

/// What a load does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Action {
    /// Force per area of the cut edge, Pa, in plate axes.
    Traction(Point),
    /// Displacement at the end of the steps (or of the rise), m; `None` leaves a component free.
    Displacement([Option<f64>; 2]),
    /// Velocity, m/s; `None` leaves a component free.
    Velocity([Option<f64>; 2]),
    /// A rigid plate without friction that moves against the body by so much at the end of the steps, m, along this axis vector.
    Platen(Point),
}

/// How a load rises in a dynamic scene: nothing before `from`, linear over `ramp`, whole from then on. Points that it drives stand
/// still before `from`. Without time all loads grow in proportion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoadRamp {
    /// Time at which it begins, s.
    pub from: f64,
    /// Time that it takes, s; 0 = at once.
    pub ramp: f64,
}

impl LoadRamp {
    /// Whole from the start.
    pub const AT_ONCE: LoadRamp = LoadRamp { from: 0.0, ramp: 0.0 };

    /// Share r of the whole load at a time, s.
    pub fn share(self, time: f64) -> f64 {
        match time - self.from {
            since if since < 0.0 => 0.0,
            since if since >= self.ramp => 1.0,
            since => since / self.ramp,
        }
    }

    /// dr/dt at a time, 1/s.
    pub fn slope(self, time: f64) -> f64 {
        let since = time - self.from;
        if since >= 0.0 && since < self.ramp { 1.0 / self.ramp } else { 0.0 }
    }

    /// ∫ r dt from the start to a time, s.
    pub fn sum(self, time: f64) -> f64 {
        let since = (time - self.from).max(0.0);
        if since < self.ramp { 0.5 * since * since / self.ramp } else { since - 0.5 * self.ramp }
    }

    /// Time at which the load is whole, s.
    pub fn end(self) -> f64 {
        self.from + self.ramp
    }
}

#[derive(Debug, Clone, PartialEq)]
pub struct SceneLoad {
    pub region: Region,
    pub action: Action,
    /// How it rises in time.
    pub rise: LoadRamp,
    /// Key of the region in the input file, for messages.
    pub key: String,
}

#[derive(Debug, Clone, PartialEq)]
pub struct SceneSupport {
    pub region: Region,
    /// Components held at zero.
    pub components: [bool; 2],
    /// Key of the region in the input file, for messages.
    pub key: String,
}

/// How the scene is worked through.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Procedure {
    /// One equilibrium at full load.
    Static,
    /// The load grows in so many steps.
    QuasiStatic {
        steps: usize,
        /// Iterations of relaxation in a step, bonds damaged in each; `None` to come to rest.
        iterations: Option<usize>,
    },
    /// Motion in time.
    Dynamic {
        /// Duration, s.
        duration: f64,
        /// Time step, s; the program's choice where it is left out.
        time_step: Option<f64>,
    },
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Damage {
    pub law: DamageLaw,
    pub enters: DamageEntry,
    /// Critical stretch if it is given instead of the fracture energy.
    pub stretch: Option<f64>,
    /// How it follows from the fracture energy.
    pub calibration: Calibration,
    pub nonlinear: Option<Softening>,
    /// Tensile strength f_t, Pa.
    pub tensile_strength: Option<f64>,
}

impl Damage {
    /// Bonds stay whole.
    pub const NONE: Damage = Damage {
        law: DamageLaw::None,
        enters: DamageEntry::Influence,
        stretch: None,
        calibration: Calibration::Growth,
        nonlinear: None,
        tensile_strength: None,
    };
}

/// Constants of the nonlinear law, stretches.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Softening {
    /// End of the linear part, s_et.
    pub elastic: f64,
    /// Stretch at the largest force, s_nt.
    pub peak: f64,
    /// Stretch at which the bond breaks, s_t.
    pub last: f64,
    /// The law as printed, which lets the force drop between s_et and s_nt, instead of the continuous one.
    pub printed: bool,
}

/// A checked fracture scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    pub name: String,
    /// Plate with its cracks, micro cracks among them. Its loads are the tractions of `drives`, in Pa at full load.
    pub specimen: Specimen,
    pub material: Material,
    pub model: SceneModel,
    pub drives: Vec<SceneLoad>,
    pub holds: Vec<SceneSupport>,
    pub damage: Damage,
    pub procedure: Procedure,
    /// Refinement, for arrangements of several levels.
    pub refinement: Option<Refinement>,
    /// What is written beside tables and pictures.
    pub output: Output,
    /// What the user should know.
    pub warnings: Vec<String>,
    /// The input as given; echoed in `result.json`.
    pub echo: serde_json::Value,
    /// Files that were read for it, and overrides.
    pub provenance: Provenance,
}

impl Scene {
    /// A static scene on a lattice of the usual horizon ratio, upright, that nothing loads, holds or breaks: what scenes that are
    /// built without a file start from.
    pub fn bare(name: &str, specimen: Specimen, material: Material, law: SceneLaw, spacing: f64) -> Scene {
        let solver = match law {
            SceneLaw::Bonds(_) => SceneSolver::Secant,
            SceneLaw::Correspondence { .. } => SceneSolver::AdaptiveDynamicRelaxation,
        };
        Scene {
            name: name.to_owned(),
            specimen,
            material,
            model: SceneModel {
                law,
                finite: false,
                spacing,
                horizon_ratio: HORIZON_RATIO,
                lattice_angle: 0.0,
                arrangement: Discretisation::Lattice,
                solver,
            },
            drives: Vec::new(),
            holds: Vec::new(),
            damage: Damage::NONE,
            procedure: Procedure::Static,
            refinement: None,
            output: Output::default(),
            warnings: Vec::new(),
            echo: serde_json::Value::Null,
            provenance: Provenance::default(),
        }
    }
}
