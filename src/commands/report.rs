//! `perilife report`: one self-contained page of a run or a fit, to be printed and signed.

use std::path::PathBuf;

use serde_json::json;

use super::console::Console;
use perilife_base::error::Result;
use perilife_results::paper::{Signed, write};

#[derive(Debug, clap::Args)]
#[command(
    after_long_help = "A browser prints the page to A4 or letter, or saves it as PDF. Missing data are printed as \"not recorded\".\n\
                       Keys of section [report]: `perilife list keys report`."
)]
pub struct Args {
    /// Results folder of `perilife predict` or `perilife calibrate`
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,
    /// HTML file to write
    #[arg(long, value_name = "FILE.html", help_heading = "Output")]
    pub out: PathBuf,
    /// Report data (TOML, section report): number, customer, machine, ...
    #[arg(long, value_name = "FILE.toml", help_heading = "Report data")]
    pub data: Option<PathBuf>,
    /// Set one item of the report data
    #[arg(long = "set", value_name = "report.KEY=VALUE", help_heading = "Report data")]
    pub overrides: Vec<String>,
    /// Name and address of the laboratory
    #[arg(long, value_name = "NAME", help_heading = "Report data")]
    pub laboratory: Option<String>,
    /// Person who tested or prepared
    #[arg(long, value_name = "NAME", help_heading = "Report data")]
    pub operator: Option<String>,
    /// Person who reviews
    #[arg(long, value_name = "NAME", help_heading = "Report data")]
    pub reviewer: Option<String>,
    /// Date of issue, in any format
    #[arg(long, value_name = "DATE", help_heading = "Report data")]
    pub date: Option<String>,
    #[command(flatten)]
    pub console: Console,
}

/// Runs `perilife report`.
/// Errors: a folder without a whole run or fit; report data that cannot be read; another file at `--out`.
pub fn run(args: &Args) -> Result<()> {
    let read = Signed::read(args.data.as_deref(), &args.overrides)?;
    let signed = Signed {
        laboratory: args.laboratory.clone().or(read.laboratory),
        operator: args.operator.clone().or(read.operator),
        reviewer: args.reviewer.clone().or(read.reviewer),
        date: args.date.clone().or(read.date),
        ..read
    };
    let (bytes, is_file) = write(&args.folder, &args.out, &signed)?;
    if is_file {
        args.console.say(&format!("report         {}", args.out.display()));
    }
    args.console.object(&json!({ "file": args.out, "bytes": bytes }))
}
