//! Rooms use only rooms listed above them in `src/lib.rs`, so that the engine stays free of files, terminals and networks.

use std::fs;
use std::path::{Path, PathBuf};

/// Uses against the order, each with its reason.
const EXCEPTIONS: [(&str, &str); 3] = [
    // K of `sif` is that of the first row of a run, read by nothing else.
    ("stress_intensity", "growth::tip_field"),
    ("stress_intensity", "growth::record"),
    ("stress_intensity", "growth::element_free"),
];

#[test]
fn rooms_use_only_rooms_above_them() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let rooms: Vec<String> = fs::read_to_string(source.join("lib.rs"))
        .unwrap()
        .lines()
        .filter_map(|line| Some(line.strip_prefix("pub mod ")?.strip_suffix(';')?.to_owned()))
        .collect();
    let place = |room: &str| rooms.iter().position(|known| known == room);
    let mut uses = 0;
    for file in rust_files(&source) {
        let room = file
            .strip_prefix(&source)
            .unwrap()
            .components()
            .next()
            .unwrap()
            .as_os_str()
            .to_str()
            .unwrap()
            .trim_end_matches(".rs")
            .to_owned();
        let Some(own) = place(&room) else { continue };
        let text = fs::read_to_string(&file).unwrap();
        let code: Vec<&str> = text.lines().filter(|line| !line.trim_start().starts_with("//")).collect();
        for path in crate_paths(&code.join("\n")) {
            let Some(other) = place(path.split("::").next().unwrap()) else { continue };
            let excepted = EXCEPTIONS.iter().any(|(from, to)| *from == room && path.starts_with(to));
            assert!(other <= own || excepted, "{}: {room} uses {path}, which stands below it in lib.rs", file.display());
            uses += 1;
        }
    }
    assert!(rooms.len() > 10 && uses > 50, "the test reads the sources: {} rooms, {uses} uses", rooms.len());
}

/// What stands behind every `crate::`, groups in braces taken apart: `crate::{a, b::c}` gives `a` and `b::c`.
fn crate_paths(code: &str) -> Vec<String> {
    let word = |text: &str| text.trim().chars().take_while(|c| c.is_alphanumeric() || *c == '_' || *c == ':').collect::<String>();
    code.split("crate::")
        .skip(1)
        .flat_map(|rest| match rest.strip_prefix('{') {
            Some(group) => group.split(';').next().unwrap().split([',', '{', '}']).map(word).collect(),
            None => vec![word(rest)],
        })
        .collect()
}

#[test]
fn paths_are_read_from_groups_too() {
    assert_eq!(
        crate_paths("use crate::{case, loading::read};\nlet x = crate::predict!(1);"),
        ["case", "loading::read", "", "predict"]
    );
}

/// Every source file below a folder.
pub fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    entries
        .flat_map(|path| if path.is_dir() { rust_files(&path) } else { vec![path] })
        .filter(|path| path.extension().is_some_and(|e| e == "rs"))
        .collect()
}
