//! A table of results: columns whose names end in their units, written to CSV in the units that are shown, read back in metric ones.

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use serde::de::DeserializeOwned;

use crate::cells::{defused, quoted};
use crate::error::{Error, InputError, Result, fail_if};
use crate::units::shown::shown;
use crate::units::us::{Renamed, System, renamed};
use crate::units::words::in_units;

const DIGITS: usize = 10;
/// Remedy for files of results that are not as they were written.
pub const AGAIN: &str = "the folder is damaged: copy it again, or rerun the case";

#[derive(Debug, Clone, Copy, PartialEq)]
enum Digits {
    /// With 10 to 15 significant digits: unit conversion may disturb the last of the 17 that a double carries.
    Some,
    /// With ten to twelve: of measured quantities.
    Few,
    /// So that they read back bit for bit.
    All,
    None,
}

#[derive(Debug, Clone, PartialEq)]
enum Cells {
    Numbers(Vec<f64>, Digits),
    Words(Vec<String>),
}

#[derive(Debug, Clone, PartialEq)]
struct Column {
    name: Cow<'static, str>,
    cells: Cells,
}

/// Columns of equal length under the name of their file; an empty cell is NaN.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    pub file: PathBuf,
    pub units: System,
    columns: Vec<Column>,
}

impl Table {
    /// One without columns.
    pub fn new(file: impl Into<PathBuf>) -> Self {
        Table { file: file.into(), units: System::Si, columns: Vec::new() }
    }

    /// Adds quantities in the unit of their name, which may not be known.
    pub fn numbers(self, name: impl Into<Cow<'static, str>>, values: impl IntoIterator<Item = impl Into<Option<f64>>>) -> Self {
        self.with(name, Cells::numbers(values, Digits::Some))
    }

    /// Adds measured quantities, and what is made of them.
    pub fn measured(self, name: impl Into<Cow<'static, str>>, values: impl IntoIterator<Item = impl Into<Option<f64>>>) -> Self {
        self.with(name, Cells::numbers(values, Digits::Few))
    }

    pub fn exact(self, name: impl Into<Cow<'static, str>>, values: impl IntoIterator<Item = impl Into<Option<f64>>>) -> Self {
        self.with(name, Cells::numbers(values, Digits::All))
    }

    pub fn counts(self, name: impl Into<Cow<'static, str>>, values: impl IntoIterator<Item = usize>) -> Self {
        self.with(name, Cells::Numbers(values.into_iter().map(|count| count as f64).collect(), Digits::None))
    }

    /// Adds text of others, which no spreadsheet shall run.
    pub fn foreign<W: ToString>(self, name: impl Into<Cow<'static, str>>, values: impl IntoIterator<Item = W>) -> Self {
        self.words(name, values.into_iter().map(|words| defused(&words.to_string()).into_owned()))
    }

    pub fn words<W: ToString>(self, name: impl Into<Cow<'static, str>>, values: impl IntoIterator<Item = W>) -> Self {
        self.with(name, Cells::Words(values.into_iter().map(|words| words.to_string()).collect()))
    }

    fn with(mut self, name: impl Into<Cow<'static, str>>, cells: Cells) -> Self {
        self.columns.push(Column { name: name.into(), cells });
        self
    }

    /// The table with its text in the units that are shown.
    pub fn with_text(self) -> (Self, String) {
        let text = self.csv();
        (self, text)
    }

    pub fn rows(&self) -> usize {
        self.columns.first().map_or(0, |column| column.cells.len())
    }

    pub fn has(&self, name: &str) -> bool {
        self.columns.iter().any(|column| column.name == name)
    }

    /// Numbers of a column; NaN in empty cells.
    /// Errors: a column that is missing, a cell that is no number, by file, line, column and value.
    pub fn get(&self, name: &str) -> Result<Cow<'_, [f64]>> {
        match self.cells(name)? {
            Cells::Numbers(values, _) => Ok(values.into()),
            Cells::Words(words) => {
                let number = |(row, cell): (usize, &String)| {
                    number(cell).ok_or_else(|| self.bad(row + 2, Some(name), Some(cell), "is not a number"))
                };
                words.iter().enumerate().map(number).collect()
            }
        }
    }

    /// The same with a number in every row.
    /// Errors: also an empty cell.
    pub fn full(&self, name: &str) -> Result<Cow<'_, [f64]>> {
        let numbers = self.get(name)?;
        match numbers.iter().position(|value| value.is_nan()) {
            Some(row) => Err(self.bad(row + 2, Some(name), Some(""), "is not a number")),
            None => Ok(numbers),
        }
    }

    /// Numbers of a column that may be missing.
    /// Errors: a cell that is no number.
    pub fn optional(&self, name: &str) -> Result<Option<Cow<'_, [f64]>>> {
        self.has(name).then(|| self.get(name)).transpose()
    }

    /// Rows by the names of their columns.
    /// Errors: a row that is not as it was written.
    pub fn records<R: DeserializeOwned>(&self) -> Result<Vec<R>> {
        let names: csv::StringRecord = self.columns.iter().map(|column| &*column.name).collect();
        let record = |row: usize| {
            let cells: csv::StringRecord = self.columns.iter().map(|column| column.cells.text(row)).collect::<Vec<_>>().into();
            cells
                .deserialize(Some(&names))
                .map_err(|error| self.bad(row + 2, None, None, &format!("is not as it was written: {error}")))
        };
        (0..self.rows()).map(record).collect()
    }

    fn cells(&self, name: &str) -> Result<&Cells> {
        let found = self.columns.iter().find(|column| column.name == name);
        found.map(|column| &column.cells).ok_or_else(|| self.bad(1, Some(name), None, "is missing"))
    }

    /// A line or cell that is not as it was written.
    pub fn bad(&self, line: usize, column: Option<&str>, value: Option<&str>, problem: &str) -> Error {
        Error::Input(Box::new(InputError {
            file: Some(self.file.clone()),
            line: Some(line),
            key: column.map(str::to_owned),
            value: value.map(|text| format!("\"{text}\"")),
            problem: problem.to_owned(),
            remedy: AGAIN.to_owned(),
            ..InputError::default()
        }))
    }

    /// The text in the units that are shown.
    pub fn csv(&self) -> String {
        self.csv_in(shown())
    }

    /// The text in the units of a system.
    pub fn csv_in(&self, units: System) -> String {
        // The level of a law whose exponent is not in the table stays.
        let change = |column: &Column| {
            renamed(&column.name, units).filter(|new| new.factor(|name| self.sibling(name, 0)).is_ok() || self.rows() == 0)
        };
        let changes: Vec<Option<Renamed>> = match units {
            System::Si => vec![None; self.columns.len()],
            System::Us => self.columns.iter().map(change).collect(),
        };
        let names = self.columns.iter().zip(&changes).map(|(column, new)| new.as_ref().map_or(&*column.name, |new| &new.name));
        let mut text = names.map(quoted).collect::<Vec<_>>().join(",") + "\n";
        for row in 0..self.rows() {
            let cell = |(column, new): (&Column, &Option<Renamed>)| match (new, column.cells.number(row), &column.cells) {
                (Some(new), Some(value), _) => new
                    .factor(|name| self.sibling(name, row))
                    .map_or_else(|_| String::new(), |factor| number_text(value * factor)),
                (_, _, Cells::Words(words)) if units == System::Us => quoted(&in_units(&words[row], units)).into_owned(),
                (_, _, cells) => quoted(&cells.text(row)).into_owned(),
            };
            let cells: Vec<String> = self.columns.iter().zip(&changes).map(cell).collect();
            text.push_str(&cells.join(","));
            text.push('\n');
        }
        text
    }

    fn sibling(&self, name: &str, row: usize) -> Option<f64> {
        self.columns.iter().find(|column| column.name == name)?.cells.number(row)
    }

    /// Of a text with a header, whichever units it is in; `path` stands in messages.
    /// Errors: a row with more or fewer cells than the header.
    pub fn read(text: &str, path: &Path) -> Result<Self> {
        let mut table = Table::new(path);
        let mut reader =
            csv::ReaderBuilder::new().has_headers(false).flexible(true).trim(csv::Trim::All).from_reader(text.as_bytes());
        let mut columns: Vec<(String, Vec<String>)> = Vec::new();
        for record in reader.records() {
            let at = |position: Option<&csv::Position>| position.map_or(1, |position| position.line() as usize);
            let record = record
                .map_err(|error| table.bad(at(error.position()), None, None, &format!("is not a line of the table: {error}")))?;
            if columns.is_empty() {
                columns = record.iter().map(|name| (name.to_owned(), Vec::new())).collect();
                continue;
            }
            let problem = || format!("has {} cells under {} columns", record.len(), columns.len());
            fail_if!(record.len() != columns.len(), table.bad(at(record.position()), None, None, &problem()));
            columns.iter_mut().zip(&record).for_each(|((_, cells), cell)| cells.push(cell.to_owned()));
        }
        table.columns =
            columns.into_iter().map(|(name, cells)| Column { name: name.into(), cells: Cells::Words(cells) }).collect();
        table.go_metric();
        Ok(table)
    }

    fn go_metric(&mut self) {
        let changes: Vec<(usize, Renamed, Vec<f64>)> = (0..self.columns.len())
            .filter_map(|place| {
                let column = &self.columns[place];
                let new = renamed(&column.name, System::Si)?;
                let values = self.get(&column.name).ok()?;
                let metric = |(row, value): (usize, &f64)| Some(value * new.factor(|name| self.sibling(name, row)).ok()?);
                let values = values.iter().enumerate().map(metric).collect::<Option<_>>()?;
                Some((place, new, values))
            })
            .collect();
        if !changes.is_empty() {
            self.units = System::Us;
            for column in &mut self.columns {
                if let Cells::Words(words) = &mut column.cells {
                    words.iter_mut().for_each(|text| *text = in_units(text, System::Si));
                }
            }
        }
        for (place, new, values) in changes {
            self.columns[place] = Column { name: new.name.into(), cells: Cells::Numbers(values, Digits::Some) };
        }
    }
}

impl Cells {
    fn numbers(values: impl IntoIterator<Item = impl Into<Option<f64>>>, digits: Digits) -> Self {
        Cells::Numbers(values.into_iter().map(|value| value.into().unwrap_or(f64::NAN)).collect(), digits)
    }

    /// The number of a row, NaN of an empty cell; `None` of text.
    fn number(&self, row: usize) -> Option<f64> {
        match self {
            Cells::Numbers(values, _) => values.get(row).copied(),
            Cells::Words(words) => words.get(row).and_then(|cell| number(cell)),
        }
    }

    fn len(&self) -> usize {
        match self {
            Cells::Numbers(values, _) => values.len(),
            Cells::Words(words) => words.len(),
        }
    }

    fn text(&self, row: usize) -> Cow<'_, str> {
        match self {
            Cells::Numbers(values, Digits::Some) => number_text(values[row]).into(),
            Cells::Numbers(values, Digits::Few) => rounded_text(values[row], 11).into(),
            Cells::Numbers(values, Digits::All) => exact_text(values[row]).into(),
            Cells::Numbers(values, Digits::None) => format!("{}", values[row]).into(),
            Cells::Words(words) => (&*words[row]).into(),
        }
    }
}

fn number(cell: &str) -> Option<f64> {
    if cell.is_empty() { Some(f64::NAN) } else { cell.parse().ok().filter(|value: &f64| value.is_finite()) }
}

/// A number so that it reads back bit for bit, with at least ten significant digits; empty for NaN.
pub fn exact_text(value: f64) -> String {
    placed(value, &format!("{value:e}"))
}

/// A quantity with 10 to 15 significant digits, so that 9 mm stay 9.000000000.
pub fn number_text(value: f64) -> String {
    rounded_text(value, 14)
}

fn rounded_text(value: f64, digits: usize) -> String {
    placed(value, &format!("{value:.digits$e}"))
}

/// A number in scientific form, as a decimal from 1e-4 to 1e15, with zeros behind its digits up to those that are wanted.
fn placed(value: f64, scientific: &str) -> String {
    let Some((mantissa, exponent)) = scientific.split_once('e').filter(|_| value != 0.0) else {
        return if value.is_nan() { String::new() } else { format!("{value}") };
    };
    let power: i32 = exponent.parse().unwrap_or(0);
    let mut text = String::with_capacity(32);
    if value < 0.0 {
        text.push('-');
    }
    let first = text.len();
    let digits = mantissa.trim_start_matches('-').trim_end_matches('0');
    text.extend(digits.chars().filter(|digit| *digit != '.'));
    let is_decimal = (-4..15).contains(&power);
    // Digits before the decimal point.
    let whole = if is_decimal { (power + 1).max(0) as usize } else { 1 };
    let wanted = DIGITS.max(whole) + first;
    while text.len() < wanted {
        text.push('0');
    }
    if is_decimal && power < 0 {
        text.insert_str(first, &"0.000"[..(1 - power) as usize]);
    } else if text.len() > first + whole {
        text.insert(first + whole, '.');
    }
    if !is_decimal {
        text.push('e');
        text.push_str(exponent);
    }
    text
}
