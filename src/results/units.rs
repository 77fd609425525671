//! Tables and results in US units, and back: what a run has written in metric units is changed once, at the rim, by the units that the
//! names of columns and keys end in. Who reads a table or a result of a run takes both.
//!
//! What the program reads back as input stays metric: `fitted.toml`, `case.toml` and `inputs/`, checkpoints; so do `case` in results, files for
//! ParaView and Parquet.

use std::borrow::Cow;
use std::path::Path;

use serde_json::{Map, Value};

use super::digits::number;
use super::output::write_file;
use perilife_base::error::{Error, Result};
use perilife_base::input::sha256;
use perilife_base::units::shown::shown;
use perilife_base::units::us::{Renamed, System, clean, renamed};
use perilife_base::units::words::{in_units, with_keys};

/// Keys of results that stay as they are: what was given, names, hashes, lists of keys, and constants whose name says SI.
const KEPT: [&str; 15] = [
    "case",
    "constants_si",
    "commit",
    "design",
    "file",
    "finished",
    "fatigue",
    "inputs",
    "key",
    "kinds",
    "laws",
    "name",
    "overrides",
    "sources",
    "version",
];
/// Keys whose fields belong to the constants that stand beside them.
const ERRORS: &str = "standard_errors";
const CONSTANTS: &str = "constants";
const TABLES: &str = "tables";
/// The table without a header: lengths first.
const BETA_FILE: &str = "beta.txt";

/// A table with a header in the units of `to`: columns by their names, and quantities in words of other cells.
pub fn of_table(text: &str, to: System) -> Cow<'_, str> {
    let mut reader = csv::ReaderBuilder::new().has_headers(false).flexible(true).from_reader(text.as_bytes());
    let mut records = reader.records();
    let Some(Ok(head)) = records.next() else { return text.into() };
    let place = |name: &str| head.iter().position(|column| column == name);
    // The level of a law whose exponent is not in the table stays.
    let change = |column: &str| renamed(column, to).filter(|new| new.factor(|name| place(name).map(|_| 1.0)).is_ok());
    let changes: Vec<Option<Renamed>> = head.iter().map(change).collect();
    if changes.iter().all(Option::is_none) {
        return text.into();
    }
    let mut out = csv::WriterBuilder::new().flexible(true).from_writer(Vec::new());
    let names = head.iter().zip(&changes).map(|(old, new)| new.as_ref().map_or(old, |new| &*new.name));
    // Into memory nothing fails; a table that is none is left to its reader.
    let mut is_whole = out.write_record(names).is_ok();
    for record in records {
        let Ok(record) = record else { return text.into() };
        let sibling = |name: &str| place(name).and_then(|place| record.get(place)).and_then(|cell| cell.parse::<f64>().ok());
        let cell = |(place, cell): (usize, &str)| match (changes.get(place), cell.parse::<f64>()) {
            (Some(Some(new)), Ok(value)) => new.factor(sibling).map_or_else(|_| String::new(), |factor| number(value * factor)),
            (_, Ok(_)) => cell.to_owned(),
            (_, Err(_)) => in_units(cell, to),
        };
        is_whole &= out.write_record(record.iter().enumerate().map(cell)).is_ok();
    }
    let written = out.into_inner().ok().and_then(|bytes| String::from_utf8(bytes).ok());
    written.filter(|_| is_whole).map_or(text.into(), Cow::from)
}

/// A result in the units of `to`: numbers by their keys, and quantities in words.
pub fn of_result(value: &Value, to: System) -> Value {
    match value {
        Value::Object(fields) => of_fields(fields, fields, to),
        Value::Array(items) => items.iter().map(|item| of_result(item, to)).collect(),
        Value::String(words) => with_keys(words, to).into(),
        other => other.clone(),
    }
}

/// A result that was written in either units, in metric ones.
pub fn metric_result(value: Value) -> Value {
    let is_us = value.as_object().is_some_and(|fields| fields.keys().any(|key| renamed(key, System::Si).is_some()));
    if is_us { of_result(&value, System::Si) } else { value }
}

fn of_fields(fields: &Map<String, Value>, beside: &Map<String, Value>, to: System) -> Value {
    let field = |(key, value): (&String, &Value)| {
        if KEPT.contains(&key.as_str()) {
            return (key.clone(), value.clone());
        }
        if let (ERRORS, Some(errors), Some(constants)) =
            (key.as_str(), value.as_object(), fields.get(CONSTANTS).and_then(Value::as_object))
        {
            return (key.clone(), of_fields(errors, constants, to));
        }
        let Some(new) = renamed(key, to) else { return (key.clone(), of_result(value, to)) };
        match new.factor(|name| beside.get(name).and_then(Value::as_f64)) {
            Ok(factor) => (new.name, scaled(value, factor)),
            // Not known, or of an exponent that is not: as it is.
            Err(_) if value.is_null() => (new.name, Value::Null),
            Err(_) => (key.clone(), value.clone()),
        }
    };
    Value::Object(fields.iter().map(field).collect())
}

fn scaled(value: &Value, factor: f64) -> Value {
    match value {
        Value::Number(number) => number.as_f64().map_or(Value::Null, |number| clean(number * factor).into()),
        Value::Array(items) => items.iter().map(|item| scaled(item, factor)).collect(),
        other => other.clone(),
    }
}

/// A table in the units that are shown.
pub fn shown_table(text: &str) -> Cow<'_, str> {
    if shown() == System::Si { text.into() } else { of_table(text, shown()) }
}

/// A result in the units that are shown.
pub fn shown_result(value: &Value) -> Cow<'_, Value> {
    if shown() == System::Si { Cow::Borrowed(value) } else { Cow::Owned(of_result(value, shown())) }
}

/// Puts the tables and results of a folder into the units that are shown; `result` then has the hashes of these tables, as the files have.
/// Errors: files that cannot be read or written.
pub fn show_folder(folder: &Path, result: &mut Value) -> Result<()> {
    if shown() == System::Si {
        return Ok(());
    }
    let cannot = |error| Error::file(folder, "cannot read the folder", error);
    let mut results = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(cannot)? {
        let path = entry.map_err(cannot)?.path();
        let of = |ending: &str| path.extension().is_some_and(|own| own == ending);
        let read = || std::fs::read_to_string(&path).map_err(|error| Error::file(&path, "cannot read", error));
        if of("csv") {
            write_file(&path, of_table(&read()?, shown()).as_bytes())?;
        } else if path.ends_with(BETA_FILE) {
            write_file(&path, beta(&read()?).as_bytes())?;
        } else if of("json") {
            results.push(path);
        }
    }
    // Last, since they hold the hashes of the tables.
    for path in results {
        let text = std::fs::read(&path).map_err(|error| Error::file(&path, "cannot read", error))?;
        let Ok(value) = serde_json::from_slice::<Value>(&text) else { continue };
        let mut value = of_result(&value, shown());
        hash_anew(folder, &mut value);
        write_file(&path, format!("{value:#}\n").as_bytes())?;
    }
    hash_anew(folder, result);
    Ok(())
}

/// Lines of a length and β.
fn beta(text: &str) -> String {
    let Some(length) = renamed("mm", shown()).and_then(|new| new.factor(|_| None).ok()) else { return text.to_owned() };
    let line = |line: &str| match line.split_once(' ').and_then(|(a, beta)| Some((a.parse::<f64>().ok()?, beta))) {
        Some((a, beta)) => format!("{} {beta}\n", number(a * length)),
        None => format!("{line}\n"),
    };
    text.lines().map(line).collect()
}

/// Length and hash of every table that a result lists, as it is in the folder.
fn hash_anew(folder: &Path, result: &mut Value) {
    for table in result.get_mut(TABLES).and_then(Value::as_array_mut).into_iter().flatten() {
        let content = table["file"].as_str().and_then(|name| std::fs::read(folder.join(name)).ok());
        if let Some(content) = content {
            table["sha256"] = sha256(&content).into();
            table["bytes"] = content.len().into();
        }
    }
}
