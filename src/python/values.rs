//! Values of Python as those of an input file.

use std::path::PathBuf;

use perilife_base::error::{input, input_missing};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyFloat, PyInt, PyMapping, PyString};
use toml::{Table, Value};

use crate::errors::raised;

/// Levels of dicts and lists within each other at the most: a file has five. One that holds itself has no end.
const LEVELS_MAX: usize = 64;

/// A dict of sections or keys; what is `None` is left out.
/// Errors: `InputError` for a value that has no form in an input file, by its key.
pub fn table(key: &str, given: &Bound<'_, PyAny>) -> PyResult<Table> {
    match value(key, given, LEVELS_MAX)? {
        Some(Value::Table(table)) => Ok(table),
        _ => Err(strange(key, given, "give a dict of keys")),
    }
}

/// One value; `None` of `None`. Scalars and arrays of numpy are taken as the numbers and lists that they hold, paths as text.
fn value(key: &str, given: &Bound<'_, PyAny>, levels: usize) -> PyResult<Option<Value>> {
    let Some(levels) = levels.checked_sub(1) else {
        let key: String = key.chars().take(40).collect();
        let problem = format!("holds more than {LEVELS_MAX} dicts or lists within each other");
        return Err(raised(input_missing(&key, problem, "give a dict that does not hold itself")));
    };
    Ok(Some(match given {
        _ if given.is_none() => return Ok(None),
        _ if given.is_instance_of::<PyBool>() => Value::Boolean(given.extract()?),
        _ if given.is_instance_of::<PyInt>() => {
            Value::Integer(given.extract().map_err(|_| strange(key, given, "give a number of at most 64 bits"))?)
        }
        _ if given.is_instance_of::<PyFloat>() => Value::Float(given.extract()?),
        _ if given.is_instance_of::<PyString>() => Value::String(given.extract()?),
        _ if given.hasattr("tolist")? => return value(key, &given.call_method0("tolist")?, levels),
        _ => match (given.cast::<PyMapping>(), given.extract::<PathBuf>(), given.try_iter()) {
            (Ok(mapping), ..) => Value::Table(entries(key, mapping, levels)?),
            (_, Ok(path), _) => Value::String(path.to_string_lossy().into_owned()),
            (.., Ok(items)) => Value::Array(
                items
                    .enumerate()
                    .filter_map(|(place, item)| {
                        item.and_then(|item| value(&format!("{key}[{place}]"), &item, levels)).transpose()
                    })
                    .collect::<PyResult<_>>()?,
            ),
            _ => return Err(strange(key, given, "give numbers, text, true or false, lists or dicts of them")),
        },
    }))
}

fn entries(key: &str, mapping: &Bound<'_, PyMapping>, levels: usize) -> PyResult<Table> {
    let mut table = Table::new();
    for item in mapping.items()?.iter() {
        let (name, inner): (Bound<'_, PyAny>, Bound<'_, PyAny>) = item.extract()?;
        let name: String = name.extract().map_err(|_| strange(key, &name, "name keys by text"))?;
        let inner_key = if key.is_empty() { name.clone() } else { format!("{key}.{name}") };
        if let Some(inner) = value(&inner_key, &inner, levels)? {
            table.insert(name, inner);
        }
    }
    Ok(table)
}

fn strange(key: &str, given: &Bound<'_, PyAny>, remedy: &str) -> PyErr {
    let kind = given.get_type().name().map_or_else(|_| "object".to_owned(), |name| name.to_string());
    let shown: String = given.repr().map_or_else(|_| kind.clone(), |text| text.to_string().chars().take(80).collect());
    let key = if key.is_empty() { "case" } else { key };
    raised(input(key, shown, format!("is of type {kind}, which has no place here"), remedy))
}
