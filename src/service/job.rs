//! A job: what was asked for, how far it is, what came of it.

use std::path::Path;
use std::str::FromStr;
use std::time::{Duration, UNIX_EPOCH};

use serde::{Deserialize, Serialize};
use serde_json::Value;
use utoipa::ToSchema;

use super::problem::Problem;
use perilife_base::error::{Error, Result, input, input_missing};
use perilife_base::input::{Document, Folder};
use perilife_calibration::inspection::{FACTOR, InspectFrom};
use perilife_growth::case::remove_law;
pub use perilife_runner::Kind as JobKind;
use perilife_runner::Task;

perilife_base::kinds! {
    /// Where a job stands.
    #[derive(ToSchema)]
    #[schema(rename_all = "snake_case")]
    pub enum State for "state" {
        Queued = "queued": "Waits for a worker.",
        Running = "running": "A worker has it.",
        Succeeded = "succeeded": "Done; its results are there.",
        Failed = "failed": "Ended without a result; its problem says why.",
        Cancelled = "cancelled": "Canceled by a user.",
    }
}

impl State {
    /// Whether nothing more will happen.
    pub fn is_final(self) -> bool {
        matches!(self, State::Succeeded | State::Failed | State::Cancelled)
    }
}

/// How far a running job is.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct JobProgress {
    /// Cycles since N = 0.
    pub cycles: f64,
    pub crack_length_mm: f64,
    /// Share of the way to the end, 0 to 1.
    pub share: f64,
    /// Time spent by the worker that has it now.
    pub elapsed_s: f64,
    /// What is left at the pace so far.
    pub seconds_left: Option<f64>,
    /// What is being done before the first cycles, in words, and how much of it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stage: Option<String>,
}

/// A job as the API shows it.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct Job {
    /// Opaque; sorts by time of submission.
    pub id: String,
    /// What it does.
    pub kind: JobKind,
    /// As the one who submitted it called it, or renamed it.
    pub name: String,
    /// What somebody has noted of it; empty where nobody has.
    pub note: String,
    /// Report data, as section `[report]` of `report --data`.
    pub report: Option<Value>,
    /// Whether it was put away: lists leave it out unless asked.
    pub archived: bool,
    /// Where it stands.
    pub state: State,
    /// Name of the token it was submitted with.
    pub owner: String,
    /// Time of submission (RFC 3339).
    pub created: String,
    /// When a worker first took it.
    pub started: Option<String>,
    /// When it ended.
    pub finished: Option<String>,
    /// Workers that have taken it so far; more than one where a worker stopped or died.
    pub attempts: i64,
    /// Ends so far that were not its fault.
    pub failures: i64,
    /// Why it ended so the last time.
    pub last_failure: Option<String>,
    /// When it may be tried again, where it waits for that.
    pub next_try: Option<String>,
    /// Somebody has asked for its end.
    pub cancel_asked: bool,
    /// Jobs before it in the queue.
    pub position: Option<i64>,
    /// While it runs.
    pub progress: Option<JobProgress>,
    /// Why it failed.
    pub problem: Option<Problem>,
    /// The figures of its result.
    pub summary: Option<Value>,
    /// The calibration whose law a prediction uses.
    pub calibration: Option<String>,
    /// Counts every change.
    pub revision: i64,
}

/// What was asked for.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Submission {
    /// Name of the case.
    pub name: String,
    /// TOML, as in a file.
    pub text: String,
    /// Whether the law is that of the file [`FITTED`], whatever the text says.
    pub with_fitted: bool,
    /// Options of the command, `NAME=VALUE`; stored beside it.
    pub options: Vec<String>,
    /// Files that the text names; stored beside it.
    pub files: Vec<(String, Vec<u8>)>,
}

/// The record of a calibration among the files of a prediction that uses it.
pub const FITTED: &str = "fitted.toml";

impl Submission {
    /// Values of an option.
    fn option(&self, name: &str) -> Vec<String> {
        let value = |option: &String| Some(option.strip_prefix(name)?.strip_prefix('=')?.to_owned());
        self.options.iter().filter_map(value).collect()
    }

    /// The first value of an option.
    fn parsed<T: FromStr>(&self, name: &str) -> Result<Option<T>> {
        let wrong = |text: &String| {
            input(
                &format!("options.{name}"),
                text,
                "is not a value of this option",
                "give a number, or true or false; see JobRequest in /openapi.json",
            )
        };
        self.option(name).first().map(|text| text.parse().map_err(|_| wrong(text))).transpose()
    }

    /// What is to be run as this kind, with its options.
    pub fn task(&self, kind: JobKind, document: &Document) -> Result<Task> {
        let mut task = Task::read(kind, document, &self.option("method"))?;
        if let Some(name) = self.option("measured").first() {
            task.read_plate(document, Path::new(name), &document.folder.read(name)?)?;
        }
        if let Task::Prediction { wanted, .. } = &mut task {
            let is_set = |name| Ok::<_, Error>(self.parsed(name)?.unwrap_or(false));
            (wanted.strength, wanted.asked.sensitivities) = (is_set("residual_strength")?, is_set("sensitivities")?);
            wanted.asked.detection = self.option("pod").first().map(|text| text.parse()).transpose()?;
            let (tip, factor) = (self.parsed("tip")?, self.parsed("factor")?.unwrap_or(FACTOR));
            let names = ["options.inspect_from_mm", "options.factor", "options.tip"];
            let from = |crack_length_mm| InspectFrom { crack_length_mm, tip, factor, names };
            wanted.inspection = self.parsed("inspect_from_mm")?.map(from);
            let needs = ["pod", "tip", "factor"].into_iter().find(|name| !self.option(name).is_empty());
            if let (None, Some(name)) = (&wanted.inspection, needs) {
                let problem = format!("is missing: options.{name} needs it");
                return Err(input_missing("options.inspect_from_mm", problem, "give a crack length, mm"));
            }
        }
        Ok(task)
    }

    /// The text as a parsed document.
    pub fn document(&self) -> Result<Document> {
        let mut document = Document::parse(&self.text, &self.name, Folder::at_hand(self.files.iter().cloned()), &[])?;
        if self.with_fitted {
            remove_law(&mut document.table);
            let fatigue = document.table.entry("fatigue").or_insert_with(|| toml::Table::new().into());
            if let Some(fatigue) = fatigue.as_table_mut() {
                fatigue.insert("fitted".to_owned(), FITTED.into());
            }
        }
        Ok(document)
    }
}

/// Milliseconds since 1970 as RFC 3339 in UTC.
pub fn time(milliseconds: i64) -> String {
    let since = Duration::from_millis(milliseconds.try_into().unwrap_or(0));
    humantime::format_rfc3339_millis(UNIX_EPOCH + since).to_string()
}

/// Whether a job can have this id. Anything else never gets to the database.
pub fn is_id(id: &str) -> bool {
    uuid::Uuid::try_parse(id).is_ok()
}
