//! `perilife export`: the a-N curve of a finished run at chosen cycles.

use std::path::{Path, PathBuf};

use serde_json::json;

use super::console::Console;
use perilife_base::error::{Error, Result, input};
use perilife_base::input::Opened;
use perilife_base::units::shown::asked;
use perilife_base::units::us::System;
use perilife_results::curve::{self, A_N_FILE, ROWS_MAX, Row, Sampling};
use perilife_results::output::{OutputFile, Sort};
use perilife_results::paper;

/// First line of an export, which a run's own table has not.
const HEADER: &str = "cycles,crack_length_mm,delta_k_mpa_sqrt_m,da_dn_mm_per_cycle\n";

#[derive(Debug, clap::Args)]
pub struct Args {
    /// Folder of a finished run
    #[arg(value_name = "DIR")]
    pub run: PathBuf,
    /// Number of rows, equally spaced in cycles, at least 2
    #[arg(long, value_name = "COUNT", default_value_t = 200, value_parser = clap::value_parser!(u64).range(2..=ROWS_MAX), help_heading = "Sampling")]
    pub points: u64,
    /// One row every CYCLES (instead of --points)
    #[arg(long, value_name = "CYCLES", help_heading = "Sampling")]
    pub every_cycles: Option<f64>,
    /// CSV file to write
    #[arg(long, value_name = "FILE.csv", help_heading = "Output")]
    pub out: PathBuf,
    #[command(flatten)]
    pub console: Console,
}

pub fn run(args: &Args) -> Result<()> {
    let opened = Opened::default();
    let (curve, units) = curve_of(&args.run, &opened)?;
    let (first, last) = (curve[0].cycles, curve[curve.len() - 1].cycles);
    let sampling = args.every_cycles.map_or(Sampling::Points(args.points), Sampling::EveryCycles);
    let rows = sampling.of(&curve, "--every-cycles")?;
    let sort = Sort { option: "--out", sign: HEADER.as_bytes() };
    let file = OutputFile::claim(&args.out, sort, &opened.so_far())?;
    let is_file = file.is_file();
    file.write(curve::table(&rows).csv_in(units).as_bytes())?;
    if is_file {
        args.console.say(&format!("{}: {} rows, {first} to {last} cycles", args.out.display(), rows.len()));
    }
    args.console.object(&json!({ "file": args.out, "rows": rows.len(), "cycles_first": first, "cycles_last": last }))
}

/// The a-N curve of a run's folder, at least one row, and the units that it is written in: those that are asked for, else those of the run.
fn curve_of(folder: &Path, opened: &Opened) -> Result<(Vec<Row>, System)> {
    std::fs::read_dir(folder).map_err(|e| Error::file(folder, "cannot read the folder of a run", e))?;
    if folder.join(A_N_FILE).is_file() {
        let (rows, of_run) = paper::curve(folder, A_N_FILE, opened)?;
        return Ok((rows, asked().unwrap_or(of_run)));
    }
    let remedy = if folder.join("fitted.toml").is_file() {
        "give the folder of a predicted case inside this calibration"
    } else {
        "give the --out folder of `perilife predict`"
    };
    Err(input("DIR", folder.display(), format!("contains no finished run ({A_N_FILE} is missing)"), remedy))
}
