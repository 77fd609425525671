//! `perilife chart`: speed against accuracy of every method, law, solver and resolution.

use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use super::console::Console;
use super::signals;
use perilife_base::error::{Error, Result, input, input_missing};
use perilife_base::input::Provenance;
use perilife_results::output::{LockedFolder, Marker, RunKind, Share};
use perilife_study::chart::schedule::{BenchmarkRecord, Effort, Request, measure};
use perilife_study::chart::{BenchmarkRun, Machine, scenes, schedule};
use perilife_study::speed::{self, Origin, digits, seconds};
use perilife_study::tasks::Outcome;

#[derive(Debug, clap::Args)]
pub struct Args {
    /// Scenes to run [default: all; see `perilife list`]
    #[arg(value_name = "SCENE")]
    pub names: Vec<String>,
    /// Short version (under 3 min on 2 cores)
    #[arg(long)]
    pub quick: bool,
    /// Results folder; rerun to resume an interrupted benchmark
    #[arg(long, value_name = "DIR", help_heading = "Output")]
    pub out: Option<PathBuf>,
    /// Run one scene once with the keys of --set; print time and error
    #[arg(long, conflicts_with_all = ["quick", "out"])]
    pub once: bool,
    /// Set a key for --once (repeatable), e.g. --set model.spacing_mm=2
    #[arg(long = "set", value_name = "SECTION.KEY=VALUE", requires = "once")]
    pub set: Vec<String>,
    #[command(flatten)]
    pub console: Console,
}

/// File of all runs so far, one JSON object a line.
const RUNS_FILE: &str = "runs.jsonl";
/// Seconds between two looks at a process.
const LOOK: Duration = Duration::from_millis(2);

pub fn run(args: &Args) -> Result<()> {
    if args.once {
        return once(args);
    }
    args.console.object(&measured(args)?)
}

/// Measures scenes and writes what was found: the object of `--json`.
pub fn measured(args: &Args) -> Result<Value> {
    let scenes = scenes(&args.names)?;
    let effort = if args.quick { Effort::QUICK } else { Effort::FULL };
    let folder = args.out.as_deref().map(RunsFolder::open).transpose()?;
    let known = folder.as_ref().map(|folder| folder.known()).transpose()?.unwrap_or_default();
    if let Some(folder) = &folder {
        signals::say_at_the_end(&format!("finished runs are in {}; run the same command to resume", folder.name.display()));
        if !known.is_empty() {
            args.console.note(&format!("{}: {} runs already finished", folder.name.display(), known.len()));
        }
    }
    let mut keep = |record: &BenchmarkRecord| {
        args.console.say(&line(record));
        folder.as_ref().map_or(Ok(()), |folder| folder.keep(record))
    };
    let chart = measure(&scenes, effort, known, &in_own_process, &mut keep)?;
    let origin = Origin::now(command(args));
    if let Some(folder) = &folder {
        speed::write(folder.standing.path(), &chart, &origin)?;
    }
    let object = json!({
        "version": chart.machine.version, "threads": chart.machine.threads, "reference_s": chart.reference_s,
        "points": chart.points.len(), "with_result": chart.points.iter().filter(|point| point.place().is_some()).count(),
        "files": folder.as_ref().map(|folder| folder.name.display().to_string()),
    });
    args.console.say("");
    args.console.say(&speed::markdown(&chart, &origin));
    Ok(object)
}

fn command(args: &Args) -> String {
    let quick = if args.quick { " --quick" } else { "" };
    let names = args.names.iter().map(|name| format!(" {name}")).collect::<String>();
    format!("perilife chart{quick}{names}")
}

fn line(record: &BenchmarkRecord) -> String {
    let keys = record.request.set.join(" ");
    let told = match &record.outcome {
        Outcome::Done(BenchmarkRun { wall_s, error_percent, .. }) => {
            let [error, ratio] = [*error_percent, wall_s / record.reference_s].map(digits);
            format!("{:>9} {error:>8} %  ratio {ratio}", seconds(*wall_s))
        }
        Outcome::Refused(reason) => format!("refused: {reason}"),
        Outcome::Failed(reason) => format!("failed: {reason}"),
        Outcome::Stopped(reason) => format!("stopped: {reason}"),
    };
    format!("  {:<20} {told}  {keys}", record.request.scene)
}

fn once(args: &Args) -> Result<()> {
    let [name] = args.names.as_slice() else {
        return Err(input_missing("SCENE", "is not one scene, and --once runs one".to_owned(), "name one scene"));
    };
    let panel = scenes(std::slice::from_ref(name))?[0];
    let ran = schedule::once(panel, &args.set);
    if args.console.json {
        return args.console.object(&json!(Outcome::of(ran)));
    }
    let found = ran?;
    args.console.say(&format!(
        "{}: error {} % of {}, {}, {} solves, {} MB",
        panel.name,
        digits(found.error_percent),
        panel.quantity,
        seconds(found.wall_s),
        found.solves,
        digits(found.memory_mb)
    ));
    Ok(())
}

/// Starts this program once more for one run, so that memory and caches are that run's alone.
fn in_own_process(request: &Request, limit_s: f64) -> Result<Outcome<BenchmarkRun>> {
    let failed = |source| Error::file(Path::new("perilife"), "cannot start a process of its own", source);
    let program = std::env::current_exe().map_err(failed)?;
    let mut answer = tempfile::tempfile().map_err(failed)?;
    let out = answer.try_clone().map_err(failed)?;
    let mut command = Command::new(program);
    command.args(["chart", &request.scene, "--once", "--json"]);
    for key in &request.set {
        command.args(["--set", key]);
    }
    let mut child = command.stdin(Stdio::null()).stdout(out).stderr(Stdio::null()).spawn().map_err(failed)?;
    let started = Instant::now();
    let status = loop {
        if let Some(status) = child.try_wait().map_err(failed)? {
            break status;
        }
        if started.elapsed().as_secs_f64() > limit_s {
            child.kill().and_then(|()| child.wait()).map_err(failed)?;
            return Ok(Outcome::Stopped(format!("not done after {limit_s:.0} s")));
        }
        thread::sleep(LOOK);
    };
    let mut text = String::new();
    std::io::Seek::rewind(&mut answer).and_then(|()| std::io::Read::read_to_string(&mut answer, &mut text)).map_err(failed)?;
    let ended = || Outcome::Failed(format!("its process ended without an answer: {status}"));
    Ok(serde_json::from_str(&text).unwrap_or_else(|_| ended()))
}

/// The folder of a chart: it keeps every run, which is how a chart that was broken off goes on.
#[derive(Debug)]
struct RunsFolder {
    name: PathBuf,
    standing: LockedFolder,
}

/// First line of the file of runs: runs of another version, machine or number of threads are not mixed with these.
fn header() -> String {
    json!(Machine::here()).to_string()
}

impl RunsFolder {
    fn open(path: &Path) -> Result<RunsFolder> {
        let files: Vec<&str> = speed::FILES.into_iter().chain([RUNS_FILE]).collect();
        let marker = Marker::listing(RunKind::Chart, &files);
        let first = format!("{}\n", header()).into_bytes();
        let standing = LockedFolder::open(path, &marker, &Provenance::default(), Share::Alone, &[(RUNS_FILE, first)])?;
        Ok(RunsFolder { name: path.to_path_buf(), standing })
    }

    fn file(&self) -> PathBuf {
        self.standing.path().join(RUNS_FILE)
    }

    /// Runs of an earlier call; a last line that was broken off counts for nothing.
    fn known(&self) -> Result<Vec<BenchmarkRecord>> {
        let path = self.name.join(RUNS_FILE);
        let text = fs::read_to_string(self.file()).map_err(|error| Error::file(&path, "cannot read", error))?;
        let mut lines = text.lines();
        if lines.next() != Some(header().as_str()) {
            let problem = "contains runs of another version, machine or number of threads";
            return Err(input("--out", self.name.display(), problem, "use a new folder, or delete this one"));
        }
        Ok(lines.filter_map(|line| serde_json::from_str(line).ok()).collect())
    }

    fn keep(&self, record: &BenchmarkRecord) -> Result<()> {
        let path = self.name.join(RUNS_FILE);
        let append =
            || fs::OpenOptions::new().append(true).open(self.file())?.write_all(format!("{}\n", json!(record)).as_bytes());
        append().map_err(|error| Error::file(&path, "cannot write", error))
    }
}
