//! `perilife report`: one self-contained page of a run or a fit, to be printed and signed.

use std::path::PathBuf;

use serde_json::json;

use super::console::Console;
use perilife_base::error::Result;
use perilife_results::paper::{Signed, write};

/// Arguments of `perilife report`.
#[derive(Debug, clap::Args)]
#[command(
    after_long_help = "The page holds its pictures and its style and names no other file; a browser prints it to A4 or letter, or saves it as PDF.\n\
                       What is not given is printed as \"not recorded\"."
)]
pub struct Args {
    /// Folder that `perilife predict` or `perilife calibrate` wrote
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,
    /// Page to write (HTML); replaced if an earlier report made it
    #[arg(long, value_name = "FILE.html", help_heading = "Output")]
    pub out: PathBuf,
    /// Name of the laboratory or office
    #[arg(long, value_name = "NAME", help_heading = "Who signs")]
    pub laboratory: Option<String>,
    /// Who tested or computed
    #[arg(long, value_name = "NAME", help_heading = "Who signs")]
    pub operator: Option<String>,
    /// Who checks
    #[arg(long, value_name = "NAME", help_heading = "Who signs")]
    pub reviewer: Option<String>,
    /// Date of the report, in your own writing
    #[arg(long, value_name = "DATE", help_heading = "Who signs")]
    pub date: Option<String>,
    /// What is printed.
    #[command(flatten)]
    pub console: Console,
}

/// Runs `perilife report`.
/// Errors: a folder without a whole run or fit; a file in the way.
pub fn run(args: &Args) -> Result<()> {
    let signed = Signed {
        laboratory: args.laboratory.clone(),
        operator: args.operator.clone(),
        reviewer: args.reviewer.clone(),
        date: args.date.clone(),
    };
    let (bytes, is_file) = write(&args.folder, &args.out, &signed)?;
    if is_file {
        args.console.say(&format!("report         {}", args.out.display()));
    }
    args.console.object(&json!({ "file": args.out, "bytes": bytes }))
}
