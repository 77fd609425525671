//! Looking at input before anything is run: measured curves, and what a file would run.

use std::collections::BTreeMap;
use std::path::Path;

use axum::extract::{Request, State};
use axum::{Extension, Json};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;
use utoipa::ToSchema;

use super::App;
use super::caller::Caller;
use super::documents::{self, JobRequest, submission, while_asked};

use crate::job::JobKind;
use crate::problem::{Answer, Place, Problem};
use perilife_base::error::{Error, input};
use perilife_base::units::{KN, MM, MPA};
use perilife_base::watch;
use perilife_base::{
    table::{
        Decimal, Sheet,
        units::{CycleUnit, LengthUnit, LoadUnit},
    },
    units::round_off,
};
use perilife_measured::{Column, ColumnNames, Import, Layout, Loads, MeasuredCurve, Named, SAME_LOAD, Shape, Survey, survey};
use perilife_plate::specimen::LoadMeasure;
use perilife_runner::check;

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

/// A form of files of readings.
#[derive(ToSchema)]
#[expect(dead_code, reason = "describes a form")]
struct Readings {
    /// Files (repeatable).
    #[schema(value_type = String, format = Binary)]
    file: Vec<u8>,
    /// `mm`, `inch` or `m`, where the header does not say it.
    length_unit: Option<String>,
    /// `cycles`, `kilocycles` or `megacycles`, where the header does not say it.
    cycle_unit: Option<String>,
    /// Unit of loads, where the header does not say it.
    load_unit: Option<String>,
    /// `.` or `,`, where the file leaves it open.
    decimal: Option<String>,
    /// Sheet of a workbook, by name or number.
    sheet: Option<String>,
    /// JSON object of columns by name, as `columns` of `[measured]`.
    columns: Option<String>,
    /// JSON list of rows that are left out by their lines, as `leave_out` of `[measured]`.
    leave_out: Option<String>,
}

/// Fields of the form beside the files: what the user says of them.
const FIELDS: [&str; 7] = ["length_unit", "cycle_unit", "load_unit", "decimal", "sheet", "columns", "leave_out"];

/// Reads measured a-N curves: what was understood, and every row that is wrong.
#[utoipa::path(post, path = "/v1/measured", tag = "inputs",
    request_body(content = inline(Readings), content_type = "multipart/form-data"),
    responses((status = 200, body = Found), (status = 400, body = Problem), (status = 413, body = Problem)))]
pub async fn measured(State(app): State<App>, Extension(caller): Extension<Caller>, request: Request) -> Answer<Json<Found>> {
    let room = app.bodies.wait(&caller).await?;
    let (fields, files) = documents::form(&app, request).await?;
    if let Some(name) = fields.keys().find(|name| !FIELDS.contains(&name.as_str())) {
        return Err(Problem::bad_request(format!("the form has a field `{name}`; known are file, {}", FIELDS.join(", "))));
    }
    if files.is_empty() {
        return Err(Problem::bad_request("the form has no `file`: send at least one"));
    }
    let field = |name: &str| fields.get(name).filter(|text| !text.is_empty());
    let import = Import {
        length: field("length_unit").map(|name| named(LengthUnit::ALL, LengthUnit::name, "length_unit", name)).transpose()?,
        cycles: field("cycle_unit").map(|name| named(CycleUnit::ALL, CycleUnit::name, "cycle_unit", name)).transpose()?,
        load: field("load_unit").map(|name| named(LoadUnit::ALL, LoadUnit::name, "load_unit", name)).transpose()?,
        columns: json_of("columns", field("columns"), &format!("object with keys of {}", ColumnNames::names(", ")))?,
        left_out: json_of("leave_out", field("leave_out"), "list of { file, line, value, reason }")?,
        decimal: field("decimal").map(|name| named(Decimal::ALL, Decimal::name, "decimal", name)).transpose()?,
        sheet: field("sheet").map(|name| Sheet(name.clone())),
        ..Import::default()
    };
    let look = move || {
        // Taken up until the work is done, even if nobody waits for it any more.
        let _room = room;
        // Between two files is where it ends if nobody waits for it any more.
        let looked = |(file, content): (String, Vec<u8>)| {
            watch::unless_cancelled(&file.clone(), Ok(())).map(|()| found(file, &content, &import))
        };
        Ok(Found { files: files.into_iter().map(looked).collect::<Result<_, Error>>()? })
    };
    while_asked(look).await.map(Json)
}

/// What a field holds as JSON of a form; the default where it is missing.
fn json_of<T: DeserializeOwned + Default>(key: &str, text: Option<&String>, form: &str) -> Answer<T> {
    let Some(text) = text else { return Ok(T::default()) };
    let wrong = |error| input(key, text, format!("names no {key}: {error}"), format!("give a JSON {form}")).into();
    serde_json::from_str(text).map_err(wrong)
}

/// The kind of this name.
fn named<T: Copy>(all: &[T], name_of: fn(T) -> &'static str, key: &str, name: &str) -> Answer<T> {
    let known: Vec<&str> = all.iter().map(|kind| name_of(*kind)).collect();
    let place = known.iter().position(|known| *known == name);
    place.map(|place| all[place]).ok_or_else(|| {
        input(key, format!("\"{name}\""), "is not a known unit", format!("use one of {}", known.join(", "))).into()
    })
}

/// The load of all readings in keys of `[loading]`; nothing where there is none, or several.
fn load_of(curves: &[MeasuredCurve]) -> BTreeMap<&'static str, f64> {
    let loads: Vec<&Loads> = curves.iter().filter_map(|curve| curve.loads.as_ref()).collect();
    let Some(first) = loads.first().filter(|_| loads.len() == curves.len()) else { return BTreeMap::new() };
    let (key, unit) = match (first.measure, first.is_range) {
        (LoadMeasure::Force, false) => ("force_max_kn", KN),
        (LoadMeasure::Force, true) => ("force_range_kn", KN),
        (LoadMeasure::Stress, false) => ("stress_max_mpa", MPA),
        (LoadMeasure::Stress, true) => ("stress_range_mpa", MPA),
    };
    let is_alike = |loads: &&Loads| (loads.measure, loads.is_range) == (first.measure, first.is_range);
    let of = |values: fn(&Loads) -> &Vec<f64>, slack: f64| {
        let mut all = loads.iter().flat_map(|loads| values(loads)).copied();
        let value = all.next()?;
        // NaN, which stands where the file says nothing, is like nothing.
        all.all(|other| (other - value).abs() <= slack * value.abs()).then_some(value).filter(|value| value.is_finite())
    };
    let load = of(|loads| &loads.maximum, SAME_LOAD).filter(|_| loads.iter().all(is_alike));
    let ratio = of(|loads| &loads.ratio, SAME_LOAD).map(|ratio| ("stress_ratio", round_off(ratio)));
    load.map(|load| (key, round_off(load / unit))).into_iter().chain(ratio).collect()
}

fn found(file: String, content: &[u8], import: &Import) -> FoundFile {
    let Survey { header, first_rows, layout, measured, problems } = survey(content, Path::new(&file), import);
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
        file,
        header,
        first_rows,
        taken,
        columns,
        loading: load_of(&measured.curves),
        curves: measured.curves.into_iter().map(curve).collect(),
        warnings: measured.warnings,
        problems: problems.into_iter().map(Place::from).collect(),
    }
}

/// Checks a case, a calibration, a sweep or a fracture scene without running it: what was understood, and a drawing.
#[utoipa::path(post, path = "/v1/check", tag = "inputs", request_body = JobRequest,
    responses((status = 200, body = Value), (status = 400, body = Problem), (status = 422, body = Problem)))]
pub async fn check(State(app): State<App>, Extension(caller): Extension<Caller>, request: Request) -> Answer<Json<Value>> {
    let body = documents::read(&app, &caller, request).await?;
    let is_text = body.asked.input.as_ref().is_some_and(Value::is_string);
    let submission = submission(&app, None, body.asked).await?;
    let limits = app.limits.clone();
    let room = body.room;
    let look = move || -> Answer<Value> {
        let _room = room;
        let document = submission.document()?;
        let task = documents::check(&submission, JobKind::of(&document.table), &document, &limits)?;
        let checked = check::check(&document, &task)?;
        let mut object = checked.json();
        object["drawing"] = checked.drawing.into();
        Ok(object)
    };
    while_asked(look).await.map(Json).map_err(|problem| if is_text { problem } else { problem.without_line() })
}
