//! What an input consists of: every file that was opened for it, as it was read, and the overrides.
//!
//! Who reads an input file opens all others through its [`super::Folder`], so that this list is whole whatever keys name files:
//! results say what made them, a sweep sends along what its cases need, and no output is written over what was read.

use std::fs::File;
use std::io::{Read, Write as _};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use sha2::{Digest, Sha256};

use crate::error::{Error, Result, input};

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

/// A file as it was read.
#[derive(Debug, Clone)]
pub struct OpenedFile {
    /// As the user or the input file names it.
    pub name: String,
    /// Where it lay, if on disk.
    pub path: Option<PathBuf>,
    /// What it is on disk.
    pub id: Option<FileId>,
    /// Its bytes.
    pub content: Arc<[u8]>,
}

impl OpenedFile {
    /// SHA-256 of its bytes, hexadecimal.
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

/// What an input was made of.
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

    /// Adds an override.
    pub fn add_override(&self, text: &str) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).overrides.push(text.to_owned());
    }

    /// Adds all that is known of another input.
    pub fn add_all(&self, other: &Provenance) {
        other.files.iter().cloned().for_each(|file| self.add(file));
        other.overrides.iter().for_each(|text| self.add_override(text));
    }

    /// All so far.
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

/// All of standard input, which can be read once.
fn stdin() -> Result<Vec<u8>> {
    static IS_READ: AtomicBool = AtomicBool::new(false);
    if IS_READ.swap(true, Ordering::Relaxed) {
        return Err(input("file", STREAM, "is standard input, which was read already", "name it once, and files for the others"));
    }
    let mut content = Vec::new();
    let read = std::io::stdin().lock().read_to_end(&mut content);
    read.map_err(|error| Error::file(Path::new(STREAM), "cannot read", error))?;
    Ok(content)
}
