//! Sections of an input file: those there may be, and those that must be.

use toml::{Table, Value};

use super::slice::shorten;
use crate::error::{Result, input, input_missing};

/// Sections of another sort of file: their names, what is wrong with them here, what would be right.
pub type ForeignSections = (&'static [&'static str], &'static str, &'static str);

/// The sections of one file, all of them known and tables.
pub struct Sections<'t> {
    table: &'t Table,
    empty: Value,
}

impl<'t> Sections<'t> {
    /// Looks at the sections of a file.
    /// Errors: anything but a table under one of the `known` names; `strangers` get words of their own.
    pub fn of(table: &'t Table, known: &[&str], strangers: &[ForeignSections]) -> Result<Self> {
        for (name, value) in table {
            if !known.contains(&name.as_str()) {
                if let Some((_, problem, remedy)) = strangers.iter().find(|(names, ..)| names.contains(&name.as_str())) {
                    return Err(input(name, shorten(value), *problem, *remedy));
                }
                let what = if value.is_table() { "is not a known section" } else { "stands in no section" };
                return Err(input(name, shorten(value), what, format!("known sections: {}", known.join(", "))));
            }
            if !value.is_table() {
                return Err(input(name, shorten(value), "is not a section", format!("write [{name}] and its keys below")));
            }
        }
        Ok(Sections { table, empty: Value::Table(Table::new()) })
    }

    /// A section that must be there.
    pub fn required(&self, section: &str) -> Result<&Value> {
        self.given(section).ok_or_else(|| input_missing(section, "is missing", format!("write a section [{section}]")))
    }

    /// A section, without keys where it is left out.
    pub fn optional(&self, section: &str) -> &Value {
        self.given(section).unwrap_or(&self.empty)
    }

    /// A section that may be left out.
    pub fn given(&self, section: &str) -> Option<&Value> {
        self.table.get(section)
    }

    /// The whole input as results repeat it.
    /// Errors: values that JSON has not.
    pub fn echo(&self) -> Result<serde_json::Value> {
        serde_json::to_value(self.table).map_err(|error| input_missing("file", error.to_string(), "write it as plain TOML"))
    }
}
