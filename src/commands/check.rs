//! `perilife check`: is this input file right, and what would be run?

use std::path::PathBuf;

use super::console::Console;
use perilife_base::error::Result;
use perilife_results::checks::{messages, verdict};
use perilife_results::output::{OutputFile, Sort};
use perilife_results::specimen_picture::SIGN;
use perilife_runner::Summary;
use perilife_runner::check::check_file;

#[derive(clap::Args, Debug)]
pub struct Args {
    /// Case, calibration file, fracture scene or sweep
    #[arg(value_name = "FILE.toml")]
    pub file: PathBuf,
    /// Draw specimen, crack, loads and supports into this SVG file
    #[arg(long, value_name = "OUT.svg", help_heading = "Output")]
    pub picture: Option<PathBuf>,
    /// Set a key (repeatable), e.g. --set model.spacing_mm=2
    #[arg(long = "set", value_name = "SECTION.KEY=VALUE", help_heading = "Input")]
    pub set: Vec<String>,
    #[command(flatten)]
    pub console: Console,
}

/// Checks the file, prints what was understood and draws the picture.
pub fn run(args: &Args) -> Result<()> {
    let mut checked = check_file(&args.file, &args.set)?;
    if let Some(path) = &args.picture {
        match std::mem::take(&mut checked.drawn).svg() {
            None => args.console.warn("picture: none is written: tables of rates have no plate"),
            Some(drawing) => {
                let sort = Sort { option: "--picture", sign: SIGN.as_bytes() };
                OutputFile::claim(path, sort, &checked.provenance)?.write(drawing.as_bytes())?;
            }
        }
    }
    let (long, short): (Vec<_>, Vec<_>) = checked.lines.iter().partition(|line| line.is_detail);
    let [mut lines, details] =
        [short, long].map(|lines| lines.iter().map(|line| labeled(line.what, &line.value)).collect::<Vec<_>>());
    lines.insert(0, format!("{}: valid input", args.file.display()));
    lines.extend((!checked.checks.is_empty()).then(|| labeled("validity", &verdict(&checked.checks))));
    lines.extend(messages(&checked.checks, &[]).iter().map(|open| labeled(open.kind, &open.text)));
    args.console.print(Summary::of_words(lines, details, Vec::new()))?;
    checked.warnings.iter().for_each(|warning| args.console.warn(warning));
    args.console.object(&checked.json())
}

fn labeled(label: &str, value: &str) -> String {
    let mut rest = label.chars();
    let first: String = rest.next().into_iter().flat_map(char::to_uppercase).collect();
    format!("  {:<14} {value}", first + rest.as_str())
}
