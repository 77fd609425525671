//! A job: what was asked for, how far it is, what came of it.
//!
//! What comes from outside may take any time and memory, so that a process of its own looks at it where it is large.

use std::collections::BTreeMap;
use std::path::Path;
use std::str::FromStr;
use std::time::{Duration, UNIX_EPOCH};

use serde::{Deserialize, Serialize};
use serde_json::Value;
use utoipa::ToSchema;

use super::problem::{Answer, Place, Problem};
use perilife_base::error::{Error, Result, input, input_missing};
use perilife_base::input::{Document, Folder};
use perilife_base::keys::{Field, Key};
use perilife_base::table::units::{CycleUnit, LengthUnit, LoadUnit};
use perilife_base::table::{Decimal, Sheet};
use perilife_base::units::MM;
use perilife_calibration::inspection::{FACTOR, InspectFrom};
use perilife_calibration::preamble::Preamble;
use perilife_growth::case::remove_law;
use perilife_measured::{Column, Import, Layout, MeasuredCurve, Named, Shape, Survey, survey};
use perilife_results::chart::Size;
pub use perilife_runner::Kind as JobKind;
use perilife_runner::{Task, check};

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

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Submission {
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

/// Size of the drawing of a plate beside its form.
const DRAWING: Size = Size { width: 620.0, height: 330.0, text: 12.0 };
/// Cases of a sweep that are looked at before it is accepted.
const LOOKED_AT: usize = 100;

/// What is to be looked at.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub enum Look {
    /// Files of readings: what was found in them.
    Measured {
        /// What the user says of them, by [`FIELDS`].
        fields: BTreeMap<String, String>,
        /// Name and content.
        files: Vec<(String, Vec<u8>)>,
    },
    /// A document: bytes that its run will write, or what was understood of it where no kind of job is named.
    Check {
        /// What it is to be read as.
        kind: Option<JobKind>,
        /// The document.
        submission: Submission,
        /// Most points of a plate, and most memory of a case, bytes.
        limits: [f64; 2],
    },
}

impl Look {
    /// What was found, JSON.
    pub fn answer(&self) -> Answer<String> {
        match self {
            Look::Measured { fields, files } => {
                let import = import(fields)?;
                let files = files.iter().map(|(file, content)| found(file, content, &import)).collect();
                Ok(serde_json::to_string(&Found { files }).unwrap_or_default())
            }
            Look::Check { kind, submission, limits: [points, case_bytes] } => {
                let document = submission.document()?;
                let task = submission.task(kind.unwrap_or_else(|| JobKind::of(&document.table)), &document)?;
                // As far as it shows without building the plate, and of very many cases a few: each runs within the memory of the job
                // all the same.
                for budget in task.budgets(LOOKED_AT)? {
                    budget.within_points(*points)?;
                    budget.within(*case_bytes)?;
                }
                if kind.is_some() {
                    return Ok(task.room().all.to_string());
                }
                let checked = check::check(&document, &task)?;
                let mut object = checked.json();
                object["drawing"] = checked.drawn.beside_form(DRAWING).unwrap_or_default().into();
                Ok(object.to_string())
            }
        }
    }
}

/// What was found in files of readings.
#[derive(Serialize, ToSchema)]
pub struct Found {
    files: Vec<FoundFile>,
}

/// What was found in a file of readings.
#[derive(Serialize, ToSchema)]
pub struct FoundFile {
    /// Its name.
    file: String,
    /// Column names as written; empty where no table was found.
    header: Vec<String>,
    /// Cells of the first rows.
    first_rows: Vec<Vec<String>>,
    /// What these cells are taken for: cycles, and crack lengths in mm; null for all that is neither, or no number.
    taken: Vec<Vec<Option<f64>>>,
    /// What its columns are; null where that cannot be told.
    columns: Option<Columns>,
    /// Curves of the good rows.
    curves: Vec<FoundCurve>,
    /// Keys of `[loading]` that its columns say, where all readings have one load.
    loading: BTreeMap<&'static str, f64>,
    preamble: Preamble,
    warnings: Vec<String>,
    /// Bad rows, or what is wrong with the file as a whole.
    problems: Vec<Place>,
}

/// What the columns of a file are.
#[derive(Serialize, ToSchema)]
pub struct Columns {
    /// `long` (a row a reading), `wide` (a column a specimen) or `paired` (two columns a specimen).
    layout: &'static str,
    length_unit: &'static str,
    cycle_unit: &'static str,
    /// Whether `7,5` was taken for a number.
    decimal_comma: bool,
    /// What separates columns; empty for stored cells.
    separator: &'static str,
    /// The key of `measured.columns` of every column; empty for one that is not read or is a specimen of a wide table.
    keys: Vec<&'static str>,
}

/// Readings of a specimen.
#[derive(Serialize, ToSchema)]
pub struct FoundCurve {
    specimen: String,
    cycles: Vec<f64>,
    crack_length_mm: Vec<f64>,
    /// Line of each reading.
    lines: Vec<usize>,
}

/// Fields of the form beside the files: what the user says of them.
pub const FIELDS: [&str; 7] = ["length_unit", "cycle_unit", "load_unit", "decimal", "sheet", "columns", "leave_out"];

fn import(fields: &BTreeMap<String, String>) -> Answer<Import> {
    let field = |name: &str| fields.get(name).filter(|text| !text.is_empty());
    Ok(Import {
        length: field("length_unit").map(|name| named(LengthUnit::ALL, LengthUnit::name, "length_unit", name)).transpose()?,
        cycles: field("cycle_unit").map(|name| named(CycleUnit::ALL, CycleUnit::name, "cycle_unit", name)).transpose()?,
        load: field("load_unit").map(|name| named(LoadUnit::ALL, LoadUnit::name, "load_unit", name)).transpose()?,
        columns: json_of(
            "columns",
            field("columns"),
            "give a JSON object such as { \"cycles\": \"N\", \"length\": [\"a left\", \"a right\"] }",
        )?,
        left_out: json_of("leave_out", field("leave_out"), "give a JSON list of { file, line, value, reason }")?,
        decimal: field("decimal").map(|name| named(Decimal::ALL, Decimal::name, "decimal", name)).transpose()?,
        sheet: field("sheet").map(|name| Sheet(name.clone())),
        ..Import::default()
    })
}

/// What a field holds as JSON; the default where it is missing.
fn json_of<T: Field + Default>(key: &str, text: Option<&String>, remedy: &'static str) -> Answer<T> {
    let Some(text) = text else { return Ok(T::default()) };
    let wrong = |error| input(key, text, format!("names no {key}: {error}"), remedy);
    let value = serde_json::from_str::<perilife_base::keys::Value>(text).map_err(wrong)?;
    Ok(T::take(&Key { shape: T::SHAPE, remedy, ..Key::new("", "") }, key, &value)?)
}

/// The kind of this name.
fn named<T: Copy>(all: &[T], name_of: fn(T) -> &'static str, key: &str, name: &str) -> Answer<T> {
    let known: Vec<&str> = all.iter().map(|kind| name_of(*kind)).collect();
    let place = known.iter().position(|known| *known == name);
    place.map(|place| all[place]).ok_or_else(|| {
        input(key, format!("\"{name}\""), "is not a known unit", format!("use one of {}", known.join(", "))).into()
    })
}

fn found(file: &str, content: &[u8], import: &Import) -> FoundFile {
    let found = survey(content, Path::new(file), import);
    let preamble = Preamble::of(&found);
    let Survey { header, first_rows, layout, measured, problems, .. } = found;
    let unit = |column: &Column| if let Named::Is(unit) = column.unit { unit.name() } else { "" };
    let lengths = |layout: &Layout| -> Vec<usize> {
        layout.series.iter().flat_map(|series| &series.lengths).map(|column| column.index).collect()
    };
    let taken = layout.iter().flat_map(|layout| {
        let lengths = lengths(layout);
        first_rows.iter().map(move |cells| {
            let shown = |(index, value): (usize, Option<f64>)| value.map(|v| if lengths.contains(&index) { v / MM } else { v });
            layout.taken(cells).into_iter().enumerate().map(shown).collect()
        })
    });
    let taken = taken.collect();
    let columns = layout.map(|layout| Columns {
        layout: match layout.shape {
            Shape::Long => "long",
            Shape::Paired => "paired",
            Shape::WideCycles | Shape::WideLengths => "wide",
        },
        length_unit: unit(&layout.series[0].lengths[0]),
        cycle_unit: unit(&layout.series[0].cycles),
        decimal_comma: layout.decimal == Decimal::Comma,
        separator: layout.separator,
        keys: layout.keys(header.len()),
    });
    let curve = |curve: MeasuredCurve| FoundCurve {
        specimen: curve.specimen,
        cycles: curve.cycles,
        crack_length_mm: curve.crack_length.iter().map(|metres| metres / MM).collect(),
        lines: curve.source.lines,
    };
    FoundFile {
        file: file.to_owned(),
        header,
        first_rows,
        taken,
        columns,
        loading: measured.load(),
        preamble,
        curves: measured.curves.into_iter().map(curve).collect(),
        warnings: measured.warnings,
        problems: problems.into_iter().map(Place::from).collect(),
    }
}
