//! What a table says of its readings beside the numbers: columns that say which count, remarks that reject one, a unit above the header.

use super::header::columns_of;
use super::import::Import;
use perilife_base::error::Result;
use perilife_base::table::names::{Column, Kind, Role};
use perilife_base::table::numerals::is_number;
use perilife_base::table::units::{CycleUnit, Unit};
use perilife_base::table::words::words;
use perilife_base::table::{Row, Table};

const YES: &str = "yes y true t 1 x ja j oui si wahr vrai";
const NO: &str = "no n false f 0 nein non falsch faux";
/// Cells that say whether the reading counts, whatever the name of the column asks.
const COUNTS: &str = "ok good valid keep kept use used include included accept accepted pass passed";
const COUNTS_NOT: &str = "bad invalid reject rejected outlier exclude excluded discard discarded fail failed";
/// Further words of remarks on readings that do not count.
const REMARKS: &str = "void voided unusable ungueltig verworfen ausreisser rejete rejetee invalide rechazado scartato";

/// What a cell says of its row: whether it counts; `None` where it cannot be understood. `is_out`: the column marks rows that do not.
pub(super) fn counts(cell: &str, is_out: bool) -> Option<bool> {
    let word = match cell.parse::<f64>() {
        Ok(number) => number.to_string(),
        Err(_) => cell.to_lowercase(),
    };
    let is = |list: &str| list.split(' ').any(|known| known == word);
    match word.as_str() {
        _ if is(COUNTS) => Some(true),
        _ if is(COUNTS_NOT) => Some(false),
        _ if is(YES) => Some(!is_out),
        _ if is(NO) => Some(is_out),
        _ => None,
    }
}

/// The note of rows whose remarks reject them, which are read all the same; `read`: places of the columns that are read.
pub(super) fn rejected(table: &Table, read: &[usize]) -> Option<String> {
    let is_word = |word: &String| [COUNTS_NOT, REMARKS].iter().any(|list| list.split(' ').any(|known| known == word));
    // "not rejected" and "no outlier" are rare, and only told of.
    let rejects = |remark: &str| !is_number(remark) && words(remark).0.iter().any(is_word);
    let columns: Vec<usize> = (0..table.header.len()).filter(|column| !read.contains(column)).collect();
    let of_row = |row: &Row| {
        columns.iter().find(|column| rejects(row.cell(**column))).map(|column| (row.line, *column, row.cell(*column).to_owned()))
    };
    let mut found = table.rows.iter().filter_map(of_row);
    let (line, column, cell) = found.next()?;
    let (file, name, count) = (table.file.display(), &table.header[column], found.count() + 1);
    let rows = if count == 1 { "row" } else { "rows" };
    Some(format!(
        "readings: {file}:{line}: {name} = \"{cell}\" looks like a rejection mark ({count} {rows}); these readings are used; exclude them \
         by measured.leave_out, or by a column valid with yes or no"
    ))
}

/// Whether a line says that cycles are counted in thousands or millions: `N x 1000`, `Zyklen in Tausend`; not `precracked for 50 thousand cycles`.
pub(super) fn is_of_thousands(line: &str) -> bool {
    let all = words(line).0;
    let is_cycles = |word: &String| Column::named(Kind::Readings, 0, word).role == Role::Cycles;
    let is_many = |from: usize| {
        let before = from.checked_sub(1).map_or("", |before| &all[before]);
        let is_said = match all[from].parse::<f64>() {
            Ok(_) => ["in", "of", "mal", "times"].contains(&before),
            Err(_) => all[from].len() > 2 && before.parse::<f64>().is_err() || all[from] == "x",
        };
        let spelled =
            (from + 1..=all.len().min(from + 3)).filter_map(|to| Unit::spelled(&all[from..to], Unit::Cycles(CycleUnit::Cycles)));
        is_said && spelled.into_iter().any(|unit| unit.si() > 1.0)
    };
    all.iter().any(is_cycles) && (0..all.len()).any(is_many)
}

fn is_blank(cell: &str) -> bool {
    cell.chars().all(|c| "-–—/".contains(c))
}

/// Leaves out the rows that such columns mark, with a note; a note, too, of cells that cannot be understood.
/// Errors: no row is left.
pub(super) fn exclude_flagged(table: &mut Table, import: &Import) -> Result<()> {
    let columns = columns_of(&table.header, &table.names, import);
    for Column { index, role, .. } in columns.into_iter().filter(|column| matches!(column.role, Role::Counts | Role::CountsNot)) {
        let (name, is_out) = (table.header[index].clone(), role == Role::CountsNot);
        let said: Vec<bool> = table.rows.iter().filter_map(|row| counts(row.cell(index), is_out)).collect();
        // Blank is what the cells that say something do not say.
        let blank = match (said.contains(&true), said.contains(&false)) {
            _ if is_out => Some(true),
            (true, false) => Some(false),
            (false, true) => Some(true),
            _ => None,
        };
        let of_row = |row: &Row| if is_blank(row.cell(index)) { blank } else { counts(row.cell(index), is_out) };
        let open: Vec<&Row> = table.rows.iter().filter(|row| of_row(row).is_none()).collect();
        if let Some(first) = open.first().filter(|_| !said.is_empty() || open.iter().any(|row| !is_blank(row.cell(index)))) {
            // `flags` of this program name what speaks against a rate, and are no marks of readings.
            if name == "flags" {
                continue;
            }
            let (file, line, cell, more) = (table.file.display(), first.line, first.cell(index), open.len() - 1);
            let note = format!(
                "table: {file}:{line}: {name} = \"{cell}\" is neither yes nor no ({more} more cells); these rows are used; write yes or no"
            );
            table.notes.push(note);
        }
        table.leave_out(&format!("flagged by the column {name}"), "remove the column to use them", |row| {
            of_row(row) == Some(false)
        })?;
    }
    Ok(())
}
