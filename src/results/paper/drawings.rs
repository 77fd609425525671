//! Pictures of a run that its tables do not suffice to draw again, taken from its folder.

use std::collections::BTreeMap;
use std::path::Path;

use perilife_base::error::Result;
use perilife_base::input::Opened;

const NAMES: [&str; 4] = ["spectrum.svg", "section.svg", "fleet.svg", "sensitivities.svg"];
/// Elements of the drawings of this program.
const ELEMENTS: [&str; 10] = ["svg", "g", "rect", "path", "line", "circle", "polygon", "polyline", "text", "tspan"];

#[derive(Debug, Default)]
pub struct Drawings(BTreeMap<&'static str, String>);

impl Drawings {
    /// Those of a folder; all that is read is added to `opened`. Files that this program did not draw are not shown.
    /// Errors: a file that cannot be read.
    pub(super) fn read(folder: &Path, opened: &Opened) -> Result<Self> {
        let mut found = BTreeMap::new();
        for name in NAMES {
            let path = folder.join(name);
            if !path.is_file() {
                continue;
            }
            let text = String::from_utf8_lossy(&opened.read(&path, name)?).trim_end().to_owned();
            if is_drawing(&text) {
                found.insert(name, text);
            }
        }
        Ok(Drawings(found))
    }

    pub(super) fn get(&self, name: &str) -> Option<&str> {
        self.0.get(name).map(String::as_str)
    }
}

/// Whether a text draws and does nothing else: it becomes part of a page.
fn is_drawing(text: &str) -> bool {
    let tags = || text.split('<').skip(1).map(|rest| rest.split_once('>').map_or(rest, |(tag, _)| tag));
    let is_known = |tag: &str| {
        let name = tag.trim_start_matches('/').split(|c: char| !c.is_ascii_alphanumeric()).next().unwrap_or_default();
        ELEMENTS.contains(&name)
    };
    let acts = |tag: &str| {
        let handles = |part: &str| part.starts_with("on") && part.contains('=');
        tag.contains("href") || tag.contains("url(") || tag.split_whitespace().any(handles)
    };
    text.starts_with("<svg ") && text.ends_with("</svg>") && tags().all(|tag| is_known(tag) && !acts(tag))
}
