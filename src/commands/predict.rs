//! `perilife predict`: a case to its a-N curve, tables and pictures.

use std::path::{Path, PathBuf};

use super::checkpoint;
use super::console::Console;
use perilife_base::error::{Result, input};
use perilife_base::input::Document;
use perilife_base::units::{MM, shown::length_given};
use perilife_calibration::inspection::{FACTOR, InspectFrom};
use perilife_results::output::OutputFile;
use perilife_runner::{Kind, Task};

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
    /// Folder for the results [default: name of the case]
    #[arg(long, value_name = "DIR", help_heading = "Output")]
    pub out: Option<PathBuf>,
    /// Override a key of the case (repeatable), e.g. --set model.spacing_mm=0.5
    #[arg(long = "set", value_name = "SECTION.KEY=VALUE", help_heading = "Input")]
    pub set: Vec<String>,
    /// Also write the load that would end the plate at once over crack length (residual_strength.csv and .svg)
    #[arg(long, help_heading = "Output")]
    pub residual_strength: bool,
    /// Also write the fields of some moments for ParaView (paraview/run.pvd), as the key output.paraview does
    #[arg(long, help_heading = "Output")]
    pub paraview: bool,
    /// Also draw the cracks as they grow (growth.svg, which moves in a browser), as the key output.animation does
    #[arg(long, help_heading = "Output")]
    pub animate: bool,
    /// Readings of this very plate (cycles, crack length), which narrow the band of what it has left
    #[arg(long, value_name = "READINGS.csv", help_heading = "Input")]
    pub measured: Option<PathBuf>,
    /// Inspection interval from this crack length, 6.35mm or 0.25in: 5 % remaining life / factor; a bare number is in the unit of --units
    #[arg(long, value_name = "LENGTH", help_heading = "Output")]
    pub inspect_from: Option<String>,
    /// Factor of the inspection interval
    #[arg(long, value_name = "F", default_value_t = FACTOR, requires = "inspect_from", help_heading = "Output")]
    pub factor: f64,
    /// Tip of a plate whose crack has that length; the one that ends the life where it is left out
    #[arg(long, value_name = "NUMBER", requires = "inspect_from", help_heading = "Output")]
    pub tip: Option<usize>,
    /// Crack lengths that an inspection finds with 50 and with 90 %, units as of --inspect-from: probability that all of them miss the crack
    #[arg(long, value_name = "A50,A90", requires = "inspect_from", help_heading = "Output")]
    pub pod: Option<String>,
    /// Cycles of the first inspection [default: at the length of --inspect-from; of a fleet when 5 % of plates have it]
    #[arg(long, value_name = "CYCLES", requires = "pod", help_heading = "Output")]
    pub first_inspection: Option<u64>,
    /// Also write lives of so many plates that differ in law, initial length and load (fleet.csv and .svg), as the key fleet.plates does
    #[arg(long, value_name = "PLATES", help_heading = "Output")]
    pub fleet: Option<u64>,
    /// Seed of the plates, as the key fleet.seed is
    #[arg(long, value_name = "NUMBER", help_heading = "Output")]
    pub seed: Option<u64>,
    /// Also write the life at somewhat other load, initial length and law (sensitivities.csv and .svg)
    #[arg(long, help_heading = "Output")]
    pub sensitivities: bool,
    /// Also print the life by the other engine, coarse: two methods that share nothing
    #[arg(long, help_heading = "Output")]
    pub cross_check: bool,
    /// Do not look for how wrong the life may be
    #[arg(long, help_heading = "Output")]
    pub no_estimate: bool,
    /// Keeping the run for later.
    #[command(flatten)]
    pub keeping: checkpoint::Args,
    /// What is printed.
    #[command(flatten)]
    pub console: Console,
}

/// Runs `perilife predict`.
pub fn run(args: &Args) -> Result<()> {
    let mut set = super::with_output(&args.set, [("paraview", args.paraview), ("animation", args.animate)]);
    let fleet = [("plates", args.fleet), ("seed", args.seed)];
    set.extend(fleet.iter().filter_map(|(key, value)| Some(format!("fleet.{key}={}", (*value)?))));
    let document = Document::read(&args.case, &set)?;
    let mut task = Task::read(Kind::Prediction, &document, &[])?;
    if let Some(file) = &args.measured {
        task.read_plate(&document, file).map_err(|error| document.locate(error))?;
    }
    if let Task::Prediction { wanted, .. } = &mut task {
        (wanted.strength, wanted.asked.sensitivities) = (args.residual_strength, args.sensitivities);
        wanted.asked.detection = args.pod.as_deref().map(str::parse).transpose()?;
        wanted.asked.first_inspection = args.first_inspection.map(|cycles| cycles as f64);
        (wanted.no_estimate, wanted.cross_check) = (args.no_estimate, args.cross_check);
        let names = ["--inspect-from", "--factor", "--tip"];
        if let Some(text) = &args.inspect_from {
            let wrong = || input(names[0], text, "is not a length", "give for example 6.35mm or 0.25in");
            let crack_length_mm = length_given(text).ok_or_else(wrong)? / MM;
            wanted.inspection = Some(InspectFrom { crack_length_mm, tip: args.tip, factor: args.factor, names });
        }
    }
    let out = args.out.as_deref().unwrap_or(Path::new(&document.name));
    let (summary, checkpoint) = args.keeping.run(&task, &document, out, &args.console)?;
    let summary = summary.counted()?;
    checkpoint.map(OutputFile::remove).transpose()?;
    args.console.object(&summary.result)
}
