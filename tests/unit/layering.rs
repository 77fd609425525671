//! Rooms use only rooms listed above them in `src/lib.rs`, so that the engine stays free of files, terminals and networks.

use std::fs;
use std::path::{Path, PathBuf};

/// Uses against the order, each with its reason.
const EXCEPTIONS: [(&str, &str); 1] = [
    // The record is plain data that `calibrate` writes and a case reads; the search itself stays below `predict`.
    ("case", "calibration::record"),
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
        for (number, line) in fs::read_to_string(&file).unwrap().lines().enumerate() {
            if line.trim_start().starts_with("//") {
                continue;
            }
            assert!(
                !line.contains("crate::{"),
                "{}:{}: one `use crate::room` a line, so that this test can read it",
                file.display(),
                number + 1
            );
            for path in line.split("crate::").skip(1) {
                let used = path.split(|c: char| !c.is_alphanumeric() && c != '_').next().unwrap();
                let Some(other) = place(used) else { continue };
                let excepted = EXCEPTIONS.iter().any(|(from, to)| *from == room && path.starts_with(to));
                assert!(
                    other <= own || excepted,
                    "{}:{}: {room} uses {used}, which stands below it in lib.rs",
                    file.display(),
                    number + 1
                );
                uses += 1;
            }
        }
    }
    assert!(rooms.len() > 10 && uses > 50, "the test reads the sources: {} rooms, {uses} uses", rooms.len());
}

fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    entries
        .flat_map(|path| if path.is_dir() { rust_files(&path) } else { vec![path] })
        .filter(|path| path.extension().is_some_and(|e| e == "rs"))
        .collect()
}
