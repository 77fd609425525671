//! `perilife sweep`: many cases of one, run here, by a service or by Slurm, to one table.

#[cfg(feature = "service")]
mod service;

use std::fs;
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::str::FromStr;
use std::time::Instant;

use super::console::Console;
use super::signals;
#[cfg(feature = "service")]
use super::worker::Place;
use perilife_base::error::{Error, Result, fail_if, input};
use perilife_base::input::Document;
use perilife_calibration::sweep::design::CASES_MAX;
use perilife_calibration::sweep::{DrawnCase, Sweep};
use perilife_results::output::{Share, write_file};
use perilife_results::sweep::Plan;
use perilife_runner::Task;
use perilife_runner::sweep::{LOGS, SCRIPT_FILE, SweepFolder, collect, run as run_here};

#[derive(Debug, clap::Args)]
#[command(
    after_long_help = "Designs: a grid over any keys, latin_hypercube over distributions, or fitted_scatter: laws sampled from the scatter of the\n\
                       specimens of a calibration, or from the errors of one fit. Examples: data/sweeps of the source.\n\
                       DIR contains sweep.csv with a row for each case, sweep.json with quantiles of life, life.svg, and the files of each in cases/."
)]
pub struct Args {
    /// Sweep file
    #[arg(value_name = "SWEEP.toml")]
    pub sweep: PathBuf,
    /// Results folder; rerun to resume an interrupted sweep
    #[arg(long, value_name = "DIR", help_heading = "Output")]
    pub out: PathBuf,
    /// Set a key (repeatable), e.g. --set design.samples=50
    #[arg(long = "set", value_name = "SECTION.KEY=VALUE", help_heading = "Input")]
    pub set: Vec<String>,
    /// Maximum number of cases
    #[arg(long, value_name = "COUNT", default_value_t = CASES_MAX, help_heading = "Input")]
    pub most: usize,
    /// Write the summary table only
    #[arg(long, help_heading = "Output")]
    pub summary_only: bool,
    /// Where the cases run
    #[arg(long, value_enum, default_value_t = Engine::Local, help_heading = "Execution")]
    pub engine: Engine,
    /// Cases in parallel on this machine [default: one per core]
    #[arg(long, value_name = "COUNT", help_heading = "Execution")]
    pub threads: Option<usize>,
    /// Run shard I of N; merge the shards with `perilife collect`
    #[arg(long, value_name = "I/N", help_heading = "Execution")]
    pub shard: Option<Shard>,
    /// How Slurm is asked.
    #[command(flatten)]
    pub slurm: SlurmArgs,
    /// Where a service keeps its jobs.
    #[cfg(feature = "service")]
    #[command(flatten)]
    pub place: Place,
    #[command(flatten)]
    pub console: Console,
}

/// Who runs the cases.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Engine {
    /// Cores of this machine
    Local,
    /// Workers of a service, through its database (--database or --data)
    #[cfg(feature = "service")]
    Service,
    /// Slurm array job; nodes share the folder
    Slurm,
}

/// Part of a sweep: every n-th case from the i-th on, so that neighbours, which take about as long, go to different parts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    /// Number, from 1.
    pub number: usize,
    pub of: usize,
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let parsed = text.split_once('/').and_then(|(i, n)| Some(Shard { number: i.parse().ok()?, of: n.parse().ok()? }));
        let fits = |shard: &Shard| (1..=shard.of).contains(&shard.number);
        parsed.filter(fits).ok_or_else(|| format!("`{text}` is not I/N with I from 1 to N, such as 3/16"))
    }
}

impl Shard {
    pub fn has(self, number: usize) -> bool {
        (number - 1) % self.of == self.number - 1
    }
}

pub fn run(args: &Args) -> Result<()> {
    let begun = Instant::now();
    let Task::Sweep { sweep, cases } = Task::sweep(Document::read(&args.sweep, &[])?, &args.set, args.most)? else {
        return Ok(());
    };
    let plan = Plan::new(&sweep, &cases);
    let read = sweep.document.folder.opened().so_far();
    if let Some(shard) = args.shard {
        return run_part(args, shard, &sweep, &cases, SweepFolder::open_part(&args.out, plan, &read)?);
    }
    // Tasks of an earlier call of Slurm may still run, and those of this one will.
    let share = if args.engine == Engine::Slurm { Share::Parts } else { Share::Alone };
    let folder = SweepFolder::open(&args.out, plan, &read, share)?;
    if let Some(changed) = &folder.changed {
        args.console.warn(&format!("sweep: {}: {changed}", args.out.display()));
    }
    signals::say_at_the_end(&format!("finished cases are in {}; run the same command to resume", args.out.display()));
    let left = left(&cases, &folder, !args.summary_only);
    if left.len() < cases.len() {
        args.console.note(&format!("{}: {} of {} cases already finished", sweep.name, cases.len() - left.len(), cases.len()));
    }
    match args.engine {
        Engine::Local => {
            let count = args.console.count(&sweep.name, left.len());
            run_here(&left, &folder, threads(args), !args.summary_only, &|| count.inc(1))?;
        }
        #[cfg(feature = "service")]
        Engine::Service => {
            let url = args.place.url()?;
            let place = perilife_service::without_password(&url);
            args.console.note(&format!("{} jobs queued at {place}; they continue if you interrupt this command", left.len()));
            service::run(&url, &left, &folder, !args.summary_only, &args.console.count(&sweep.name, left.len()))?;
        }
        Engine::Slurm if !submit(args, &folder, &left)? => return Ok(()),
        Engine::Slurm => {}
    }
    finish(&folder, begun, &args.console)
}

/// Writes table, figures and picture of what is there, and says what it is.
pub fn finish(folder: &SweepFolder, begun: Instant, console: &Console) -> Result<()> {
    let summary = console.print(collect(folder, begun, console)?)?;
    console.object(&summary.result)?;
    summary.counted().map(drop)
}

fn left<'a>(cases: &'a [DrawnCase], folder: &SweepFolder, with_files: bool) -> Vec<&'a DrawnCase> {
    cases.iter().filter(|case| !folder.is_done(case.number, with_files)).collect()
}

fn threads(args: &Args) -> usize {
    let cores = || std::thread::available_parallelism().map_or(1, usize::from);
    args.threads.unwrap_or_else(cores).max(1)
}

/// Runs one part and leaves the gathering to `perilife collect`.
fn run_part(args: &Args, shard: Shard, sweep: &Sweep, cases: &[DrawnCase], folder: SweepFolder) -> Result<()> {
    let own = || cases.iter().filter(|case| shard.has(case.number));
    let left: Vec<&DrawnCase> = own().filter(|case| !folder.is_done(case.number, !args.summary_only)).collect();
    let name = format!("{} {}/{}", sweep.name, shard.number, shard.of);
    let count = args.console.count(&name, left.len());
    run_here(&left, &folder, threads(args), !args.summary_only, &|| count.inc(1))?;
    let failed = own().filter(|case| folder.outcome(case.number).is_some_and(|outcome| outcome.problem.is_some())).count();
    let line = format!("{name}: {} cases, {} run, {failed} failed", own().count(), left.len());
    args.console.say(&line);
    args.console.object(&serde_json::json!({
        "name": sweep.name, "shard": shard.number, "shards": shard.of,
        "cases": own().count(), "run": left.len(), "failed": failed,
    }))
}

/// Most tasks of an array unless the user asks for smaller ones: Slurm's own default limit is 1001.
const TASKS_MAX: usize = 1000;
/// Options for Slurm.
#[derive(Debug, Clone, Default, clap::Args)]
#[command(next_help_heading = "Slurm")]
pub struct SlurmArgs {
    /// Cases per array task [default: fewest for at most 1000 tasks]
    #[arg(long, value_name = "COUNT")]
    pub cases_per_task: Option<usize>,
    /// sbatch option (repeatable), e.g. --sbatch-option=--time=02:00:00
    #[arg(long, value_name = "OPTION", allow_hyphen_values = true)]
    pub sbatch_option: Vec<String>,
    /// Wait for the array, then collect
    #[arg(long)]
    pub wait: bool,
}

pub fn submit(args: &Args, folder: &SweepFolder, left: &[&DrawnCase]) -> Result<bool> {
    if left.is_empty() {
        return Ok(true);
    }
    let all = folder.plan.cases.len();
    let per_task = args.slurm.cases_per_task.unwrap_or_else(|| all.div_ceil(TASKS_MAX));
    fail_if!(per_task == 0, input("--cases-per-task", per_task, "must be at least 1", "give at least 1"));
    let count = all.div_ceil(per_task);
    let is_needed = |number: &usize| left.iter().any(|case| Shard { number: *number, of: count }.has(case.number));
    let needed: Vec<usize> = (1..=count).filter(is_needed).collect();
    let logs = folder.path.join(LOGS);
    fs::create_dir_all(&logs).map_err(|error| Error::file(&logs, "cannot create the folder", error))?;
    let script = folder.path.join(SCRIPT_FILE);
    write_file(&script, script_text(args, folder, count, &ranges(&needed))?.as_bytes())?;
    sbatch(args, &script, count)
}

/// Calls sbatch, says the number of the job, and waits if that is asked for.
fn sbatch(args: &Args, script: &Path, count: usize) -> Result<bool> {
    let cannot = |error| Error::file(Path::new("sbatch"), "cannot be run (is this a login node of Slurm?)", error);
    let mut command = Command::new("sbatch");
    command.arg("--parsable").args(args.slurm.wait.then_some("--wait")).args(&args.slurm.sbatch_option).arg(script);
    let mut process = command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().map_err(cannot)?;
    // Both were asked for as pipes just now.
    let (stdout, mut stderr) = (process.stdout.take(), process.stderr.take());
    let mut job = String::new();
    if let Some(stdout) = stdout {
        BufReader::new(stdout).read_line(&mut job).map_err(cannot)?;
    }
    // With a cluster it is `number;cluster`.
    let job = job.trim().split(';').next().unwrap_or_default().to_owned();
    let console = &args.console;
    if !job.is_empty() {
        console.say(&format!("job {job}: {count} tasks, results in {}", args.out.display()));
        if !args.slurm.wait {
            console.say(&format!("  when it is done: perilife collect {}", args.out.display()));
            console.object(&serde_json::json!({ "job": job, "tasks": count, "out": args.out }))?;
        }
    }
    let mut words = String::new();
    if let Some(stderr) = &mut stderr {
        stderr.read_to_string(&mut words).map_err(cannot)?;
    }
    let status = process.wait().map_err(cannot)?;
    let words = words.trim().replace('\n', "; ");
    fail_if!(job.is_empty(), cannot(std::io::Error::other(format!("{status}: {words}"))));
    if !status.success() {
        console.warn(&format!("sweep: job {job}: a task failed ({status}) {words}; see {LOGS}"));
    }
    Ok(args.slurm.wait)
}

/// The array job. Paths are absolute, since a task may begin in another folder.
fn script_text(args: &Args, folder: &SweepFolder, count: usize, array: &str) -> Result<String> {
    let absolute = |path: &Path| fs::canonicalize(path).map_err(|error| Error::file(path, "cannot be found", error));
    let program = std::env::current_exe().map_err(|error| Error::file(Path::new("perilife"), "cannot be found", error))?;
    let out = absolute(&folder.path)?;
    let mut words = vec![
        quoted(&program),
        "sweep".to_owned(),
        quoted(&absolute(&args.sweep)?),
        "--out".to_owned(),
        quoted(&out),
        format!("--shard \"$SLURM_ARRAY_TASK_ID/{count}\""),
        "--threads \"${SLURM_CPUS_PER_TASK:-1}\"".to_owned(),
        format!("--most {}", args.most),
    ];
    words.extend(args.set.iter().map(|set| format!("--set {}", quoted(Path::new(set)))));
    words.extend(args.summary_only.then(|| "--summary-only".to_owned()));
    let logs = out.join(LOGS).join("%A_%a.log");
    // Options on the command line of sbatch go before these.
    Ok(format!(
        "#!/bin/sh\n#SBATCH --job-name=perilife\n#SBATCH --array={array}\n#SBATCH --cpus-per-task=1\n#SBATCH --output={}\nexec {}\n",
        quoted(&logs),
        words.join(" ")
    ))
}

/// A word of a shell.
fn quoted(path: &Path) -> String {
    format!("'{}'", path.to_string_lossy().replace('\'', "'\\''"))
}

/// Numbers as Slurm writes them: `1-4,7`.
fn ranges(numbers: &[usize]) -> String {
    let mut runs: Vec<(usize, usize)> = Vec::new();
    for &number in numbers {
        match runs.last_mut() {
            Some((_, last)) if *last + 1 == number => *last = number,
            _ => runs.push((number, number)),
        }
    }
    let word = |(first, last): (usize, usize)| if first == last { first.to_string() } else { format!("{first}-{last}") };
    runs.into_iter().map(word).collect::<Vec<_>>().join(",")
}
