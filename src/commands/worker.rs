//! `perilife worker`: works for a service, from this or another machine.

use std::fs::DirBuilder;
use std::os::unix::fs::DirBuilderExt;
use std::path::PathBuf;
use std::time::Duration;

use super::console::Console;
use crate::error::{Error, Result};
use crate::service::store::url_of_file;
use crate::service::{self, worker};

/// Where a service keeps its jobs.
#[derive(Debug, Clone, clap::Args)]
#[command(next_help_heading = "Jobs and results")]
pub struct Place {
    /// Folder of the database file, made if it is not there
    #[arg(long, value_name = "DIR", default_value = "perilife-data")]
    pub data: PathBuf,
    /// Database instead of that file, e.g. postgres://user:password@host/name, for several machines
    #[arg(long, value_name = "URL", env = "PERILIFE_DATABASE", hide_env_values = true)]
    pub database: Option<String>,
}

impl Place {
    /// URL of the database.
    ///
    /// # Errors
    /// A folder that cannot be made.
    pub fn url(&self) -> Result<String> {
        if let Some(url) = &self.database {
            return Ok(url.clone());
        }
        let cannot = |error| Error::file(&self.data, "cannot create the folder", error);
        // Measured data and results are nobody else's business.
        DirBuilder::new().recursive(true).mode(0o700).create(&self.data).map_err(cannot)?;
        Ok(url_of_file(&std::fs::canonicalize(&self.data).map_err(cannot)?.join("perilife.sqlite")))
    }
}

/// Where jobs and results are kept, and who runs them.
#[derive(Debug, Clone, clap::Args)]
#[command(next_help_heading = "Jobs and results")]
pub struct Work {
    /// Where jobs are kept.
    #[command(flatten)]
    pub place: Place,
    /// Jobs at a time [default: one for each core]
    #[arg(long, value_name = "COUNT")]
    pub jobs: Option<usize>,
    /// Threads for each job
    #[arg(long, value_name = "COUNT", default_value_t = 1, value_parser = threads)]
    pub threads: usize,
    /// Least time between two checkpoints of a job, s
    #[arg(long, value_name = "SECONDS", default_value_t = 3)]
    pub checkpoint_every: u64,
    /// Time without a sign of life after which another worker takes a job, s
    #[arg(long, value_name = "SECONDS", default_value_t = 15, value_parser = clap::value_parser!(u64).range(2..))]
    pub lease: u64,
    /// Workers that may die over a job without getting as far as a checkpoint, until it is given up
    #[arg(long, value_name = "COUNT", default_value_t = 10, value_parser = clap::value_parser!(u32).range(1..))]
    pub attempts: u32,
    /// Delete finished jobs after so many days [default: never]
    #[arg(long, value_name = "DAYS", value_parser = days)]
    pub keep_days: Option<f64>,
}

fn threads(text: &str) -> std::result::Result<usize, String> {
    let count = text.parse().ok().filter(|count| (1..=1024).contains(count));
    count.ok_or_else(|| format!("`{text}` is not 1 to 1024"))
}

fn days(text: &str) -> std::result::Result<f64, String> {
    let days = text.parse().ok().filter(|days| *days > 0.0 && *days < 1e6);
    days.ok_or_else(|| format!("`{text}` is no time in days above 0"))
}

impl Work {
    /// How workers work.
    #[must_use]
    pub fn settings(&self) -> worker::Settings {
        let default = worker::Settings::default();
        worker::Settings {
            jobs: self.jobs.unwrap_or(default.jobs),
            threads: self.threads,
            lease: Duration::from_secs(self.lease),
            checkpoint_every: Duration::from_secs(self.checkpoint_every),
            attempts: i64::from(self.attempts),
            keep: self.keep_days.and_then(|days| Duration::try_from_secs_f64(86_400.0 * days).ok()),
        }
    }
}

/// Arguments of `perilife worker`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Where jobs and results are kept, and who runs them.
    #[command(flatten)]
    pub work: Work,
    /// What is printed.
    #[command(flatten)]
    pub console: Console,
}

/// Runs `perilife worker`, until it is asked to stop.
///
/// # Errors
/// A database that cannot be used.
pub fn run(args: &Args) -> Result<()> {
    let (url, settings) = (args.work.place.url()?, args.work.settings());
    let place = service::without_password(&url);
    let ready = || args.console.note(&format!("perilife worker: {} jobs at a time from {place}", settings.jobs));
    service::work(&url, &settings, ready)
}
