//! Texts of the repository that a test knows how to write.

use std::fs;
use std::path::Path;

/// Whether what is old is written anew.
pub fn refreshes() -> bool {
    std::env::var_os("PERILIFE_REFRESH").is_some()
}

/// Files that are not what they should be; with PERILIFE_REFRESH they are written.
#[track_caller]
pub fn hold(files: &[(&str, &str)]) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let is_old = |(name, wanted): &&(&str, &str)| fs::read_to_string(root.join(name)).unwrap_or_default() != *wanted;
    let old: Vec<_> = files.iter().filter(is_old).collect();
    if refreshes() {
        old.iter().for_each(|(name, wanted)| fs::write(root.join(name), wanted).unwrap());
    }
    let names: Vec<_> = old.iter().map(|(name, _)| name).collect();
    assert!(refreshes() || names.is_empty(), "{names:?} are of another day; PERILIFE_REFRESH=1 writes them");
}
