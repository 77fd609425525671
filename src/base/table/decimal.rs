//! Which sign is the decimal one, decided for a whole file and never for a cell.
//!
//! `5.000` is five, or five thousand. What decides: a cell with both signs, the same sign twice, or other than three digits behind it
//! (`12,00`). A column in which every sign has exactly three digits behind it, `5.000` next to `58.528`, stays open where nothing else in
//! the file decides, and for cycles even then; it is refused unless `[measured] decimal` says which it is.

use super::cells::{Row, Separator, Table};
use super::numerals::{Decimal, Evidence, evidence, number};
use crate::error::{Error, Result, fail_if};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Numbers {
    /// Its place in the header.
    pub index: usize,
    /// Whether it holds large whole numbers, cycles one by one or forces in N and lbf; the others never reach a thousand: lengths,
    /// kilocycles, forces in kN, stresses, ratios.
    pub counts: bool,
}

/// Decides the decimal sign of a table by the columns that are read, or else by the others.
/// Errors: cells that contradict each other, and columns that stay open.
pub fn decide(table: &Table, columns: &[Numbers], given: Option<Decimal>) -> Result<Decimal> {
    if let Some(given) = given {
        return Ok(given);
    }
    let seen: Vec<Seen<'_>> = columns.iter().map(|column| Seen::of(table, column.index)).collect();
    let proof = |decimal: Decimal| seen.iter().find_map(|seen| seen.proof(decimal));
    let decided = match (proof(Decimal::Point), proof(Decimal::Comma)) {
        (Some(point), Some(comma)) => return Err(contradiction(table, point, comma)),
        (Some(_), None) => Some(Decimal::Point),
        (None, Some(_)) => Some(Decimal::Comma),
        (None, None) => by_the_rest(table, columns, &seen),
    };
    let open = |seen: &Seen<'_>| seen.open[0].or(seen.open[1]).map(|row| open_column(table, row, seen.column));
    let Some(decided) = decided else {
        return seen.iter().find_map(open).map_or(Ok(Decimal::Point), Err);
    };
    for (seen, column) in seen.iter().zip(columns) {
        // Whole thousands beside decimals of the same sign, and thousands where none can be: one of two programs wrote the column.
        let own_sign = column.counts && seen.open[decided as usize].is_some() && seen.proofs[decided as usize].is_none();
        let other_sign = !column.counts && seen.open[decided.other() as usize].is_some();
        fail_if!(own_sign || other_sign, open(seen).unwrap_or_else(|| table.header_fault(seen.column).error("is ambiguous", "")));
    }
    Ok(decided)
}

/// The sign as columns that are not read prove it; that commas separate columns; or that no length has thousands.
fn by_the_rest(table: &Table, columns: &[Numbers], seen: &[Seen<'_>]) -> Option<Decimal> {
    let others = (0..table.header.len()).filter(|&index| columns.iter().all(|column| column.index != index));
    let others: Vec<Seen<'_>> = others.map(|column| Seen::of(table, column)).filter(|seen| seen.all_numbers).collect();
    let proved = |decimal: Decimal| others.iter().any(|seen| seen.proof(decimal).is_some());
    let measures = || seen.iter().zip(columns).filter(|(_, column)| !column.counts).map(|(seen, _)| seen);
    let in_measures = |decimal: Decimal| measures().any(|seen| seen.open[decimal as usize].is_some());
    match [proved(Decimal::Point), proved(Decimal::Comma)] {
        [true, false] => return Some(Decimal::Point),
        [false, true] => return Some(Decimal::Comma),
        _ => {}
    }
    match [in_measures(Decimal::Point), in_measures(Decimal::Comma)] {
        [true, false] => Some(Decimal::Point),
        [false, true] => Some(Decimal::Comma),
        // No comma can be seen where commas separate columns; points that separate thousands would need one somewhere.
        [false, false] if table.separator == Some(Separator::Comma) && seen.iter().all(|seen| seen.open[1].is_none()) => {
            Some(Decimal::Point)
        }
        _ => None,
    }
}

struct Seen<'t> {
    column: usize,
    all_numbers: bool,
    /// First cell that proves point, comma.
    proofs: [Option<&'t Row>; 2],
    /// First open cell with a point, a comma.
    open: [Option<&'t Row>; 2],
}

impl<'t> Seen<'t> {
    fn of(table: &'t Table, column: usize) -> Self {
        let mut seen = Seen { column, all_numbers: true, proofs: [None; 2], open: [None; 2] };
        for row in table.rows.iter().filter(|row| !row.cell(column).is_empty()) {
            match evidence(row.cell(column)) {
                Evidence::NoNumber => seen.all_numbers = false,
                Evidence::Whole => {}
                Evidence::Proves(decimal) => seen.proofs[decimal as usize] = seen.proofs[decimal as usize].or(Some(row)),
                Evidence::Open(decimal) => seen.open[decimal as usize] = seen.open[decimal as usize].or(Some(row)),
            }
        }
        seen
    }

    fn proof(&self, decimal: Decimal) -> Option<(&'t Row, usize)> {
        self.proofs[decimal as usize].map(|row| (row, self.column))
    }
}

const REMEDY: &str = "set measured.decimal = \".\" or \",\" (--decimal) for readings, or remove the thousands separators";

fn open_column(table: &Table, row: &Row, column: usize) -> Error {
    let cell = row.cell(column);
    let readings = [Decimal::Point, Decimal::Comma].map(|decimal| number(cell, decimal).unwrap_or(f64::NAN));
    let problem = format!("is ambiguous: {} or {}", readings[0], readings[1]);
    table.cell_fault(row, column).error(problem, REMEDY)
}

fn contradiction(table: &Table, point: (&Row, usize), comma: (&Row, usize)) -> Error {
    let (name, cell, line) = (&table.header[point.1], point.0.cell(point.1), point.0.line);
    let problem = format!("has a decimal comma, but {name} = {cell} on line {line} a decimal point");
    table.cell_fault(comma.0, comma.1).error(problem, "use one decimal sign in the whole file")
}
