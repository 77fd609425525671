//! `perilife fracture`: a scene without cycles to its histories, crack paths, pictures and ParaView files.

use std::path::{Path, PathBuf};

use super::checkpoint;
use super::console::Console;
use crate::error::{Error, Result};
use crate::fracture::scene::Procedure;
use crate::fracture::{Fracture, Scene, SceneEnd};
use crate::input::Document;
use crate::report::fracture as report;
use crate::report::output::{OutputFolder, Replaced, RunKind};
use crate::units::{KN, MM};

/// Arguments of `perilife fracture`.
#[derive(Debug, clap::Args)]
#[command(
    after_long_help = "Loads: traction, displacement, velocity or platens. [damage]: critical stretch, critical energy, softening or principal stress.\n\
                       A growing load is followed along the path of equilibrium through snap-back (model.solver = \"secant\"), by relaxation to rest, or\n\
                       with loading.iterations_per_step as many published examples are, which is not at rest.\n\
                       A run that was killed goes on from its checkpoint to the same histories, bit for bit on the same kind of processor.\n\
                       Scenes of the literature: data/cases/fracture of the source."
)]
pub struct Args {
    /// Scene file
    #[arg(value_name = "CASE.toml")]
    pub case: PathBuf,
    /// Folder for the results; replaced if an earlier run made it
    #[arg(long, value_name = "DIR", help_heading = "Output")]
    pub out: PathBuf,
    /// Override a key of the scene (repeatable), e.g. --set model.spacing_mm=0.5
    #[arg(long = "set", value_name = "SECTION.KEY=VALUE", help_heading = "Input")]
    pub set: Vec<String>,
    /// Keeping the run for later.
    #[command(flatten)]
    pub keeping: checkpoint::Args,
    /// What is printed.
    #[command(flatten)]
    pub console: Console,
}

/// Runs `perilife fracture`.
///
/// # Errors
/// Wrong input; files that cannot be read or written; [`Error::Mechanics`] where the scene ended without convergence or blew up,
/// whose histories are written all the same.
pub fn run(args: &Args) -> Result<()> {
    let document = Document::read(&args.case, &args.set)?;
    let scene = Scene::from_document(&document)?;
    scene.budget().within_machine().map_err(|error| document.locate(error))?;
    // Claimed first: a folder that cannot be written should not cost a run.
    args.keeping.check_outside(&args.out)?;
    let folder = OutputFolder::claim(&args.out, RunKind::Fracture, &scene.provenance, report::room(&scene))?;
    for warning in scene.warnings.iter().map(String::as_str).chain(folder.warning()) {
        args.console.warn(warning);
    }
    // Some wrong input shows only once points and bonds stand.
    let run = args.keeping.run_scene(&scene, &args.console);
    let (fracture, checkpoint) = run.map_err(|error| document.locate(error))?;
    keep(&scene, &fracture, folder, &args.console)?;
    checkpoint.map_or(Ok(()), Replaced::remove)
}

/// Writes the files of a run, puts the folder in place and prints what was found.
///
/// # Errors
/// [`Error::File`] if a file cannot be written; [`Error::Mechanics`], with everything written, if the scene ended without
/// convergence or blew up.
pub fn keep(scene: &Scene, fracture: &Fracture, mut folder: OutputFolder, console: &Console) -> Result<()> {
    for warning in &fracture.warnings {
        console.warn(warning);
    }
    let result = report::result(scene, fracture);
    folder.fill(|path| report::write(path, scene, fracture, &result))?;
    let out = folder.name().to_owned();
    drop(folder.finish()?);
    for line in summary(scene, fracture, &out) {
        console.say(&line);
    }
    console.object(&result)?;
    match fracture.end {
        SceneEnd::Done | SceneEnd::Separated | SceneEnd::LoadFallen => Ok(()),
        SceneEnd::NoConvergence | SceneEnd::Unstable => {
            let (end, out) = (fracture.end, out.display());
            Err(Error::Mechanics(format!("{}: {end}: {}, in {out}", scene.name, end.meaning())))
        }
    }
}

fn summary(scene: &Scene, fracture: &Fracture, out: &Path) -> Vec<String> {
    let last = fracture.history.last().copied().unwrap_or_default();
    let figures = &fracture.figures;
    let when = |step: Option<usize>| match step {
        None => "never".to_owned(),
        Some(step) if figures.time_step > 0.0 => format!("step {step}, {:.3} µs", step as f64 * figures.time_step * 1e6),
        Some(step) => format!("step {step}"),
    };
    let way = match scene.procedure {
        Procedure::Static => "one static solve".to_owned(),
        Procedure::QuasiStatic { iterations: Some(_), .. } => format!("{} load steps", last.step),
        Procedure::QuasiStatic { steps, .. } => format!("{steps} load steps, {} states of equilibrium", last.step),
        Procedure::Dynamic { .. } => format!("{} time steps of {:.4} µs", last.step, figures.time_step * 1e6),
    };
    let mut lines = vec![
        format!("{}: peak load {:.4} kN", scene.name, fracture.peak_load() / KN),
        format!("  stopped        {}: {}", fracture.end, fracture.end.meaning()),
        format!("  displacement   {:.6} mm at the end, load {:.4} kN", last.displacement / MM, last.load / KN),
        format!("  first break    {}", when(fracture.onset_step)),
        format!("  separated      {}", when(fracture.separated_step)),
        format!("  broken         {} of {} bonds", last.broken_bonds, figures.bonds),
    ];
    lines.extend(
        figures
            .touching
            .filter(|flanks| flanks.pressed > 0)
            .map(|flanks| format!("  flanks         pressed together over {:.0} % of the cracks", 100.0 * flanks.share())),
    );
    lines.extend([
        format!("  computed       {} points, {way}, {:.1} s", figures.points, figures.wall_s),
        format!("  results        {}", out.display()),
    ]);
    lines
}
