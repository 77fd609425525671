//! Rows that tests loop over, kept as data in `tests/reference/rows`: a file for each module of tests, a key for each table.

use std::fs;
use std::path::Path;

use serde::de::DeserializeOwned;

/// A table: rows are arrays in the order of a tuple.
pub fn rows<T: DeserializeOwned>(file: &str, table: &str) -> T {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/reference/rows/{file}.toml"));
    let mut all: toml::Table = fs::read_to_string(&path).unwrap().parse().unwrap_or_else(|error| panic!("{file}: {error}"));
    let rows = all.remove(table).unwrap_or_else(|| panic!("{file}: no {table}"));
    rows.try_into().unwrap_or_else(|error| panic!("{file}: {table}: {error}"))
}

/// A message holds all these words.
#[track_caller]
pub fn assert_says(message: &str, words: &[impl AsRef<str>]) {
    words.iter().for_each(|words| assert!(message.contains(words.as_ref()), "{} in {message}", words.as_ref()));
}

/// A message holds all that ` | ` parts.
#[track_caller]
pub fn assert_holds(message: &str, words: &str) {
    assert_says(message, &words.split(" | ").collect::<Vec<_>>());
}

/// A refusal in these words.
#[track_caller]
pub fn assert_refusal<T, E: ToString>(result: Result<T, E>, words: &[impl AsRef<str>]) {
    assert_says(&result.err().expect("it is taken").to_string(), words);
}
