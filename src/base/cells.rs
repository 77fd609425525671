//! Cells of tables: how many are read, and how text is written so that a spreadsheet takes it for text.
//!
//! A file of a few kilobytes can stand for gigabytes of cells: one value repeated, one long text in a dictionary, a workbook that unpacks.
//! What a table becomes is therefore counted and bounded before it is laid out, whatever its file is.

use std::borrow::Cow;

/// Most cells of a table that is read; more than any table of readings has, and some hundred megabytes in memory.
pub const CELLS_MAX: usize = 10_000_000;
/// Most rows of a table that is read: a row costs some 200 bytes beside its cells.
pub const ROWS_MAX: usize = 4_000_000;
/// Most bytes of text that all cells of a table hold together.
pub const TEXT_MAX: usize = 256 << 20;
/// Most bytes that a packed file may unpack to.
pub const UNPACKED_MAX: u64 = 512 << 20;

/// What is said of a table that is too large, for behind its file.
pub fn too_many(what: &str, count: usize, most: usize) -> String {
    format!("has {count} {what}, limit {most}")
}

/// What to do about it.
pub const SMALLER: &str = "give the columns and rows of the readings alone, or split the file";

/// Whether a spreadsheet would read the text as a formula, or takes it for text only because of the apostrophe in front.
fn is_formula(text: &str) -> bool {
    let signs = text.trim_start_matches('\'');
    signs.starts_with(['=', '+', '-', '@', '\t', '\r'])
        && !(signs.len() == text.len() && text.parse::<f64>().is_ok_and(f64::is_finite))
}

/// Text that no spreadsheet runs as a formula: an apostrophe stands in front of `=`, `+`, `-`, `@`, tab or carriage return unless all of it
/// is a plain number. [`restored`] takes it away again.
///
/// ```
/// use perilife_base::cells::{defused, restored};
/// assert_eq!(defused("=1+1"), "'=1+1");
/// assert_eq!(restored("'=1+1"), "=1+1");
/// assert_eq!(defused("-5.3"), "-5.3");
/// ```
pub fn defused(text: &str) -> Cow<'_, str> {
    if is_formula(text) { Cow::Owned(format!("'{text}")) } else { Cow::Borrowed(text) }
}

/// What [`defused`] was given.
pub fn restored(cell: &str) -> &str {
    cell.strip_prefix('\'').filter(|_| is_formula(cell)).unwrap_or(cell)
}

/// Text of others as a field of a CSV file: [`defused`], in quotes where it holds a separator.
pub fn field(text: &str) -> String {
    quoted(&defused(text)).into_owned()
}

/// Text as a field of a CSV file: in quotes where it holds a separator.
pub fn quoted(text: &str) -> Cow<'_, str> {
    if text.contains([',', '"', '\n', '\r']) { format!("\"{}\"", text.replace('"', "\"\"")).into() } else { text.into() }
}
