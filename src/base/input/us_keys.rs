//! Keys of an input file in US units, which become the metric ones that readers know, before anything is read.

use toml::{Table, Value};

use crate::error::{InputError, Result, input, input_missing};
use crate::units::us::{System, clean, renamed};
use crate::units::words::in_units;
use crate::units::{INCH, MM};

use super::slice::{number_of, path_steps, shorten, value_at};

#[derive(Debug, Clone, PartialEq)]
pub(super) struct Written {
    /// Its place as readers name it, `specimen.width_mm`, and in the file, `specimen.width_in`.
    metric: String,
    us: String,
    value: Value,
}

/// Name of the other twin of a key, if it has a unit of length, stress, force, rate or K.
pub(super) fn twin(key: &str) -> Option<String> {
    [System::Si, System::Us].into_iter().find_map(|to| renamed(key, to)).map(|other| other.name)
}

/// The place of a key as readers name it.
pub(super) fn metric(path: &str) -> String {
    match path.rsplit_once('.') {
        Some((above, key)) => renamed(key, System::Si).map_or_else(|| path.to_owned(), |si| format!("{above}.{}", si.name)),
        None => path.to_owned(),
    }
}

/// Makes every key in US units the metric one, values and points of lists with it; a table under such a key has the number as `value`.
/// Errors: a quantity that is given twice, naming both keys; C of a law without its exponent, which both belong to the unit of ΔK; a
/// formula without unit, which would be a guess.
pub(super) fn to_metric(table: &mut Table) -> Result<Vec<Written>> {
    let mut written = Vec::new();
    below(table, "", &mut written)?;
    let formula = table.get("loading").and_then(|loading| loading.get("residual_stress"));
    let Some((Written { us, .. }, formula)) = written.first().zip(formula) else { return Ok(written) };
    let problem = format!("has no unit in its name, and {us} is in US units");
    let remedy = "write loading.residual_stress_ksi for a formula in US units, or loading.residual_stress_mpa for a metric one";
    Err(input("loading.residual_stress", shorten(formula), problem, remedy))
}

fn below(table: &mut Table, above: &str, written: &mut Vec<Written>) -> Result<()> {
    let path = |key: &str| if above.is_empty() { key.to_owned() } else { format!("{above}.{key}") };
    let given = table.clone();
    for (key, value) in &given {
        let Some(si) = renamed(key, System::Si) else {
            if let Some(value) = table.get_mut(key) {
                inside(value, &path(key), written)?;
            }
            continue;
        };
        if let Some(other) = given.get(&si.name) {
            let problem = format!("conflicts with {} = {}", path(&si.name), shorten(other));
            return Err(input(&path(key), shorten(value), problem, "remove one of them"));
        }
        let sibling = |name: &str| given.get(name).and_then(number_of);
        let factor = si.factor(sibling).map_err(|exponent| {
            let problem = format!("required: sets the unit of {}", path(key));
            input_missing(&path(exponent), problem, format!("give it, or {}", path(&si.name)))
        })?;
        written.push(Written { metric: path(&si.name), us: path(key), value: value.clone() });
        table.remove(key);
        let value = if above == "loading" { of_rows(value, factor) } else { scaled(value, factor) };
        table.insert(si.name.clone(), value);
    }
    Ok(())
}

fn inside(value: &mut Value, path: &str, written: &mut Vec<Written>) -> Result<()> {
    match value {
        Value::Table(table) => below(table, path, written),
        Value::Array(items) => {
            items.iter_mut().enumerate().try_for_each(|(i, item)| inside(item, &format!("{path}[{i}]"), written))
        }
        _ => Ok(()),
    }
}

/// A load, times a factor: of rows over crack length that is in inches.
fn of_rows(value: &Value, factor: f64) -> Value {
    let Some(rows) = value.as_array() else { return scaled(value, factor) };
    let row = |row: &Value| match row.as_array().map(Vec::as_slice) {
        Some([length, load]) => Value::Array(vec![scaled(length, INCH / MM), scaled(load, factor)]),
        _ => row.clone(),
    };
    Value::Array(rows.iter().map(row).collect())
}

/// A number, or all of a list, times a factor; what is no number stays, for its reader to refuse.
fn scaled(value: &Value, factor: f64) -> Value {
    match (value, number_of(value)) {
        (_, Some(number)) => Value::Float(clean(number * factor)),
        (Value::Array(items), _) => Value::Array(items.iter().map(|item| scaled(item, factor)).collect()),
        (Value::Table(table), _) => {
            let of_key = |(key, value): (&String, &Value)| {
                (key.clone(), if key == "value" { scaled(value, factor) } else { value.clone() })
            };
            Value::Table(table.iter().map(of_key).collect())
        }
        (other, _) => other.clone(),
    }
}

/// An error about a key as the user wrote it: key, value, and quantities in the units of the key.
pub(super) fn as_written(mut trouble: Box<InputError>, written: &[Written]) -> Box<InputError> {
    let within = |written: &&Written| {
        let rest = trouble.key.as_deref()?.strip_prefix(&written.metric)?.to_owned();
        (rest.is_empty() || rest.starts_with(['.', '['])).then_some(rest)
    };
    let Some((own, rest)) = written.iter().find_map(|one| Some((one, within(&one)?))) else { return trouble };
    let value = if path_steps(&rest).is_empty() { Some(&own.value) } else { value_at(&own.value, &rest) };
    trouble.key = Some(format!("{}{rest}", own.us));
    if trouble.value.is_some() {
        trouble.value = value.map(shorten).or(trouble.value);
    }
    trouble.problem = in_units(&trouble.problem, System::Us);
    trouble.remedy = in_units(&trouble.remedy, System::Us);
    trouble
}
