//! `perilife report`: one self-contained page of a run or a fit, to be printed and signed.

use std::path::PathBuf;

use serde_json::json;

use super::console::Console;
use perilife_base::error::Result;
use perilife_results::paper::{Signed, write};

/// Arguments of `perilife report`.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "One self-contained file; print to A4, Letter or PDF from a browser.\n\
                       What is not given is printed as \"not recorded\".")]
pub struct Args {
    /// Results folder of `perilife predict` or `perilife calibrate`
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,
    /// HTML file to write
    #[arg(long, value_name = "FILE.html", help_heading = "Output")]
    pub out: PathBuf,
    /// Name of the laboratory or office
    #[arg(long, value_name = "NAME", help_heading = "Signature")]
    pub laboratory: Option<String>,
    /// Prepared by
    #[arg(long, value_name = "NAME", help_heading = "Signature")]
    pub operator: Option<String>,
    /// Reviewed by
    #[arg(long, value_name = "NAME", help_heading = "Signature")]
    pub reviewer: Option<String>,
    /// Date (free text)
    #[arg(long, value_name = "DATE", help_heading = "Signature")]
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
