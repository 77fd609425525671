//! `perilife check`: is this input file right, and what would be run?

use std::path::PathBuf;

use super::console::Console;
use perilife_base::error::Result;
use perilife_results::output::{OutputFile, Sort};
use perilife_results::specimen_picture::SIGN;
use perilife_runner::check::check_file;

/// Arguments of `perilife check`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// Case, calibration file, fracture scene or sweep
    #[arg(value_name = "FILE.toml")]
    pub file: PathBuf,
    /// Draw specimen, crack, loads and supports into this SVG file
    #[arg(long, value_name = "OUT.svg", help_heading = "Output")]
    pub picture: Option<PathBuf>,
    /// Override a key of the file (repeatable), e.g. --set model.spacing_mm=2
    #[arg(long = "set", value_name = "SECTION.KEY=VALUE", help_heading = "Input")]
    pub set: Vec<String>,
    /// What is printed.
    #[command(flatten)]
    pub console: Console,
}

/// Checks the file, prints what was understood and draws the picture.
pub fn run(args: &Args) -> Result<()> {
    let checked = check_file(&args.file, &args.set)?;
    match &args.picture {
        Some(_) if checked.drawing.is_empty() => args.console.warn("no picture is written: tables of rates have no plate"),
        Some(path) => {
            let sort = Sort { option: "--picture", sign: SIGN.as_bytes() };
            OutputFile::claim(path, sort, &checked.provenance)?.write(checked.drawing.as_bytes())?;
        }
        None => {}
    }
    for warning in &checked.warnings {
        args.console.warn(warning);
    }
    for line in &checked.lines {
        args.console.say(&format!("{:<12} {}", line.what, line.value));
    }
    args.console.say(&format!("{:<12} no errors", "check"));
    args.console.object(&checked.json())
}
