//! One table of the file to one serde struct, and serde's short messages to whole sentences.

use serde::de::DeserializeOwned;
use toml::{Table, Value};

use crate::error::{Error, InputError, Result, input, input_missing};
use crate::units::us::{System, renamed};

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
pub const LEVELS_OF_SCENES: &str = "leave it out: levels are for scenes without cycles (`perilife fracture`); for fatigue use method = \
     \"element_free_galerkin\", whose nodes refine themselves";

/// Reads `value`, found at `path` of the file, as a `T` that denies unknown fields.
///
/// ```
/// #[derive(serde::Deserialize, Debug)]
/// #[serde(deny_unknown_fields)]
/// struct Stop { cycles_max: f64 }
/// let value: toml::Value = "cycles_maks = 5".parse::<toml::Table>().unwrap().into();
/// let error = perilife_base::input::slice::<Stop>(&value, "stop").unwrap_err();
/// assert_eq!(error.to_string(), "stop.cycles_maks = 5: is not a known key; known here: cycles_max");
/// ```
pub fn slice<T: DeserializeOwned>(value: &Value, path: &str) -> Result<T> {
    slice_beside(value, path, &[])
}

/// The same of a table that has keys `beside`, which others read.
pub fn slice_beside<T: DeserializeOwned>(value: &Value, path: &str, beside: &[&str]) -> Result<T> {
    let mut own = table_of(value, path)?.clone();
    own.retain(|key, _| !beside.contains(&key));
    own.try_into().map_err(|error| explain(&error, value, path, beside))
}

/// Keys with what an input has for them, from the fields of their names: `keyed!(input: mean, median)`.
#[macro_export]
macro_rules! keyed {
    ($input:ident: $($key:ident),+) => { [$((stringify!($key), $input.$key)),+] };
}

/// Keys with whether they are given, from the fields of their names, as [`refuse_given`](crate::input::refuse_given) takes them.
#[macro_export]
macro_rules! given {
    ($input:ident: $($key:ident),+) => { [$((stringify!($key), $input.$key.is_some())),+] };
}

/// Lengths of `[specimen]` by their keys in mm, each read in turn; m.
#[macro_export]
macro_rules! lengths {
    ($input:ident: $($key:ident),+) => {
        [$($crate::input::LENGTH.read(concat!("specimen.", stringify!($key)), $input.$key)?),+]
    };
}

/// Refuses the first key of a section that is given, though it has no use there.
pub fn refuse_given(section: &str, keys: &[(&str, bool)], problem: &str, remedy: &str) -> Result<()> {
    match keys.iter().find(|(_, is_given)| *is_given) {
        Some((key, _)) => Err(input_missing(&format!("{section}.{key}"), problem, remedy)),
        None => Ok(()),
    }
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

/// A value as it is shown in a message: one line, not too long.
pub fn shorten(value: &Value) -> String {
    let text = value.to_string().replace('\n', " ");
    if text.chars().count() <= 80 { text } else { text.chars().take(77).chain("...".chars()).collect() }
}

/// serde's message to key, value, problem and remedy.
fn explain(error: &toml::de::Error, value: &Value, path: &str, beside: &[&str]) -> Error {
    let message = error.message();
    let whole = error.to_string();
    // toml prints the key below the message as "in `holes.x_mm`".
    let inner = whole.rsplit_once("in `").and_then(|(_, rest)| rest.trim_end().strip_suffix('`')).unwrap_or("");
    let place = if inner.is_empty() { path.to_owned() } else { format!("{path}.{inner}") };
    let given = |key: &str| value_at(value, key.strip_prefix(path).unwrap_or(key)).map(shorten);

    if let Some(name) = quoted_after(message, "unknown field `") {
        let key = format!("{place}.{name}");
        let known = message
            .split_once("expected ")
            .map_or_else(String::new, |(_, list)| list.trim_start_matches("one of ").replace('`', ""));
        if key == "model.discretisation" {
            return input(&key, given(&key).unwrap_or_default(), "is not a key of fatigue cases", LEVELS_OF_SCENES);
        }
        let known = [&beside.join(", "), &*known].into_iter().filter(|list| !list.is_empty()).collect::<Vec<_>>().join(", ");
        let (value, known) = (given(&key).unwrap_or_default(), if known.is_empty() { "none".to_owned() } else { known });
        // The same quantity in another unit: what it is called is said first, in both systems.
        let stem = |name: &str| name.rsplit_once('_').map(|(stem, _)| stem.to_owned());
        let alike = known.split(", ").find(|own| stem(own).is_some() && stem(own) == stem(name));
        let alike = alike.and_then(|own| Some(format!("use {own} or {}; ", renamed(own, System::Us)?.name))).unwrap_or_default();
        return input(&key, value, "is not a known key", format!("{alike}known here: {known}"));
    }
    if let Some(name) = quoted_after(message, "missing field `") {
        return input_missing(&format!("{place}.{name}"), "is missing", "this key is required here");
    }
    if let Some((_, remedy)) = message.split_once("is not a known kind; ") {
        let text = value_at(value, inner).and_then(Value::as_str).unwrap_or_default();
        let listed = |list: &[(&str, &[&str])]| list.iter().any(|(key, names)| *key == place && names.contains(&text));
        let (problem, remedy) = if listed(OF_SCENES) {
            ("belongs to fracture scenes, not to a fatigue case", format!("run `perilife fracture`, or {remedy}"))
        } else {
            (if listed(PLANNED) { "is not built yet" } else { "is not a known kind" }, remedy.to_owned())
        };
        return Error::Input(Box::new(InputError {
            key: Some(place.clone()),
            value: given(&place),
            problem: problem.into(),
            remedy,
            ..InputError::default()
        }));
    }
    let wanted = message.rsplit_once("expected ").map_or("another kind of value", |(_, wanted)| plain(wanted));
    // One pair where a list of them belongs.
    let is_pair = value_at(value, inner).and_then(Value::as_array).is_some_and(|list| list.len() == 2 && !list[0].is_array());
    let wanted = if wanted == PAIR && is_pair { "a list of pairs, such as [[1, 2], [3, 4]]" } else { wanted };
    input(&place, given(&place).unwrap_or_default(), format!("is not {wanted}"), format!("give {wanted}"))
}

fn quoted_after<'t>(text: &'t str, start: &str) -> Option<&'t str> {
    text.strip_prefix(start)?.split('`').next()
}

/// Two numbers in a list.
const PAIR: &str = "a pair of numbers, such as [1, 2]";

/// Rust's words for a type to a reader's.
fn plain(wanted: &str) -> &str {
    match wanted.trim() {
        "f64" | "f32" => "a number",
        "usize" | "u64" | "u32" | "i64" => "a whole number, zero or more",
        "a string" => "text in quotes",
        "a boolean" => "true or false",
        "a sequence" => "a list [...]",
        "an array of length 2" | "an array of size 2" | "fewer elements in array" => PAIR,
        other => other,
    }
}
