//! Cases of other people in `field/practice5` of the shared data: files and the commands that were run on them.

use std::fs;
use std::path::Path;

use serde_json::Value;
use tempfile::{TempDir, tempdir};

use crate::interface::cli::{perilife, texts};
use crate::interface::practice::copy;
use crate::support::shared::shared;

/// A kind in a folder of its own; `None` with a printed reason where the data are not there.
pub fn kind(name: &str) -> Option<TempDir> {
    let from = shared(&format!("field/practice5/{name}/README.md"))?;
    let dir = tempdir().unwrap();
    copy(from.parent().unwrap(), dir.path());
    Some(dir)
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
