//! `[model]` of an input file: how the plate becomes points and bonds.

use super::model_keys::{ModelKeys, refuse_strangers, too_fine};
use super::{Case, Choices, Method, Model, PointSettings, RESIDUAL, choose};
use perilife_base::error::{Result, input, input_missing};
use perilife_base::keys::{Given, section};
use perilife_base::units::round_mm;
use perilife_plate::loading::Loading;
use perilife_plate::material::Material;
use perilife_plate::specimen::beta::KEY;
use perilife_plate::specimen::handbook::handbook;
use perilife_plate::specimen::{Bearing, Load, Specimen};
use perilife_points::bond_law::{BondLaw, BondLawKind, Kernel, Rotation, SurfaceCorrection, stencil};
use perilife_points::solver::{SolverKind, Symmetry};
use perilife_points::spacing::HORIZON_RATIO;
use perilife_points::spacing::{check_spacing, default_spacing};

/// Reads `[model]` with defaults; explicit choices go into `choices`, messages about defaults into `warnings`.
pub(super) fn from_value(
    sections: &choose::Sections<'_>,
    (specimen, material, loading): (&Specimen, &Material, &Loading),
    choices: &mut Choices,
    warnings: &mut Vec<String>,
) -> Result<(Model, Option<String>)> {
    let (given, input) = (Given::of(sections.model, "model")?, section::<ModelKeys>(sections.model, "model")?);
    let (method, why) = match input.method {
        Method::Auto => {
            let (method, why) = choose::choose(sections, specimen, loading, input.tolerance_percent);
            (method, Some(why))
        }
        method => (method, None),
    };
    check_part_through(specimen, method)?;
    check_beta(specimen, method)?;
    refuse_strangers(&given, method, why.as_deref())?;
    Ok((of_method(method, &input, (specimen, material), choices, warnings)?, why))
}

/// The model of a method, by the keys of `[model]`.
fn of_method(
    method: Method,
    input: &ModelKeys,
    (specimen, material): (&Specimen, &Material),
    choices: &mut Choices,
    warnings: &mut Vec<String>,
) -> Result<Model> {
    if method == Method::ElementFreeGalerkin {
        let nodes = input.nodes(specimen)?;
        warnings.extend(input.spacing.and_then(|spacing| too_fine(spacing, specimen, &nodes)));
        return Ok(Model::Nodes(nodes));
    }
    choices.bond_law = input.bond_law;
    choices.kernel = input.kernel;
    choices.rotation = input.rotation;
    choices.surface_correction = input.surface_correction;
    choices.horizon_ratio = input.horizon_ratio;
    let (usual, warning) = usual_points(specimen, material);
    let (spacing, angle) = (input.spacing, input.lattice_angle_deg);
    let points = PointSettings {
        bond_law: BondLaw {
            kind: choices.bond_law.unwrap_or(usual.bond_law.kind),
            kernel: choices.kernel.unwrap_or(usual.bond_law.kernel),
            rotation: choices.rotation.unwrap_or(usual.bond_law.rotation),
            surface_correction: choices.surface_correction.unwrap_or(usual.bond_law.surface_correction),
        },
        spacing: spacing.unwrap_or(usual.spacing),
        horizon_ratio: choices.horizon_ratio.unwrap_or(usual.horizon_ratio),
        lattice_angle: angle.map_or(usual.lattice_angle, f64::to_radians),
        solver: input.solver.unwrap_or(usual.solver),
        symmetry: input.symmetry.unwrap_or(usual.symmetry),
        residual: usual.residual,
    };
    if method == Method::Handbook {
        check_formula(specimen)?;
        return Ok(Model::Handbook(points));
    }
    warnings.extend(warning.filter(|_| spacing.is_none()));
    check_spacing(points.spacing, specimen)?;
    warnings.extend(tiny_flaw(specimen));
    Ok(Model::Points(points))
}

/// Points and bonds where a case says nothing of them, with what is to be said of their spacing.
pub(super) fn usual_points(specimen: &Specimen, material: &Material) -> (PointSettings, Option<String>) {
    let (spacing, warning) = default_spacing(specimen);
    let bond_law = BondLaw {
        kind: BondLawKind::for_material(material),
        kernel: Kernel::Conical,
        rotation: Rotation::Free,
        surface_correction: SurfaceCorrection::VolumeAndSurface,
    };
    let points = PointSettings {
        bond_law,
        spacing,
        horizon_ratio: HORIZON_RATIO,
        lattice_angle: 0.0,
        solver: SolverKind::Window,
        symmetry: Symmetry::Auto,
        residual: RESIDUAL,
    };
    (points, warning)
}

/// Spacing of a second opinion over the usual one.
const COARSE: f64 = 1.5;

/// Points for K of the tips of a case on nodes.
pub(super) fn points_for_factors(case: &Case) -> PointSettings {
    let (mut points, _) = usual_points(&case.specimen, &case.material);
    points.bond_law.surface_correction = SurfaceCorrection::Balanced;
    points
}

/// The same for a coarse look.
pub fn coarse_points(case: &Case) -> PointSettings {
    let points = points_for_factors(case);
    PointSettings { spacing: COARSE * points.spacing, ..points }
}

/// What is said of a flaw so small that points are as fine as that everywhere for its sake.
fn tiny_flaw(specimen: &Specimen) -> Option<String> {
    let (flaw, width) = (specimen.smallest_flaw(), specimen.gross_width);
    (flaw < TINY * width).then(|| {
        format!(
            "spacing: a flaw of {} mm in a plate of {} mm: model.method = \"element_free_galerkin\" refines only around it and is faster",
            round_mm(flaw),
            round_mm(width)
        )
    })
}

/// A crack that does not go through is known to hand calculation alone.
fn check_part_through(specimen: &Specimen, method: Method) -> Result<()> {
    let Some(flaw) = specimen.part_through.as_ref().filter(|_| method != Method::Handbook) else { return Ok(()) };
    let problem = format!("does not support the part-through crack of a {}", flaw.kind());
    let remedy =
        format!("use model.method = \"{}\", or remove it: after breakthrough the crack grows on nodes", Method::Handbook);
    Err(input("model.method", format!("\"{method}\""), problem, remedy))
}

/// A table of β drives hand calculation alone.
fn check_beta(specimen: &Specimen, method: Method) -> Result<()> {
    if specimen.beta.is_none() || method == Method::Handbook {
        return Ok(());
    }
    let problem = format!("gives K(a), and model.method = \"{method}\" finds K itself");
    Err(input_missing(KEY, problem, format!("use model.method = \"{}\", or leave one of both out", Method::Handbook)))
}

/// Hand calculation needs a formula for K(a).
fn check_formula(specimen: &Specimen) -> Result<()> {
    // A table of β may be of any pins.
    let angle = specimen.loads.iter().find_map(|load| match load {
        Load::Pin { contact: Bearing::Cosine(angle), .. } => Some(angle.to_degrees()),
        _ => None,
    });
    if let Some(angle) = angle.filter(|_| specimen.beta.is_none()) {
        let problem = "is not known to the handbook, whose K is that of its own pins";
        return Err(input("specimen.pin_half_angle_deg", angle, problem, "remove it, or use another model.method"));
    }
    if handbook(specimen).is_some() || !specimen.is_through() {
        return Ok(());
    }
    let problem = format!("has no K(a) for this specimen ({})", specimen.kind);
    let remedy = "remove it (nodes find K), or give specimen.beta_file; formulas: tension strips at least 1.5 widths long (no clamped \
                  ends), compact_tension, single_edge_bend, eccentric_single_edge_tension";
    Err(input("model.method", "\"handbook\"", problem, remedy))
}

/// Flaw over the width of the plate below which nodes are the better model.
const TINY: f64 = 0.01;
/// The bond law can represent the material, and its choices go together.
pub(super) fn check_law(case: &Case) -> Result<()> {
    match &case.model {
        Model::Points(points) => stencil::check(&points.bond_law, &case.material),
        Model::Nodes(_) | Model::Handbook(_) => Ok(()),
    }
}
