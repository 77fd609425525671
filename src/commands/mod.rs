//! The command line: one file per subcommand, each with its `Args` and its `run`.
//!
//! A new subcommand is its file, its `mod` and its line in the list below.

pub mod calibrate;
pub mod chart;
pub mod check;
pub mod collect;
pub mod completions;
pub mod export;
pub mod fracture;
pub mod guide;
#[cfg(feature = "service")]
pub mod job;
pub mod list;
pub mod predict;
pub mod rates;
mod rates_of_materials;
pub mod report;
#[cfg(feature = "service")]
pub mod serve;
pub mod sif;
pub mod stability;
pub mod sweep;
#[cfg(feature = "service")]
pub mod token;
pub mod validate;
pub mod verify;
#[cfg(feature = "service")]
pub mod worker;

pub mod checkpoint;
pub mod console;
pub mod signals;

use std::path::Path;

use clap::{Parser, Subcommand};
use tracing_subscriber::EnvFilter;

use perilife_base::error::Result;
use perilife_base::input::Document;
use perilife_base::units::shown::show;
use perilife_base::units::us::System;
use perilife_growth::case::Case;
use perilife_runner::Task;

/// Specimen, material, load and model of a case or calibration file, of whose fatigue law nothing is asked: a fitted record that does not
/// exist yet is no obstacle.
fn case_without_law(path: &Path, overrides: &[String]) -> Result<Case> {
    let case = Case::plate_of(&Document::read(path, overrides)?)?;
    case.specimen.check_growth().map_err(|error| error.in_file(path))?;
    Ok(case)
}

/// The overrides with what flags of `[output]` stand for.
fn with_output<const N: usize>(set: &[String], flags: [(&str, bool); N]) -> Vec<String> {
    let keys = flags.into_iter().filter(|(_, is_given)| *is_given).map(|(key, _)| format!("output.{key}=true"));
    set.iter().cloned().chain(keys).collect()
}

/// Refuses a task that this machine has no memory for, before anything is laid out.
fn within_machine(task: &Task, document: &Document) -> Result<()> {
    task.budgets(1)?.iter().try_for_each(|budget| budget.within_machine()).map_err(|error| document.locate(error))
}

/// Declares the subcommands: doc line, name and module; gives the enum that clap parses and the call of the right `run`.
macro_rules! commands {
    ($($(#[$attribute:meta])+ $Name:ident: $module:ident $(or $alias:literal)? $(hidden = $hide:literal)?),+ $(,)?) => {
        /// A subcommand with its arguments.
        #[derive(Debug, Subcommand)]
        pub enum Command { $($(#[$attribute])+ $(#[command(alias = $alias)])? $(#[command(hide = $hide)])? $Name($module::Args)),+ }

        impl Command {
            /// Runs it.
            /// Errors: what the command reports; [`perilife_base::error::Error::exit_code`] is the exit code of the process.
            pub fn run(&self) -> Result<()> {
                #[allow(unused_doc_comments, reason = "the lines about a subcommand stand at its arm too, as its condition does")]
                match self { $($(#[$attribute])+ Command::$Name(args) => $module::run(args)),+ }
            }
        }
    };
}

commands! {
    /// Predict crack growth: run a case, write its a-N curve and pictures
    Predict: predict,
    /// Run many cases of one: a grid, a random design or a law that scatters
    Sweep: sweep,
    /// Gather the results of a sweep whose cases were run in parts
    Collect: collect,
    /// Run a fracture scene without cycles: static, load steps or motion in time
    Fracture: fracture,
    /// Fit the fatigue law to measured a-N curves
    Calibrate: calibrate,
    /// Resample the a-N curve of a finished run
    Export: export,
    /// One page of a run or a fit, to be printed and signed
    Report: report,
    /// Stress intensity factors of every crack tip, beside the handbook value
    Sif: sif,
    /// Growth rate da/dN against ΔK from measured a-N curves
    Rates: rates,
    /// Run the built-in verification: computed, reference, error and bound of every row
    Verify: verify,
    /// Predict published tests: ratio to what was measured, band, paths
    Validate: validate,
    /// Measure every method, law, solver and resolution: time against error
    Chart: chart or "bench",
    /// Take every method across its range until it fails: safe ranges and why they end
    Stability: stability,
    /// Check an input file without running it
    Check: check,
    /// List every kind of every key of the input files
    List: list,
    /// Print a page of the guide
    Guide: guide,
    /// Print what a shell needs to complete commands, or the manual page
    Completions: completions,
    /// Serve calibrations and predictions over HTTP, with a web page
    #[cfg(feature = "service")]
    Serve: serve,
    /// Work for a service from this or another machine
    #[cfg(feature = "service")]
    Worker: worker,
    /// Make, list and remove the tokens of a service
    #[cfg(feature = "service")]
    Token: token,
    /// Run one job of a worker, which starts this by itself
    #[cfg(feature = "service")]
    Job: job hidden = true,
}

/// Fatigue-life prediction of cracked plates by peridynamics.
///
/// Cracks go through the plate, or are surface, corner and embedded cracks, by hand calculation until they do.
#[derive(Debug, Parser)]
#[command(
    name = "perilife",
    version,
    subcommand_required = true,
    arg_required_else_help = true,
    after_help = "Units: mm, MPa, GPa, N, MPa√m, mm/cycle, or with --units us inch, ksi, Msi, lbf, ksi√in, in/cycle; every key and column carries its own.\n\
                  Exit codes: 0 done, 2 wrong input, 3 no convergence, 4 file trouble, 128 + number of the signal that ended it.\n\
                  A run that ends for a mechanical reason after its crack has grown is done: stop_reason says why it stopped.\n\
                  An output folder appears when it is whole. A run replaces the files of an earlier one of its kind (.perilife lists them), and no others.\n\
                  `perilife <COMMAND> --help` explains a command."
)]
pub struct CommandLine {
    /// Print all messages and details; twice for the log (the variable RUST_LOG overrides)
    #[arg(long, short, action = clap::ArgAction::Count, global = true, help_heading = "What is printed")]
    pub verbose: u8,
    /// Units of what is written and printed: si (mm, MPa, MPa√m), the default, or us (inch, ksi, ksi√in). Input files take keys of both. Metric stay what is read
    /// again as input (fitted.toml, case.toml, checkpoints), files for ParaView and Parquet, and options of the command line
    #[arg(
        long,
        value_name = "UNITS",
        env = "PERILIFE_UNITS",
        hide_env_values = true,
        global = true,
        help_heading = "What is printed"
    )]
    pub units: Option<System>,
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

impl CommandLine {
    /// Whether it ends on signals by itself, once what it began is done or given back.
    fn is_service(&self) -> bool {
        #[cfg(feature = "service")]
        return matches!(self.command, Command::Serve(_) | Command::Worker(_));
        #[cfg(not(feature = "service"))]
        return false;
    }

    /// Has all commands but services and their jobs write and print in the units that were asked for: the page of a service converts.
    pub fn show_units(&self) {
        #[cfg(feature = "service")]
        let is_job = matches!(self.command, Command::Job(_));
        #[cfg(not(feature = "service"))]
        let is_job = false;
        if let Some(units) = self.units.filter(|_| !self.is_service() && !is_job) {
            show(units);
        }
    }

    /// Has signals that end the process leave nothing half-made behind.
    pub fn watch_signals(&self) {
        if !self.is_service() {
            signals::fold_up_on_signals();
        }
    }

    /// Sends the log to stderr, filtered by RUST_LOG or else by `--verbose`.
    pub fn start_log(&self) {
        let level = ["warn", "warn", "perilife=info", "perilife=debug"][usize::from(self.verbose.min(3))];
        let filter = EnvFilter::try_from_default_env().unwrap_or_else(|_| EnvFilter::new(level));
        // A second start (several calls in one test process) leaves the first log in place.
        let _ = tracing_subscriber::fmt().with_env_filter(filter).with_writer(std::io::stderr).without_time().try_init();
    }
}
