//! An input file as text and table, with overrides, the line of every key, and its sections.

use std::path::{Path, PathBuf};

use serde::Deserialize;
use toml::de::{DeTable, DeValue};
use toml::{Table, Value};

use super::folder::{Folder, OpenedFile, STREAM, text_of};
use super::slice::{path_steps, shorten, value_at};
use super::us_keys::{Written, as_written, metric, to_metric, twin};
use crate::error::{Error, InputError, Result, fail_if, input, input_missing};
use crate::keys::nearest;

const BY_SET: &str = " (value given by --set)";

/// A parsed input file that still knows where everything stands in the text.
#[derive(Debug, Clone)]
pub struct Document {
    pub name: String,
    /// Where the files lie that it names.
    pub folder: Folder,
    /// Content with overrides applied; keys in US units are the metric ones here.
    pub table: Table,
    /// The same with the keys as they were written.
    as_given: Table,
    written: Vec<Written>,
    file: Option<PathBuf>,
    text: String,
    overridden: Vec<String>,
}

impl Document {
    /// Reads a TOML file, once, and applies `section.key=value` overrides; `-` is standard input.
    pub fn read(path: &Path, overrides: &[String]) -> Result<Self> {
        // What comes through a pipe lies nowhere: its names start from the current folder.
        let is_pipe = ["/dev", "/proc"].iter().any(|system| path.starts_with(system));
        let folder: Folder = if is_pipe { Path::new("") } else { path.parent().unwrap_or(Path::new("")) }.into();
        let text = text_of(folder.opened().read(path, &path.display().to_string())?, path)?;
        Self::of_file(text, path, folder, overrides)
    }

    /// A TOML file in a folder, with overrides; the files that it names lie beside it.
    ///
    /// Errors: one that cannot be read, or is not TOML; overrides that are none.
    pub fn in_folder(folder: &Folder, name: &str, overrides: &[String]) -> Result<Self> {
        let path = folder.path(name);
        let text = text_of(folder.read(name)?, &path)?;
        Self::of_file(text, &path, folder.beside(&path), overrides)
    }

    /// The text of a file; the files it names lie in `folder`.
    fn of_file(text: String, path: &Path, folder: Folder, overrides: &[String]) -> Result<Self> {
        // Standard input has no name.
        let stem = path.file_stem().filter(|stem| *stem != STREAM);
        let name = stem.map_or_else(|| "case".to_owned(), |stem| stem.to_string_lossy().into_owned());
        Self::build(text, name, folder, Some(path.to_path_buf()), overrides)
    }

    /// The same for text that is not in a file; the files it names lie in `folder`.
    pub fn parse(text: &str, name: &str, folder: impl Into<Folder>, overrides: &[String]) -> Result<Self> {
        let folder: Folder = folder.into();
        let file = OpenedFile { name: format!("{name}.toml"), path: None, id: None, content: text.as_bytes().into() };
        folder.opened().add(file);
        Self::build(text.to_owned(), name.to_owned(), folder, None, overrides)
    }

    fn build(text: String, name: String, folder: Folder, file: Option<PathBuf>, overrides: &[String]) -> Result<Self> {
        let table = text.parse::<Table>().map_err(|error| syntax_error(&error, &text, file.as_deref()))?;
        let (as_given, written) = (table.clone(), Vec::new());
        let mut document = Document { name, folder, table, as_given, written, file, text, overridden: Vec::new() };
        document.set_all(overrides)?;
        Ok(document)
    }

    /// Whether a key has its value from an override.
    pub fn is_overridden(&self, key: &str) -> bool {
        self.overridden.iter().any(|set| key.starts_with(set.as_str()))
    }

    /// Names file and line in an error about a key of this document.
    pub fn locate(&self, error: Error) -> Error {
        let Error::Input(trouble) = error else { return error };
        let mut all: Vec<InputError> = trouble.each().into_iter().map(|one| self.locate_one(one)).collect();
        all.sort_by_key(|one| one.line.unwrap_or(usize::MAX));
        let first = all.remove(0);
        Error::Input(Box::new(InputError { more: all, ..first }))
    }

    fn locate_one(&self, trouble: InputError) -> InputError {
        let mut trouble = Box::new(trouble);
        // An option of the command line stands in no file.
        if trouble.file.is_some() || trouble.key.as_ref().is_some_and(|key| key.starts_with("--")) {
            return *trouble;
        }
        trouble.file.clone_from(&self.file);
        let is_overridden = trouble.key.as_ref().is_some_and(|key| self.is_overridden(&metric(key)));
        trouble = as_written(trouble, &self.written);
        if let Some(key) = &trouble.key {
            if is_overridden {
                // A document without a file may be asked twice.
                if !trouble.remedy.ends_with(BY_SET) {
                    trouble.remedy.push_str(BY_SET);
                }
            } else if trouble.line.is_none() {
                trouble.line = line_of_key(&self.text, key);
            }
        }
        *trouble
    }

    /// Applies overrides on top of those that it was read with.
    /// Errors: one that is no `section.key=value`, or names no place for a value; a quantity that the file gives twice.
    pub fn set_all(&mut self, overrides: &[String]) -> Result<()> {
        overrides.iter().try_for_each(|text| self.set(text))?;
        self.read_units().map_err(|error| self.locate(error))
    }

    fn read_units(&mut self) -> Result<()> {
        let mut table = self.as_given.clone();
        self.written = to_metric(&mut table)?;
        self.table = table;
        Ok(())
    }

    fn set(&mut self, text: &str) -> Result<()> {
        let refuse = |problem: &str| {
            let remedy = "write --set section.key=value, for example --set model.spacing_mm=0.5";
            input("--set", format!("\"{text}\""), problem, remedy)
        };
        let (key, value) = text.split_once('=').ok_or_else(|| refuse("has no ="))?;
        let (key, value) = (key.trim(), value.trim());
        fail_if!(value.is_empty(), refuse("has no value"));
        let other = key.rsplit_once('.').and_then(|(above, last)| Some(format!("{above}.{}", twin(last)?)));
        let is_set = |other: &String| value_at(&Value::Table(self.as_given.clone()), other).is_some();
        if let Some(other) = other.filter(|other| self.overridden.contains(&metric(key)) && is_set(other)) {
            return Err(refuse(&format!("conflicts with {other}")));
        }
        // TOML where it is TOML, else text, so that names need no quotes in a shell.
        let parsed = toml::de::ValueDeserializer::parse(value).and_then(Value::deserialize);
        self.put_as_given(key, parsed.unwrap_or_else(|_| Value::String(value.to_owned()))).map_err(refuse)?;
        self.overridden.push(metric(key));
        self.folder.opened().add_override(text);
        Ok(())
    }

    /// Gives a key (`section.key`, below a list by number) another value, in the unit of its name.
    /// Errors: what is wrong with the key, in words that go behind it; nothing but tables above it may have been made then.
    pub fn put(&mut self, key: &str, value: Value) -> std::result::Result<(), String> {
        self.put_as_given(key, value)?;
        self.read_units().map_err(|error| error.to_string())
    }

    fn put_as_given(&mut self, key: &str, value: Value) -> std::result::Result<(), &'static str> {
        const NO_TABLE: &str = "its parent is not a table";
        let steps = path_steps(key);
        fail_if!(steps.len() < 2 || key.split('.').any(|step| step.trim().is_empty()), "expected SECTION.KEY=VALUE");
        let (last, parents) = (&steps[steps.len() - 1], &steps[..steps.len() - 1]);
        let mut place = self.as_given.entry(parents[0].clone()).or_insert_with(|| Value::Table(Table::new()));
        for step in &parents[1..] {
            place = child(place, step).ok_or(NO_TABLE)?;
        }
        match place {
            Value::Table(table) => {
                // In other units it is the same quantity.
                twin(last).map(|twin| table.remove(&twin));
                table.insert(last.clone(), value);
            }
            Value::Array(_) => *child(place, last).ok_or("the list has no such entry")? = value,
            _ => return Err(NO_TABLE),
        }
        Ok(())
    }
}

/// Child of a table (created where missing) or of a list (which must have it).
fn child<'v>(value: &'v mut Value, step: &str) -> Option<&'v mut Value> {
    match value {
        Value::Table(table) => Some(table.entry(step.to_owned()).or_insert_with(|| Value::Table(Table::new()))),
        Value::Array(items) => items.get_mut(step.parse::<usize>().ok()?),
        _ => None,
    }
}

fn syntax_error(error: &toml::de::Error, text: &str, file: Option<&Path>) -> Error {
    let span = error.span();
    let line = span.as_ref().map(|span| line_at(text, span.start));
    let value = line.and_then(|line| text.lines().nth(line - 1)).map(|line| shorten(&Value::String(line.trim().to_owned())));
    Error::Input(Box::new(InputError {
        file: file.map(Path::to_path_buf),
        line,
        key: None,
        value,
        problem: format!("invalid TOML: {}", error.message().replace('\n', ", ")),
        remedy: "use `key = value` lines under `[section]`, each key once, text in quotes".into(),
        ..InputError::default()
    }))
}

fn line_at(text: &str, offset: usize) -> usize {
    1 + text.as_bytes().iter().take(offset).filter(|byte| **byte == b'\n').count()
}

/// Line of a dotted key, or of the nearest table above it that exists.
fn line_of_key(text: &str, key: &str) -> Option<usize> {
    let root = DeTable::parse(text).ok()?;
    let steps = path_steps(key);
    let (first, inner) = steps.split_first()?;
    let entry = root.get_ref().iter().find(|(name, _)| name.get_ref() == first.as_str())?;
    let mut offset = entry.0.span().start;
    let mut value = entry.1;
    for step in inner {
        match value.get_ref() {
            DeValue::Table(table) => {
                let Some((name, below)) = table.iter().find(|(name, _)| name.get_ref() == step.as_str()) else { break };
                (offset, value) = (name.span().start, below);
            }
            DeValue::Array(items) => {
                let Some(below) = step.parse::<usize>().ok().and_then(|index| items.get(index)) else { break };
                (offset, value) = (below.span().start, below);
            }
            _ => break,
        }
    }
    Some(line_at(text, offset))
}

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
                let what = if value.is_table() { "unknown section" } else { "key outside any section" };
                let near =
                    nearest(name, known.iter().copied()).map_or_else(String::new, |near| format!("did you mean [{near}]? "));
                return Err(input(name, shorten(value), what, format!("{near}known sections: {}", known.join(", "))));
            }
            fail_if!(!value.is_table(), input(name, shorten(value), "is not a section", format!("add a section [{name}]")));
        }
        Ok(Sections { table, empty: Value::Table(Table::new()) })
    }

    pub fn required(&self, section: &str) -> Result<&Value> {
        self.given(section).ok_or_else(|| input_missing(section, "is missing", format!("add a section [{section}]")))
    }

    /// A section, without keys where it is left out.
    pub fn optional(&self, section: &str) -> &Value {
        self.given(section).unwrap_or(&self.empty)
    }

    pub fn given(&self, section: &str) -> Option<&Value> {
        self.table.get(section)
    }

    /// The whole input as results repeat it.
    /// Errors: values that JSON has not.
    pub fn echo(&self) -> Result<serde_json::Value> {
        serde_json::to_value(self.table).map_err(|error| input_missing("file", error.to_string(), "write it as plain TOML"))
    }
}
