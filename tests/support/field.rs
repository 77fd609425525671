//! Cases of other people in `field` of the shared data: files, the commands that were run on them, and what is right.

use std::fs;
use std::path::Path;

use serde::Deserialize;
use serde_json::Value;
use tempfile::{TempDir, tempdir};

use crate::interface::cli::{perilife, texts};
use crate::support::desk::json;
use crate::support::rows::{assert_says, rows};
use crate::support::shared::shared;

/// A folder of the shared data in one of its own; `None` with a printed reason where the data are not there.
pub fn folder(place: &str) -> Option<TempDir> {
    let from = shared(place)?;
    let dir = tempdir().unwrap();
    copy(&from, dir.path());
    Some(dir)
}

fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap().map(Result::unwrap) {
        let target = to.join(entry.file_name());
        if entry.path().is_dir() { copy(&entry.path(), &target) } else { fs::copy(entry.path(), target).map(drop).unwrap() }
    }
}

/// A kind of `field/practice5`.
pub fn kind(name: &str) -> Option<TempDir> {
    folder(&format!("field/practice5/{name}"))
}

/// Arguments of a command, its exit code, words of what it says, and places in files of results with the value that is right and the relative
/// difference that its page allows.
type Row = (String, i32, Vec<String>, Vec<(String, String, f64, f64)>);

/// Commands of a kind in its folder, one after the other.
#[derive(Deserialize)]
struct Kind {
    kind: String,
    rows: Vec<Row>,
}

/// Every command of a file of rows gives the right value within what its page states, or the cause by name.
pub fn hold_rows(file: &str, data: &str) {
    for Kind { kind, rows } in rows::<Vec<Kind>>(file, "kinds") {
        let Some(own) = folder(&format!("field/{data}/{kind}")) else { return };
        for (call, exit, words, figures) in &rows {
            for folder in ["out", "out_fit"] {
                // Fits are kept for the predictions behind them.
                if call.ends_with(folder) && own.path().join(folder).is_dir() {
                    fs::remove_dir_all(own.path().join(folder)).unwrap();
                }
            }
            let (code, said) = command(own.path(), call);
            assert_eq!(code, *exit, "{kind}: {call}: {said}");
            assert_says(&format!("{kind}: {call}: {said}"), words);
            for (file, place, right, slack) in figures {
                let object = json(own.path().join(file));
                let value = object.pointer(place).and_then(Value::as_f64).unwrap_or(f64::NAN);
                assert!((value / right - 1.0).abs() <= *slack, "{kind}: {call}: {place} {value}, {right} is right");
            }
        }
    }
}

/// What a command prints, all of it, with its exit code.
pub fn command(folder: &Path, arguments: &str) -> (i32, String) {
    let output = perilife(folder, &arguments.split(' ').chain(["-v"]).collect::<Vec<_>>());
    let (stdout, stderr) = texts(&output);
    (output.status.code().unwrap(), stdout + &stderr)
}

/// What a prediction that is well prints, and its result.
pub fn predicted(folder: &Path, arguments: &str) -> (String, Value) {
    let (code, said) = command(folder, &format!("predict {arguments} --out out --force"));
    assert_eq!(code, 0, "{arguments}: {said}");
    (said, serde_json::from_slice(&fs::read(folder.join("out/result.json")).unwrap()).unwrap())
}

/// A number is another one but for a share of it.
pub fn is_near(found: &Value, wanted: f64, share: f64, what: &str) {
    let found = found.as_f64().unwrap_or(f64::NAN);
    assert!((found / wanted - 1.0).abs() < share, "{what}: {found} for {wanted}");
}
