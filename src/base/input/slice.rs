//! One table of the file to one serde struct, and serde's short messages to whole sentences.

use serde::de::DeserializeOwned;
use toml::{Table, Value};

use crate::error::{Error, Result, input, input_missing};

/// Names fixed for later that no room has built yet: they get "is not built yet" instead of "is not a known kind".
///
/// Looked at only after a room has refused the name, so a name that gets built needs no line changed here.
pub const PLANNED: &[(&str, &[&str])] = &[("fatigue.failure", &["energy", "stress"])];

/// Names that a fracture scene knows and a fatigue case does not. Looked at as [`PLANNED`] is.
pub const OF_SCENES: &[(&str, &[&str])] = &[
    ("model.bond_law", &["correspondence"]),
    ("model.solver", &["velocity_verlet", "secant", "adaptive_dynamic_relaxation"]),
    ("loading.kind", &["traction", "velocity", "platens"]),
];

/// Remedy of a fatigue case that asks for points of several levels.
pub const LEVELS_OF_SCENES: &str = "remove it: levels are for scenes without cycles (`perilife fracture`); for fatigue use \
                                    method = \"element_free_galerkin\", whose nodes refine themselves";

/// Reads what the program wrote, a record or a source of tests, as a `T` that denies unknown fields; what users write is read by their
/// [`keys`](mod@crate::keys).
pub fn slice<T: DeserializeOwned>(value: &Value, path: &str) -> Result<T> {
    table_of(value, path)?.clone().try_into().map_err(|error| explain(&error, value, path))
}

/// The table at `path`, refused with words if it is anything else.
pub fn table_of<'v>(value: &'v Value, path: &str) -> Result<&'v Table> {
    value.as_table().ok_or_else(|| {
        input(path, shorten(value), "is not a table of keys", format!("write a section [{path}] or {{ key = value }}"))
    })
}

/// The value at `path` (`holes[0].x_mm`) below `root`.
pub fn value_at<'v>(root: &'v Value, path: &str) -> Option<&'v Value> {
    path_steps(path).into_iter().try_fold(root, |value, step| match value {
        Value::Table(table) => table.get(&step),
        Value::Array(items) => items.get(step.parse::<usize>().ok()?),
        _ => None,
    })
}

/// Steps of a path: `specimen.holes[0].x_mm` gives specimen, holes, 0, x_mm.
pub(super) fn path_steps(path: &str) -> Vec<String> {
    path.split(['.', '[']).map(|step| step.trim_end_matches(']').to_owned()).filter(|step| !step.is_empty()).collect()
}

pub fn number_of(value: &Value) -> Option<f64> {
    value.as_float().or_else(|| value.as_integer().map(|whole| whole as f64))
}

/// A value as it is shown in a message: one line, not too long.
pub fn shorten(value: &Value) -> String {
    let text = value.to_string().replace('\n', " ");
    if text.chars().count() <= 80 { text } else { text.chars().take(77).chain("...".chars()).collect() }
}

fn explain(error: &toml::de::Error, value: &Value, path: &str) -> Error {
    let message = error.message();
    let whole = error.to_string();
    // toml prints the key below the message as "in `holes.x_mm`".
    let inner = whole.rsplit_once("in `").and_then(|(_, rest)| rest.trim_end().strip_suffix('`')).unwrap_or("");
    let place = if inner.is_empty() { path.to_owned() } else { format!("{path}.{inner}") };
    let given = |key: &str| value_at(value, key.strip_prefix(path).unwrap_or(key)).map(shorten).unwrap_or_default();
    if let Some(name) = quoted_after(message, "unknown field `") {
        let key = format!("{place}.{name}");
        let known = message.split_once("expected ").map_or("", |(_, list)| list).trim_start_matches("one of ").replace('`', "");
        return input(&key, given(&key), "unknown key", format!("use one of: {known}"));
    }
    if let Some(name) = quoted_after(message, "missing field `") {
        return input_missing(&format!("{place}.{name}"), "is missing", "add the key");
    }
    if let Some((_, remedy)) = message.split_once("unknown kind; ") {
        return input(&place, given(&place), "unknown kind", remedy.trim_end());
    }
    let wanted = match message.rsplit_once("expected ").map_or("another kind of value", |(_, wanted)| wanted).trim() {
        "f64" => "a number",
        "usize" | "u64" => "a whole number, zero or more",
        "a string" => "text in quotes",
        other => other,
    };
    input(&place, given(&place), format!("is not {wanted}"), format!("give {wanted}"))
}

fn quoted_after<'t>(text: &'t str, start: &str) -> Option<&'t str> {
    text.strip_prefix(start)?.split('`').next()
}
