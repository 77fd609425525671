//! `perilife verify`.

use std::fs;

use serde_json::Value;
use tempfile::tempdir;

use crate::interface::cli::{assert_refused, perilife};
use crate::support::desk::done;

/// The table is the same text however long its rows took; JSON names both bounds of every row.
#[test]
fn rows_are_written_as_markdown_and_as_json() {
    let dir = tempdir().unwrap();
    let tables = ["first.md", "second.md"].map(|file| {
        let (stdout, _) = done(dir.path(), &["verify", "golden", "--json", "--markdown", file]);
        let object: Value = serde_json::from_str(&stdout).expect("one JSON object and nothing else");
        let rows = object["rows"].as_array().unwrap();
        assert!(rows.len() >= 12, "{}", rows.len());
        for row in rows {
            assert!(row["bound_percent"].is_f64() && row.get("miss_bound_percent").is_some_and(Value::is_null), "{row}");
        }
        fs::read_to_string(dir.path().join(file)).unwrap()
    });
    assert!(tables[0].contains("\n## golden\n") && tables[0].contains("247200"), "{}", tables[0]);
    assert_eq!(tables[0], tables[1]);
    assert_refused(&perilife(dir.path(), &["verify", "gold"]), 2, &["NAME", "gold", "golden_peridynamics"]);
    assert_refused(&perilife(dir.path(), &["verify", "golden", "--json", "--markdown", "."]), 2, &["--markdown", "folder"]);
}
