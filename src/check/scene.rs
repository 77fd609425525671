//! What `perilife check` has understood of a fracture scene, in words.

use super::preview::{as_input, is_quick};
use super::understood::{self, Line, line, plate_lines, points_words};
use crate::error::Result;
use crate::fracture::Scene;
use crate::fracture::preview::preview;
use crate::fracture::scene::{Action, DamageLaw, Procedure, SceneLoad, SceneSupport};
use crate::report::model_words::{self, mm, short};
use crate::report::specimen_picture::scene_svg;
use crate::units::{MM, MPA};

/// Lines about loads and supports that fit below the drawing.
const LINES_MAX: usize = 8;
/// Bonds up to which points and bonds are built, those of 1e5 points at the usual horizon; below a second.
const BONDS_BUILT: f64 = 1.5e6;

/// One line for each thing understood, and what the user should know; points and bonds are built where that is quick, since only
/// then some troubles show.
pub(super) fn scene_lines(scene: &Scene) -> Result<(Vec<Line>, Vec<String>)> {
    let budget = scene.budget();
    budget.within_machine()?;
    let is_quick = budget.bonds <= BONDS_BUILT && is_quick(&budget, &scene.specimen);
    let built = is_quick.then(|| preview(scene).map_err(as_input)).transpose()?;
    let specimen = &scene.specimen;
    let chosen = model_words::of_scene(scene, None);
    let micro = scene.echo.get("micro_cracks").and_then(|section| section.get("count")).and_then(serde_json::Value::as_u64);
    let cracks = specimen.cracks.len() - micro.unwrap_or(0) as usize;
    let micro_words = micro.map_or_else(String::new, |count| format!(", {count} micro cracks"));
    let asked = scene.model.spacing;
    let (counts, [fine, coarse], horizon) = match &built {
        Some(laid) => (understood::built([laid.points, laid.bonds, laid.cut]), laid.spacings, laid.horizons[0]),
        None => (format!("about {:.0}", budget.points), [asked; 2], asked * scene.model.horizon_ratio),
    };
    // Scenes ask for the spacing of the coarsest level.
    let points = points_words(&counts, [fine, coarse], [asked * fine / coarse, horizon], &chosen);
    let mut lines = plate_lines(specimen, &scene.material, ("flaws", cracks, micro_words));
    lines.extend([
        line("law", model_words::words(&chosen, &model_words::OF_BONDS)),
        line("points", points),
        line("procedure", procedure_words(scene)),
    ]);
    lines.extend(scene.drives.iter().map(|drive| line("load", drive_words(drive))));
    lines.extend(scene.holds.iter().map(|hold| line("support", hold_words(hold))));
    lines.extend(scene.refinement.as_ref().map(|refinement| line("refinement", refinement.words())));
    lines.extend([line("damage", damage_words(scene)), line("computing", budget.words())]);
    Ok((lines, built.map_or_else(Vec::new, |built| built.warnings)))
}

fn procedure_words(scene: &Scene) -> String {
    let solver = scene.model.solver;
    match scene.procedure {
        Procedure::Static => format!("one equilibrium at full load, solver {solver}"),
        Procedure::QuasiStatic { steps, iterations: None } => format!("{steps} load steps, solver {solver}"),
        Procedure::QuasiStatic { steps, iterations: Some(each) } => {
            format!("{steps} load steps of {each} iterations, not to rest, solver {solver}")
        }
        Procedure::Dynamic { duration, time_step } => {
            let step = time_step.map_or_else(|| "its own time step".to_owned(), |step| format!("time step {step:e} s"));
            format!("motion over {duration:e} s, {step}, solver {solver}")
        }
    }
}

/// The drawing of a scene with its loads and supports in words.
pub(super) fn scene_drawing(scene: &Scene) -> String {
    let loads = scene.drives.iter().map(|drive| format!("blue: {}", drive_words(drive)));
    let holds = scene.holds.iter().map(|hold| format!("green: {}", hold_words(hold)));
    let mut lines: Vec<String> = loads.chain(holds).collect();
    let more = lines.len().saturating_sub(LINES_MAX);
    lines.truncate(LINES_MAX);
    lines.extend((more > 0).then(|| format!("and {more} more loads and supports")));
    scene_svg(scene, &procedure_words(scene), &lines)
}

fn drive_words(drive: &SceneLoad) -> String {
    let pair = |[x, y]: [f64; 2], unit: f64| format!("({}, {})", short(x / unit), short(y / unit));
    let components = |components: [Option<f64>; 2]| {
        let one = |value: Option<f64>| value.map_or_else(|| "free".to_owned(), mm);
        format!("({}, {})", one(components[0]), one(components[1]))
    };
    let what = match drive.action {
        Action::Traction(traction) => format!("traction {} MPa", pair(traction, MPA)),
        Action::Displacement(values) => format!("displacement {} mm", components(values)),
        Action::Velocity(values) => format!("velocity {} mm/s", components(values)),
        Action::Platen(motion) => format!("platen moving {} mm", pair(motion, MM)),
    };
    let ramp = if drive.rise.ramp > 0.0 { format!(", rising over {:e} s", drive.rise.ramp) } else { String::new() };
    let from = if drive.rise.from > 0.0 { format!(" from {:e} s on", drive.rise.from) } else { String::new() };
    format!("{what} on {}{ramp}{from}", drive.region)
}

fn hold_words(hold: &SceneSupport) -> String {
    let held = match hold.components {
        [true, true] => "x and y",
        [true, false] => "x",
        _ => "y",
    };
    format!("{held} held on {}", hold.region)
}

fn damage_words(scene: &Scene) -> String {
    let damage = &scene.damage;
    let limit = match (damage.law, damage.stretch, scene.material.fracture_energy) {
        (DamageLaw::CriticalStretch | DamageLaw::CriticalEnergy, Some(stretch), _) => format!(", critical stretch {stretch}"),
        (DamageLaw::CriticalStretch | DamageLaw::CriticalEnergy, None, Some(energy)) => {
            format!(", fracture energy {energy} J/m²")
        }
        (DamageLaw::PrincipalStress, ..) => {
            format!(", tensile strength {} MPa", short(damage.tensile_strength.unwrap_or(f64::NAN) / MPA))
        }
        (DamageLaw::NonlinearTwoParameter, ..) => damage.nonlinear.map_or_else(String::new, |law| {
            let printed = if law.printed { ", as printed" } else { "" };
            format!(", stretches {:.6}, {:.6}, {:.6}{printed}", law.elastic, law.peak, law.last)
        }),
        _ => String::new(),
    };
    format!("{}{limit}", damage.law)
}
