//! From a result back to what made it: hashes of all that was read, the texts themselves, overrides, time and commit.

use std::path::Path;
use std::sync::OnceLock;

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use toml::Table;

use super::format;
use super::output::write_file;
use perilife_base::error::{Error, Result};
use perilife_base::input::{OpenedFile, Provenance, sha256};

/// Folder of the inputs as they were read, in that of a run.
pub const INPUTS: &str = "inputs";
/// The input as it was run: overrides applied, and every file that it names beside it in [`INPUTS`].
pub const CASE_FILE: &str = "case.toml";
static COMMIT: OnceLock<&'static str> = OnceLock::new();

/// Commit that the program was built from, said once at its start; results of a program that says none have none.
pub fn built_from(commit: &'static str) {
    let _ = COMMIT.set(commit);
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TableEntry {
    pub file: String,
    pub sha256: String,
    pub bytes: usize,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct InputEntry {
    pub file: String,
    pub sha256: String,
    pub bytes: usize,
    pub kept_as: String,
}

#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct MadeBy {
    #[serde(default)]
    pub tables: Vec<TableEntry>,
    #[serde(default)]
    pub inputs: Vec<InputEntry>,
    #[serde(default)]
    pub overrides: Vec<String>,
    pub finished: Option<String>,
    pub commit: Option<String>,
}

impl MadeBy {
    /// Of what was read, and the texts of its tables by their names.
    pub fn of<'t>(provenance: &Provenance, tables: impl IntoIterator<Item = (&'t Path, &'t str)>) -> Self {
        let input = |(file, kept_as): (&OpenedFile, String)| InputEntry {
            file: file.name.clone(),
            sha256: file.sha256(),
            bytes: file.content.len(),
            kept_as,
        };
        let table = |(file, text): (&Path, &str)| TableEntry {
            file: file.display().to_string(),
            sha256: sha256(text.as_bytes()),
            bytes: text.len(),
        };
        MadeBy {
            tables: tables.into_iter().map(table).collect(),
            inputs: provenance.files.iter().zip(kept_names(&provenance.files)).map(input).collect(),
            overrides: provenance.overrides.clone(),
            finished: Some(format::now()),
            commit: COMMIT.get().map(|commit| (*commit).to_owned()),
        }
    }
}

pub fn add<'t>(object: &mut Value, provenance: &Provenance, tables: impl IntoIterator<Item = (&'t Path, &'t str)>) {
    if let (Some(fields), Ok(Value::Object(made_by))) =
        (object.as_object_mut(), serde_json::to_value(MadeBy::of(provenance, tables)))
    {
        fields.extend(made_by);
    }
}

/// Writes the texts as they were read, and the input as it was run: `perilife` with that file repeats the run.
pub fn write(folder: &Path, command: &str, input: Table, provenance: &Provenance) -> Result<()> {
    let inputs = folder.join(INPUTS);
    std::fs::create_dir_all(&inputs).map_err(|error| Error::file(&inputs, "cannot create the folder", error))?;
    let names = kept_names(&provenance.files);
    for (file, name) in provenance.files.iter().zip(&names) {
        write_file(&folder.join(name), &file.content)?;
    }
    let mut input = toml::Value::Table(input);
    // The first is the input itself, which names the others.
    let named: Vec<(&str, &str)> =
        provenance.files.iter().zip(&names).skip(1).map(|(file, kept)| (&*file.name, &**kept)).collect();
    rename(&mut input, &named);
    // What was read as TOML has a form in TOML.
    let text = toml::to_string(&input).unwrap_or_default();
    let head = format!("# The input as it was run, overrides applied: `perilife {command} {CASE_FILE}` repeats it.\n\n");
    write_file(&folder.join(CASE_FILE), (head + &text).as_bytes())
}

/// The echo of an input as a table; what has no form in TOML is left out.
pub fn table_of(echo: &Value) -> Table {
    let fields = echo.as_object().cloned().unwrap_or_default();
    Table::try_from(without_nulls(fields)).unwrap_or_default()
}

fn without_nulls(fields: Map<String, Value>) -> Map<String, Value> {
    let whole = |value: Value| match value {
        Value::Object(fields) => Value::Object(without_nulls(fields)),
        other => other,
    };
    fields.into_iter().filter(|(_, value)| !value.is_null()).map(|(key, value)| (key, whole(value))).collect()
}

/// Puts the new name wherever an old one stands, whatever the key.
fn rename(value: &mut toml::Value, named: &[(&str, &str)]) {
    match value {
        toml::Value::String(text) => {
            if let Some((_, kept)) = named.iter().find(|(name, _)| name == text) {
                (*kept).clone_into(text);
            }
        }
        toml::Value::Array(items) => items.iter_mut().for_each(|item| rename(item, named)),
        toml::Value::Table(table) => table.iter_mut().for_each(|(_, item)| rename(item, named)),
        _ => {}
    }
}

/// A name as every system takes it: Windows has folders behind `\`, characters that no name may have, and names of devices.
fn portable(name: &str) -> String {
    const DEVICES: [&str; 6] = ["con", "prn", "aux", "nul", "com", "lpt"];
    let last = name.rsplit('\\').next().unwrap_or_default().trim_end_matches([' ', '.']);
    let name = last.replace(|c: char| c.is_control() || "<>:\"|?*".contains(c), "_");
    let stem = name.split('.').next().unwrap_or_default().trim_end().to_ascii_lowercase();
    let device = stem.trim_end_matches(|c: char| c.is_ascii_digit());
    let is_device = DEVICES.contains(&device) && stem.len() <= device.len() + 1;
    if is_device || name.is_empty() { format!("_{name}") } else { name }
}

/// Where each file is kept in the folder of a run: by its last name, with a number where that is taken.
fn kept_names(files: &[OpenedFile]) -> Vec<String> {
    let mut names: Vec<String> = Vec::with_capacity(files.len());
    for file in files {
        let last = Path::new(&file.name).file_name().map(|name| name.to_string_lossy().into_owned());
        let last = last.filter(|name| name != perilife_base::input::STREAM).map(|name| portable(&name));
        let last = last.unwrap_or_else(|| "input.toml".to_owned());
        let numbered = |count: usize| if count == 1 { format!("{INPUTS}/{last}") } else { format!("{INPUTS}/{count}_{last}") };
        names.extend((1..).map(numbered).find(|name| names.iter().all(|other| !other.eq_ignore_ascii_case(name))));
    }
    names
}
