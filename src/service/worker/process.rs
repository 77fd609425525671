//! The process of a job: it has its own memory, of which it may take so much, and can be ended at any moment.
//!
//! Worker and process talk over a pair of sockets, one end of which is the standard input of the process: it ends when the other end is
//! closed, by whatever death of the worker. With the processes that it starts itself it is a group, which ends together. What they tell
//! each other are frames: a length, 4 bytes little-endian, and a value packed by postcard.

use std::io::{self, ErrorKind, Read, Write};
use std::os::fd::OwnedFd;
use std::os::unix::net::UnixStream;
use std::os::unix::process::{CommandExt, ExitStatusExt};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::thread::JoinHandle;
use std::time::Duration;

use rustix::process::{Pid, Resource, Rlimit, Signal, kill_process_group, prlimit};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::job::{JobKind, Look, Submission};
use crate::problem::{Answer, Problem};
use crate::store::Growth;
use perilife_base::watch;

/// The subcommand that takes an order.
pub const COMMAND: &str = "job";
/// News that may wait for the worker; the process waits when there are more.
const WAITING: usize = 4;
/// Bytes of what the process said last that are kept.
const TAIL: usize = 4096;

#[derive(Debug)]
pub struct JobProcess {
    child: Child,
    /// What it tells; none will come any more where its end is disconnected.
    pub news: Receiver<News>,
    said: Option<JoinHandle<Vec<u8>>>,
    socket: UnixStream,
}

/// How a process ended without having said so.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Death {
    OutOfMemory,
    /// It panicked: a fault of the program. What it said.
    Panicked(String),
    /// Something else, in words.
    Other(String),
}

impl JobProcess {
    pub fn start(program: &Path, order: &Order, memory: u64, threads: usize) -> io::Result<JobProcess> {
        let (ours, theirs) = UnixStream::pair()?;
        let mut child = Command::new(program)
            .arg(COMMAND)
            .stdin(Stdio::from(OwnedFd::from(theirs)))
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            // A signal of a terminal is for the service, which ends its jobs in order.
            .process_group(0)
            .spawn()?;
        let stderr = child.stderr.take();
        let mut process = JobProcess { child, news: sync_channel(0).1, said: None, socket: ours.try_clone()? };
        let begin = || -> io::Result<()> {
            let most = Some(memory + reserved(threads));
            let limit = Rlimit { current: most, maximum: most };
            // Writable private memory, and not addresses: reserved addresses cost nothing. What it touches is watched beside
            // ([`JobProcess::touched`]).
            prlimit(Some(process.group()), Resource::Data, limit)?;
            process.said = stderr.map(|stderr| std::thread::Builder::new().spawn(move || tail(stderr))).transpose()?;
            write_frame(&ours, order)?;
            let (told, news) = sync_channel(WAITING);
            std::thread::Builder::new().spawn(move || {
                while let Ok(Some(piece)) = read_frame(&ours) {
                    if told.send(piece).is_err() {
                        break;
                    }
                }
            })?;
            process.news = news;
            Ok(())
        };
        // One that died at once says why when it is asked how it ended.
        match begin() {
            Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(error),
            _ => Ok(process),
        }
    }

    /// Has it end after its next cycle block with the curve so far; one that is past these ends as it would.
    pub fn is_enough(&self) {
        let _ = (&self.socket).write_all(&[1]);
    }

    fn group(&self) -> Pid {
        Pid::from_child(&self.child)
    }

    /// Most memory that it has had, bytes; `None` where the system does not tell.
    pub fn memory(&self) -> Option<u64> {
        self.status("VmHWM:")
    }

    /// Private memory that it has touched and not given back, bytes; `None` where the system does not tell.
    pub fn touched(&self) -> Option<u64> {
        self.status("RssAnon:")
    }

    fn status(&self, key: &str) -> Option<u64> {
        let status = std::fs::read_to_string(format!("/proc/{}/status", self.child.id())).ok()?;
        let line = status.lines().find_map(|line| line.strip_prefix(key))?;
        line.trim().strip_suffix(" kB")?.trim().parse::<u64>().ok().map(|kilobytes| 1024 * kilobytes)
    }

    /// How it ended; one that has nothing more to say and does not end is ended.
    pub fn death(mut self) -> Death {
        // Its news end with it, so that this takes no time unless it hangs.
        for _ in 0..100 {
            match self.child.try_wait() {
                Ok(Some(status)) => return death(status, &self.said()),
                _ => std::thread::sleep(Duration::from_millis(10)),
            }
        }
        Death::Other("closed its connection and did not end".to_owned())
    }

    fn said(&mut self) -> String {
        let said = self.said.take().and_then(|said| said.join().ok()).unwrap_or_default();
        String::from_utf8_lossy(&said).trim().to_owned()
    }
}

/// Time between two looks whether somebody still waits.
const ASKED_EVERY: Duration = Duration::from_millis(100);

/// Looks at input in a process of its own, which ends when nobody waits any more ([`watch`]).
pub fn look(program: &Path, look: &Look, memory: u64) -> Answer<String> {
    let fault = |why: String| {
        tracing::error!("input cannot be looked at: {why}");
        Problem::internal()
    };
    let process = JobProcess::start(program, &Order::Look(look.clone()), memory, 1).map_err(|error| fault(error.to_string()))?;
    loop {
        let is_over = match process.news.recv_timeout(ASKED_EVERY) {
            Ok(News::Done(found)) => return Ok(found),
            Ok(News::Failed(problem)) => return Err(serde_json::from_str(&problem).unwrap_or_else(|_| Problem::internal())),
            Err(RecvTimeoutError::Timeout) if watch::is_cancelled() => return Err(Problem::internal()),
            Ok(_) | Err(RecvTimeoutError::Timeout) => process.touched().is_some_and(|touched| touched > memory),
            Err(RecvTimeoutError::Disconnected) => match process.death() {
                Death::Panicked(why) | Death::Other(why) => return Err(fault(why)),
                Death::OutOfMemory => return Err(too_large(memory)),
            },
        };
        if is_over {
            return Err(too_large(memory));
        }
    }
}

fn too_large(memory: u64) -> Problem {
    Problem::too_large(format!("the input takes more than the {} MB of memory of a job (--job-memory)", memory / 1_000_000))
}

/// Bytes that matrix products reserve and hardly touch: twice the third-level cache for each thread (private-gemm-x86, which `faer` calls),
/// 600 MB on a processor with 300 MB of it.
fn reserved(threads: usize) -> u64 {
    let size = std::fs::read_to_string("/sys/devices/system/cpu/cpu0/cache/index3/size").unwrap_or_default();
    let kilobytes: u64 = size.trim().strip_suffix('K').and_then(|size| size.parse().ok()).unwrap_or(0);
    2 * 1024 * kilobytes * (threads as u64 + 1)
}

/// Ends it with all that it started.
impl Drop for JobProcess {
    fn drop(&mut self) {
        let _ = kill_process_group(self.group(), Signal::KILL);
        let _ = self.child.wait();
    }
}

fn death(status: ExitStatus, said: &str) -> Death {
    if said.contains("memory allocation of") || said.contains("out of memory") || said.contains("Cannot allocate memory") {
        return Death::OutOfMemory;
    }
    match (status.signal(), status.code()) {
        (Some(signal), _) => Death::Other(format!("was ended by signal {signal}")),
        // The exit code of a panic.
        (None, Some(101)) => Death::Panicked(said.to_owned()),
        (None, code) => Death::Other(format!("ended with exit code {}: {said}", code.unwrap_or(-1))),
    }
}

fn tail(mut from: impl io::Read) -> Vec<u8> {
    let (mut kept, mut piece) = (Vec::new(), [0; TAIL]);
    while let Ok(count @ 1..) = from.read(&mut piece) {
        kept.extend_from_slice(&piece[..count]);
        kept.drain(..kept.len().saturating_sub(TAIL));
    }
    kept
}

#[derive(Debug, Clone, Serialize, Deserialize)]
pub enum Order {
    Run(Box<Run>),
    Look(Look),
}

#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Run {
    pub kind: JobKind,
    pub submission: Submission,
    /// Where an earlier worker stood.
    pub checkpoint: Option<Vec<u8>>,
    /// The curve that earlier workers have shown; `None` for the first.
    pub shown: Option<Vec<Growth>>,
    /// Empty folder for the results, in one of its own, which goes with the job.
    pub folder: PathBuf,
    pub threads: usize,
    /// Least time between two checkpoints.
    pub checkpoint_every: Duration,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
pub enum News {
    /// How far it is, [`crate::job::JobProgress`] as JSON.
    Progress(String),
    Growth(Growth),
    /// What is said of a picture, JSON, and its PNG.
    Picture(String, Vec<u8>),
    /// Where it could be taken up.
    Checkpoint(Vec<u8>),
    /// It is done: the figures of its result or what was found, JSON. Its files are in the folder.
    Done(String),
    /// It has no result: [`crate::problem::Problem`] as JSON.
    Failed(String),
    /// The disk did not take its files: why, and bytes that they need.
    NoRoom(String, u64),
}

const MOST: u32 = 1 << 31;

pub fn write_frame(mut to: impl Write, value: &impl Serialize) -> io::Result<()> {
    let bytes = postcard::to_stdvec(value).map_err(io::Error::other)?;
    let length = u32::try_from(bytes.len()).ok().filter(|length| *length <= MOST);
    let length = length.ok_or_else(|| io::Error::new(ErrorKind::InvalidData, "a frame is longer than 2 GiB"))?;
    to.write_all(&length.to_le_bytes())?;
    to.write_all(&bytes)
}

/// Reads a frame; `None` where the other side has closed, in the middle of a frame as well.
pub fn read_frame<T: DeserializeOwned>(mut from: impl Read) -> io::Result<Option<T>> {
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
