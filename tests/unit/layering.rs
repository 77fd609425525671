//! Rooms use only rooms listed above them in `src/engine/lib.rs` and `src/analysis/lib.rs`, so that the engine stays free of files, terminals and networks.

use std::fs;
use std::path::{Path, PathBuf};

/// Parts of the library whose rooms are modules of the whole; what is in none of them is the service or the command line.
const PARTS: [&str; 2] = ["engine", "analysis"];

fn source() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src")
}

/// All rooms in the order in which data flows.
fn rooms() -> Vec<String> {
    let listed = PARTS.iter().flat_map(|part| {
        let text = fs::read_to_string(source().join(part).join("lib.rs")).unwrap();
        let rooms = text.lines().filter_map(|line| Some(line.strip_prefix("pub mod ")?.strip_suffix(';')?.to_owned()));
        rooms.collect::<Vec<_>>()
    });
    listed.chain(["service".to_owned(), "commands".to_owned()]).collect()
}

/// Every source file with the segments of its module, room first; those at the root of a crate have none.
pub fn modules() -> Vec<(PathBuf, Vec<String>)> {
    let source = source();
    let module = |file: &Path| -> Vec<String> {
        let parts = file.strip_prefix(&source).unwrap().with_extension("");
        let parts = parts.iter().map(|part| part.to_str().unwrap().to_owned());
        let parts = parts.enumerate().filter(|(place, part)| *place > 0 || !PARTS.contains(&&**part)).map(|(_, part)| part);
        parts.filter(|part| part != "mod" && part != "lib").collect()
    };
    rust_files(&source).into_iter().map(|file| (module(&file), file)).map(|(module, file)| (file, module)).collect()
}

#[test]
fn rooms_use_only_rooms_above_them() {
    let rooms = rooms();
    let place = |room: &str| rooms.iter().position(|known| known == room);
    let mut uses = 0;
    for (file, module) in modules() {
        let Some((room, own)) = module.first().and_then(|room| Some((room, place(room)?))) else { continue };
        let text = fs::read_to_string(&file).unwrap();
        let code: Vec<&str> = text.lines().filter(|line| !line.trim_start().starts_with("//")).collect();
        for path in crate_paths(&code.join("\n")) {
            let Some(other) = place(path.split("::").next().unwrap()) else { continue };
            assert!(other <= own, "{}: {room} uses {path}, which stands below it", file.display());
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
