//! What a command prints: results on stdout, warnings and progress on stderr.

use std::io::{self, IsTerminal, Write};
use std::path::Path;
use std::time::Duration;

use indicatif::{MultiProgress, ProgressBar, ProgressStyle};
use serde_json::Value;

pub use super::run_progress::RunProgress;

use crate::error::{Error, Result};

/// Options of every command that prints results.
#[derive(Debug, Clone, Copy, Default, clap::Args)]
#[command(next_help_heading = "What is printed")]
pub struct Console {
    /// Print one JSON object on stdout and nothing else there
    #[arg(long, global = true)]
    pub json: bool,
    /// Print no summary and no progress bar; warnings stay
    #[arg(long, short, global = true)]
    pub quiet: bool,
}

impl Console {
    /// A line of the summary on stdout.
    pub fn say(&self, line: &str) {
        if !self.quiet && !self.json {
            // Nobody is left to read when stdout is closed (`| head`); the result files are what counts.
            let _ = writeln!(io::stdout(), "{line}");
        }
    }

    /// A line on stderr that is no warning.
    pub fn note(&self, text: &str) {
        if !self.quiet {
            let _ = writeln!(io::stderr(), "{text}");
        }
    }

    /// A warning on stderr.
    pub fn warn(&self, text: &str) {
        let _ = writeln!(io::stderr(), "warning: {text}");
    }

    /// A result that was asked for on stdout and stands in no file, unless `--json` replaces it.
    ///
    /// # Errors
    /// [`Error::File`] if stdout cannot be written; a closed pipe is no trouble.
    pub fn result(&self, text: &str) -> Result<()> {
        if self.json { Ok(()) } else { to_stdout(text) }
    }

    /// The JSON object on stdout, if it was asked for.
    ///
    /// # Errors
    /// [`Error::File`] if stdout cannot be written; a closed pipe is no trouble.
    pub fn object(&self, object: &Value) -> Result<()> {
        if self.json { to_stdout(&format!("{object:#}\n")) } else { Ok(()) }
    }

    /// A progress bar on stderr, drawn only on a terminal.
    pub fn progress(&self, name: &str) -> RunProgress {
        self.progress_within(name, None)
    }

    /// The same for a run that is asked to end after so long.
    pub fn progress_within(&self, name: &str, limit: Option<Duration>) -> RunProgress {
        let bar = if self.quiet || !io::stderr().is_terminal() { ProgressBar::hidden() } else { ProgressBar::new(STEPS) };
        let style = ProgressStyle::with_template("{prefix} {bar:30} {percent:>3} %  {msg}  {eta} left");
        // The template is fixed, so it either always parses or a look at the screen shows the plain bar.
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        bar.set_prefix(name.to_owned());
        RunProgress::new(bar, limit)
    }

    /// A bar on stderr that counts to `total`, drawn only on a terminal.
    pub fn count(&self, name: &str, total: usize) -> Count {
        let bar = if self.quiet || !io::stderr().is_terminal() { ProgressBar::hidden() } else { ProgressBar::new(total as u64) };
        let style = ProgressStyle::with_template("{prefix} {bar:30} {pos} of {len}  {eta} left");
        // As for the bar of a run.
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        bar.set_prefix(name.to_owned());
        Count { bar }
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

fn to_stdout(text: &str) -> Result<()> {
    let mut stdout = io::stdout().lock();
    match stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(Error::file(Path::new("stdout"), "cannot write", error)),
        _ => Ok(()),
    }
}

/// Steps of a full bar.
pub(super) const STEPS: u64 = 1000;

/// Counts what is done; the bar goes when the value is dropped.
#[derive(Debug)]
pub struct Count {
    bar: ProgressBar,
}

impl Count {
    /// One more.
    pub fn one(&self) {
        self.bar.inc(1);
    }
}

impl Drop for Count {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
