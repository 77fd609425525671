//! Where the files lie that an input file names, in a folder on disk or at hand, and what was opened of them.
//!
//! Who reads an input file opens all others through its [`Folder`], so that the list of what was opened is whole whatever keys name
//! files: results say what made them, a sweep sends along what its cases need, and no output is written over what was read.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{Read, Write as _};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use sha2::{Digest, Sha256};

use crate::error::{Error, Result, fail_if, input, input_missing};

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

    pub fn path(&self, name: &str) -> PathBuf {
        match &self.disk {
            Some(folder) if !self.at_hand.contains_key(name) => folder.join(name),
            _ => PathBuf::from(name),
        }
    }

    /// Content of a file. Without a folder on disk a path is known by its last part as well: who sends files seldom sends their folders.
    /// Errors: [`Error::File`] if it cannot be read from disk; [`Error::Input`] if it is not at hand, or two paths have one last part.
    pub fn read(&self, name: &str) -> Result<Vec<u8>> {
        let last = |path: &str| path.rsplit('/').next().unwrap_or_default().to_owned();
        if let Some(content) = self.at_hand.get(name).or_else(|| self.at_hand.get(&last(name)).filter(|_| self.disk.is_none())) {
            let opened = self.opened.so_far();
            let has = |name: &str| self.at_hand.contains_key(name);
            let is_other = |file: &&OpenedFile| file.path.is_none() && file.name != name && last(&file.name) == last(name);
            if let Some(other) = opened.files.iter().filter(is_other).find(|other| !has(name) || !has(&other.name)) {
                let problem = format!("ambiguous: \"{}\" has the same file name", other.name);
                return Err(input("file", format!("\"{name}\""), problem, "send each under its own name"));
            }
            let file = OpenedFile { name: name.to_owned(), path: None, id: None, content: content.clone().into() };
            self.opened.add(file);
            return Ok(content.clone());
        }
        let Some(folder) = &self.disk else {
            let names: Vec<&str> = self.at_hand.keys().map(String::as_str).collect();
            let given = if names.is_empty() { "nothing".to_owned() } else { names.join(", ") };
            let remedy = format!("send it with the input, which came with {given}");
            return Err(input("file", format!("\"{name}\""), "was not uploaded", remedy));
        };
        self.opened.read(&folder.join(name), name)
    }

    /// Where names in a file of this folder start from.
    pub(super) fn beside(&self, path: &Path) -> Folder {
        let disk = self.disk.as_ref().map(|_| path.parent().unwrap_or(Path::new("")).to_path_buf());
        Folder { disk, ..self.clone() }
    }
}

impl From<&Path> for Folder {
    fn from(folder: &Path) -> Self {
        Folder { disk: Some(folder.to_path_buf()), at_hand: Arc::default(), opened: Opened::default() }
    }
}

/// Name that stands for standard input, and for standard output where a file is written.
pub const STREAM: &str = "-";

/// A file, or a device that holds it: the same pair is the same content by whatever name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FileId {
    device: u64,
    inode: u64,
}

impl FileId {
    /// Of what is known about a file.
    pub fn of(metadata: &std::fs::Metadata) -> Self {
        use std::os::unix::fs::MetadataExt;
        FileId { device: metadata.dev(), inode: metadata.ino() }
    }
}

#[derive(Debug, Clone)]
pub struct OpenedFile {
    /// As the user or the input file names it.
    pub name: String,
    pub path: Option<PathBuf>,
    pub id: Option<FileId>,
    pub content: Arc<[u8]>,
}

impl OpenedFile {
    pub fn sha256(&self) -> String {
        sha256(&self.content)
    }
}

/// SHA-256, hexadecimal.
pub fn sha256(bytes: &[u8]) -> String {
    let mut text = Vec::with_capacity(64);
    // Writing to memory cannot fail.
    Sha256::digest(bytes).iter().for_each(|byte| drop(write!(text, "{byte:02x}")));
    String::from_utf8(text).unwrap_or_default()
}

/// What was opened so far; clones share one list.
#[derive(Debug, Clone, Default)]
pub struct Opened(Arc<Mutex<Provenance>>);

#[derive(Debug, Clone, Default)]
pub struct Provenance {
    /// Every file that was read, in order, each once; the first is the input itself.
    pub files: Vec<OpenedFile>,
    /// `section.key=value` given beside the file.
    pub overrides: Vec<String>,
}

/// Where an input comes from is no part of what it says.
impl PartialEq for Provenance {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Opened {
    /// Adds a file that was read; one that is there already stays once.
    pub fn add(&self, file: OpenedFile) {
        let mut all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if all.files.iter().all(|known| known.name != file.name || known.content != file.content) {
            all.files.push(file);
        }
    }

    pub fn add_override(&self, text: &str) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).overrides.push(text.to_owned());
    }

    pub fn so_far(&self) -> Provenance {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Reads a file and remembers it; `-` is standard input.
    /// Errors: [`Error::File`] if it cannot be read; [`Error::Input`] for standard input a second time.
    pub fn read(&self, path: &Path, name: &str) -> Result<Vec<u8>> {
        let (content, id) = if path == Path::new(STREAM) { (stdin()?, None) } else { read(path)? };
        let on_disk = (path != Path::new(STREAM)).then(|| path.to_path_buf());
        self.add(OpenedFile { name: name.to_owned(), path: on_disk, id, content: content.clone().into() });
        Ok(content)
    }
}

fn read(path: &Path) -> Result<(Vec<u8>, Option<FileId>)> {
    let read = || {
        let mut file = File::open(path)?;
        let id = FileId::of(&file.metadata()?);
        let mut content = Vec::new();
        file.read_to_end(&mut content)?;
        Ok((content, Some(id)))
    };
    read().map_err(|error| Error::file(path, "cannot read", error))
}

fn stdin() -> Result<Vec<u8>> {
    static IS_READ: AtomicBool = AtomicBool::new(false);
    let remedy = "name it once, and files for the others";
    fail_if!(IS_READ.swap(true, Ordering::Relaxed), input("file", STREAM, "standard input was already read", remedy));
    let mut content = Vec::new();
    let read = std::io::stdin().lock().read_to_end(&mut content);
    read.map_err(|error| Error::file(Path::new(STREAM), "cannot read", error))?;
    Ok(content)
}

pub(super) fn text_of(bytes: Vec<u8>, path: &Path) -> Result<String> {
    String::from_utf8(bytes).map_err(|error| {
        let message = format!("is not UTF-8 text (byte {})", error.utf8_error().valid_up_to() + 1);
        input_missing("file", message, "save it as plain UTF-8 text").in_file(path)
    })
}
