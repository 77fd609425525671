//! Columns that say whether a reading counts: `valid`, `use`, `outlier`, `flag`.

use super::header::columns_of;
use super::import::Import;
use perilife_base::error::Result;
use perilife_base::table::names::vocabulary::{MARKS_KEEP, MARKS_OUT};
use perilife_base::table::names::{Role, any_in, of_words, says_one_of};
use perilife_base::table::numerals::is_number;
use perilife_base::table::{Row, Table};

/// Cells that answer what the name of the column asks.
const YES: &str = "yes y true t 1 x ja j oui si wahr vrai";
/// See [`YES`].
const NO: &str = "no n false f 0 nein non falsch faux";
/// Cells that say whether the reading counts, whatever the name of the column asks.
const COUNTS: &str = "ok good valid keep kept use used include included accept accepted pass passed";
/// See [`COUNTS`].
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

/// Whether a remark says that its reading does not count.
pub(super) fn rejects(remark: &str) -> bool {
    // "not rejected" and "no outlier" are rare, and only told of.
    !is_number(remark) && [COUNTS_NOT, REMARKS].iter().any(|list| says_one_of(remark, list))
}

fn is_blank(cell: &str) -> bool {
    cell.chars().all(|c| "-–—/".contains(c))
}

/// Leaves out the rows that such columns mark, with a note; a note, too, of cells that cannot be understood.
/// Errors: no row is left.
pub(super) fn leave_marked_out(table: &mut Table, import: &Import) -> Result<()> {
    let columns = columns_of(&table.header, &table.names, import);
    for index in columns.iter().filter(|column| column.role == Role::Mark).map(|column| column.index) {
        let (name, is_out) = (table.header[index].clone(), marks_out(&table.names[index]));
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
            let note = format!(
                "{}:{}: {name} = \"{}\" does not say whether the row counts, nor do {} more cells of this column: such rows are read \
                 like the others; write yes or no",
                table.file.display(),
                first.line,
                first.cell(index),
                open.len() - 1
            );
            table.notes.push(note);
        }
        table.leave_out(&format!("marked by the column {name}"), "take the column out of the table to read them", |row| {
            of_row(row) == Some(false)
        })?;
    }
    Ok(())
}

/// Whether a column that says which readings count marks those that do not.
fn marks_out(name: &str) -> bool {
    of_words(name, |words, _| any_in(words, MARKS_OUT) || !any_in(words, MARKS_KEEP))
}
