//! `[model]` of an input file: how the plate becomes points and bonds.

use super::model_keys::{ModelKeys, read, refuse_strangers, tolerance, too_fine};
use super::{Case, Choices, HORIZON_RATIO, Method, Model, PointSettings, RESIDUAL, choose};
use crate::bond_law::{BondLaw, BondLawKind, Kernel, Rotation, SurfaceCorrection, stencil};
use crate::error::{Result, input, input_missing};
use crate::input::slice;
use crate::loading::Loading;
use crate::material::Material;
use crate::solver::{SolverKind, Symmetry};
use crate::specimen::beta::KEY;
use crate::specimen::handbook::handbook;
use crate::specimen::{Bearing, Load, Specimen};
use crate::units::MM;

/// More points than this do not fit into the memory of an ordinary machine.
const POINTS_MAX: f64 = 4e6;
/// Fewer spacings than this across the plate say nothing about a crack in it.
const COLUMNS_MIN: f64 = 8.0;

/// Reads `[model]`; what is left out gets the program's choice. Explicit choices go into `choices`, what is to be said of the program's
/// into `warnings`.
pub(super) fn from_value(
    sections: &choose::Sections<'_>,
    (specimen, material, loading): (&Specimen, &Material, &Loading),
    choices: &mut Choices,
    warnings: &mut Vec<String>,
) -> Result<(Model, Option<String>)> {
    let input: ModelKeys = slice(sections.model, "model")?;
    let (method, why) = match input.method.unwrap_or(Method::Auto) {
        Method::Auto => {
            let (method, why) = choose::choose(sections, specimen, loading, tolerance(&input)?);
            (method, Some(why))
        }
        method => (method, None),
    };
    check_part_through(specimen, method)?;
    check_beta(specimen, method)?;
    refuse_strangers(sections.model, method, why.as_deref())?;
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
        warnings.extend(input.spacing_mm.and_then(|spacing| too_fine(spacing, specimen, &nodes)));
        return Ok(Model::Nodes(nodes));
    }
    choices.bond_law = input.bond_law;
    choices.kernel = input.kernel;
    choices.rotation = input.rotation;
    choices.surface_correction = input.surface_correction;
    choices.horizon_ratio = read("horizon_ratio", input.horizon_ratio)?;
    let (usual, warning) = usual_points(specimen, material);
    let spacing = read("spacing_mm", input.spacing_mm)?;
    let angle = read("lattice_angle_deg", input.lattice_angle_deg)?;
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
            "a flaw of {} mm in a plate of {} mm: model.method = \"element_free_galerkin\" has nodes that fine where it lies only, and takes less time",
            round_mm(flaw),
            round_mm(width)
        )
    })
}

/// A crack that does not go through is known to hand calculation alone.
fn check_part_through(specimen: &Specimen, method: Method) -> Result<()> {
    let Some(flaw) = specimen.part_through.as_ref().filter(|_| method != Method::Handbook) else { return Ok(()) };
    let problem = format!("knows plates in their plane, and the crack of a {} does not go through", flaw.kind());
    let remedy =
        format!("use model.method = \"{}\", or leave it out: once the crack is through it grows on nodes", Method::Handbook);
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
        return Err(input("specimen.pin_half_angle_deg", angle, problem, "leave it out, or use another model.method"));
    }
    if handbook(specimen).is_some() || !specimen.is_through() {
        return Ok(());
    }
    let problem = format!("has no K(a) for this specimen ({})", specimen.kind);
    let remedy = "use model.method = \"peridynamics\"; or middle_tension, single_edge_tension (ends free to rotate), \
                  double_edge_tension at least 1.5 widths long, or compact_tension; or give specimen.beta_file";
    Err(input("model.method", "\"handbook\"", problem, remedy))
}

/// Flaw over the width of the plate below which nodes are the better model.
const TINY: f64 = 0.01;
/// Share of the longest flaw below which a flaw does not decide the life: its rate is an eighth or less of that of the longest at m = 3.
const SMALL_FLAW: f64 = 0.25;
/// Points on a flaw that does not decide.
const POINTS_ON_FLAW: f64 = 6.0;
/// Flaws up to which a plate may have as many points as the shortest that decides asks for.
const FEW_FLAWS: usize = 2;
/// Points on the shortest of more flaws. K of ten cracks of 1 to 5.5 mm at holes errs by 2 % at the shortest and by 0.4 % at the others.
const POINTS_ON_SHORT: f64 = 3.0;
/// Points on the least gap beside a tip. Lives of two plates with gaps of 3 mm err by 2.1 and 3.8 % with six, by 1.3 and 2.3 % with nine.
const POINTS_ON_GAP: f64 = 9.0;
/// Points across a plate that is shorter than wide, and so bent by loads along its length: K of a beam errs by 4 % with 18, by 1 % with 40.
const POINTS_ACROSS: f64 = 40.0;
/// Points on the way over which a bent crack is straight behind its tip: its ring fits into that.
const POINTS_ON_BEND: f64 = 5.0;
/// Points to which a gap beside a tip refines a plate at the most.
const POINTS_FOR_GAP: f64 = 3e5;

/// Spacing where an input file says nothing: a ninth of the smallest flaw that can decide the life and of the least gap between a
/// tip and a rim, another tip or another crack, a sixth of every other flaw, a fifth of the way over which a bent crack is straight behind its tip, a hundredth of the width and a fortieth of the length at the most. What is said where a gap asks
/// for more than 3e5 points or a small flaw for too many comes beside.
pub fn default_spacing(specimen: &Specimen) -> (f64, Option<String>) {
    let sizes = specimen.flaw_sizes();
    let longest = sizes.iter().copied().fold(0.0, f64::max);
    let deciding = sizes.iter().copied().filter(|size| *size >= SMALL_FLAW * longest).fold(f64::INFINITY, f64::min);
    let usual = (deciding / 9.0).min(specimen.width / 100.0).min(specimen.length() / POINTS_ACROSS);
    let smallest = sizes.iter().copied().fold(f64::INFINITY, f64::min);
    let gap = specimen.least_gap();
    let bend = specimen.least_straight_way();
    let wanted = usual.min(smallest / POINTS_ON_FLAW).min(gap / POINTS_ON_GAP).min(bend / POINTS_ON_BEND);
    // Among many flaws a short one grows beside others that are read well.
    let most = if sizes.len() > FEW_FLAWS { smallest / POINTS_ON_SHORT } else { usual };
    let finest = (specimen.area() / POINTS_FOR_GAP).sqrt().min(most);
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
/// Errors: `Error::Input` on `model.spacing_mm`.
pub fn check_spacing(spacing: f64, specimen: &Specimen) -> Result<()> {
    const KEY: &str = "model.spacing_mm";
    const NODES: &str = "use model.method = \"element_free_galerkin\", whose nodes are that fine at the crack only";
    let (given, flaw) = (round_mm(spacing), specimen.smallest_flaw());
    let finest = (specimen.area() / POINTS_MAX).sqrt();
    if spacing > flaw {
        let problem = format!("is larger than the crack ({} mm): no bond would be cut as it should", round_mm(flaw));
        let ninth = format!("give a ninth of the crack or less, {} mm", round_mm(flaw / 9.0));
        return Err(input(KEY, given, problem, if flaw / 9.0 < finest { NODES.to_owned() } else { ninth }));
    }
    check_columns(spacing, specimen)?;
    let tips = specimen.tips.iter().filter(|tip| !tip.from_slot && specimen.kind.is_plate());
    let gap = tips.map(|tip| specimen.rim_distance(tip.position)).fold(f64::INFINITY, f64::min);
    if spacing > gap * (1.0 + 1e-9) {
        let problem = format!("is larger than the {} mm between a tip and a rim", round_mm(gap));
        let remedy = format!(
            "give {} mm or less, end the crack at the rim, or use model.method = \"element_free_galerkin\"",
            round_mm(gap / POINTS_ON_GAP)
        );
        return Err(input(KEY, given, problem, remedy));
    }
    let points = specimen.area() / (spacing * spacing);
    if points > POINTS_MAX {
        let problem = format!("would make about {points:.1e} points, more than {POINTS_MAX:.0e}");
        let remedy = if finest > flaw { NODES.to_owned() } else { format!("give {} mm or more, or {NODES}", round_mm(finest)) };
        return Err(input(KEY, given, problem, remedy));
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

/// The bond law can represent the material, and its choices go together.
pub(super) fn check_law(case: &Case) -> Result<()> {
    match &case.model {
        Model::Points(points) => stencil::check(&points.bond_law, &case.material),
        Model::Nodes(_) | Model::Handbook(_) => Ok(()),
    }
}
