//! `perilife fracture`: a scene without cycles to its histories, crack paths and pictures.

use std::path::{Path, PathBuf};

use super::checkpoint;
use super::console::Console;
use perilife_base::error::{Error, Result};
use perilife_base::input::Document;
use perilife_results::output::OutputFile;
use perilife_runner::{Kind, Task};

#[derive(Debug, clap::Args)]
#[command(
    after_long_help = "Loads: traction, displacement, velocity or platens. [damage]: critical stretch, critical energy, softening or principal stress.\n\
                       Growing loads follow the equilibrium path through snap-back (model.solver = \"secant\"), relax to rest, or\n\
                       run loading.iterations_per_step as published examples do (not at rest).\n\
                       A resumed run gives the same histories (bit-identical on the same CPU type).\n\
                       Scenes of the literature: data/cases/fracture of the source."
)]
pub struct Args {
    /// Scene file
    #[arg(value_name = "CASE.toml")]
    pub case: PathBuf,
    /// Folder for the results [default: name of the scene]
    #[arg(long, value_name = "DIR", help_heading = "Output")]
    pub out: Option<PathBuf>,
    /// Set a key (repeatable), e.g. --set model.spacing_mm=0.5
    #[arg(long = "set", value_name = "SECTION.KEY=VALUE", help_heading = "Input")]
    pub set: Vec<String>,
    /// Write fields for ParaView (key output.paraview)
    #[arg(long, help_heading = "Output")]
    pub paraview: bool,
    /// Keeping the run for later.
    #[command(flatten)]
    pub keeping: checkpoint::Args,
    #[command(flatten)]
    pub console: Console,
}

/// Runs `perilife fracture`.
/// Errors: wrong input; files that cannot be read or written; [`Error::Mechanics`] where the scene ended without convergence or
/// blew up, whose histories are written all the same.
pub fn run(args: &Args) -> Result<()> {
    let document = Document::read(&args.case, &super::with_output(&args.set, [("paraview", args.paraview)]))?;
    let task = Task::read(Kind::Scene, &document, &[])?;
    let out = args.out.as_deref().unwrap_or(Path::new(&document.name));
    let (summary, checkpoint) = args.keeping.run(&task, &document, out, &args.console)?;
    args.console.object(&summary.result)?;
    summary.counted().map_err(|error| Error::Mechanics(format!("{error}, in {}", out.display())))?;
    checkpoint.map_or(Ok(()), OutputFile::remove)
}
