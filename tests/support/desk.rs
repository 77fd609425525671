//! A folder in which the program is run, and what it leaves there.

use std::fs;
use std::path::Path;

use serde_json::Value;
use tempfile::{TempDir, tempdir};

use crate::interface::cli::{Call, perilife, texts};

/// A folder with these files.
pub fn desk(files: &[(&str, &dyn AsRef<[u8]>)]) -> TempDir {
    let dir = tempdir().unwrap();
    files.iter().for_each(|(name, content)| fs::write(dir.path().join(name), content.as_ref()).unwrap());
    dir
}

/// Standard output and standard error of a run that ends well.
#[track_caller]
pub fn done(folder: &Path, call: &(impl Call + ?Sized)) -> (String, String) {
    let output = perilife(folder, call);
    let (stdout, stderr) = texts(&output);
    assert_eq!(output.status.code(), Some(0), "{:?}: {stderr}{stdout}", call.words());
    (stdout, stderr)
}

/// A file of results.
#[track_caller]
pub fn json(path: impl AsRef<Path>) -> Value {
    serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap()
}
