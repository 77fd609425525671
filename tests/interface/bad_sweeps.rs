//! Sweep files that are wrong: refused before anything is run, with words.

use std::collections::BTreeMap;

use crate::interface::cli::{assert_refused, perilife};
use crate::interface::sweep::{GRID, folder_with};
use crate::support::rows::rows;

#[test]
fn bad_designs_are_refused_before_anything_runs() {
    let heads: BTreeMap<String, String> = rows("bad_sweeps", "heads");
    for (head, rest, code, words) in rows::<Vec<(String, String, i32, Vec<String>)>>("bad_sweeps", "broken") {
        let dir = folder_with(&format!("{}{rest}", heads.get(&head).map_or("", String::as_str)));
        println!("{head} {rest}");
        let output = perilife(dir.path(), &["sweep", "sweep.toml", "--out", "out"]);
        assert_refused(&output, code, &words);
        assert!(!dir.path().join("out").exists());
    }
    let dir = folder_with(GRID);
    for shard in ["0/3", "4/3", "1", "a/b"] {
        let output = perilife(dir.path(), &["sweep", "sweep.toml", "--out", "out", "--shard", shard]);
        assert_eq!(output.status.code(), Some(2), "{shard}");
    }
}
