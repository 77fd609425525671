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

use clap::{CommandFactory, Parser, Subcommand};
use tracing_subscriber::EnvFilter;

use perilife_base::error::Result;
use perilife_base::input::Document;
use perilife_base::units::shown::show;
use perilife_base::units::us::System;
use perilife_runner::Task;

/// The overrides with what flags of `[output]` stand for.
fn with_output<const N: usize>(set: &[String], flags: [(&str, bool); N]) -> Vec<String> {
    let keys = flags.into_iter().filter(|(_, is_given)| *is_given).map(|(key, _)| format!("output.{key}=true"));
    set.iter().cloned().chain(keys).collect()
}

/// Refuses a task that this machine has no memory for, before anything is laid out.
fn within_machine(task: &Task, document: &Document) -> Result<()> {
    task.budgets(1)?.iter().try_for_each(|budget| budget.within_machine()).map_err(|error| document.locate(error))
}

/// Declares the subcommands by groups: doc line, name and module; gives the enum that clap parses, the call of the right `run` and the
/// names of each group.
macro_rules! commands {
    ($($group:literal { $($(#[$attribute:meta])+ $Name:ident: $module:ident $(or $alias:literal)? $(hidden = $hide:literal)?),+ })+) => {
        /// A subcommand with its arguments.
        #[derive(Debug, Subcommand)]
        pub enum Command {
            $($($(#[$attribute])+ $(#[command(alias = $alias)])? $(#[command(hide = $hide)])? $Name($module::Args),)+)+
        }

        impl Command {
            /// Runs it.
            /// Errors: what the command reports; [`perilife_base::error::Error::exit_code`] is the exit code of the process.
            pub fn run(&self) -> Result<()> {
                #[allow(unused_doc_comments, reason = "the attributes of a subcommand are at its arm too, for its condition")]
                match self { $($($(#[$attribute])+ Command::$Name(args) => $module::run(args),)+)+ }
            }

            fn name(&self) -> &'static str {
                #[allow(unused_doc_comments, reason = "as above")]
                match self { $($($(#[$attribute])+ Command::$Name(_) => stringify!($module),)+)+ }
            }
        }

        const GROUPS: &[(&str, &[&str])] = &[$(($group, &[$(stringify!($module)),+])),+];
    };
}

commands! {
    "Analyze" {
        /// Predict crack path, a-N curve and life of a case
        Predict: predict,
        /// Fit a crack growth law to test data
        Calibrate: calibrate,
        /// Compute stress intensity factors and compare with the handbook
        Sif: sif,
        /// Run a fracture simulation (static, quasi-static, dynamic)
        Fracture: fracture,
        /// Validate an input file
        Check: check
    }
    "Data" {
        /// Compute da/dN against ΔK from test data (ASTM E647)
        Rates: rates,
        /// Export an a-N curve at equal cycle steps (CSV)
        Export: export,
        /// Write an HTML report for signature
        Report: report,
        /// List input keys and their values
        List: list
    }
    "Studies" {
        /// Run a parameter study (grid, Latin hypercube, scatter)
        Sweep: sweep,
        /// Merge the shards of a sweep
        Collect: collect
    }
    "Verify" {
        /// Run the verification suite
        Verify: verify,
        /// Predict published tests and compare with measured lives
        Validate: validate,
        /// Find the accuracy limits of each method
        Stability: stability,
        /// Benchmark time against error
        Chart: chart or "bench"
    }
    "Service" {
        /// Start the HTTP service and web page
        #[cfg(feature = "service")]
        Serve: serve,
        /// Start a worker for a service
        #[cfg(feature = "service")]
        Worker: worker,
        /// Manage access tokens
        #[cfg(feature = "service")]
        Token: token,
        /// Run one job of a worker, which starts this by itself
        #[cfg(feature = "service")]
        Job: job hidden = true
    }
    "Other" {
        /// Print a page of the guide
        Guide: guide,
        /// Generate shell completions or the man page
        Completions: completions
    }
}

/// The command line; where help is asked for, with its subcommands by groups, which clap has not.
pub fn command_line() -> clap::Command {
    let all = CommandLine::command();
    let is_short = |word: &str| word.starts_with('-') && !word.starts_with("--") && word.contains('h');
    let asks = |word: String| ["help", "--help"].contains(&&*word) || is_short(&word);
    let mut given = std::env::args_os().skip(1).map(|word| word.to_string_lossy().into_owned()).peekable();
    if given.peek().is_some() && !given.any(asks) {
        return all;
    }
    let style = clap::builder::Styles::styled();
    let (head, name) = (style.get_header(), style.get_literal());
    let line = |command: &clap::Command| {
        format!("  {name}{:<12}{name:#} {}\n", command.get_name(), command.get_about().cloned().unwrap_or_default())
    };
    let of_group = |(title, names): &(&str, &[&str])| {
        let shown = names.iter().filter_map(|name| all.find_subcommand(name)).filter(|command| !command.is_hide_set());
        let lines: String = shown.map(line).collect();
        if lines.is_empty() { lines } else { format!("{head}{title}:{head:#}\n{lines}\n") }
    };
    let groups: String = GROUPS.iter().map(of_group).collect();
    all.help_template(format!(
        "{{about-with-newline}}\n{{usage-heading}} {{usage}}\n\n{groups}{head}Options:{head:#}\n{{options}}{{after-help}}"
    ))
}

/// Predict fatigue crack growth and life of cracked plates.
///
/// Through cracks on any path; surface, corner and embedded cracks until breakthrough and beyond.
#[derive(Debug, Parser)]
#[command(
    name = "perilife",
    version,
    subcommand_required = true,
    arg_required_else_help = true,
    after_help = "Units: mm, MPa, GPa, N, MPa√m, mm/cycle, or with --units us inch, ksi, Msi, lbf, ksi√in, in/cycle; every key and column carries its own.\n\
                  Exit codes: 0 success, 2 invalid input, 3 no valid result, 4 I/O error, 128+n signal n.\n\
                  A run that ends by fracture, yield or separation exits 0; see stop_reason.\n\
                  Output folders are written atomically. A run replaces only the files of an earlier run (listed in .perilife).\n\
                  Help on a command: perilife <COMMAND> --help"
)]
pub struct CommandLine {
    /// Print all messages and details; -vv for debug (RUST_LOG overrides)
    #[arg(long, short, action = clap::ArgAction::Count, global = true, help_heading = "Output options")]
    pub verbose: u8,
    /// Output units: si (mm, MPa, MPa√m) or us (in, ksi, ksi√in)
    ///
    /// Inputs accept both. Always metric: fitted.toml, case.toml, checkpoints, ParaView, Parquet.
    #[arg(
        long,
        value_name = "UNITS",
        env = "PERILIFE_UNITS",
        hide_env_values = true,
        global = true,
        help_heading = "Output options"
    )]
    pub units: Option<System>,
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

impl CommandLine {
    /// Starts what goes with every command. Its log goes to stderr, filtered by RUST_LOG or else by `--verbose`. All but services and their
    /// jobs write and print in the units that were asked for: the page of a service converts. Signals leave nothing half-made behind; services
    /// end on them by themselves, once what they began is done or given back.
    pub fn begin(&self) {
        let level = ["warn", "perilife=info", "perilife=debug"][usize::from(self.verbose.min(2))];
        let filter = EnvFilter::try_from_default_env().unwrap_or_else(|_| EnvFilter::new(level));
        // A second start (several calls in one test process) leaves the first log in place.
        let _ = tracing_subscriber::fmt().with_env_filter(filter).with_writer(std::io::stderr).without_time().try_init();
        let name = self.command.name();
        let is_service = ["serve", "worker"].contains(&name);
        self.units.filter(|_| !is_service && name != "job").into_iter().for_each(show);
        if !is_service {
            signals::fold_up_on_signals();
        }
    }
}
