//! Where the files lie that an input file names: in a folder on disk, or at hand.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::Document;
use crate::error::{Error, Result, input};

/// A place that relative names start from.
#[derive(Debug, Clone, PartialEq)]
pub enum Folder {
    /// A folder on disk.
    Disk(PathBuf),
    /// Content by name, for input that came over a network or was built in: no name in it ever reaches the disk.
    AtHand(Arc<BTreeMap<String, Vec<u8>>>),
}

impl Folder {
    /// Nothing at hand: for input that names no files.
    #[must_use]
    pub fn none() -> Self {
        Folder::at_hand([])
    }

    /// Files given with their content.
    #[must_use]
    pub fn at_hand(files: impl IntoIterator<Item = (String, Vec<u8>)>) -> Self {
        Folder::AtHand(Arc::new(files.into_iter().collect()))
    }

    /// What messages call a file.
    #[must_use]
    pub fn path(&self, name: &str) -> PathBuf {
        match self {
            Folder::Disk(folder) => folder.join(name),
            Folder::AtHand(_) => PathBuf::from(name),
        }
    }

    /// Content of a file.
    ///
    /// # Errors
    /// [`Error::File`] if it cannot be read from disk; [`Error::Input`] if it is not at hand.
    pub fn read(&self, name: &str) -> Result<Vec<u8>> {
        match self {
            Folder::Disk(folder) => {
                let path = folder.join(name);
                std::fs::read(&path).map_err(|error| Error::file(&path, "cannot read", error))
            }
            Folder::AtHand(files) => files.get(name).cloned().ok_or_else(|| {
                let names: Vec<&str> = files.keys().map(String::as_str).collect();
                let given = if names.is_empty() { "nothing".to_owned() } else { names.join(", ") };
                input(
                    "file",
                    format!("\"{name}\""),
                    "was not sent along",
                    format!("send it with the input, which came with {given}"),
                )
            }),
        }
    }

    /// A TOML file.
    ///
    /// # Errors
    /// As [`Folder::read`]; content that is not TOML.
    pub fn document(&self, name: &str) -> Result<Document> {
        match self {
            Folder::Disk(folder) => Document::read(&folder.join(name), &[]),
            Folder::AtHand(_) => {
                let path = self.path(name);
                Document::of_file(super::text_of(self.read(name)?, &path)?, &path, self.clone(), &[])
            }
        }
    }
}

impl From<&Path> for Folder {
    fn from(folder: &Path) -> Self {
        Folder::Disk(folder.to_path_buf())
    }
}
