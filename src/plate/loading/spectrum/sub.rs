//! `.sub` of AFGROW: sub-spectra one after the other, each a line with its number of rows, then rows `max min cycles`.

use super::content::Content;
use super::rows::{Row, cells, fault};
use super::table::{cycle, is_numbers};
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
            return Err(fault(Some(line), "row", title, "stands where a .sub file has its title", remedy));
        }
        if !is_title {
            found.push(cycle((line, title), [Some(0), Some(1), Some(2)])?);
            continue;
        }
        has_title = true;
        for read in 0..count.unwrap_or(0) {
            let Some(row) = rows.next() else {
                let problem = format!("names more rows than follow, {read}");
                return Err(fault(Some(line), "rows", title, &problem, "give as many rows max min cycles as the line says"));
            };
            found.push(cycle(row, [Some(0), Some(1), Some(2)])?);
        }
    }
    Ok(Content::Cycles(found))
}
