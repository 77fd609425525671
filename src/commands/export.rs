//! `perilife export`: the a-N curve of a finished run at chosen cycles.
//!
//! Between two rows everything is linear in N, so the curve stays monotone; first and last row are kept exactly.

use std::path::{Path, PathBuf};

use serde_json::json;

use super::console::Console;
use crate::error::{Error, Result, input};
use crate::report::csv::{A_N_COLUMNS, A_N_FILE, Row, read_a_n};
use crate::report::output::write_file;

/// Most rows an export writes; more is a slip of the pen.
const ROWS_MAX: u64 = 10_000_000;

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
    let cycles = match args.every_cycles {
        Some(step) => every(first, last, step)?,
        None => equally_spaced(first, last, args.points),
    };
    let rows: Vec<Row> = cycles.iter().map(|n| at(&curve, *n)).collect();
    let mut text = A_N_COLUMNS.join(",") + "\n";
    for row in &rows {
        text += &(row.fields() + "\n");
    }
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

/// `count` cycles from `first` to `last`, both exact.
fn equally_spaced(first: f64, last: f64, count: u64) -> Vec<f64> {
    if first == last {
        return vec![first];
    }
    let gaps = (count - 1) as f64;
    let inner = (1..count - 1).map(|i| first + (last - first) * (i as f64 / gaps));
    std::iter::once(first).chain(inner).chain(std::iter::once(last)).collect()
}

/// `first`, then every `step` cycles, then `last`.
fn every(first: f64, last: f64, step: f64) -> Result<Vec<f64>> {
    if !(step.is_finite() && step > 0.0) {
        return Err(input("--every-cycles", step, "is not a positive number of cycles", "give for example 1000"));
    }
    let count = ((last - first) / step).floor();
    if count > ROWS_MAX as f64 {
        let problem = format!("asks for {count:.0} rows, more than {ROWS_MAX}");
        return Err(input("--every-cycles", step, problem, format!("give at least {:.3e}", (last - first) / ROWS_MAX as f64)));
    }
    let mut cycles: Vec<f64> = (0..=count as u64).map(|i| first + step * i as f64).filter(|n| *n < last).collect();
    cycles.push(last);
    Ok(cycles)
}

/// The curve at `cycles`, which lies within it. Where several rows share these cycles the last one counts; at the very
/// start the first one does, so that the curve begins at the initial crack length.
fn at(curve: &[Row], cycles: f64) -> Row {
    if cycles <= curve[0].cycles && curve[curve.len() - 1].cycles > curve[0].cycles {
        return curve[0];
    }
    let after = curve.partition_point(|row| row.cycles <= cycles);
    let from = curve[after.saturating_sub(1)];
    let Some(to) = curve.get(after) else { return from };
    let share = (cycles - from.cycles) / (to.cycles - from.cycles);
    // Written so that share 0 and 1 give the rows themselves and rounding cannot leave the interval.
    let between = |a: f64, b: f64| if share <= 0.0 { a } else { (a + share * (b - a)).clamp(a.min(b), a.max(b)) };
    Row {
        cycles,
        crack_length_mm: between(from.crack_length_mm, to.crack_length_mm),
        delta_k_mpa_sqrt_m: unknown_or(between, from.delta_k_mpa_sqrt_m, to.delta_k_mpa_sqrt_m),
        da_dn_mm_per_cycle: unknown_or(between, from.da_dn_mm_per_cycle, to.da_dn_mm_per_cycle),
    }
}

/// `clamp` refuses NaN bounds, so an unknown end makes the value unknown before it is asked.
fn unknown_or(between: impl Fn(f64, f64) -> f64, a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::NAN } else { between(a, b) }
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
