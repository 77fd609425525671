//! Columns of numbers: cycles `max,min,cycles`, or one column of turning points.

use super::content::{Content, RawCycle};
use super::rows::{Row, cells, fault, number};
use perilife_base::error::Result;

const REMEDY: &str = "give the columns max, min, cycles (or max, min for one each), or one column of turning points";

/// Columns of a title.
const COLUMNS: [&str; 3] = ["max", "min", "cycles"];

/// Whether a line holds numbers only.
pub(super) fn is_numbers(line: &str) -> bool {
    cells(line).all(|cell| cell.parse::<f64>().is_ok())
}

/// Whether a line has several cells.
pub(super) fn is_several(line: &str) -> bool {
    cells(line).nth(1).is_some()
}

/// Whether a title names the columns of cycles.
pub(super) fn names_cycles(line: &str) -> bool {
    let names: Vec<String> = cells(line).map(str::to_lowercase).collect();
    names.iter().any(|name| name == COLUMNS[0]) && names.iter().any(|name| name == COLUMNS[1])
}

/// Places of maximum, minimum and number of cycles.
fn places(title: Row<'_>) -> Result<[Option<usize>; 3]> {
    let (line, names) = (title.0, cells(title.1).map(str::to_lowercase).collect::<Vec<_>>());
    if let Some(strange) = names.iter().find(|name| !COLUMNS.contains(&name.as_str())) {
        let problem = "is no column of a spectrum, whose values are fractions of loading.spectrum_scale_mpa or spectrum_scale_n";
        return Err(fault(Some(line), "column", strange, problem, "name the columns max, min, cycles"));
    }
    Ok(COLUMNS.map(|column| names.iter().position(|name| name == column)))
}

/// Cycles in their order; a title may say which column is which.
pub(super) fn cycles<'a>(mut rows: impl Iterator<Item = Row<'a>>) -> Result<Content> {
    let mut of = [Some(0), Some(1), Some(2)];
    let mut found = Vec::new();
    let first = rows.next();
    if let Some(title) = first.filter(|(_, line)| !is_numbers(line)).filter(|(_, line)| names_cycles(line)) {
        of = places(title)?;
    } else if let Some(row) = first {
        found.push(cycle(row, of)?);
    }
    for row in rows {
        found.push(cycle(row, of)?);
    }
    Ok(Content::Cycles(found))
}

/// One row of cycles.
pub(super) fn cycle((line, text): Row<'_>, of: [Option<usize>; 3]) -> Result<RawCycle> {
    let mut values = [""; 3];
    let mut many = 0;
    for cell in cells(text) {
        if many < 3 {
            values[many] = cell;
        }
        many += 1;
    }
    if !(2..=3).contains(&many) {
        return Err(fault(Some(line), "row", text, &format!("has {many} values"), REMEDY));
    }
    let value = |column: usize| -> Result<f64> {
        match of[column].map(|place| values[place]) {
            Some("") | None if column == 2 => Ok(1.0),
            Some(cell) => number(line, COLUMNS[column], cell),
            None => Ok(f64::NAN),
        }
    };
    Ok(RawCycle { line, max: value(0)?, min: value(1)?, count: value(2)? })
}

/// Turning points, one a line; a title is passed over.
pub(super) fn points<'a>(rows: impl Iterator<Item = Row<'a>>) -> Result<Content> {
    let mut found = Vec::new();
    for (place, (line, text)) in rows.enumerate() {
        if place == 0 && !is_numbers(text) {
            continue;
        }
        let mut cells = cells(text);
        found.push(number(line, "load", cells.next().unwrap_or_default())?);
        if cells.next().is_some() {
            return Err(fault(Some(line), "row", text, "has several values, and rows before it have one", REMEDY));
        }
    }
    Ok(Content::Points(found))
}
