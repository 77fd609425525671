//! What stands between the columns of a text table, and lines cut by it.

use std::path::Path;

use csv::StringRecord;

use super::{Row, whole_file};
use crate::cells::{CELLS_MAX, SMALLER, too_many};
use crate::error::Result;

/// A line of the file with its number.
pub(super) type Line<'a> = (usize, &'a str);

/// What stands between columns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Separator {
    /// A tab.
    Tab,
    /// A semicolon.
    Semicolon,
    /// A comma.
    Comma,
    /// A vertical bar.
    Bar,
    /// Two blanks or more, so that names may have blanks.
    Gap,
    /// Any number of blanks.
    Blanks,
}

impl Separator {
    /// All, those first that stand in numbers least.
    pub(super) const ALL: [Separator; 6] =
        [Separator::Tab, Separator::Semicolon, Separator::Comma, Separator::Bar, Separator::Gap, Separator::Blanks];

    /// Its name in messages.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Separator::Tab => "tabs",
            Separator::Semicolon => "semicolons",
            Separator::Comma => "commas",
            Separator::Bar => "vertical bars",
            Separator::Gap => "two or more blanks",
            Separator::Blanks => "blanks",
        }
    }

    /// Its character; `None` for a run of blanks.
    pub(super) fn character(self) -> Option<char> {
        match self {
            Separator::Tab => Some('\t'),
            Separator::Semicolon => Some(';'),
            Separator::Comma => Some(','),
            Separator::Bar => Some('|'),
            Separator::Gap | Separator::Blanks => None,
        }
    }

    /// The lines cut into cells, quotes respected.
    ///
    /// # Errors
    /// More cells than a table that is read may have: a byte of text can be one of them, which takes up eight and more.
    pub(super) fn cut(self, lines: &[Line<'_>], file: &Path) -> Result<Vec<Row>> {
        let cells = lines.iter().map(|(_, text)| self.cells(text)).sum::<usize>();
        if cells > CELLS_MAX {
            return Err(
                whole_file(file).error(format!("{}, cut at {}", too_many("cells", cells, CELLS_MAX), self.name()), SMALLER)
            );
        }
        match self.character() {
            // Quotes may hold the separator and line ends.
            Some(character) if lines.iter().any(|(_, text)| text.contains('"')) => records(lines, character as u8, file),
            Some(character) => Ok(lines.iter().map(|&(line, text)| Row { line, cells: at_character(text, character) }).collect()),
            None => Ok(lines.iter().map(|&(line, text)| Row { line, cells: self.at_blanks(text) }).collect()),
        }
    }

    /// Cells of a line, at the most.
    fn cells(self, text: &str) -> usize {
        match self.character() {
            Some(character) => text.matches(character).count() + 1,
            None => text.split_whitespace().count(),
        }
    }

    fn at_blanks(self, text: &str) -> StringRecord {
        let whole = text.trim();
        match self {
            Separator::Gap => whole.split("  ").map(str::trim).filter(|cell| !cell.is_empty()).collect(),
            _ => whole.split_whitespace().collect(),
        }
    }
}

fn at_character(text: &str, character: char) -> StringRecord {
    let mut cells = StringRecord::with_capacity(text.len(), text.matches(character).count() + 1);
    text.split(character).for_each(|cell| cells.push_field(cell.trim()));
    cells
}

/// Records of the lines. The CSV reader counts lines of what it is given, `lines` maps them to lines of the file.
fn records(lines: &[Line<'_>], separator: u8, file: &Path) -> Result<Vec<Row>> {
    let mut joined = String::with_capacity(lines.iter().map(|(_, line)| line.len() + 1).sum());
    for (_, line) in lines {
        joined.push_str(line);
        joined.push('\n');
    }
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .delimiter(separator)
        .trim(csv::Trim::All)
        .from_reader(joined.as_bytes());
    let mut rows = Vec::with_capacity(lines.len());
    for record in reader.records() {
        let record = record
            .map_err(|error| whole_file(file).error(format!("cannot be cut into columns ({error})"), "save it as plain CSV"))?;
        let position = record.position().map_or(1, |position| position.line() as usize);
        let line = lines.get(position.saturating_sub(1)).map_or(0, |&(line, _)| line);
        rows.push(Row { line, cells: record });
    }
    Ok(rows)
}
