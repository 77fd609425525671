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

const FILE: &str = "perilife.sqlite";

/// Where a service keeps its jobs.
#[derive(Debug, Clone, clap::Args)]
#[command(next_help_heading = "Jobs and results")]
pub struct Place {
    /// Folder of the database file; `serve` and `token add` create it
    #[arg(long, value_name = "DIR", default_value = "perilife-data", global = true)]
    pub data: PathBuf,
    /// Database URL instead, e.g. postgres://user:password@host/name
    #[arg(long, value_name = "URL", env = "PERILIFE_DATABASE", hide_env_values = true, global = true)]
    pub database: Option<String>,
}

impl Place {
    pub fn url(&self) -> Result<String> {
        if let Some(url) = self.given()? {
            return Ok(url);
        }
        self.check_drive()?;
        match std::fs::canonicalize(self.data.join(FILE)) {
            Ok(file) => Ok(url_of_file(&file)),
            Err(error) if error.kind() == ErrorKind::NotFound => {
                let remedy = "give the --data folder of `perilife serve`, which creates the database";
                Err(input(
                    "--data",
                    self.data.display(),
                    format!("contains no database of a service ({FILE} is missing)"),
                    remedy,
                ))
            }
            Err(error) => Err(Error::file(&self.data, "cannot use the folder", error)),
        }
    }

    /// Refuses drives over which SQLite cannot keep several processes apart (sqlite.org, "How to corrupt an SQLite database file", 2.1).
    fn check_drive(&self) -> Result<()> {
        // One that is not there yet, or tells nothing, shows what it is when the database is opened.
        let Ok(about) = rustix::fs::statfs(&self.data) else { return Ok(()) };
        let Some(kind) = network_drive(about.f_type as u64) else { return Ok(()) };
        let problem = format!("is on a network drive ({kind}); SQLite needs a local disk");
        let remedy = "give a folder on a disk of this machine, or --database postgres://... for several machines";
        Err(input("--data", self.data.display(), problem, remedy))
    }

    fn given(&self) -> Result<Option<String>> {
        let Some(url) = &self.database else { return Ok(None) };
        if url.trim().is_empty() {
            let problem = "is empty (PERILIFE_DATABASE, used when --database is not given)";
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
    /// Jobs in parallel [default: one per core]
    #[arg(long, value_name = "COUNT")]
    pub jobs: Option<usize>,
    /// Threads per job
    #[arg(long, value_name = "COUNT", default_value_t = 1, value_parser = threads)]
    pub threads: usize,
    /// Minimum time between checkpoints of a job, s
    #[arg(long, value_name = "SECONDS", default_value_t = 3)]
    pub checkpoint_every: u64,
    /// Lease: another worker takes the job after this silence, s
    #[arg(long, value_name = "SECONDS", default_value_t = 15, value_parser = clap::value_parser!(u64).range(2..))]
    pub lease: u64,
    /// Attempts before a job fails (workers lost without a checkpoint)
    #[arg(long, value_name = "COUNT", default_value_t = 10, value_parser = clap::value_parser!(u32).range(1..))]
    pub attempts: u32,
    /// Memory limit per job, MiB
    #[arg(long, value_name = "MIB", default_value_t = 4096, value_parser = clap::value_parser!(u32).range(256..))]
    pub job_memory: u32,
    /// Time limit per job, h
    #[arg(long, value_name = "HOURS", default_value_t = 24.0, value_parser = above_zero("hours"))]
    pub job_hours: f64,
    /// Delete finished jobs after this many days [default: never]
    #[arg(long, value_name = "DAYS", value_parser = above_zero("days"))]
    pub keep_days: Option<f64>,
}

fn threads(text: &str) -> std::result::Result<usize, String> {
    let count = text.parse().ok().filter(|count| (1..=1024).contains(count));
    count.ok_or_else(|| format!("`{text}` is not 1 to 1024"))
}

/// Reads a time in hours or days.
fn above_zero(unit: &str) -> impl Fn(&str) -> std::result::Result<f64, String> + Clone + Send + Sync + 'static + use<> {
    let wrong = format!("is not a time in {unit} above 0");
    move |text| text.parse().ok().filter(|time| *time > 0.0 && *time < 1e6).ok_or_else(|| format!("`{text}` {wrong}"))
}

impl Work {
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

#[derive(Debug, clap::Args)]
pub struct Args {
    /// Where jobs and results are kept, and who runs them.
    #[command(flatten)]
    pub work: Work,
    #[command(flatten)]
    pub console: Console,
}

/// Runs `perilife worker`, until it is asked to stop.
pub fn run(args: &Args) -> Result<()> {
    let (url, settings) = (args.work.place.url()?, args.work.settings());
    let place = perilife_service::without_password(&url);
    let ready = || args.console.note(&format!("perilife worker: {} jobs in parallel from {place}", settings.jobs));
    perilife_service::work(&url, &settings, ready)
}
