//! One run of whatever kind, kept so that its tables can be read and its files written later.

use std::path::PathBuf;

use perilife_base::error::Result;
use perilife_base::input::Provenance;
use perilife_results::output::OutputFolder;
use perilife_runner::{Summary, Task};
use pyo3::prelude::*;

use crate::errors::raised;
use crate::watcher::Told;

#[pyclass(frozen, module = "perilife._perilife")]
pub struct Run {
    task: Task,
    summary: Summary,
    read: Provenance,
    /// Content of `result.json` or `fit.json`.
    #[pyo3(get)]
    result: String,
    /// The result in words.
    #[pyo3(get)]
    lines: Vec<String>,
    /// What the user should know.
    #[pyo3(get)]
    warnings: Vec<String>,
}

impl Run {
    /// Runs a task.
    /// Errors: as [`perilife_runner::of`]; a run that does not count.
    pub fn of(task: Task, read: Provenance, told: &Told) -> Result<Self> {
        let summary = perilife_runner::of(&task, None, None, told)?.counted()?;
        let messages = summary.messages.iter().map(|message| message.text.clone());
        let warnings = messages.chain(task.warnings().iter().cloned()).chain(told.warnings()).collect();
        let lines = summary.printed.lines().map(str::to_owned).chain(summary.lines.iter().cloned()).collect();
        Ok(Run { read, result: summary.result.to_string(), lines, warnings, summary, task })
    }
}

#[pymethods]
impl Run {
    /// Texts of its tables by the names of their files.
    fn tables(&self, py: Python<'_>) -> PyResult<Vec<(String, String)>> {
        py.detach(|| self.summary.tables(&self.task)).map_err(raised)
    }

    /// Writes what its command writes into `--out`; results of another input are replaced by `force` alone.
    #[pyo3(signature = (folder, force=false))]
    fn save(&self, py: Python<'_>, folder: PathBuf, force: bool) -> PyResult<()> {
        let save = || {
            let mut claimed = OutputFolder::claim(&folder, self.task.run_kind(), &self.read, self.task.room(), force)?;
            claimed.fill(|path| self.summary.write(&self.task, path))?;
            claimed.finish().map(drop)
        };
        py.detach(save).map_err(raised)
    }
}
