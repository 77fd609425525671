//! What a command prints: results on stdout, warnings, progress and errors on stderr, all in the units that are shown.

use std::io::{self, IsTerminal, Write};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use indicatif::{MultiProgress, ProgressBar, ProgressFinish, ProgressState, ProgressStyle};
use miette::{GraphicalReportHandler, LabeledSpan, MietteDiagnostic, NamedSource, Report};
use serde_json::{Value, json};

use perilife_base::error::{Error, InputError, Result};
use perilife_base::units::MM;
use perilife_base::units::shown::{told, told_of_file};
use perilife_base::watch::Watch;
use perilife_growth::predict::{Observer, Progress};
use perilife_results::format::{PLAIN, shown_result};
use perilife_results::output::OutputFolder;
use perilife_runner::scenes::{SceneObserver, SceneProgress};
use perilife_runner::{Message, Summary, Watcher};

/// Options of every command that prints results.
#[derive(Debug, Clone, Copy, Default, clap::Args)]
#[command(next_help_heading = "Output options")]
pub struct Console {
    /// Print the result as JSON
    #[arg(long, global = true)]
    pub json: bool,
    /// Print the first line of the result alone
    #[arg(long, short, global = true)]
    pub quiet: bool,
    /// Print all messages and details; -vv for debug (RUST_LOG overrides)
    #[arg(long, short, action = clap::ArgAction::Count, global = true)]
    pub verbose: u8,
}

impl Console {
    /// A line of the summary on stdout.
    pub fn say(&self, line: &str) {
        if !self.quiet && !self.json {
            // Nobody is left to read when stdout is closed (`| head`); the result files are what counts.
            let _ = writeln!(io::stdout(), "{}", told(line));
        }
    }

    /// A line on stderr that is no warning.
    pub fn note(&self, text: &str) {
        if !self.quiet {
            let _ = writeln!(io::stderr(), "{}", told(text));
        }
    }

    pub fn warn(&self, text: &str) {
        let _ = writeln!(io::stderr(), "warning: {}", told(text));
    }

    /// Prints the warnings of an input whose run has no result.
    pub fn warn_all(&self, lines: &[String]) {
        lines.iter().for_each(|line| self.warn(line));
    }

    /// A result that was asked for on stdout and stands in no file, in the units that are shown, unless `--json` replaces it.
    pub fn result(&self, text: &str) -> Result<()> {
        if self.json { Ok(()) } else { to_stdout(text) }
    }

    /// The JSON object on stdout, if it was asked for.
    pub fn object(&self, object: &Value) -> Result<()> {
        if !self.json {
            return Ok(());
        }
        HAS_OBJECT.store(true, Ordering::Relaxed);
        to_stdout(&format!("{:#}\n", shown_result(object)))
    }

    /// Tables and words of a run, the answer first, then its messages.
    pub fn print(&self, summary: Summary) -> Result<Summary> {
        self.result(&summary.printed)?;
        match summary.lines.first().filter(|_| self.quiet) {
            Some(first) => self.result(&format!("{}\n", told(first)))?,
            None => {
                let details = summary.details.iter().filter(|_| self.verbose > 0);
                summary.lines.iter().chain(details).for_each(|line| self.say(line));
            }
        }
        self.messages(&summary.messages);
        Ok(summary)
    }

    /// Messages on stderr: their number and the first, or all of them.
    pub fn messages(&self, messages: &[Message]) {
        let fix =
            |message: &Message, before: &str| message.remedy.as_ref().map_or_else(String::new, |fix| format!("{before}{fix}"));
        match messages {
            [] => {}
            _ if self.verbose > 0 => messages.iter().for_each(|message| {
                self.note(&format!("{:<10} {}{}", message.kind, message.text, fix(message, "\n           fix: ")));
            }),
            [one] => self.note(&format!("1 message: {}{}", one.text, fix(one, "; "))),
            [first, ..] => self.note(&format!("{} messages, first: {}. -v lists all.", messages.len(), first.text)),
        }
    }

    /// Fills the claimed folder by a run, puts it in place and prints the result; `warnings` are those of its input.
    pub fn keep(
        &self,
        mut folder: OutputFolder,
        warnings: &[String],
        work: impl FnOnce(&Path) -> Result<Summary>,
    ) -> Result<Summary> {
        warnings.iter().map(String::as_str).chain(folder.warning()).for_each(|warning| self.warn(warning));
        let mut summary = folder.fill(work)?;
        summary.lines.push(format!("  Results        {}", folder.name().display()));
        drop(folder.finish()?);
        self.print(summary)
    }

    pub fn progress(&self, name: &str) -> RunProgress {
        self.progress_within(name, None)
    }

    /// The same for a run that is asked to end after so long.
    pub fn progress_within(&self, name: &str, limit: Option<Duration>) -> RunProgress {
        RunProgress::new(self.bar(name, STEPS, "{prefix}  {bar:30} {percent:>3} %  {msg}{left}"), limit)
    }

    /// A bar on stderr that counts to `total`, drawn only on a terminal.
    pub fn count(&self, name: &str, total: usize) -> ProgressBar {
        self.bar(name, total as u64, "{prefix}  {bar:30} {pos} of {len}{left}")
    }

    /// A bar that goes when it is dropped.
    fn bar(&self, name: &str, steps: u64, template: &str) -> ProgressBar {
        let bar = if self.quiet || !io::stderr().is_terminal() { ProgressBar::hidden() } else { ProgressBar::new(steps) };
        let style = ProgressStyle::with_template(template);
        // The template is fixed, so it either always parses or a look at the screen shows the plain bar.
        let left = |state: &ProgressState, out: &mut dyn std::fmt::Write| {
            // There is no estimate before there is progress.
            let seconds = if state.pos() > 0 { state.eta().as_secs() } else { 0 };
            let _ = if seconds > 0 { write!(out, "  {seconds} s left") } else { Ok(()) };
        };
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()).with_key("left", left));
        bar.set_prefix(name.to_owned());
        bar.with_finish(ProgressFinish::AndClear)
    }

    /// A progress bar for each of several runs side by side, one below the other.
    pub fn progress_of_each<'a>(&self, names: impl Iterator<Item = &'a str>) -> Vec<RunProgress> {
        let bars: Vec<RunProgress> = names.map(|name| self.progress(name)).collect();
        if bars.iter().any(|run| !run.bar().is_hidden()) {
            let screen = MultiProgress::new();
            bars.iter().for_each(|run| drop(screen.add(run.bar().clone())));
        }
        bars
    }
}

impl Observer for Console {}
impl SceneObserver for Console {}

impl Watcher for Console {
    fn warn(&self, warning: &str) {
        Console::warn(self, warning);
    }
}

fn to_stdout(text: &str) -> Result<()> {
    let mut stdout = io::stdout().lock();
    match stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(Error::file(Path::new("stdout"), "cannot write", error)),
        _ => Ok(()),
    }
}

const STEPS: u64 = 1000;

static HAS_OBJECT: AtomicBool = AtomicBool::new(false);

/// Prints an error as a JSON object on stdout, if no other object is there.
pub fn print_error_object(error: &Error) {
    let of_problem = |file, problem| vec![InputError { file, problem, ..InputError::default() }];
    let each = match error {
        Error::Input(input) => input.clone().each(),
        Error::File { path, action, source } => of_problem(Some(path.clone()), format!("{action}: {source}")),
        _ => of_problem(None, error.to_string()),
    };
    let object = |one: &InputError| {
        json!({
            "code": error.exit_code(), "file": one.file, "line": one.line, "key": one.key, "value": one.value,
            "problem": told_of_file(&one.problem), "fix": told_of_file(&one.remedy),
        })
    };
    let mut first = object(&each[0]);
    first["more"] = each[1..].iter().map(object).collect();
    if !HAS_OBJECT.load(Ordering::Relaxed) {
        // The exit code is the same if stdout is closed.
        let _ = to_stdout(&format!("{:#}\n", json!({ "error": first })));
    }
}

pub fn error_words(error: &Error) -> String {
    let Error::Input(input) = error else { return told(&format!("error: {error}")) };
    let shown = std::io::stderr().is_terminal().then(|| with_source_line(input)).flatten();
    shown.unwrap_or_else(|| told_of_file(&format!("error: {error}")))
}

/// The message with the file's line shown; `None` if file or line are not known or the file has gone.
pub fn with_source_line(input: &InputError) -> Option<String> {
    let (file, line) = (input.file.as_ref().filter(|_| input.more.is_empty())?, input.line?);
    // A pipe is empty by now, and a terminal would wait.
    let text = Some(file).filter(|file| file.is_file()).and_then(|file| std::fs::read_to_string(file).ok())?;
    let start: usize = text.split_inclusive('\n').take(line.checked_sub(1)?).map(str::len).sum();
    let length = text.lines().nth(line - 1)?.len();
    // Where the trouble stands is part of the message already; the shown line takes their place.
    let message = told_of_file(&InputError { file: None, line: None, remedy: String::new(), ..input.clone() }.to_string());
    let label = LabeledSpan::new(Some("here".to_owned()), start, length);
    let mut shown = MietteDiagnostic::new(message).with_label(label);
    if !input.remedy.is_empty() {
        shown = shown.with_help(told_of_file(&input.remedy));
    }
    let report = Report::from(shown).with_source_code(NamedSource::new(file.display().to_string(), text));
    let mut words = String::new();
    GraphicalReportHandler::new().render_report(&mut words, report.as_ref()).ok()?;
    Some(words)
}

/// Time between two looks at what a run does.
const LOOK_EVERY: Duration = Duration::from_millis(100);

/// Shows a run's cycles, crack length, share and time left; the bar goes when the value is dropped.
#[derive(Debug)]
pub struct RunProgress {
    bar: ProgressBar,
    shared: Arc<Shared>,
    /// Looks at the run from beside it; none where nobody would see it and nothing limits it.
    looker: Option<JoinHandle<()>>,
}

#[derive(Debug, Default)]
struct Shared {
    watch: Arc<Watch>,
    has_rows: AtomicBool,
    is_over: AtomicBool,
    ran_out: AtomicBool,
}

impl RunProgress {
    pub fn new(bar: ProgressBar, limit: Option<Duration>) -> Self {
        let shared = Arc::new(Shared::default());
        let is_looked_at = !bar.is_hidden() || limit.is_some();
        let (shown, known) = (bar.clone(), shared.clone());
        let looker = is_looked_at.then(|| std::thread::spawn(move || look(&shown, &known, limit)));
        RunProgress { bar, shared, looker }
    }

    pub fn bar(&self) -> &ProgressBar {
        &self.bar
    }

    /// Whether the time was over before the run was.
    pub fn ran_out(&self) -> bool {
        self.shared.ran_out.load(Ordering::Relaxed)
    }

    fn advance(&self, share: f64, message: Option<String>) -> bool {
        self.shared.has_rows.store(true, Ordering::Relaxed);
        let share = if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.0 };
        self.bar.set_message(message.unwrap_or_default());
        self.bar.set_position((share * STEPS as f64) as u64);
        !self.shared.watch.is_cancelled()
    }
}

/// Shows what a run does before it has rows, and asks it to end when its time is over.
fn look(bar: &ProgressBar, shared: &Shared, limit: Option<Duration>) {
    let begun = Instant::now();
    while !shared.is_over.load(Ordering::Relaxed) {
        if limit.is_some_and(|limit| begun.elapsed() >= limit) && !shared.ran_out.swap(true, Ordering::Relaxed) {
            shared.watch.cancel();
        }
        if !shared.has_rows.load(Ordering::Relaxed)
            && let Some((stage, share)) = shared.watch.now()
        {
            bar.set_message(format!("{} {:.0} %", stage.words(), 100.0 * share));
            bar.tick();
        }
        let left =
            limit.map_or(LOOK_EVERY, |limit| limit.saturating_sub(begun.elapsed()).clamp(Duration::from_millis(1), LOOK_EVERY));
        std::thread::park_timeout(left);
    }
}

impl Observer for RunProgress {
    fn block_done(&self, progress: &Progress) -> bool {
        let (cycles, length) = (PLAIN.whole(progress.cycles), progress.crack_length / MM);
        self.advance(progress.share, Some(told(&format!("N = {cycles}  a = {length:.1} mm"))))
    }

    fn watch(&self) -> Option<Arc<Watch>> {
        Some(self.shared.watch.clone())
    }
}

impl SceneObserver for RunProgress {
    fn step_done(&self, progress: &SceneProgress) -> bool {
        self.advance(progress.share, None)
    }

    fn watch(&self) -> Option<Arc<Watch>> {
        Some(self.shared.watch.clone())
    }
}

impl Watcher for RunProgress {
    fn warn(&self, warning: &str) {
        self.bar.suspend(|| Console::default().warn(warning));
    }
}

impl Drop for RunProgress {
    fn drop(&mut self) {
        self.shared.is_over.store(true, Ordering::Relaxed);
        if let Some(looker) = self.looker.take() {
            looker.thread().unpark();
            // It ends at once, and has nothing to say.
            let _ = looker.join();
        }
    }
}
