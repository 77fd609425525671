//! `perilife bench`: every solver, law and resolution side by side, time against error.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use serde_json::json;

use super::console::Console;
use crate::bench::first_solve::first_solve;
use crate::bench::{self, Effort, Figure, FirstSolve, Observer, Request, Row, groups};
use crate::error::{Error, Result, input};
use crate::report::output::{OutputFolder, RunKind, write_file};
use crate::report::{bench as tables, speed_chart};

/// Arguments of `perilife bench`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Groups to measure; all where none is given (`perilife list` names them)
    #[arg(value_name = "NAME")]
    pub names: Vec<String>,
    /// Coarse scenes and few rows: a minute, for a look
    #[arg(long)]
    pub quick: bool,
    /// Repeats of every row, of which the median counts [default: 5, with --quick 1]
    #[arg(long, value_name = "COUNT", value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub repeats: Option<u32>,
    /// Seconds after which a row is not repeated again [default: 4, with --quick 0.5]
    #[arg(long, value_name = "SECONDS")]
    pub seconds_per_row: Option<f64>,
    /// Folder for bench.csv, figures.csv, bench.json, bench.md and bench.svg
    #[arg(long, value_name = "DIR", help_heading = "Output")]
    pub out: Option<PathBuf>,
    /// What is printed.
    #[command(flatten)]
    pub console: Console,
    /// Measures one size (LAW:POINTS) and prints it: how the benchmark calls itself
    #[arg(long, value_name = "LAW:POINTS", hide = true)]
    pub first_solve: Option<String>,
}

/// Runs `perilife bench`.
///
/// # Errors
/// A name that is no group; mechanics that fail where they must not; files that cannot be written.
pub fn run(args: &Args) -> Result<()> {
    if let Some(request) = &args.first_solve {
        return print_first_solve(request);
    }
    let groups = groups(&args.names)?;
    let effort = effort(args)?;
    let folder = args.out.as_deref().map(|path| OutputFolder::create(path, RunKind::Bench)).transpose()?;
    let outcome = bench::run(&groups, effort, &in_own_process, &args.console)?;
    let object = tables::object(&outcome);
    if let Some(mut folder) = folder {
        folder.fill(|path| {
            let write = |name: &str, text: String| write_file(&path.join(name), text.as_bytes());
            write("bench.csv", tables::csv(&outcome.rows))?;
            write("figures.csv", tables::figures_csv(&outcome.figures))?;
            write("bench.json", format!("{object:#}\n"))?;
            write("bench.md", tables::markdown(&outcome))?;
            speed_chart::speed_accuracy(&path.join("bench.svg"), &outcome)
        })?;
        drop(folder.finish()?);
    }
    args.console.say(&format!(
        "{} rows; reference run: {}, {}; {}",
        outcome.rows.len(),
        outcome.reference,
        tables::seconds(outcome.reference_s),
        outcome.machine
    ));
    args.console.object(&object)
}

fn effort(args: &Args) -> Result<Effort> {
    let effort = if args.quick { Effort::QUICK } else { Effort::FULL };
    let seconds_per_row = args.seconds_per_row.unwrap_or(effort.seconds_per_row);
    if !(seconds_per_row > 0.0 && seconds_per_row.is_finite()) {
        return Err(input("--seconds-per-row", seconds_per_row, "must be above zero", "give seconds, for example 4"));
    }
    Ok(Effort { repeats: args.repeats.map_or(effort.repeats, |repeats| repeats as usize), seconds_per_row, ..effort })
}

impl Observer for Console {
    fn row(&self, row: &Row) {
        self.say(&tables::line(row));
    }

    fn figure(&self, figure: &Figure) {
        self.say(&tables::figure_line(figure));
    }
}

/// Starts this program once more for one size, so that the peak of memory is that of this size alone.
fn in_own_process(request: &Request) -> Result<FirstSolve> {
    let failed = |source| Error::file(Path::new("perilife"), "cannot start a process of its own", source);
    let program = std::env::current_exe().map_err(failed)?;
    let size = format!("{}:{}", request.law, request.points);
    let output = Command::new(program).args(["bench", "--first-solve", &size]).stdin(Stdio::null()).output().map_err(failed)?;
    if !output.status.success() {
        let words = String::from_utf8_lossy(&output.stderr).trim().to_owned();
        return Err(Error::Mechanics(format!("first solve of {size} points: {words}")));
    }
    serde_json::from_slice(&output.stdout)
        .map_err(|error| Error::Mechanics(format!("first solve of {size} points gave no figures: {error}")))
}

/// One size in this process, as JSON on stdout.
fn print_first_solve(text: &str) -> Result<()> {
    let wrong = || input("--first-solve", format!("\"{text}\""), "is not LAW:POINTS", "write for example bond_based:30000");
    let (law, points) = text.split_once(':').ok_or_else(wrong)?;
    let request = Request { law: law.parse()?, points: points.parse().map_err(|_| wrong())? };
    let console = Console { json: true, quiet: true };
    console.object(&json!(first_solve(&request)?))
}
