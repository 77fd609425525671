//! `[model]` of a scene: points, law and solver.

use toml::Value;

use crate::correspondence::elasticity::SILLING_FACTOR;
use crate::scene::{Discretisation, PointLaw, Procedure, SceneLaw, SceneModel, SceneSolver, ZeroEnergyControl};
use perilife_base::error::{Error, Result, input, input_missing};
use perilife_base::input::number as plain;
use perilife_base::keys::{Given, key, length, number, section};
use perilife_plate::material::Material;
use perilife_plate::specimen::Specimen;
use perilife_points::bond_law::{BondLaw, BondLawKind, Kernel, Rotation, SurfaceCorrection, stencil};
use perilife_points::spacing::HORIZON_RATIO;
use perilife_points::spacing::{check_spacing, default_spacing};

perilife_base::kinds! {
    /// Measures of deformation of a bond.
    pub enum Kinematics for "model.kinematics" {
        Small = "small": "small displacements: stretch linear in displacement; fracture scenes",
        Finite = "finite": "true stretch along the deformed bond; bond_based by velocity_verlet or adaptive_dynamic_relaxation; fracture scenes",
    }
}

const OF_POINTS: (&str, &[&str]) = ("bond_law", &["correspondence"]);

perilife_base::keys! {
    pub struct ModelKeys {
        bond_law: Option<String> = key("bond_law", "Bond law: default two_parameter");
        kernel: Option<Kernel> = key("kernel", "Kernel: weight of bonds over their length");
        rotation: Option<Rotation> = key("rotation", "Rotation: free or resisted rigid rotation of bonds");
        surface_correction: Option<SurfaceCorrection> = key("surface_correction", "Surface correction: at the boundary");
        spacing: Option<f64> = length("spacing_mm", "Spacing: of points");
        horizon_ratio: f64 = number("horizon_ratio", "Horizon ratio: horizon over spacing", "a horizon ratio", 1.5, 12.0), or "3.015" HORIZON_RATIO;
        lattice_angle_deg: f64 = number("lattice_angle_deg", "Lattice angle, °: of rows of points against x", "an angle in degrees", -90.0, 90.0), or "0" 0.0;
        discretisation: Discretisation = key("discretisation", "Discretisation"), or "lattice" Discretisation::Lattice;
        solver: Option<SceneSolver> = key("solver", "Solver");
        zero_energy_control: Option<ZeroEnergyControl> = key("zero_energy_control", "Zero-energy control").only(OF_POINTS.0, OF_POINTS.1);
        zero_energy_factor: Option<f64> = key("zero_energy_factor", "Factor of the zero-energy control").only(OF_POINTS.0, OF_POINTS.1);
        kinematics: Kinematics = key("kinematics", "Kinematics"), or "small" Kinematics::Small;
    }
}

/// Reads `[model]`; what is left out gets the program's choice.
pub fn from_value(value: &Value, specimen: &Specimen, material: &Material, procedure: &Procedure) -> Result<SceneModel> {
    let (given, input) = (Given::of(value, "model")?, section::<ModelKeys>(value, "model")?);
    let spacing = input.spacing.unwrap_or_else(|| default_spacing(specimen).0);
    check_spacing(spacing, specimen)?;
    let law = law(&given, &input, material)?;
    let solver = solver(input.solver, law, *procedure)?;
    Ok(SceneModel {
        finite: finite(&input, law, solver)?,
        law,
        spacing,
        horizon_ratio: input.horizon_ratio,
        lattice_angle: input.lattice_angle_deg.to_radians(),
        arrangement: input.discretisation,
        solver,
    })
}

fn law(given: &Given<'_>, input: &ModelKeys, material: &Material) -> Result<SceneLaw> {
    match input.bond_law.as_deref() {
        Some(name) if name.parse::<PointLaw>().is_ok() => correspondence(given, input),
        name => bonds(name, (given, input), material),
    }
}

/// Springs in the bonds; a kernel that is left out is that of the law's literature.
fn bonds(name: Option<&str>, (all, given): (&Given<'_>, &ModelKeys), material: &Material) -> Result<SceneLaw> {
    const KEY: &str = "model.bond_law";
    let names = || {
        let springs = BondLawKind::ALL.iter().filter(|kind| **kind != BondLawKind::StateBased).map(|kind| kind.name());
        springs.chain(PointLaw::ALL.iter().map(|law| law.name())).collect::<Vec<_>>().join(", ")
    };
    let kind = match name {
        None => BondLawKind::TwoParameter,
        Some(name) => {
            let quoted = format!("\"{name}\"");
            match name.parse::<BondLawKind>() {
                Ok(BondLawKind::StateBased) => {
                    let problem = "is not supported in fracture scenes (no damage)";
                    return Err(input(KEY, quoted, problem, format!("use one of {}", names())));
                }
                Ok(kind) => kind,
                Err(_) => return Err(input(KEY, quoted, "unknown kind", format!("use one of {}", names()))),
            }
        }
    };
    let problem = format!("applies only to bond_law = \"correspondence\"; {kind} has no zero-energy modes");
    all.refuse_any(&["zero_energy_control", "zero_energy_factor"], &problem, "remove it")?;
    let kernel = match kind {
        BondLawKind::BondBased | BondLawKind::OneBondTwoParameter => Kernel::Constant,
        BondLawKind::TwoParameter | BondLawKind::StateBased => Kernel::Conical,
    };
    let law = BondLaw {
        kind,
        kernel: given.kernel.unwrap_or(kernel),
        rotation: given.rotation.unwrap_or(Rotation::Free),
        surface_correction: given.surface_correction.unwrap_or(SurfaceCorrection::VolumeAndSurface),
    };
    stencil::check(&law, material).map_err(|error| beyond_springs(error, &law, material))?;
    Ok(SceneLaw::Bonds(law))
}

/// The remedy of a Poisson's ratio beyond springs that a scene has.
fn beyond_springs(error: Error, law: &BondLaw, material: &Material) -> Error {
    match error {
        Error::Input(mut trouble) if material.poisson_ratio > stencil::poisson_limit(material.plane) => {
            let also = if law.kind == BondLawKind::BondBased { "" } else { ", or another Poisson's ratio" };
            trouble.remedy = format!("use model.bond_law = \"correspondence\", which supports any{also}");
            Error::Input(trouble)
        }
        other => other,
    }
}

fn correspondence(all: &Given<'_>, given: &ModelKeys) -> Result<SceneLaw> {
    let problem = "applies only to bond laws, not to bond_law = \"correspondence\"";
    all.refuse_any(&["kernel", "rotation", "surface_correction", "kinematics"], problem, "remove it")?;
    const FACTOR: &str = "model.zero_energy_factor";
    let control = given.zero_energy_control.unwrap_or(ZeroEnergyControl::Silling);
    let factor = match (control, given.zero_energy_factor) {
        (ZeroEnergyControl::None, Some(factor)) => {
            let problem = "conflicts with zero_energy_control = \"none\"";
            return Err(input(FACTOR, factor, problem, "remove it, or use \"silling\" or \"spring\""));
        }
        (ZeroEnergyControl::None, None) => 0.0,
        (ZeroEnergyControl::Silling, factor) => {
            plain("a factor", 0.0, 1e3).read(FACTOR, check_sign(factor.unwrap_or(SILLING_FACTOR))?)?
        }
        (ZeroEnergyControl::Spring, Some(factor)) => {
            plain("a spring constant c_I in N/m⁷", 0.0, 1e40).read(FACTOR, check_sign(factor)?)?
        }
        (ZeroEnergyControl::Spring, None) => {
            let remedy = "give the spring constant c_I in N/m⁷; it raises Young's modulus by π c_I h δ⁴/8";
            return Err(input_missing(FACTOR, "is missing (required by \"spring\")", remedy));
        }
    };
    Ok(SceneLaw::Correspondence { control, factor })
}

fn check_sign(factor: f64) -> Result<f64> {
    if factor >= 0.0 || factor.is_nan() {
        return Ok(factor);
    }
    let problem = "is negative: it would amplify zero-energy modes";
    Err(input("model.zero_energy_factor", factor, problem, "give zero or more"))
}

/// The solver of procedure and law, or the one asked for where it suits them.
fn solver(asked: Option<SceneSolver>, law: SceneLaw, procedure: Procedure) -> Result<SceneSolver> {
    const KEY: &str = "model.solver";
    let timed = matches!(procedure, Procedure::Dynamic { .. });
    let by_points = matches!(law, SceneLaw::Correspondence { .. });
    let marches = matches!(procedure, Procedure::QuasiStatic { iterations: Some(_), .. });
    let usual = match (timed, by_points || marches) {
        (true, _) => SceneSolver::VelocityVerlet,
        (false, true) => SceneSolver::AdaptiveDynamicRelaxation,
        (false, false) => SceneSolver::Secant,
    };
    let Some(asked) = asked else { return Ok(usual) };
    let refuse = |problem: &str, remedy: &str| Err(input(KEY, format!("\"{asked}\""), problem, remedy));
    match asked {
        SceneSolver::VelocityVerlet if !timed => refuse("requires loading.duration_s", "give duration_s, or remove the solver"),
        SceneSolver::Secant | SceneSolver::AdaptiveDynamicRelaxation if timed => refuse(
            "finds equilibrium and conflicts with loading.duration_s (motion)",
            "use \"velocity_verlet\", or give loading.steps instead of duration_s",
        ),
        SceneSolver::Secant if marches => refuse(
            "finds equilibrium in every step and conflicts with loading.iterations_per_step",
            "use \"adaptive_dynamic_relaxation\", or remove iterations_per_step",
        ),
        SceneSolver::Secant if by_points => {
            refuse("requires a bond law with springs, not \"correspondence\"", "use \"adaptive_dynamic_relaxation\"")
        }
        _ => Ok(asked),
    }
}

/// Whether bonds are measured by their true stretch.
fn finite(given: &ModelKeys, law: SceneLaw, solver: SceneSolver) -> Result<bool> {
    if given.kinematics != Kinematics::Finite {
        return Ok(false);
    }
    let refuse = |problem: &str, remedy: &str| Err(input("model.kinematics", "\"finite\"", problem, remedy));
    if !matches!(law, SceneLaw::Bonds(BondLaw { kind: BondLawKind::BondBased, .. })) {
        let problem = "supports only bond_law = \"bond_based\"";
        return refuse(problem, "use bond_based, or kinematics = \"small\"");
    }
    if solver == SceneSolver::Secant {
        let problem = "cannot be combined with solver = \"secant\" (linear in displacement)";
        return refuse(problem, "use solver = \"adaptive_dynamic_relaxation\"");
    }
    Ok(true)
}
