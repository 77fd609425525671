//! Small inputs of every command that writes a folder, and what a folder holds.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use tempfile::{TempDir, tempdir};

use crate::interface::cli::SMALL_CASE;

/// A hand calculation of a millisecond.
pub const PANEL: &str = include_str!("../reference/cases/daily_panel.toml");

/// Its plate, load and method, without law and end.
pub fn panel_without_law() -> &'static str {
    PANEL.split_once("[fatigue]").unwrap().0
}

/// A plate that is pulled once.
pub const SCENE: &str = include_str!("../reference/cases/daily_scene.toml");

/// A curve of the panel above.
pub const READINGS: &str = "specimen,cycles,crack_length_mm\nA,0,9\nA,20000,9.6\nA,40000,10.3\nA,60000,11.2\nA,80000,12.3\nA,100000,13.6\n\
                            A,120000,15.3\nA,140000,17.6\n";

pub const SWEEP: &str =
    "case = \"panel.toml\"\n[design]\nkind = \"grid\"\n[[vary]]\nkey = \"specimen.crack_length_mm\"\nvalues = [9.0, 10.0]\n";

/// Every kind of folder: the call that makes it, without `--out`, and a table of it.
pub const KINDS: [(&[&str], &str); 5] = [
    (&["predict", "panel.toml"], "a_n.csv"),
    (&["fracture", "scene.toml"], "history.csv"),
    (&["calibrate", "fit.toml", "--predict", "panel.toml"], "fitted.toml"),
    (&["sweep", "sweep.toml"], "sweep.csv"),
    (&["verify", "golden"], "verify.csv"),
];

/// Writes the inputs of all kinds.
pub fn write_inputs(folder: &Path) {
    let files = [
        ("panel.toml", PANEL.to_owned()),
        ("small.toml", SMALL_CASE.to_owned()),
        ("scene.toml", SCENE.to_owned()),
        ("readings.csv", READINGS.to_owned()),
        ("fit.toml", format!("[measured]\nfiles = [\"readings.csv\"]\n{}", panel_without_law())),
        ("sweep.toml", SWEEP.to_owned()),
    ];
    files.iter().for_each(|(name, text)| fs::write(folder.join(name), text).unwrap());
}

/// A folder with the inputs of all kinds.
pub fn inputs() -> TempDir {
    let dir = tempdir().unwrap();
    write_inputs(dir.path());
    dir
}

/// Every file below a folder with its content, links as what they point to in words.
pub fn content(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut all = BTreeMap::new();
    let mut open = vec![folder.to_path_buf()];
    while let Some(next) = open.pop() {
        for entry in fs::read_dir(&next).unwrap().map(Result::unwrap) {
            let (path, name) = (entry.path(), entry.path().strip_prefix(folder).unwrap().display().to_string());
            let kind = entry.file_type().unwrap();
            if kind.is_dir() {
                all.insert(name + "/", Vec::new());
                open.push(path);
            } else if kind.is_symlink() {
                all.insert(name, fs::read_link(&path).unwrap().display().to_string().into_bytes());
            } else {
                all.insert(name, fs::read(&path).unwrap());
            }
        }
    }
    all
}

/// Names in a folder, hidden ones too, sorted.
pub fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}
