//! Rows of numbers in the text of `.sub` and FASTRAN, and errors that name their line.

use perilife_base::error::{Error, InputError};

/// A line that is not empty and no comment: its number, counted from 1, and what it holds.
pub(super) type Row<'a> = (usize, &'a str);

/// Lines that say something; what stands behind `#` is a comment.
pub(super) fn rows(text: &str) -> impl Iterator<Item = Row<'_>> {
    let numbered = text.lines().enumerate().map(|(place, line)| (place + 1, line.split('#').next().unwrap_or_default().trim()));
    numbered.filter(|(_, line)| !line.is_empty())
}

/// Cells of a line: between semicolons, or else between commas, tabs and blanks.
pub(super) fn cells(line: &str) -> impl Iterator<Item = &str> {
    let by_semicolon = line.contains(';');
    let is_between = move |c: char| if by_semicolon { c == ';' } else { c == ',' || c.is_whitespace() };
    line.split(is_between).map(str::trim).filter(|cell| !cell.is_empty())
}

/// The number of a cell.
/// Errors: none, or one that is not finite.
pub(super) fn number(line: usize, column: &str, cell: &str) -> Result<f64, Error> {
    let remedy = "give a number with a decimal point";
    match cell.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        Ok(_) => Err(fault(Some(line), column, cell, "is not a finite number", remedy)),
        Err(_) => Err(fault(Some(line), column, cell, "is not a number", remedy)),
    }
}

/// An error about a value of a spectrum; the file is named by who knows it.
pub(super) fn fault(line: Option<usize>, column: &str, value: &str, problem: &str, remedy: &str) -> Error {
    Error::Input(Box::new(InputError {
        line,
        key: Some(column.to_owned()),
        value: Some(value.to_owned()),
        problem: problem.to_owned(),
        remedy: remedy.to_owned(),
        ..InputError::default()
    }))
}
