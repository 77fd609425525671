//! `[model]` of an input file: how the plate becomes points and bonds.

use serde::Deserialize;
use toml::Value;

use super::choices::{Choices, Method};
use super::nodes::{NodeKeys, refuse_keys_of_points};
use super::{Case, HORIZON_RATIO, Model, RESIDUAL};
use crate::bond_law::{BondLaw, BondLawKind, Kernel, Rotation, SurfaceCorrection, stencil};
use crate::element_free::basis::{BasisKind, Enrichment};
use crate::error::{Result, input};
use crate::fatigue::Ageing;
use crate::input::{LENGTH, number, slice};
use crate::levels::dual_horizon::regions::Area;
use crate::levels::{Discretisation, Refinement, read};
use crate::material::Material;
use crate::solver::{SolverKind, Symmetry};
use crate::specimen::Specimen;
use crate::specimen::handbook::handbook;
use crate::units::MM;

/// More points than this do not fit into the memory of an ordinary machine.
const POINTS_MAX: f64 = 4e6;
/// Fewer spacings than this across the plate say nothing about a crack in it.
const COLUMNS_MIN: f64 = 8.0;

/// Keys of `[model]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Input {
    method: Option<Method>,
    discretisation: Option<Discretisation>,
    symmetry: Option<Symmetry>,
    bond_law: Option<BondLawKind>,
    kernel: Option<Kernel>,
    rotation: Option<Rotation>,
    surface_correction: Option<SurfaceCorrection>,
    spacing_mm: Option<f64>,
    horizon_ratio: Option<f64>,
    lattice_angle_deg: Option<f64>,
    solver: Option<SolverKind>,
    nodes: Option<f64>,
    tolerance_percent: Option<f64>,
    basis: Option<BasisKind>,
    enrichment: Option<Enrichment>,
    influence_radius: Option<f64>,
}

/// Reads `[model]` and, if there is one, `[refinement]`; what is left out gets the program's choice. Explicit choices go into
/// `choices`, what is to be said of the program's into `warnings`.
pub(super) fn from_values(
    value: &Value,
    refinement: Option<&Value>,
    specimen: &Specimen,
    material: &Material,
    choices: &mut Choices,
    warnings: &mut Vec<String>,
) -> Result<Model> {
    let input: Input = slice(value, "model")?;
    let method = input.method.unwrap_or(Method::Peridynamics);
    let of_nodes = NodeKeys {
        // Of points, where it is another method's.
        spacing_mm: input.spacing_mm.filter(|_| method == Method::ElementFreeGalerkin),
        nodes: input.nodes,
        tolerance_percent: input.tolerance_percent,
        basis: input.basis,
        enrichment: input.enrichment,
        influence_radius: input.influence_radius,
    };
    if method == Method::ElementFreeGalerkin {
        refuse_keys_of_points(value, refinement)?;
    } else {
        of_nodes.refuse(method)?;
    }
    let arrangement = input.discretisation.unwrap_or(Discretisation::Lattice);
    let refinement = refinement.map(|value| read::from_value(value, specimen)).transpose()?;
    check_arrangement(arrangement, refinement.is_some(), input.solver)?;
    choices.bond_law = input.bond_law;
    choices.kernel = input.kernel;
    choices.rotation = input.rotation;
    choices.surface_correction = input.surface_correction;
    choices.horizon_ratio = number("a horizon ratio", 1.5, 12.0).read_optional("model.horizon_ratio", input.horizon_ratio)?;
    let levels = refinement.as_ref().map_or(0, Refinement::deepest);
    let element_free = of_nodes.read(specimen)?;
    if method == Method::ElementFreeGalerkin {
        warnings.extend(of_nodes.too_fine(specimen, &element_free));
    }
    let of_points = input.spacing_mm.filter(|_| method != Method::ElementFreeGalerkin);
    let spacing = match LENGTH.read_optional("model.spacing_mm", of_points)? {
        Some(coarsest) => coarsest / 2.0_f64.powi(levels as i32),
        None => {
            let (spacing, warning) = default_spacing(specimen);
            warnings.extend(warning.filter(|_| method == Method::Peridynamics));
            spacing
        }
    };
    let angle =
        number("an angle in degrees", -90.0, 90.0).read("model.lattice_angle_deg", input.lattice_angle_deg.unwrap_or(0.0))?;
    let model = Model {
        method,
        bond_law: BondLaw {
            kind: choices.bond_law.unwrap_or_else(|| BondLawKind::for_material(material)),
            kernel: choices.kernel.unwrap_or(Kernel::Conical),
            rotation: choices.rotation.unwrap_or(Rotation::Free),
            surface_correction: choices.surface_correction.unwrap_or(SurfaceCorrection::VolumeAndSurface),
        },
        spacing,
        horizon_ratio: choices.horizon_ratio.unwrap_or(HORIZON_RATIO),
        lattice_angle: angle.to_radians(),
        solver: input.solver.unwrap_or(SolverKind::Window),
        symmetry: input.symmetry.unwrap_or(Symmetry::Auto),
        element_free,
        residual: RESIDUAL,
        arrangement,
        refinement,
    };
    match method {
        Method::Peridynamics => {
            check_spacing(spacing, levels, specimen)?;
            check_columns(model.coarsest_spacing(), specimen)?;
        }
        Method::ElementFreeGalerkin => {}
        Method::Handbook => check_formula(specimen)?,
    }
    Ok(model)
}

/// Several levels need regions, regions need several levels, and both a solver that knows them.
fn check_arrangement(arrangement: Discretisation, refined: bool, solver: Option<SolverKind>) -> Result<()> {
    const KEY: &str = "model.discretisation";
    let quoted = format!("\"{arrangement}\"");
    match arrangement {
        Discretisation::Lattice if refined => {
            let problem = "has one spacing everywhere, and there is a section [refinement]";
            return Err(input(KEY, quoted, problem, "use \"dual_horizon\", or remove the section"));
        }
        Discretisation::DualHorizon if !refined => {
            let problem = "is points of several levels, and no section [refinement] says where they are fine";
            return Err(input(KEY, quoted, problem, "give [refinement] with regions, or use \"lattice\""));
        }
        Discretisation::VariableHorizon => {
            let problem = "belongs to fracture scenes, not to a fatigue case: without the dual horizon forces do not balance";
            return Err(input(KEY, quoted, problem, "use \"dual_horizon\", or run `perilife fracture` on a scene"));
        }
        Discretisation::Lattice | Discretisation::DualHorizon => {}
    }
    match solver {
        Some(solver @ (SolverKind::Multigrid | SolverKind::AdaptiveDynamicRelaxation)) if refined => {
            let problem = "works on lattices of one spacing, and discretisation = \"dual_horizon\" has several levels";
            Err(input("model.solver", format!("\"{solver}\""), problem, "use \"window\", or \"direct\""))
        }
        _ => Ok(()),
    }
}

/// Hand calculation needs a formula for K(a).
fn check_formula(specimen: &Specimen) -> Result<()> {
    if handbook(specimen).is_some() {
        return Ok(());
    }
    let problem = format!("has no K(a) for this specimen ({})", specimen.kind);
    let remedy = "use model.method = \"peridynamics\"; or middle_tension, single_edge_tension (ends free to rotate), \
                  double_edge_tension at least 1.5 widths long, or compact_tension";
    Err(input("model.method", "\"handbook\"", problem, remedy))
}

/// Share of the longest flaw below which a flaw does not decide the life: its rate is an eighth or less of that of the longest at m = 3.
const SMALL_FLAW: f64 = 0.25;
/// Points on a flaw that does not decide.
const POINTS_ON_FLAW: f64 = 6.0;
/// Points on the least gap beside a tip. Lives of two plates with gaps of 3 mm err by 2.1 and 3.8 % with six, by 1.3 and 2.3 % with nine.
const POINTS_ON_GAP: f64 = 9.0;
/// Points to which a gap beside a tip refines a plate at the most.
const POINTS_FOR_GAP: f64 = 3e5;

/// Spacing where an input file says nothing: a ninth of the smallest flaw that can decide the life and of the least gap between a
/// tip and a rim, another tip or another crack, a sixth of every other flaw, a hundredth of the width at the most. What is said where a gap asks
/// for more than 3e5 points or a small flaw for too many comes beside.
pub fn default_spacing(specimen: &Specimen) -> (f64, Option<String>) {
    let sizes = specimen.flaw_sizes();
    let longest = sizes.iter().copied().fold(0.0, f64::max);
    let deciding = sizes.iter().copied().filter(|size| *size >= SMALL_FLAW * longest).fold(f64::INFINITY, f64::min);
    let usual = (deciding / 9.0).min(specimen.width / 100.0);
    let smallest = sizes.iter().copied().fold(f64::INFINITY, f64::min);
    let gap = specimen.least_gap();
    let wanted = usual.min(smallest / POINTS_ON_FLAW).min(gap / POINTS_ON_GAP);
    let finest = (specimen.area() / POINTS_FOR_GAP).sqrt().min(usual);
    if wanted >= finest {
        return (wanted, None);
    }
    // A flaw has at least a point of its own.
    let spacing = finest.min(smallest);
    let warning = format!(
        "model.spacing_mm: {} mm were taken, since {} mm would make more than {POINTS_FOR_GAP:.0e} points; a gap of {} mm at a tip \
         has fewer than {POINTS_ON_GAP} spacings or a flaw of {} mm fewer than {POINTS_ON_FLAW}: give model.spacing_mm if its growth decides the life",
        round_mm(spacing),
        round_mm(wanted),
        round_mm(gap),
        round_mm(smallest)
    );
    (spacing, Some(warning))
}

/// The spacing resolves crack and plate, and the number of points can be held.
///
/// # Errors
/// `Error::Input` on `model.spacing_mm`.
pub fn check_spacing(spacing: f64, levels: usize, specimen: &Specimen) -> Result<()> {
    const KEY: &str = "model.spacing_mm";
    // The key is that of the coarsest level.
    let coarsening = 2.0_f64.powi(levels as i32);
    let coarsest = coarsening * spacing;
    let (given, flaw) = (round_mm(coarsest), specimen.smallest_flaw());
    if spacing > flaw {
        let refined = if levels > 0 { format!(" on {levels} finer levels") } else { String::new() };
        let problem = format!("is larger{refined} than the crack ({} mm): no bond would be cut as it should", round_mm(flaw));
        let remedy = format!("give a ninth of the crack or less on the finest level, {} mm", round_mm(coarsening * flaw / 9.0));
        return Err(input(KEY, given, problem, remedy));
    }
    check_columns(spacing, specimen)?;
    // Of the coarsest level at the least.
    let points = specimen.area() / (coarsest * coarsest);
    if points > POINTS_MAX {
        let smallest = round_mm((specimen.area() / POINTS_MAX).sqrt());
        let problem = format!("would make about {points:.1e} points, more than {POINTS_MAX:.0e}");
        return Err(input(KEY, given, problem, format!("give {smallest} mm or more")));
    }
    Ok(())
}

/// The plate has some points of this spacing across, whatever lies in it.
fn check_columns(spacing: f64, specimen: &Specimen) -> Result<()> {
    let thinnest = specimen.gross_width.min(specimen.length());
    if thinnest >= COLUMNS_MIN * spacing {
        return Ok(());
    }
    let problem = format!("leaves fewer than {COLUMNS_MIN} points across the plate ({} mm)", round_mm(thinnest));
    Err(input("model.spacing_mm", round_mm(spacing), problem, format!("give {} mm or less", round_mm(thinnest / 100.0))))
}

/// Metres as mm, rounded to six digits for messages.
pub fn round_mm(metres: f64) -> f64 {
    (metres / MM * 1e6).round() / 1e6
}

/// The bond law can represent the material, and its choices go together; levels of points go with law, horizon and ageing.
pub(super) fn check_law(case: &Case) -> Result<()> {
    let (model, law) = (&case.model, &case.model.bond_law);
    if model.method != Method::Peridynamics {
        return Ok(());
    }
    if model.arrangement != Discretisation::Lattice {
        if law.kind == BondLawKind::StateBased {
            let problem = format!("has a dilatation of every point, and \"{}\" joins points by springs only", model.arrangement);
            let remedy = "use bond_based or two_parameter, or discretisation = \"lattice\"";
            return Err(input("model.bond_law", format!("\"{}\"", law.kind), problem, remedy));
        }
        if case.fatigue.ageing == Ageing::Everywhere {
            let problem = format!("ages all bonds, and with \"{}\" those of the finest level alone can break", model.arrangement);
            let remedy = "use \"crack_tip\", or model.discretisation = \"lattice\"";
            return Err(input("fatigue.ageing", format!("\"{}\"", case.fatigue.ageing), problem, remedy));
        }
    }
    Area::all(&case.specimen, model.refinement.as_ref(), model.horizon_ratio)?;
    stencil::check(law, &case.material)
}
