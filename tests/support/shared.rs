//! Measured curves that are shared between projects and not part of this one.

use std::path::PathBuf;

/// A file or folder of the shared folder (`$PERILIFE_SHARED`, else `../shared`), where it is there.
pub fn shared_root(file: &str) -> Option<PathBuf> {
    let root = std::env::var_os("PERILIFE_SHARED").map_or_else(|| PathBuf::from("../shared"), PathBuf::from);
    Some(root.join(file)).filter(|path| path.exists())
}

/// A file or folder of the shared data, or `None` with a printed reason.
pub fn shared(file: &str) -> Option<PathBuf> {
    let path = shared_root(&format!("data/{file}"));
    if path.is_none() {
        eprintln!("skipped: data/{file} is not there (set PERILIFE_SHARED to the folder that holds data/)");
    }
    path
}
