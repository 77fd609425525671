//! Measured curves that are shared between projects and not part of this one.

use std::path::PathBuf;

/// A file of the shared data (`$PERILIFE_SHARED/data`, else `../shared/data`), or `None` with a printed reason.
pub fn shared(file: &str) -> Option<PathBuf> {
    let root = std::env::var_os("PERILIFE_SHARED").map_or_else(|| PathBuf::from("../shared"), PathBuf::from);
    let path = root.join("data").join(file);
    if path.is_file() {
        return Some(path);
    }
    eprintln!("skipped: {} is not there (set PERILIFE_SHARED to the folder that holds data/)", path.display());
    None
}
