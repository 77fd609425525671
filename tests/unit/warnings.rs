//! Names of warnings: the table of the guide and the sources say the same ones, each once.

use std::collections::BTreeSet;
use std::fs;

use super::house::{rust_files, source};

/// Names in the tables of a section of the guide.
fn names_below(head: &str) -> Vec<String> {
    let page = fs::read_to_string("src/guide/validity.md").unwrap();
    let section = page.split("\n## ").find(|section| section.starts_with(head)).unwrap();
    let name = |line: &str| Some(line.strip_prefix("| `")?.split_once('`')?.0.to_owned());
    section.lines().filter_map(name).collect()
}

/// Of a line `NAME: what was found`, that the guide has the name.
#[track_caller]
pub fn assert_named(line: &str) {
    let is_known = line.split_once(": ").is_some_and(|(name, _)| names_below("Messages").iter().any(|known| known == name));
    assert!(is_known, "a warning begins with a name that src/guide/validity.md lists: {line}");
}

#[test]
fn every_name_is_unique_documented_and_used() {
    let (warnings, checks) = (names_below("Messages"), names_below("# Validity"));
    assert!(warnings.len() > 40 && checks.len() > 14, "{warnings:?} {checks:?}");
    let unique: BTreeSet<&String> = warnings.iter().chain(&checks).collect();
    assert_eq!(unique.len(), warnings.len() + checks.len(), "a name stands twice");
    assert!(warnings.is_sorted(), "{warnings:?}");
    let sources: String = rust_files(&source()).iter().map(|file| fs::read_to_string(file).unwrap()).collect();
    let is_used = |name: &&String| sources.contains(&format!("\"{name}: "));
    let unused: Vec<_> = warnings.iter().filter(|name| !is_used(name)).collect();
    assert!(unused.is_empty(), "no source says {unused:?}");
    let unused: Vec<_> = checks.iter().filter(|name| !sources.contains(&format!("\"{name}\""))).collect();
    assert!(unused.is_empty(), "no source has the checks {unused:?}");
}
