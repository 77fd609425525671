//! Tables of text as cells, each row with its line: from CSV in any usual dress, or a workbook.
//!
//! Only the form is judged here: the encoding and which character separates columns (`lines`), which row is the header (`cut`), which
//! sign is the decimal one ([`decimal`]). What a column means is said by the [`Vocabulary`] of whoever reads.

pub mod cells;
mod cut;
pub mod decimal;
mod hidden;
mod lines;
pub mod names;
pub mod numerals;
pub mod quantities;
pub mod units;
pub mod words;
mod workbook;

use std::path::Path;

use toml::Value;

pub use cells::{Fault, Row, Separator, Table, whole_file};
pub use lines::decoded;
pub use numerals::Decimal;
pub use workbook::is_workbook;

use crate::error::Result;
use crate::keys::{Field, Key, Shape, refuse};

/// What the reader of a table knows of it before it is cut.
pub trait Vocabulary {
    /// Whether these names are the header of a table of the kind that is looked for.
    fn is_header(&self, names: &[String]) -> bool;
    /// Whether a row is left out by its line, so that it may have other columns than the header.
    fn leaves_out(&self, _line: usize) -> bool {
        false
    }
    /// The sheet of a workbook that is asked for.
    fn sheet(&self) -> Option<&Sheet>;
    fn columns(&self) -> usize {
        2
    }
    /// What to give where a file is no such table.
    fn remedy(&self) -> &str {
        "give a header line `specimen,cycles,crack_length_mm`, with at least the columns cycles and crack_length_mm, and at least 5 readings"
    }
}

/// Cuts the bytes of a file into cells: a workbook by its content, everything else as text.
/// Errors: no table of the kind that is looked for, or a sheet of what is no workbook.
pub fn read(bytes: &[u8], file: &Path, words: &dyn Vocabulary) -> Result<Table> {
    if workbook::is_workbook(bytes, file) {
        return workbook::table(bytes, file, words);
    }
    if let Some(sheet) = words.sheet() {
        let fault = Fault { key: Some("measured.sheet"), value: Some(&sheet.0), ..whole_file(file) };
        return Err(fault.error("is set for a file that is not a workbook", "remove sheet, or give the .xlsx file"));
    }
    cut::text(&lines::decoded(bytes, file)?, file, words)
}

/// A sheet by name, or by number from 1.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Sheet(pub String);

impl Field for Sheet {
    const SHAPE: Shape = Shape::Other("the name of a sheet or its number");
    fn take(key: &Key, path: &str, value: &Value) -> Result<Self> {
        text_or_number(value).map(Sheet).map_or_else(|| refuse(key, path, value, Self::SHAPE), Ok)
    }
}

pub fn text_or_number(value: &Value) -> Option<String> {
    let number = || value.as_integer().and_then(|number| u32::try_from(number).ok()).map(|number| number.to_string());
    value.as_str().map(str::to_owned).or_else(number)
}
