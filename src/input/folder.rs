//! Where the files lie that an input file names: in a folder on disk, or at hand.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::opened::{Opened, OpenedFile};
use super::{Document, text_of};
use crate::error::{Error, Result, input};

/// A place that relative names start from, and what was opened through it.
#[derive(Debug, Clone)]
pub struct Folder {
    /// A folder on disk; `None` for input that came over a network or was built in: no name in it ever reaches the disk.
    disk: Option<PathBuf>,
    /// Content by name, which goes before what lies on disk.
    at_hand: Arc<BTreeMap<String, Vec<u8>>>,
    opened: Opened,
}

/// The same place, whatever was opened through it.
impl PartialEq for Folder {
    fn eq(&self, other: &Self) -> bool {
        self.disk == other.disk && self.at_hand == other.at_hand
    }
}

impl Folder {
    /// Nothing at hand: for input that names no files.
    pub fn none() -> Self {
        Folder::at_hand([])
    }

    /// Files given with their content.
    pub fn at_hand(files: impl IntoIterator<Item = (String, Vec<u8>)>) -> Self {
        Folder { disk: None, at_hand: Arc::new(files.into_iter().collect()), opened: Opened::default() }
    }

    /// The same place, through which nothing was opened yet, with files at hand beside what lies there.
    pub fn anew_with(&self, files: impl IntoIterator<Item = (String, Vec<u8>)>) -> Self {
        let at_hand = self.at_hand.iter().map(|(name, content)| (name.clone(), content.clone())).chain(files).collect();
        Folder { disk: self.disk.clone(), at_hand: Arc::new(at_hand), opened: Opened::default() }
    }

    /// Files and overrides that were read through it so far.
    pub fn opened(&self) -> &Opened {
        &self.opened
    }

    /// What messages call a file.
    pub fn path(&self, name: &str) -> PathBuf {
        match &self.disk {
            Some(folder) if !self.at_hand.contains_key(name) => folder.join(name),
            _ => PathBuf::from(name),
        }
    }

    /// Content of a file.
    /// Errors: [`Error::File`] if it cannot be read from disk; [`Error::Input`] if it is not at hand.
    pub fn read(&self, name: &str) -> Result<Vec<u8>> {
        if let Some(content) = self.at_hand.get(name) {
            let file = OpenedFile { name: name.to_owned(), path: None, id: None, content: content.clone().into() };
            self.opened.add(file);
            return Ok(content.clone());
        }
        let Some(folder) = &self.disk else {
            let names: Vec<&str> = self.at_hand.keys().map(String::as_str).collect();
            let given = if names.is_empty() { "nothing".to_owned() } else { names.join(", ") };
            let remedy = format!("send it with the input, which came with {given}");
            return Err(input("file", format!("\"{name}\""), "was not sent along", remedy));
        };
        self.opened.read(&folder.join(name), name)
    }

    /// Content of a file that need not exist.
    /// Errors: [`Error::File`] if it is there and cannot be read.
    pub fn read_if_there(&self, name: &str) -> Result<Option<Vec<u8>>> {
        match self.read(name) {
            Ok(content) => Ok(Some(content)),
            Err(Error::File { source, .. }) if source.kind() == std::io::ErrorKind::NotFound => Ok(None),
            Err(Error::Input(_)) => Ok(None),
            Err(error) => Err(error),
        }
    }

    /// A TOML file.
    /// Errors: as [`Folder::read`]; content that is not TOML.
    pub fn document(&self, name: &str) -> Result<Document> {
        self.document_with(name, &[])
    }

    /// A TOML file with overrides; the files that it names lie beside it.
    /// Errors: as [`Folder::document`]; overrides that are none.
    pub fn document_with(&self, name: &str, overrides: &[String]) -> Result<Document> {
        let path = self.path(name);
        let text = text_of(self.read(name)?, &path)?;
        let disk = self.disk.as_ref().map(|_| path.parent().unwrap_or(Path::new("")).to_path_buf());
        Document::of_file(text, &path, Folder { disk, ..self.clone() }, overrides)
    }
}

impl From<&Path> for Folder {
    fn from(folder: &Path) -> Self {
        Folder { disk: Some(folder.to_path_buf()), at_hand: Arc::default(), opened: Opened::default() }
    }
}
