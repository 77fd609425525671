//! `perilife stability`.

use std::fs;

use serde_json::Value;
use tempfile::tempdir;

use crate::interface::cli::{assert_refused, perilife, texts};
use crate::support::desk::done;

/// Columns that users rely on, a row a run, pictures, and a name that is no sweep.
#[test]
fn a_sweep_is_written_as_table_and_pictures() {
    let dir = tempdir().unwrap();
    let (stdout, _) = done(dir.path(), &["stability", "density_factor", "reading_count", "--quick", "--json", "--out", "map"]);
    let object: Value = serde_json::from_str(&stdout).expect("one JSON object and nothing else");
    let read = |name: &str| fs::read_to_string(dir.path().join("map").join(name)).unwrap();
    let table = read("stability.csv");
    assert!(table.starts_with("sweep,method,parameter,value,status,error_percent,boundary,reason,version\n"), "{table}");
    let runs: usize = object["records"].as_array().unwrap().iter().map(|record| record["points"].as_array().unwrap().len()).sum();
    assert!(table.lines().count() == runs + 1 && runs > 8, "{runs}");
    let rows: Vec<&str> = table.lines().filter(|line| line.starts_with("density_factor")).collect();
    // Too little density is unstable by theory, and says so; the density of the bound is not.
    assert!(rows[0].contains(",failed,") && rows[0].contains("unstable after"), "{}", rows[0]);
    assert!(rows.iter().any(|row| row.contains(",1.000000000,stable,")), "{rows:?}");
    for picture in ["stability.svg", "density_factor.svg", "reading_count.svg"] {
        let svg = read(picture);
        assert!(svg.starts_with("<svg") && svg.ends_with("</svg>\n") && svg.contains("<rect"), "{picture}");
    }
    assert_eq!(read("boundaries.csv").lines().count(), 3);
    assert_refused(&perilife(dir.path(), &["stability", "density"]), 2, &["NAME", "density", "density_factor"]);
    let listed = perilife(dir.path(), &["list"]);
    assert!(texts(&listed).0.contains("stability NAME"));
}
