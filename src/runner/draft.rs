//! An input file put together in code: its sections, and what lies beside it.

use std::path::Path;

use toml::{Table, Value};

use perilife_base::error::{Result, input_missing};
use perilife_base::input::{Document, Folder};
use perilife_calibration::calibrate::Calibration;
use perilife_growth::case::{Case, RECORD, remove_law};

/// Sections of an input file in the making; the keys are those of the file.
///
/// ```
/// use perilife_growth::predict::{Silent, predict};
/// use perilife_runner::Draft;
/// use toml::toml;
///
/// let panel = Draft::new("panel")
///     .section("specimen", toml! {
///         kind = "middle_tension"
///         width_mm = 100.0
///         length_mm = 300.0
///         thickness_mm = 2.0
///         crack_length_mm = 5.0
///     })
///     .section("material", toml! { name = "al2024-t3" })
///     .section("loading", toml! {
///         stress_max_mpa = 80.0
///         stress_ratio = 0.1
///     })
///     .section("fatigue", toml! {
///         paris_c_mm_per_cycle = 8e-8
///         paris_m = 3.0
///     });
/// let shorter = predict(&panel.clone().section("loading", toml! { stress_max_mpa = 90.0 }).case()?, &Silent)?;
/// assert!(shorter.life_cycles() < predict(&panel.case()?, &Silent)?.life_cycles());
/// # Ok::<(), perilife_base::error::Error>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Draft {
    name: String,
    table: Table,
    files: Vec<(String, Vec<u8>)>,
}

impl Draft {
    /// Without sections.
    pub fn new(name: impl Into<String>) -> Self {
        Draft::of(name, Table::new())
    }

    pub fn of(name: impl Into<String>, table: Table) -> Self {
        Draft { name: name.into(), table, files: Vec::new() }
    }

    /// Adds keys to a section; those that it has already get the new values.
    pub fn section(mut self, section: &str, keys: Table) -> Self {
        extend(&mut self.table, section, keys);
        self
    }

    /// Adds a file that keys name, before any of that name in the current folder.
    pub fn file(mut self, name: impl Into<String>, content: impl Into<Vec<u8>>) -> Self {
        self.files.push((name.into(), content.into()));
        self
    }

    /// Adds a table of readings, in any form that a laboratory writes, for a calibration.
    pub fn readings(self, name: &str, content: impl Into<Vec<u8>>) -> Self {
        let mut files = self.table.get("measured").and_then(|measured| measured.get("files")?.as_array().cloned());
        let files = files.get_or_insert_default();
        files.push(name.into());
        let keys = Table::from_iter([("files".to_owned(), Value::from(std::mem::take(files)))]);
        self.section("measured", keys).file(name, content)
    }

    /// Puts the law of a fit in the place of the one it has: the text of `fitted.toml`
    /// ([`Fitted::record_text`](perilife_calibration::calibrate::Fitted::record_text)).
    pub fn law(mut self, record: &str) -> Self {
        put_law(&mut self.table, Table::from_iter([("fitted".to_owned(), RECORD.into())]));
        self.file(RECORD, record)
    }

    /// As a document, whose files lie in the current folder where they are not given.
    /// Errors: a value that has no form in TOML.
    pub fn document(&self) -> Result<Document> {
        let text = toml::to_string(&self.table)
            .map_err(|error| input_missing("case", format!("cannot be written as TOML: {error}"), "give tables of keys"))?;
        Document::parse(&text, &self.name, Folder::from(Path::new("")).anew_with(self.files.iter().cloned()), &[])
    }

    /// As a checked case.
    /// Errors: as [`Case::from_document`].
    pub fn case(&self) -> Result<Case> {
        Case::from_document(&self.document()?)
    }

    /// As a checked calibration.
    /// Errors: as [`Calibration::from_document`].
    pub fn calibration(&self) -> Result<Calibration> {
        Calibration::from_document(&self.document()?)
    }
}

/// Puts keys of a law into `[fatigue]` in the place of those that the table has.
pub fn put_law(table: &mut Table, law: Table) {
    remove_law(table);
    extend(table, "fatigue", law);
}

fn extend(table: &mut Table, section: &str, keys: Table) {
    let place = table.entry(section).or_insert_with(|| Table::new().into());
    match place {
        Value::Table(known) => known.extend(keys),
        other => *other = keys.into(),
    }
}
