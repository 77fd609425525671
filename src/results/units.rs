//! Results in US units, and back: numbers by the units that their keys end in, quantities in words. Who reads a result of a run takes both.
//!
//! What the program reads back as input stays metric: `fitted.toml`, `case.toml` and `inputs/`, checkpoints; so do `case` in results, files for
//! ParaView and Parquet.

use std::borrow::Cow;

use serde_json::{Map, Value};

use perilife_base::units::shown::shown;
use perilife_base::units::us::{System, clean, renamed};
use perilife_base::units::words::with_keys;

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

/// A result in the units that are shown.
pub fn shown_result(value: &Value) -> Cow<'_, Value> {
    if shown() == System::Si { Cow::Borrowed(value) } else { Cow::Owned(of_result(value, shown())) }
}
