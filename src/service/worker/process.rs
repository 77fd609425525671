//! The process of a job: it has its own memory, of which it may take so much, and can be ended at any moment.
//!
//! Worker and process talk over a pair of sockets, one end of which is the standard input of the process: it ends when the other end is
//! closed, by whatever death of the worker. With the processes that it starts itself it is a group, which ends together.

use std::io;
use std::os::fd::OwnedFd;
use std::os::unix::net::UnixStream;
use std::os::unix::process::{CommandExt, ExitStatusExt};
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::thread::JoinHandle;
use std::time::Duration;

use rustix::process::{Pid, Resource, Rlimit, Signal, kill_process_group, prlimit};

use super::frames::{self, News, Order};

/// The subcommand that takes an order.
pub const COMMAND: &str = "job";
/// News that may wait for the worker; the process waits when there are more.
const WAITING: usize = 4;
/// Bytes of what the process said last that are kept.
const TAIL: usize = 4096;

/// A running job.
#[derive(Debug)]
pub struct JobProcess {
    child: Child,
    news: Receiver<News>,
    said: Option<JoinHandle<Vec<u8>>>,
}

/// What a look for news brings.
#[derive(Debug)]
pub enum Look {
    /// Something new.
    News(News),
    /// Nothing within the time.
    Quiet,
    /// Nothing more will come.
    Over,
}

/// How a process ended without having said so.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Death {
    /// It wanted more memory than it may have.
    OutOfMemory,
    /// It panicked: a fault of the program. What it said.
    Panicked(String),
    /// Something else, in words.
    Other(String),
}

impl JobProcess {
    /// Starts the process with an order.
    pub fn start(program: &Path, order: &Order, memory: u64) -> io::Result<JobProcess> {
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
        let mut process = JobProcess { child, news: sync_channel(0).1, said: None };
        let begin = || -> io::Result<()> {
            let limit = Rlimit { current: Some(memory), maximum: Some(memory) };
            // Writable private memory, and not addresses: reserved addresses cost nothing.
            prlimit(Some(process.group()), Resource::Data, limit)?;
            process.said = stderr.map(|stderr| std::thread::Builder::new().spawn(move || tail(stderr))).transpose()?;
            frames::write(&ours, order)?;
            let (told, news) = sync_channel(WAITING);
            std::thread::Builder::new().spawn(move || {
                while let Ok(Some(piece)) = frames::read(&ours) {
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

    fn group(&self) -> Pid {
        Pid::from_child(&self.child)
    }

    /// The next news within a time.
    pub fn look(&self, within: Duration) -> Look {
        match self.news.recv_timeout(within) {
            Ok(news) => Look::News(news),
            Err(RecvTimeoutError::Timeout) => Look::Quiet,
            Err(RecvTimeoutError::Disconnected) => Look::Over,
        }
    }

    /// Most memory that it has had, bytes; `None` where the system does not tell.
    pub fn memory(&self) -> Option<u64> {
        let status = std::fs::read_to_string(format!("/proc/{}/status", self.child.id())).ok()?;
        let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
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

/// The last of what is said.
fn tail(mut from: impl io::Read) -> Vec<u8> {
    let (mut kept, mut piece) = (Vec::new(), [0; TAIL]);
    while let Ok(count @ 1..) = from.read(&mut piece) {
        kept.extend_from_slice(&piece[..count]);
        kept.drain(..kept.len().saturating_sub(TAIL));
    }
    kept
}
