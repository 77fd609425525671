//! Numbers in the cells of a reading, and its load.

use crate::calibration::columns::{Column, LoadColumns};
use crate::calibration::decimal::Decimal;
use crate::calibration::numerals::{is_number, number};
use crate::calibration::table::{Row, Table};
use crate::error::Result;

/// The number in a cell in SI units.
pub(super) fn value(table: &Table, row: &Row, column: Column, decimal: Decimal) -> Result<f64> {
    let cell = row.cell(column.index);
    let fault = || table.cell_fault(row, column.index);
    if cell.is_empty() {
        return Err(fault().error("is empty", "give a number or leave the whole row out"));
    }
    match number(cell, decimal) {
        Some(number) if number.is_finite() => Ok(number * column.factor),
        Some(_) => Err(fault().error("is not a finite number", "give the reading, or leave the whole row out")),
        None if cell.parse::<f64>().is_ok_and(|number| !number.is_finite()) => {
            Err(fault().error("is not a finite number", "give the reading, or leave the whole row out"))
        }
        None if !is_number(cell) => {
            Err(fault().error("is not a number", "give a plain number such as 1234.5 or 1.2345e3, thousands in groups of three"))
        }
        None => Err(fault().error(
            format!("is not a number whose decimal sign is the {} of this file", decimal.words()),
            "give a plain number such as 1234.5 or 1.2345e3, the same decimal sign in the whole file, thousands in groups of three",
        )),
    }
}

/// Largest load and stress ratio of a reading, the latter NaN where the file does not say it; of a file that has ranges alone, the range
/// in the place of the largest load.
pub(super) fn load(table: &Table, row: &Row, decimal: Decimal, columns: &LoadColumns) -> Result<Option<(f64, f64)>> {
    let Some(column) = columns.maximum.or(columns.range) else { return Ok(None) };
    let largest = value(table, row, column, decimal)?;
    if largest <= 0.0 {
        return Err(table
            .cell_fault(row, column.index)
            .error("is not above 0", "give the largest load of a cycle, tension positive"));
    }
    let of = |column: Option<Column>| column.map(|column| value(table, row, column, decimal)).transpose();
    let range = if columns.maximum.is_some() { of(columns.range)? } else { None };
    let ratio = match (of(columns.minimum)?, of(columns.ratio)?, range) {
        (Some(smallest), ..) if columns.maximum.is_some() => smallest / largest,
        // The largest is the smallest and the range.
        (Some(smallest), ..) => smallest / (smallest + largest),
        (None, Some(ratio), _) => ratio,
        (None, None, Some(range)) => 1.0 - range / largest,
        (None, None, None) => f64::NAN,
    };
    if ratio >= 1.0 {
        let column = columns.minimum.or(columns.ratio).or(columns.range).unwrap_or(column);
        return Err(table
            .cell_fault(row, column.index)
            .error("leaves no range of load", "give the smallest load below the largest"));
    }
    Ok(Some((largest, ratio)))
}
