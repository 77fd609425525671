//! `perilife sif`: stress intensity factors of every crack tip; on nodes also the stress of the plate, with or without cracks.

use std::path::{Path, PathBuf};

use super::console::Console;
use crate::error::{Result, input};
use crate::input::Document;
use crate::predict::tip_factors::StressIntensityMethod;
use crate::report::output::OutputFolder;
use crate::runner::{self, Kind, Task};

/// Arguments of `perilife sif`.
#[derive(Debug, clap::Args)]
#[command(
    after_long_help = "On nodes (--method element_free_galerkin) a plate needs no crack: printed are the largest and least stress along every rim, where they\n\
                       are, and the stress concentration over the gross stress. DIR gets result.json, stress.svg and nodes.svg."
)]
pub struct Args {
    /// Case file (a calibration file does as well); its fatigue law is not needed
    #[arg(value_name = "CASE.toml")]
    pub case: PathBuf,
    /// Methods: ring, element_free_galerkin, energy_release; all where none is given
    #[arg(long, value_name = "METHOD", num_args = 1.., help_heading = "Method")]
    pub method: Vec<String>,
    /// Folder for stress and displacement of the plate on nodes (with --method element_free_galerkin); replaced if an earlier run made it
    #[arg(long, value_name = "DIR", help_heading = "Output")]
    pub out: Option<PathBuf>,
    /// Also write displacement and stress for ParaView (paraview/run.pvd), as the key output.paraview does
    #[arg(long, requires = "out", help_heading = "Output")]
    pub paraview: bool,
    /// Override a key of the case (repeatable), e.g. --set specimen.crack_length_mm=20
    #[arg(long = "set", value_name = "SECTION.KEY=VALUE", help_heading = "Input")]
    pub set: Vec<String>,
    /// What is printed.
    #[command(flatten)]
    pub console: Console,
}

/// Runs `perilife sif`.
pub fn run(args: &Args) -> Result<()> {
    let console = &args.console;
    let document = Document::read(&args.case, &super::with_output(&args.set, [("paraview", args.paraview)]))?;
    let task = Task::read(Kind::Sif, &document, &args.method)?;
    super::within_machine(&task, &document)?;
    let work = |folder: Option<&Path>| runner::run(&task, None, folder, console).map_err(|error| document.locate(error));
    let summary = match &args.out {
        None => {
            task.warnings().iter().for_each(|warning| console.warn(warning));
            console.print(work(None)?)?
        }
        Some(out) => {
            let nodes = StressIntensityMethod::ElementFreeGalerkin;
            if matches!(&task, Task::Factors { methods, .. } if !methods.contains(&nodes)) {
                let problem = "takes the stress of the plate on nodes, and no method has nodes";
                let remedy = "add --method element_free_galerkin, or leave --out out";
                return Err(input("--out", out.display(), problem, remedy));
            }
            // Claimed first: a folder that cannot be written should not cost a run.
            let folder = OutputFolder::claim(out, task.run_kind(), &document.folder.opened().so_far(), task.room())?;
            console.keep(folder, task.warnings(), |path| work(Some(path)))?
        }
    };
    console.object(&summary.result)
}
