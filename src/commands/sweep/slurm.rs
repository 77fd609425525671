//! Cases of a sweep by Slurm: one array job, each of whose tasks runs a part of the sweep.

use std::fs;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::{Command, Stdio};

use super::Shard;
use perilife_base::error::{Error, Result, input};
use perilife_calibration::sweep::DrawnCase;
use perilife_results::output::write_file;
use perilife_runner::sweep_folder::{LOGS, SCRIPT_FILE, SweepFolder};

/// Most tasks of an array unless the user asks for smaller ones: Slurm's own default limit is 1001.
const TASKS_MAX: usize = 1000;
/// Options for Slurm.
#[derive(Debug, Clone, Default, clap::Args)]
#[command(next_help_heading = "Slurm")]
pub struct Args {
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

/// Submits the cases that are left, and waits for them if that is asked for; whether all that can be collected is there.
pub fn submit(args: &super::Args, folder: &SweepFolder, left: &[&DrawnCase]) -> Result<bool> {
    if left.is_empty() {
        return Ok(true);
    }
    let all = folder.plan.cases.len();
    let per_task = args.slurm.cases_per_task.unwrap_or_else(|| all.div_ceil(TASKS_MAX));
    if per_task == 0 {
        return Err(input("--cases-per-task", per_task, "must be at least 1", "give at least 1"));
    }
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
fn sbatch(args: &super::Args, script: &Path, count: usize) -> Result<bool> {
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
    if job.is_empty() {
        return Err(cannot(std::io::Error::other(format!("{status}: {words}"))));
    }
    if !status.success() {
        console.warn(&format!("job {job}: a task failed ({status}) {words}; see {LOGS}"));
    }
    Ok(args.slurm.wait)
}

/// The array job. Paths are absolute, since a task may begin in another folder.
fn script_text(args: &super::Args, folder: &SweepFolder, count: usize, array: &str) -> Result<String> {
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
