//! `perilife worker`: works for a service, from this or another machine.

use std::fs::{DirBuilder, OpenOptions};
use std::io::ErrorKind;
use std::os::unix::fs::{DirBuilderExt, OpenOptionsExt};
use std::path::PathBuf;
use std::time::Duration;

use super::console::Console;
use perilife_base::error::{Error, Result, input};
use perilife_service::store::url_of_file;
use perilife_service::worker;

/// The database in the folder of a service.
const FILE: &str = "perilife.sqlite";

/// Where a service keeps its jobs.
#[derive(Debug, Clone, clap::Args)]
#[command(next_help_heading = "Jobs and results")]
pub struct Place {
    /// Folder of the database file, which `serve` and `token add` make if it is not there
    #[arg(long, value_name = "DIR", default_value = "perilife-data", global = true)]
    pub data: PathBuf,
    /// Database instead of that file, e.g. postgres://user:password@host/name, for several machines
    #[arg(long, value_name = "URL", env = "PERILIFE_DATABASE", hide_env_values = true, global = true)]
    pub database: Option<String>,
}

impl Place {
    /// URL of the database of a service that was begun.
    pub fn url(&self) -> Result<String> {
        if let Some(url) = self.given()? {
            return Ok(url);
        }
        self.check_drive()?;
        match std::fs::canonicalize(self.data.join(FILE)) {
            Ok(file) => Ok(url_of_file(&file)),
            Err(error) if error.kind() == ErrorKind::NotFound => {
                let remedy = "give the folder that `perilife serve --data` was given; it makes the database";
                Err(input("--data", self.data.display(), format!("holds no database of a service ({FILE} is missing)"), remedy))
            }
            Err(error) => Err(Error::file(&self.data, "cannot use the folder", error)),
        }
    }

    /// Refuses drives over which SQLite cannot keep several processes apart (sqlite.org, "How to corrupt an SQLite database file", 2.1).
    fn check_drive(&self) -> Result<()> {
        // One that is not there yet, or tells nothing, shows what it is when the database is opened.
        let Ok(about) = rustix::fs::statfs(&self.data) else { return Ok(()) };
        let Some(kind) = network_drive(about.f_type as u64) else { return Ok(()) };
        let problem = format!("lies on a network drive ({kind}), on which SQLite cannot lock its file");
        let remedy = "give a folder on a disk of this machine, or --database postgres://... for several machines";
        Err(input("--data", self.data.display(), problem, remedy))
    }

    fn given(&self) -> Result<Option<String>> {
        let Some(url) = &self.database else { return Ok(None) };
        if url.trim().is_empty() {
            let problem = "is empty; where --database is left out, the variable PERILIFE_DATABASE counts";
            return Err(input(
                "--database",
                "\"\"",
                problem,
                "unset the variable, or give for example postgres://user@host/name",
            ));
        }
        Ok(Some(url.clone()))
    }

    /// The same, of a service that begins: the folder and its file are made where they are missing.
    pub fn made(&self) -> Result<String> {
        if let Some(url) = self.given()? {
            return Ok(url);
        }
        let cannot = |error| Error::file(&self.data, "cannot create the folder", error);
        // Measured data and results are nobody else's business.
        DirBuilder::new().recursive(true).mode(0o700).create(&self.data).map_err(cannot)?;
        self.check_drive()?;
        let file = std::fs::canonicalize(&self.data).map_err(cannot)?.join(FILE);
        // Whatever the folder lets others do: the files that SQLite lays beside it get the same rights.
        match OpenOptions::new().write(true).create_new(true).mode(0o600).open(&file) {
            Err(error) if error.kind() != ErrorKind::AlreadyExists => Err(Error::file(&file, "cannot create", error)),
            _ => Ok(url_of_file(&file)),
        }
    }
}

/// What a network drive is called whose file system has this number (statfs(2)); `None` for disks of the machine.
pub fn network_drive(number: u64) -> Option<&'static str> {
    match number & 0xffff_ffff {
        0x6969 => Some("NFS"),
        0x517b | 0xff53_4d42 | 0xfe53_4d42 => Some("SMB"),
        0x0102_1997 => Some("9P"),
        0x5346_414f => Some("AFS"),
        0x00c3_6400 => Some("Ceph"),
        0x0bd0_0bd0 => Some("Lustre"),
        0x4750_4653 => Some("GPFS"),
        _ => None,
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
    /// Most memory of a job's own process, MiB
    #[arg(long, value_name = "MIB", default_value_t = 4096, value_parser = clap::value_parser!(u32).range(256..))]
    pub job_memory: u32,
    /// Most computing time of a job, h
    #[arg(long, value_name = "HOURS", default_value_t = 24.0, value_parser = hours)]
    pub job_hours: f64,
    /// Delete finished jobs after so many days of service [default: never]
    #[arg(long, value_name = "DAYS", value_parser = days)]
    pub keep_days: Option<f64>,
}

fn threads(text: &str) -> std::result::Result<usize, String> {
    let count = text.parse().ok().filter(|count| (1..=1024).contains(count));
    count.ok_or_else(|| format!("`{text}` is not 1 to 1024"))
}

fn hours(text: &str) -> std::result::Result<f64, String> {
    let hours = text.parse().ok().filter(|hours| *hours > 0.0 && *hours < 1e6);
    hours.ok_or_else(|| format!("`{text}` is no time in hours above 0"))
}

fn days(text: &str) -> std::result::Result<f64, String> {
    let days = text.parse().ok().filter(|days| *days > 0.0 && *days < 1e6);
    days.ok_or_else(|| format!("`{text}` is no time in days above 0"))
}

impl Work {
    /// How workers work.
    pub fn settings(&self) -> worker::Settings {
        let default = worker::Settings::default();
        worker::Settings {
            jobs: self.jobs.unwrap_or(default.jobs),
            threads: self.threads,
            lease: Duration::from_secs(self.lease),
            checkpoint_every: Duration::from_secs(self.checkpoint_every),
            attempts: i64::from(self.attempts),
            keep: self.keep_days.and_then(|days| Duration::try_from_secs_f64(86_400.0 * days).ok()),
            memory: u64::from(self.job_memory) << 20,
            time: Duration::try_from_secs_f64(3600.0 * self.job_hours).unwrap_or(default.time),
            program: default.program,
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
pub fn run(args: &Args) -> Result<()> {
    let (url, settings) = (args.work.place.url()?, args.work.settings());
    let place = perilife_service::without_password(&url);
    let ready = || args.console.note(&format!("perilife worker: {} jobs at a time from {place}", settings.jobs));
    perilife_service::work(&url, &settings, ready)
}
