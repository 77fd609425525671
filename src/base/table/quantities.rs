//! Tables of numbers whose columns are known by name: β over crack length, residual stress over a plate, cycles of a spectrum.

use super::cells::{Fault, Row, Table, whole_file};
use super::decimal::{Numbers, decide};
use super::names::{Column, Kind, Named, Role};
use super::numerals::{is_number, number};
use super::units::Unit;
use super::{Decimal, Sheet, Vocabulary};
use crate::error::{Result, fail_if};

/// What is asked of such a table.
#[derive(Clone, Copy)]
pub struct Words {
    pub kind: Kind,
    /// Roles that its columns may have; all where it is empty.
    pub roles: &'static [Role],
    /// Whether columns of these roles are enough.
    pub is_enough: fn(&[Role]) -> bool,
    pub columns: usize,
    pub remedy: &'static str,
}

impl Vocabulary for Words {
    fn is_header(&self, names: &[String]) -> bool {
        let roles: Vec<Role> = names.iter().filter_map(|name| self.role(name)).map(|(role, _)| role).collect();
        (self.is_enough)(&roles)
    }

    fn sheet(&self) -> Option<&Sheet> {
        None
    }

    fn columns(&self) -> usize {
        self.columns
    }

    fn remedy(&self) -> &str {
        self.remedy
    }
}

impl Words {
    /// Role and unit of a name; `None` of one that such a table does not have.
    pub fn role(&self, name: &str) -> Option<(Role, Named)> {
        let column = Column::named(self.kind, 0, name);
        let is_wanted = match self.roles {
            [] => column.role != Role::Unknown,
            roles => roles.contains(&column.role),
        };
        (is_wanted && !column.is_tip_to_tip()).then_some((column.role, column.unit))
    }

    /// Role and unit of every column.
    /// Errors: no header, a header without the columns, a name that is not known, two columns of one role but of others.
    pub fn roles(&self, table: &Table) -> Result<Vec<(Role, Named)>> {
        let known: Vec<Option<(Role, Named)>> = table.names.iter().map(|name| self.role(name)).collect();
        let roles: Vec<Role> = known.iter().flatten().map(|(role, _)| *role).collect();
        let fault = |column: usize, problem: &str| table.header_fault(column).error(problem, self.remedy);
        let of_row = |line, value| Fault { line: Some(line), value: Some(value), ..whole_file(&table.file) };
        if let Some(row) = table.rows.first().filter(|_| table.header_line == 0) {
            let problem = "begins a table whose columns have no names";
            return Err(of_row(row.line, row.cell(0)).error(problem, self.remedy));
        }
        fail_if!(let Some(strange) = known.iter().position(Option::is_none), fault(strange, "unknown column"));
        if !(self.is_enough)(&roles) {
            let names = table.header.join(",");
            let fault = Fault { key: Some("header"), ..of_row(table.header_line, &names) };
            return Err(fault.error("has no column", self.remedy));
        }
        let twice = |at: &usize| roles[*at] != Role::Other && roles[..*at].contains(&roles[*at]);
        match (0..roles.len()).find(twice) {
            Some(second) => Err(fault(second, "duplicates an earlier column")),
            None => Ok(known.into_iter().flatten().collect()),
        }
    }
}

/// The unit of a name, in SI; the unit that is meant where the name has none.
/// Errors: no unit at all, or one of another quantity.
pub fn in_si(table: &Table, column: usize, unit: Named, otherwise: Option<Unit>) -> Result<f64> {
    let fault = |problem: &str| Err(table.header_fault(column).error(problem, "write the unit after the name: \"a (mm)\""));
    match (unit, otherwise) {
        (Named::Is(unit), _) => Ok(unit.si()),
        (Named::No, Some(unit)) => Ok(unit.si()),
        (Named::No, None) => fault("has no unit"),
        (Named::Strange, _) => fault("has an unknown unit"),
    }
}

/// The numbers of some columns, row by row, each with its line; `counts` says of a column whether it has large whole numbers.
/// Errors: cells that are not numbers, or whose decimal sign is not certain.
pub fn numbers(table: &Table, columns: &[(usize, bool)]) -> Result<Vec<(usize, Vec<f64>)>> {
    let sought: Vec<Numbers> = columns.iter().map(|&(index, counts)| Numbers { index, counts }).collect();
    let decimal = decide(table, &sought, None)?;
    let of_row =
        |row: &Row| Ok((row.line, columns.iter().map(|column| number_at(table, row, column.0, decimal)).collect::<Result<_>>()?));
    table.rows.iter().map(of_row).collect()
}

/// The number of a cell.
/// Errors: none, one that is not finite, or one with the other decimal sign.
pub fn number_at(table: &Table, row: &Row, column: usize, decimal: Decimal) -> Result<f64> {
    let cell = row.cell(column);
    let refused = |problem: &str, remedy: &str| Err(table.cell_fault(row, column).error(problem, remedy));
    match number(cell, decimal) {
        Some(number) if number.is_finite() => Ok(number),
        None if cell.is_empty() => refused("is empty", "give a number or remove the row"),
        None if is_number(cell) => refused(
            &format!("is not a number whose decimal sign is the {} of this file", decimal.words()),
            "give a plain number such as 1234.5 or 1.2345e3, the same decimal sign in the whole file, thousands in groups of three",
        ),
        None if !cell.parse::<f64>().is_ok_and(|number| !number.is_finite()) => {
            refused("is not a number", "give a plain number such as 1234.5 or 1.2345e3, thousands in groups of three")
        }
        _ => refused("is not a finite number", "give the reading, or remove the row"),
    }
}
