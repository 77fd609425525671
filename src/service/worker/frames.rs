//! What a worker and the process of its job tell each other: frames of a length, 4 bytes little-endian, and a value packed by postcard.

use std::io::{self, ErrorKind, Read, Write};
use std::path::PathBuf;
use std::time::Duration;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::service::job::{JobKind, Submission};
use crate::service::store::Growth;

/// What is to be run.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Order {
    /// What it does.
    pub kind: JobKind,
    /// The input without what it names.
    pub submission: Submission,
    /// Options of the command, which its form leaves out.
    pub options: Vec<String>,
    /// Files that came with it.
    pub files: Vec<(String, Vec<u8>)>,
    /// Where an earlier worker stood.
    pub checkpoint: Option<Vec<u8>>,
    /// The curve that earlier workers have shown; `None` for the first.
    pub shown: Option<Vec<Growth>>,
    /// Empty folder for the results, in one of its own, which goes with the job.
    pub folder: PathBuf,
    /// Threads.
    pub threads: usize,
    /// Least time between two checkpoints.
    pub checkpoint_every: Duration,
}

/// What a run tells.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub enum News {
    /// How far it is, [`crate::service::job::JobProgress`] as JSON.
    Progress(String),
    /// More of its curve.
    Growth(Growth),
    /// What is said of a picture, JSON, and its PNG.
    Picture(String, Vec<u8>),
    /// Where it could be taken up.
    Checkpoint(Vec<u8>),
    /// It is done: the figures of its result, JSON. Its files are in the folder.
    Done(String),
    /// It has no result: [`crate::service::problem::Problem`] as JSON.
    Failed(String),
    /// The disk did not take its files: why, and bytes that they need.
    NoRoom(String, u64),
}

/// Longest frame.
const MOST: u32 = 1 << 31;

/// Writes a frame.
pub fn write(mut to: impl Write, value: &impl Serialize) -> io::Result<()> {
    let bytes = postcard::to_stdvec(value).map_err(io::Error::other)?;
    let length = u32::try_from(bytes.len()).ok().filter(|length| *length <= MOST);
    let length = length.ok_or_else(|| io::Error::new(ErrorKind::InvalidData, "a frame is longer than 2 GiB"))?;
    to.write_all(&length.to_le_bytes())?;
    to.write_all(&bytes)
}

/// Reads a frame; `None` where the other side has closed, in the middle of a frame as well.
pub fn read<T: DeserializeOwned>(mut from: impl Read) -> io::Result<Option<T>> {
    let mut length = [0; 4];
    let closed = |error: io::Error| match error.kind() {
        ErrorKind::UnexpectedEof | ErrorKind::ConnectionReset | ErrorKind::BrokenPipe => Ok(None),
        _ => Err(error),
    };
    if let Err(error) = from.read_exact(&mut length) {
        return closed(error);
    }
    let length = u32::from_le_bytes(length);
    if length > MOST {
        return Err(io::Error::new(ErrorKind::InvalidData, "a frame is longer than 2 GiB"));
    }
    let mut bytes = Vec::new();
    // Room grows with what has come, not with what was announced.
    if let Err(error) = from.take(u64::from(length)).read_to_end(&mut bytes) {
        return closed(error);
    }
    if bytes.len() < length as usize {
        return Ok(None);
    }
    postcard::from_bytes(&bytes).map(Some).map_err(|error| io::Error::new(ErrorKind::InvalidData, error))
}
