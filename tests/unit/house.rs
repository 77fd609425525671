//! The house does not grow unseen: lines of `src` stay below the cap, and those of each member at or below its pin.
//!
//! `tests/house.toml` holds a pin for each member, its number of lines. The sum of the pins may rise by 300 lines over the commit that a change
//! stands on; a larger rise needs the line `house: +N, because ...` in the message of a commit of the change.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::support::shared::shared_root;

const PINS: &str = "tests/house.toml";
/// Rise of the sum of the pins that needs no reason.
const RISE: i64 = 300;

type Lines = BTreeMap<String, i64>;

#[test]
fn members_do_not_grow() {
    let lines = lines_of_members();
    let all: i64 = lines.values().sum();
    let pins = pins_in(&fs::read_to_string(PINS).unwrap());
    let grown: Vec<String> = lines
        .iter()
        .filter(|(member, lines)| **lines > pins.get(*member).copied().unwrap_or(0))
        .map(|(member, lines)| format!("{member} = {lines}"))
        .collect();
    assert!(grown.is_empty(), "more lines than in {PINS}; share code, replace it, or raise the pins: {}", grown.join(", "));
    assert!(lines.len() > 10 && all > 10_000, "the test reads the sources: {lines:?}");
    assert_eq!(lines.keys().collect::<Vec<_>>(), pins.keys().collect::<Vec<_>>(), "members and pins");

    match shared_root("caps.toml").map(|file| fs::read_to_string(file).unwrap().parse::<toml::Table>().unwrap()) {
        Some(caps) => {
            let cap = caps["src_lines"].as_integer().unwrap();
            assert!(all <= cap, "{all} lines of src, at most {cap}");
        }
        None => eprintln!("skipped: no cap, since caps.toml is not there"),
    }

    let Some((base, before)) = before_the_change() else { return };
    let (now, before): (i64, i64) = (pins.values().sum(), before.values().sum());
    let messages = git(&["log", "--format=%B", &format!("{base}..HEAD")]).unwrap_or_default();
    assert!(
        is_allowed(now - before, &messages),
        "the pins rise from {before} to {now} lines since {base}: at most {RISE} without `house: +N, because ...` in a commit message"
    );
}

/// Whether the sum of the pins may rise by so many lines.
fn is_allowed(rise: i64, messages: &str) -> bool {
    let said = messages.lines().filter_map(|line| {
        let (lines, reason) = line.trim().strip_prefix("house: +")?.split_once(',')?;
        reason.trim_start().starts_with("because ").then(|| lines.trim().parse::<i64>().ok())?
    });
    rise <= RISE.max(said.sum())
}

#[test]
fn a_rise_needs_a_reason() {
    assert!(is_allowed(300, "") && is_allowed(-5000, "") && !is_allowed(301, "Spectra"));
    assert!(is_allowed(450, "Spectra\n\nhouse: +450, because of nine formats"));
    assert!(!is_allowed(451, "house: +450, because of nine formats"));
    assert!(!is_allowed(450, "house: +450") && !is_allowed(450, "house: +many, because I may"));
    assert!(is_allowed(900, "house: +450, because of a\nx\nhouse: +450, because of b"));
}

/// Lines of Rust of every member; `program` is what stands in none of them.
fn lines_of_members() -> Lines {
    let source = source();
    let mut lines = Lines::new();
    for file in rust_files(&source) {
        *lines.entry(member_of(file.strip_prefix(&source).unwrap())).or_default() +=
            fs::read_to_string(&file).unwrap().lines().count() as i64;
    }
    lines
}

/// A table of results is read where another process may have written it, and judged where the run is told.
#[test]
fn no_table_is_read_by_the_process_that_made_it() {
    let with = |words: &str| -> Vec<String> {
        let files = rust_files(&source()).into_iter().filter(|file| fs::read_to_string(file).unwrap().contains(words));
        let names = files.map(|file| file.strip_prefix(source()).unwrap().display().to_string());
        // Tables of laboratories are another matter.
        let mut names: Vec<String> = names.filter(|name| !name.starts_with("measured/") && !name.starts_with("base/")).collect();
        names.sort();
        names
    };
    let doors = ["results/curve.rs", "results/paper/folder.rs", "service/api/results.rs"];
    assert_eq!(with("Table::read("), doors);
    assert_eq!(with("judgement::judge("), ["results/checks.rs"]);
}

/// The member that a path below `src` lies in.
pub fn member_of(path: &Path) -> String {
    let first = path.iter().next().unwrap().to_str().unwrap();
    let is_member = source().join(first).join("Cargo.toml").is_file();
    if is_member { first } else { "program" }.to_owned()
}

fn pins_in(text: &str) -> Lines {
    let table: toml::Table = text.parse().unwrap();
    table["lines"].as_table().unwrap().iter().map(|(member, lines)| (member.clone(), lines.as_integer().unwrap())).collect()
}

/// The commit that the change stands on, with its pins: where it leaves `origin/main`, else the last one of six hours before it.
fn before_the_change() -> Option<(String, Lines)> {
    let head = git(&["rev-parse", "HEAD"]);
    let given = std::env::var("PERILIFE_BASE").ok().filter(|base| !base.is_empty());
    let branch = || git(&["merge-base", "HEAD", "origin/main"]).filter(|base| Some(base) != head.as_ref());
    let earlier = || {
        let time: i64 = git(&["log", "-1", "--format=%ct"])?.parse().ok()?;
        git(&["rev-list", "-1", &format!("--before={}", time - 6 * 3600), "HEAD"]).filter(|base| !base.is_empty())
    };
    let base = given.or_else(branch).or_else(earlier);
    let pins = base.and_then(|base| Some((git(&["show", &format!("{base}:{PINS}")])?, base)));
    if pins.is_none() {
        eprintln!("skipped: no earlier commit with {PINS} is here");
    }
    pins.map(|(text, base)| (base, pins_in(&text)))
}

fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").args(arguments).output().ok().filter(|output| output.status.success())?;
    Some(String::from_utf8(output.stdout).ok()?.trim().to_owned())
}

/// The folder of the sources.
pub fn source() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src")
}

/// Every source file below a folder.
pub fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    entries
        .flat_map(|path| if path.is_dir() { rust_files(&path) } else { vec![path] })
        .filter(|path| path.extension().is_some_and(|e| e == "rs"))
        .collect()
}
