//! A document of an input file on disk, or of a dict.

use std::collections::HashMap;
use std::path::PathBuf;

use perilife_base::input::Document;
use perilife_runner::{Draft, put_law};
use pyo3::prelude::*;

use crate::errors::raised;
use crate::values;

/// Reads a document: `source` is the path of a file, or a dict of sections whose files lie in the current folder; `set` overrides keys,
/// `law` takes the place of the law in `[fatigue]`, and `files` are known by name before any on disk.
pub fn document(
    source: &Bound<'_, PyAny>,
    name: &str,
    set: &[String],
    law: Option<&Bound<'_, PyAny>>,
    files: HashMap<String, Vec<u8>>,
) -> PyResult<Document> {
    let law = law.map(|law| values::table("law", law)).transpose()?;
    let read = || {
        let Ok(path) = source.extract::<PathBuf>() else { return Ok(None) };
        let mut document = Document::read(&path, set)?;
        if let Some(law) = law.clone() {
            put_law(&mut document.table, law);
        }
        Ok(Some(document))
    };
    if let Some(mut document) = read().map_err(raised)? {
        let opened = document.folder.opened().so_far();
        document.folder = document.folder.anew_with(files);
        opened.files.into_iter().for_each(|file| document.folder.opened().add(file));
        opened.overrides.iter().for_each(|text| document.folder.opened().add_override(text));
        return Ok(document);
    }
    let mut table = values::table("", source)?;
    if let Some(law) = law {
        put_law(&mut table, law);
    }
    let draft = files.into_iter().fold(Draft::of(name, table), |draft, (name, content)| draft.file(name, content));
    let overridden = || {
        let mut document = draft.document()?;
        document.set_all(set).map(|()| document)
    };
    overridden().map_err(raised)
}
