//! Looking at input before anything is run: measured curves, and whether a document can be run within the limits of a service.
//!
//! What comes from outside may take any time and memory, so that a process of its own looks at it where it is large.

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::job::{JobKind, Submission};
use crate::problem::{Answer, Place};
use perilife_base::error::input;
use perilife_base::keys::{Field, Key, Value};
use perilife_base::table::units::{CycleUnit, LengthUnit, LoadUnit};
use perilife_base::table::{Decimal, Sheet};
use perilife_base::units::MM;
use perilife_measured::{Column, Import, Layout, MeasuredCurve, Named, Shape, Survey, survey};
use perilife_results::chart::Size;
use perilife_results::curve::RunTables;
use perilife_results::pictures::plate::plate_svg;
use perilife_runner::check;

/// Cases of a sweep that are looked at before it is accepted.
const LOOKED_AT: usize = 100;
/// Size of the drawing of a plate beside its form.
const DRAWING: Size = Size { width: 620.0, height: 330.0, text: 12.0 };

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
                let of_plate = |plate| plate_svg(plate, &RunTables::default(), DRAWING);
                object["drawing"] = checked.plate.as_ref().map_or(checked.drawing, of_plate).into();
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
    let value = serde_json::from_str::<Value>(text).map_err(wrong)?;
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
    let Survey { header, first_rows, layout, measured, problems } = survey(content, Path::new(file), import);
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
        curves: measured.curves.into_iter().map(curve).collect(),
        warnings: measured.warnings,
        problems: problems.into_iter().map(Place::from).collect(),
    }
}
