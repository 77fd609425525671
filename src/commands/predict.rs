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

#[derive(Debug, clap::Args)]
#[command(
    after_long_help = "DIR contains the curve (a_n.csv), crack paths (crack_path.csv), K and β of each tip (factors.csv; beta.txt for AFGROW),\n\
                       result.json, charts and pictures.\n\
                       A resumed run gives the same curve (bit-identical on the same CPU type). Bare lengths are in the unit of --units."
)]
pub struct Args {
    /// Case file
    #[arg(value_name = "CASE.toml")]
    pub case: PathBuf,
    /// Folder for the results [default: name of the case]
    #[arg(long, value_name = "DIR", help_heading = "Output")]
    pub out: Option<PathBuf>,
    /// Set a key (repeatable), e.g. --set model.spacing_mm=0.5
    #[arg(long = "set", value_name = "SECTION.KEY=VALUE", help_heading = "Input")]
    pub set: Vec<String>,
    /// Write residual strength against crack length (.csv, .svg)
    #[arg(long, help_heading = "Output")]
    pub residual_strength: bool,
    /// Write fields for ParaView (key output.paraview)
    #[arg(long, help_heading = "Output")]
    pub paraview: bool,
    /// Write an animated growth.svg (key output.animation)
    #[arg(long, help_heading = "Output")]
    pub animate: bool,
    /// Inspection readings of this plate: update its remaining life
    #[arg(long, value_name = "READINGS.csv", help_heading = "Input")]
    pub measured: Option<PathBuf>,
    /// Inspection interval from this crack length, e.g. 6.35mm or 0.25in
    #[arg(long, value_name = "LENGTH", help_heading = "Output")]
    pub inspect_from: Option<String>,
    /// Inspection factor: interval = 5 % remaining life / factor
    #[arg(long, value_name = "F", default_value_t = FACTOR, requires = "inspect_from", help_heading = "Output")]
    pub factor: f64,
    /// Tip for --inspect-from [default: governing tip]
    #[arg(long, value_name = "NUMBER", requires = "inspect_from", help_heading = "Output")]
    pub tip: Option<usize>,
    /// Detectable lengths a50,a90: probability that all inspections miss
    #[arg(long, value_name = "A50,A90", requires = "inspect_from", help_heading = "Output")]
    pub pod: Option<String>,
    /// Cycles of the first inspection [default: at --inspect-from]
    #[arg(long, value_name = "CYCLES", requires = "pod", help_heading = "Output")]
    pub first_inspection: Option<u64>,
    /// Life distribution of a fleet: scatter in law, initial crack, load
    #[arg(long, value_name = "PLATES", help_heading = "Output")]
    pub fleet: Option<u64>,
    /// Random seed of the fleet (key fleet.seed)
    #[arg(long, value_name = "NUMBER", help_heading = "Output")]
    pub seed: Option<u64>,
    /// Sensitivity of the life to load, initial crack and law
    #[arg(long, help_heading = "Output")]
    pub sensitivities: bool,
    /// Cross-check with the other method (coarse)
    #[arg(long, help_heading = "Output")]
    pub cross_check: bool,
    /// Skip the error estimate
    #[arg(long, help_heading = "Output")]
    pub no_estimate: bool,
    /// Keeping the run for later.
    #[command(flatten)]
    pub keeping: checkpoint::Args,
    #[command(flatten)]
    pub console: Console,
}

pub fn run(args: &Args) -> Result<()> {
    let mut set = super::with_output(&args.set, [("paraview", args.paraview), ("animation", args.animate)]);
    let fleet = [("plates", args.fleet), ("seed", args.seed)];
    set.extend(fleet.iter().filter_map(|(key, value)| Some(format!("fleet.{key}={}", (*value)?))));
    let document = Document::read(&args.case, &set)?;
    let mut task = Task::read(Kind::Prediction, &document, &[])?;
    if let Some(file) = &args.measured {
        let bytes = document.folder.opened().read(file, &file.display().to_string())?;
        task.read_plate(&document, file, &bytes).map_err(|error| document.locate(error))?;
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
