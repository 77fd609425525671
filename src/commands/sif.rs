//! `perilife sif`: stress intensity factors of every crack tip, at the start or over crack length; on nodes also the stress of the plate,
//! with or without cracks.

use std::path::{Path, PathBuf};

use serde_json::json;

use super::console::Console;
use perilife_base::error::{Result, input, input_missing};
use perilife_base::input::{Document, STREAM};
use perilife_base::units::MM;
use perilife_growth::predict::factor_sweep::factor_sweep;
use perilife_growth::predict::tip_factors::StressIntensityMethod;
use perilife_plate::specimen::beta::HEADER;
use perilife_results::factors as tables;
use perilife_results::output::{OutputFile, OutputFolder, Sort};
use perilife_runner::{Kind, Message, Task};

#[derive(Debug, clap::Args)]
#[command(
    after_long_help = "With --method element_free_galerkin a crack is optional: prints max and min stress along each boundary, their position\n\
                       and the stress concentration factor K_tg. DIR gets result.json, stress.svg and nodes.svg."
)]
pub struct Args {
    /// Case or calibration file (growth law not needed)
    #[arg(value_name = "CASE.toml")]
    pub case: PathBuf,
    /// Methods: ring, element_free_galerkin [default: both]
    #[arg(long, value_name = "METHOD", num_args = 1.., help_heading = "Method")]
    pub method: Vec<String>,
    /// Folder of stresses (element_free_galerkin), or table of --sweep
    #[arg(long, value_name = "DIR|FILE.csv", help_heading = "Output")]
    pub out: Option<PathBuf>,
    /// K, T, β and compliance for crack lengths, in the unit of --units
    #[arg(long, value_name = "FIRST:LAST:STEP", conflicts_with_all = ["method", "paraview"], help_heading = "Method")]
    pub sweep: Option<String>,
    /// Write β(a) of the fastest tip for AFGROW and specimen.beta_file
    #[arg(long, value_name = "FILE.csv", requires = "sweep", help_heading = "Output")]
    pub beta: Option<PathBuf>,
    /// Replace the results of another input in DIR
    #[arg(long, requires = "out", help_heading = "Output")]
    pub force: bool,
    /// Write fields for ParaView (key output.paraview)
    #[arg(long, requires = "out", help_heading = "Output")]
    pub paraview: bool,
    /// Set a key (repeatable), e.g. --set specimen.crack_length_mm=20
    #[arg(long = "set", value_name = "SECTION.KEY=VALUE", help_heading = "Input")]
    pub set: Vec<String>,
    #[command(flatten)]
    pub console: Console,
}

pub fn run(args: &Args) -> Result<()> {
    let console = &args.console;
    if let Some(asked) = &args.sweep {
        return sweep(args, asked);
    }
    let document = Document::read(&args.case, &super::with_output(&args.set, [("paraview", args.paraview)]))?;
    let task = Task::read(Kind::Sif, &document, &args.method)?;
    super::within_machine(&task, &document)?;
    let unrun = || task.case().iter().for_each(|case| console.warn_all(&case.warnings));
    let work = |folder: Option<&Path>| {
        let run = perilife_runner::run(&task, None, folder, console).inspect_err(|_| unrun());
        run.map_err(|error| document.locate(error))
    };
    let summary = match &args.out {
        None => console.print(work(None)?)?,
        Some(out) => {
            let nodes = StressIntensityMethod::ElementFreeGalerkin;
            if matches!(&task, Task::Factors { methods, .. } if !methods.contains(&nodes)) {
                let problem = "requires --method element_free_galerkin";
                let remedy = "add --method element_free_galerkin, or remove --out";
                return Err(input("--out", out.display(), problem, remedy));
            }
            // Claimed first: a folder that cannot be written should not cost a run.
            let folder = OutputFolder::claim(out, task.run_kind(), &document.folder.opened().so_far(), task.room(), args.force)?;
            console.keep(folder, task.warnings(), |path| work(Some(path)))?
        }
    };
    console.object(&summary.result)
}

fn sweep(args: &Args, asked: &str) -> Result<()> {
    let console = &args.console;
    let lengths = perilife_runner::factors::lengths(asked)?;
    let document = Document::read(&args.case, &args.set)?;
    let case = perilife_runner::factors::case(&document, &lengths)?;
    let out = args.out.as_deref().ok_or_else(|| input_missing("--out", "is missing", "name the table: --out FILE.csv"))?;
    let claim = |option, path: &Path, sign: &'static str| {
        OutputFile::claim(path, Sort { option, sign: sign.as_bytes() }, &document.folder.opened().so_far())
    };
    // Claimed first: a file that cannot be written should not cost a run.
    let file = claim("--out", out, tables::SIGN)?;
    let beta = args.beta.as_deref().map(|path| claim("--beta", path, HEADER)).transpose()?;
    let found = factor_sweep(&case, &lengths, true, console).inspect_err(|_| console.warn_all(&case.warnings));
    let found = found.map_err(|error| document.locate(error))?;
    file.write(tables::table(&found).csv().as_bytes())?;
    beta.map_or(Ok(()), |file| file.write(tables::beta_table(&found).csv().as_bytes()))?;
    let [from, to] = [lengths[0], lengths[lengths.len() - 1]].map(|length| length / MM);
    if out != Path::new(STREAM) {
        console.say(&format!("{}: {} rows from {from} to {to} mm", out.display(), found.rows.len()));
    }
    let messages: Vec<Message> = case.warnings.iter().chain(&found.warnings).map(|line| Message::warning(line)).collect();
    console.messages(&messages);
    console.object(&json!({ "file": out, "beta_file": args.beta, "rows": found.rows.len(), "lead_tip": found.lead }))
}
