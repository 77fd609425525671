//! Values by name, formulas over them, and texts with formulas in angle brackets: what lets one line of a study stand for many.
//!
//! A value that begins with `=` is a formula itself. `<formula>` in a text becomes its value, `<formula:2>` with two decimals; a name of
//! a text becomes that text, in which brackets are filled again.

use toml::{Table, Value};

use super::closed::closed;
use perilife_base::error::{Error, Result};
use perilife_plate::loading::formula::Formula;

/// What a name stands for that is no value: a reading of a run. `None` of a name that nobody knows.
pub type Reading<'a> = &'a dyn Fn(&str, &[f64]) -> Option<Result<f64>>;

/// Texts within texts at the most.
const DEPTH_MOST: usize = 8;

/// Values, and what other names read.
#[derive(Clone, Copy)]
pub struct Values<'a> {
    pub table: &'a Table,
    pub reading: Reading<'a>,
}

/// An error of a file of studies.
pub fn wrong(what: &str, problem: impl std::fmt::Display) -> Error {
    Error::Mechanics(format!("data/studies: {what}: {problem}"))
}

impl<'a> Values<'a> {
    pub fn alone(table: &'a Table) -> Self {
        Values { table, reading: &|_, _| None }
    }

    pub fn number(&self, formula: &str) -> Result<f64> {
        let read = Formula::parse_named(formula).map_err(|problem| wrong(formula, problem))?;
        read.of_names(|name, values| self.named(name, values))
    }

    /// The value of a number or a formula.
    pub fn figure(&self, value: &Value) -> Result<f64> {
        match value {
            Value::Integer(whole) => Ok(*whole as f64),
            Value::Float(number) => Ok(*number),
            Value::String(formula) => self.number(formula.strip_prefix('=').unwrap_or(formula)),
            other => Err(wrong(&other.to_string(), "is neither a number nor a formula")),
        }
    }

    fn named(&self, name: &str, values: &[f64]) -> Result<f64> {
        match self.table.get(name).filter(|_| values.is_empty()) {
            Some(value) => self.figure(value),
            None => match closed(name, values) {
                Some(value) => Ok(value),
                None => (self.reading)(name, values).unwrap_or_else(|| Err(wrong(name, "is neither a value nor a reading"))),
            },
        }
    }

    /// A text with its brackets filled.
    pub fn text(&self, text: &str) -> Result<String> {
        self.filled(text, DEPTH_MOST)
    }

    fn filled(&self, text: &str, depth: usize) -> Result<String> {
        let mut all = String::new();
        let mut rest = text;
        while let Some((before, after)) = rest.split_once('<') {
            let (inner, behind) = after.split_once('>').ok_or_else(|| wrong(text, "has no closing angle bracket"))?;
            all += before;
            all += &match (inner.rsplit_once(':'), self.table.get(inner)) {
                (_, Some(Value::String(own))) if depth > 0 && !own.starts_with('=') => self.filled(own, depth - 1)?,
                (Some((formula, decimals)), _) => {
                    let decimals: usize = decimals.parse().map_err(|_| wrong(inner, "has no number of decimals"))?;
                    format!("{:.decimals$}", self.number(formula)?)
                }
                _ => self.number(inner)?.to_string(),
            };
            rest = behind;
        }
        Ok(all + rest)
    }
}

/// Every combination of the values of some axes, the first outermost. The columns of an axis go together; what is no list stays.
pub fn combinations(axes: &[Table]) -> Result<Vec<Table>> {
    axes.iter().try_fold(vec![Table::new()], |before, axis| {
        let lengths: Vec<usize> = axis.values().filter_map(|column| Some(column.as_array()?.len())).collect();
        let count = lengths.iter().copied().max().unwrap_or(1);
        if lengths.iter().any(|length| *length != count) {
            return Err(wrong(&axis.to_string(), "has columns of different lengths"));
        }
        let place = |at: usize| axis.iter().map(move |(name, column)| (name.clone(), column.get(at).unwrap_or(column).clone()));
        let longer =
            |table: &Table| (0..count).map(|at| table.clone().into_iter().chain(place(at)).collect()).collect::<Vec<Table>>();
        Ok(before.iter().flat_map(longer).collect())
    })
}
