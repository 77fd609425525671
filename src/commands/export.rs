//! `perilife export`: the a-N curve of a finished run at chosen cycles.

use std::path::{Path, PathBuf};

use serde_json::json;

use super::console::Console;
use crate::error::{Error, Result, input};
use crate::report::csv::{self, A_N_COLUMNS, A_N_FILE, Row, read_a_n};
use crate::report::output::write_file;
use crate::report::resample::{ROWS_MAX, Sampling};

/// Arguments of `perilife export`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Folder of a finished run
    #[arg(value_name = "DIR")]
    pub run: PathBuf,
    /// Rows, equally spaced in cycles from the first to the last, at least 2
    #[arg(long, value_name = "COUNT", default_value_t = 200, value_parser = clap::value_parser!(u64).range(2..=ROWS_MAX), help_heading = "Sampling")]
    pub points: u64,
    /// A row every so many cycles and one at the end, instead of --points
    #[arg(long, value_name = "CYCLES", help_heading = "Sampling")]
    pub every_cycles: Option<f64>,
    /// Table to write (CSV); replaced if an earlier export made it
    #[arg(long, value_name = "FILE.csv", help_heading = "Output")]
    pub out: PathBuf,
    /// What is printed.
    #[command(flatten)]
    pub console: Console,
}

/// Runs `perilife export`.
///
/// # Errors
/// Wrong input, or files that cannot be read or written.
pub fn run(args: &Args) -> Result<()> {
    let curve = curve_of(&args.run)?;
    let (first, last) = (curve[0].cycles, curve[curve.len() - 1].cycles);
    let sampling = args.every_cycles.map_or(Sampling::Points(args.points), Sampling::EveryCycles);
    let rows = sampling.of(&curve, "--every-cycles")?;
    let text = csv::table(&rows);
    check_replaceable(&args.out)?;
    write_file(&args.out, text.as_bytes())?;
    if args.out.is_file() {
        args.console.say(&format!("{}: {} rows from {first} to {last} cycles", args.out.display(), rows.len()));
    }
    args.console.object(&json!({ "file": args.out, "rows": rows.len(), "cycles_first": first, "cycles_last": last }))
}

/// The a-N curve of a run's folder, at least one row.
fn curve_of(folder: &Path) -> Result<Vec<Row>> {
    std::fs::read_dir(folder).map_err(|e| Error::file(folder, "cannot read the folder of a run", e))?;
    let table = folder.join(A_N_FILE);
    if table.is_file() {
        return read_a_n(&table);
    }
    let remedy = if folder.join("fitted.toml").is_file() {
        "this is a calibration: give the folder of a predicted case inside it"
    } else {
        "give the --out folder of `perilife predict`"
    };
    Err(input("DIR", folder.display(), format!("holds no finished run ({A_N_FILE} is missing)"), remedy))
}

/// An existing file is replaced only if it is an export, or empty.
fn check_replaceable(out: &Path) -> Result<()> {
    if !out.is_file() {
        return Ok(());
    }
    let there = std::fs::read(out).map_err(|e| Error::file(out, "cannot read", e))?;
    let header = A_N_COLUMNS.join(",") + "\n";
    if there.is_empty() || there.starts_with(header.as_bytes()) {
        return Ok(());
    }
    Err(input("--out", out.display(), "is a file that this command did not write", "give a new name, or remove it yourself"))
}
