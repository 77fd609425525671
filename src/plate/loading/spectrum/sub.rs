//! `.sub` of AFGROW: sub-spectra one after the other, each a line with its number of rows, then rows `max min cycles`.

use super::content::{Content, RawCycle};
use super::rows::{Row, cells, fault, number};
use perilife_base::error::Result;

/// Reads all sub-spectra in their order.
pub(super) fn read<'a>(mut rows: impl Iterator<Item = Row<'a>>) -> Result<Content> {
    let mut found = Vec::new();
    let mut has_title = false;
    while let Some((line, title)) = rows.next() {
        // A title in words stands for one with an unknown number of rows.
        let count = if is_numbers(title) { cells(title).next().and_then(|cell| cell.parse::<usize>().ok()) } else { None };
        let is_title = !is_numbers(title) || cells(title).count() == 1;
        if !is_title && !has_title {
            let remedy = "give a title line first, with the number of rows that follow";
            return Err(fault(Some(line), "row", title, "expected the title line of a .sub file", remedy));
        }
        if !is_title {
            found.push(cycle((line, title))?);
            continue;
        }
        has_title = true;
        for read in 0..count.unwrap_or(0) {
            let Some(row) = rows.next() else {
                let problem = format!("gives more rows than follow, {read}");
                return Err(fault(Some(line), "rows", title, &problem, "give that number of rows max min cycles"));
            };
            found.push(cycle(row)?);
        }
    }
    Ok(Content::Cycles(found))
}

/// Whether a line holds numbers alone.
fn is_numbers(line: &str) -> bool {
    cells(line).all(|cell| cell.parse::<f64>().is_ok())
}

/// A row `max min cycles`, or `max min` of one cycle.
fn cycle((line, text): Row<'_>) -> Result<RawCycle> {
    let values: Vec<f64> = cells(text).map(|cell| number(line, "row", cell)).collect::<Result<_>>()?;
    match values[..] {
        [max, min] => Ok(RawCycle { line, max, min, count: 1.0 }),
        [max, min, count] => Ok(RawCycle { line, max, min, count }),
        _ => Err(fault(Some(line), "row", text, &format!("has {} values", values.len()), "give rows max min cycles")),
    }
}
