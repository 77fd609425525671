//! In which unit a column is: as its name says, or as the user does, and never two of them.

use crate::calibration::columns::{Column, unknown_shape};
use crate::calibration::import::{CycleUnit, Import, LengthUnit, LoadUnit};
use crate::calibration::names::{Meaning, Named, length_unit_at_end};
use crate::calibration::roles::Roles;
use crate::calibration::table::Table;
use crate::error::Result;

/// The column of a crack length.
pub(super) fn length_column(table: &Table, index: usize, roles: &Roles, import: &Import) -> Result<Column> {
    let (unit, share) = match roles.meanings[index] {
        Meaning::Length(unit) | Meaning::Side(unit) => (unit, 1.0),
        Meaning::Double(unit) => (unit, 0.5),
        _ => return Err(unknown_shape(table, roles)),
    };
    Ok(Column { index, factor: share * length_unit(table, index, unit, import)? })
}

fn length_unit(table: &Table, column: usize, named: Named<LengthUnit>, import: &Import) -> Result<f64> {
    let fault = table.header_fault(column);
    match (named, import.length) {
        (Named::Is(named), Some(given)) if named != given => Err(fault.error(
            format!("is in {named}, but measured.length_unit says {given}"),
            "name the unit in one place, or the same in both",
        )),
        (Named::Is(unit), _) | (Named::No, Some(unit)) => Ok(unit.metres()),
        (Named::Strange, _) => Err(fault.error(
            "has a unit that is not known",
            "known are mm, inch and m; convert the column, or name another by measured.columns.length (--column length=...)",
        )),
        (Named::No, None) => Err(fault.error(
            "does not say its unit",
            "name it crack_length_mm, crack_length_inch or crack_length_m, or set measured.length_unit (--length-unit)",
        )),
    }
}

/// The unit of a specimen's column in a wide table: of its name, or as the user says.
pub(super) fn wide_length_unit(table: &Table, column: usize, import: &Import) -> Result<f64> {
    match (length_unit_at_end(&table.names[column]), import.length) {
        (Named::No, None) => Err(table.header_fault(column).error(
            "does not say the unit of its crack lengths",
            "set measured.length_unit = \"mm\", \"inch\" or \"m\" (--length-unit)",
        )),
        // What stands in brackets may be part of a specimen's name.
        (Named::Strange, Some(unit)) => Ok(unit.metres()),
        (named, _) => length_unit(table, column, named, import),
    }
}

pub(super) fn cycle_unit(table: &Table, column: usize, roles: &Roles, import: &Import) -> Result<f64> {
    let Meaning::Cycles(named) = roles.meanings[column] else { return Err(unknown_shape(table, roles)) };
    let fault = table.header_fault(column);
    match (named, import.cycles) {
        (Named::Is(named), Some(given)) if named != given => Err(fault.error(
            format!("is in {named}, but measured.cycle_unit says {given}"),
            "name the unit in one place, or the same in both",
        )),
        (Named::Is(unit), _) | (Named::No, Some(unit)) => Ok(unit.cycles()),
        (Named::No, None) => Ok(CycleUnit::Cycles.cycles()),
        (Named::Strange, Some(unit)) => Ok(unit.cycles()),
        (Named::Strange, None) => Err(fault.error(
            "counts cycles in a unit that is not known",
            "known are cycles, kilocycles (x1000) and megacycles; set measured.cycle_unit (--cycle-unit)",
        )),
    }
}

/// The unit of a load; `None` where it is not said and the loads do not change, so that those of the case hold for all.
pub(super) fn load_unit(
    table: &Table,
    column: usize,
    named: Named<LoadUnit>,
    import: &Import,
    warnings: &mut Vec<String>,
) -> Result<Option<LoadUnit>> {
    let fault = table.header_fault(column);
    match (named, import.load) {
        (Named::Is(named), Some(given)) if named != given => Err(fault.error(
            format!("is in {named}, but measured.load_unit says {given}"),
            "name the unit in one place, or the same in both",
        )),
        (Named::Is(unit), _) | (Named::No, Some(unit)) => Ok(Some(unit)),
        (Named::Strange | Named::No, _) => {
            let known: Vec<&str> = LoadUnit::ALL.iter().map(|unit| unit.name()).collect();
            let remedy = format!("name one of {} in the header, or set measured.load_unit (--load-unit)", known.join(", "));
            let first = table.rows.first().map_or("", |row| row.cell(column));
            if let Some(row) = table.rows.iter().find(|row| row.cell(column) != first) {
                let problem = format!("is a load that changes (from {first}), in a unit that is not known");
                return Err(table.cell_fault(row, column).error(problem, remedy));
            }
            warnings.push(format!(
                "{}: {} is a load in a unit that is not known: not read, the load of the case holds for all readings; {remedy}",
                table.file.display(),
                table.header[column]
            ));
            Ok(None)
        }
    }
}
