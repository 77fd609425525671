//! What a sheet of a workbook hides: rows of readings that somebody took out, columns that nobody sees.

use std::collections::HashSet;
use std::io::{BufReader, Cursor};

use quick_xml::events::{BytesStart, Event};
use quick_xml::{Reader, XmlVersion};
use zip::ZipArchive;

use super::cells::COLUMNS_MAX;

/// Hidden rows by their line, and columns by their place from 0.
#[derive(Default)]
pub(super) struct Hidden {
    pub rows: HashSet<usize>,
    pub columns: Vec<usize>,
}

type Archive<'a> = ZipArchive<Cursor<&'a [u8]>>;

/// What a sheet hides; nothing where the workbook does not say it in the usual place.
pub(super) fn of_sheet(bytes: &[u8], sheet: &str) -> Hidden {
    let mut hidden = Hidden::default();
    let Some(mut archive) = ZipArchive::new(Cursor::new(bytes)).ok() else { return hidden };
    let Some(path) = path_of(&mut archive, sheet) else { return hidden };
    let mut line = 0;
    each_element(&mut archive, &path, |element| {
        let number = |name: &str| attribute(element, name).and_then(|text| text.trim().parse::<usize>().ok());
        let is_hidden = || attribute(element, "hidden").is_some_and(|text| ["1", "true"].contains(&text.trim()));
        match element.local_name().as_ref() {
            "row" => {
                line = number("r").unwrap_or(line + 1);
                if is_hidden() {
                    hidden.rows.insert(line);
                }
            }
            "col" if is_hidden() => {
                let last = number("max").unwrap_or(0).min(COLUMNS_MAX);
                hidden.columns.extend(number("min").unwrap_or(1).max(1) - 1..last);
            }
            _ => {}
        }
    });
    hidden
}

fn path_of(archive: &mut Archive<'_>, sheet: &str) -> Option<String> {
    let (mut id, mut target) = (None, None);
    each_element(archive, "xl/workbook.xml", |element| {
        if element.local_name().as_ref() == "sheet" && attribute(element, "name").as_deref() == Some(sheet) {
            id = attribute(element, "id");
        }
    });
    let id = id?;
    each_element(archive, "xl/_rels/workbook.xml.rels", |element| {
        if element.local_name().as_ref() == "Relationship" && attribute(element, "Id").as_deref() == Some(&id) {
            target = attribute(element, "Target");
        }
    });
    let target: String = target?;
    Some(target.strip_prefix('/').map_or_else(|| format!("xl/{target}"), str::to_owned))
}

fn attribute(element: &BytesStart<'_>, name: &str) -> Option<String> {
    let found = element.attributes().flatten().find(|one| one.key.local_name().as_ref() == name)?;
    found.normalized_value(XmlVersion::Implicit1_0).ok().map(std::borrow::Cow::into_owned)
}

fn each_element(archive: &mut Archive<'_>, path: &str, mut look: impl FnMut(&BytesStart<'_>)) {
    let Ok(entry) = archive.by_name(path) else { return };
    let (mut reader, mut buffer) = (Reader::from_reader(BufReader::new(entry)), Vec::new());
    while let Ok(event) = reader.read_event_into(&mut buffer) {
        match event {
            Event::Start(element) | Event::Empty(element) => look(&element),
            Event::Eof => break,
            _ => {}
        }
        buffer.clear();
    }
}
