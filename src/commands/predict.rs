//! `perilife predict`: a case to its a-N curve, tables and pictures.

use std::path::PathBuf;

use super::checkpoint;
use super::console::Console;
use crate::error::Result;
use crate::input::Document;
use crate::report::output::OutputFile;
use crate::runner::{Kind, Task};

/// Arguments of `perilife predict`.
#[derive(Debug, clap::Args)]
#[command(
    after_long_help = "DIR holds the curve (a_n.csv), the path of every tip (crack_path.csv), K and β of every tip (factors.csv; beta.txt for AFGROW),\n\
                       result.json, charts and pictures.\n\
                       A run that was killed goes on from its checkpoint to the same curve, bit for bit on the same kind of processor."
)]
pub struct Args {
    /// Case file
    #[arg(value_name = "CASE.toml")]
    pub case: PathBuf,
    /// Folder for the results; replaced if an earlier run made it
    #[arg(long, value_name = "DIR", help_heading = "Output")]
    pub out: PathBuf,
    /// Override a key of the case (repeatable), e.g. --set model.spacing_mm=0.5
    #[arg(long = "set", value_name = "SECTION.KEY=VALUE", help_heading = "Input")]
    pub set: Vec<String>,
    /// Also write the load that would end the plate at once over crack length (residual_strength.csv and .svg)
    #[arg(long, help_heading = "Output")]
    pub residual_strength: bool,
    /// Also write the fields of some moments for ParaView (paraview/run.pvd), as the key output.paraview does
    #[arg(long, help_heading = "Output")]
    pub paraview: bool,
    /// Keeping the run for later.
    #[command(flatten)]
    pub keeping: checkpoint::Args,
    /// What is printed.
    #[command(flatten)]
    pub console: Console,
}

/// Runs `perilife predict`.
pub fn run(args: &Args) -> Result<()> {
    let document = Document::read(&args.case, &super::with_paraview(&args.set, args.paraview))?;
    let mut task = Task::read(Kind::Prediction, &document, &[])?;
    if let Task::Prediction { with_strength, .. } = &mut task {
        *with_strength = args.residual_strength;
    }
    let (summary, checkpoint) = args.keeping.run(&task, &document, &args.out, &args.console)?;
    let summary = summary.counted()?;
    checkpoint.map(OutputFile::remove).transpose()?;
    args.console.object(&summary.result)
}
