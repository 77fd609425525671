//! The other side of a job's process: takes an order, runs it as the commands do, tells how far it is.

use std::fs;
use std::io::{self, Read as _};
use std::os::fd::AsFd;
use std::os::unix::net::UnixStream;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use rustix::process::{Signal, kill_current_process_group};
use serde_json::Value;

use super::process::{News, Order, Run, read_frame, write_frame};
use super::telling::Teller;
use super::{bytes, packed};
use crate::problem::Problem;
use crate::store::{Growth, free_bytes};
use perilife_base::error::{Error, Result};
use perilife_base::input::Opened;
use perilife_calibration::calibrate::Calibration;
use perilife_results::output::{Room, write_file, write_json};
use perilife_results::paper::{self, Signed};
use perilife_results::record::RESULT_FILE;
use perilife_runner::{Task, TaskCheckpoint};

/// The report of a run or a fit among its files.
pub const REPORT_FILE: &str = "report.html";
/// Time between two tellings.
const TELL_EVERY: Duration = Duration::from_millis(400);

/// Takes one order from the standard input and runs it to its end.
pub fn take() -> Result<()> {
    let cannot = |error| Error::file(Path::new("standard input"), "brings no order of a worker", error);
    let socket = io::stdin().as_fd().try_clone_to_owned().map(UnixStream::from).map_err(cannot)?;
    let order: Option<Order> = read_frame(&socket).map_err(cannot)?;
    let order = order.ok_or_else(|| cannot(io::ErrorKind::UnexpectedEof.into()))?;
    let failed = |problem: &Problem| News::Failed(serde_json::to_string(problem).unwrap_or_default());
    let folder = match &order {
        Order::Run(run) => run.folder.parent().map(Path::to_path_buf),
        Order::Look(_) => None,
    };
    let is_enough = Arc::new(AtomicBool::new(false));
    end_with_worker(socket.try_clone().map_err(cannot)?, folder, is_enough.clone());
    let order = match order {
        Order::Run(run) => run,
        Order::Look(look) => {
            let found = look.answer().map_or_else(|problem| failed(&problem), News::Done);
            return write_frame(&socket, &found).map_err(cannot);
        }
    };
    let threads = |error| Error::file(Path::new("threads"), "cannot be started", io::Error::other(error));
    rayon::ThreadPoolBuilder::new().num_threads(order.threads).build_global().map_err(threads)?;
    let socket = Mutex::new(socket);
    let tell = |news: &News| {
        let socket = socket.lock().unwrap_or_else(PoisonError::into_inner);
        // A worker that has gone ends this process.
        write_frame(&*socket, news).is_ok()
    };
    let mut room = Room::default();
    let end = match ended(&order, &mut room, &tell, is_enough) {
        Ok(summary) => News::Done(summary.to_string()),
        Err(error @ Error::File { .. }) => News::NoRoom(error.to_string(), room.all.max(bytes(&order.folder))),
        Err(error) => failed(&error.into()),
    };
    tell(&end);
    Ok(())
}

/// Ends this process, all that it started and what it wrote when its worker is gone.
fn end_with_worker(mut socket: UnixStream, folder: Option<PathBuf>, is_enough: Arc<AtomicBool>) {
    std::thread::spawn(move || {
        // A worker says nothing more after its order but that the curve so far is enough.
        while matches!(socket.read(&mut [0]), Ok(1)) {
            is_enough.store(true, Ordering::Relaxed);
        }
        let _ = folder.map(fs::remove_dir_all);
        let _ = kill_current_process_group(Signal::KILL);
    });
}

fn ended(order: &Run, room: &mut Room, tell: &(dyn Fn(&News) -> bool + Sync), is_enough: Arc<AtomicBool>) -> Result<Value> {
    let task = order.submission.task(order.kind, &order.submission.document()?)?;
    *room = if matches!(task, Task::Prediction { .. } | Task::Scene(_)) { task.room() } else { Room::default() };
    // Asked before the run, which would be for nothing.
    if free_bytes(&order.folder).is_some_and(|free| free < room.all) {
        return Err(Error::file(&order.folder, "has no room for the results", io::ErrorKind::StorageFull.into()));
    }
    let from = order.checkpoint.as_ref().and_then(|bytes| match TaskCheckpoint::of(&task, bytes) {
        Ok(from) => Some(from),
        Err(error) => {
            tracing::warn!("restarting the run: {error}");
            None
        }
    });
    let shown = order.shown.as_ref().map(|pieces| {
        let until = match &from {
            Some(TaskCheckpoint::Cycles(checkpoint)) => Some(checkpoint.progress().cycles),
            _ => None,
        };
        let shown = shown_until(pieces, until);
        tell(&News::Growth(shown.clone()));
        shown
    });
    let keep = |bytes| tell(&News::Checkpoint(bytes));
    let (cracks, keep) = match &task {
        Task::Prediction { case, .. } => (case.specimen.cracks.clone(), Some(&keep as _)),
        Task::Fit(Calibration::Lives(calibration)) => (calibration.case.specimen.cracks.clone(), None),
        _ => (Vec::new(), None),
    };
    let mut teller = Teller::new(&cracks, &shown.unwrap_or_default(), keep, order.checkpoint_every);
    teller.is_enough = is_enough;
    let (done, end) = channel();
    std::thread::scope(|scope| {
        scope.spawn(|| {
            let outcome = catch_unwind(AssertUnwindSafe(|| run_task(&order.folder, &task, from, &teller)));
            // Whoever waits for it waits until it comes.
            let _ = done.send(outcome);
        });
        loop {
            match end.recv_timeout(TELL_EVERY) {
                Ok(Ok(outcome)) => break outcome,
                Ok(Err(panic)) => resume_unwind(panic),
                Err(RecvTimeoutError::Disconnected) => {
                    break Err(Error::Mechanics("the run ended without an outcome".to_owned()));
                }
                Err(RecvTimeoutError::Timeout) => teller.pass_on(tell),
            }
        }
    })
}

/// The curve that earlier workers have shown, as far as the checkpoint confirms it.
fn shown_until(pieces: &[Growth], until: Option<f64>) -> Growth {
    let mut all = Growth::default();
    for piece in pieces {
        let kept = piece.cycles.iter().take_while(|cycles| until.is_some_and(|until| **cycles <= until)).count();
        all.cycles.extend_from_slice(&piece.cycles[..kept]);
        all.crack_length_mm.extend_from_slice(&piece.crack_length_mm[..kept]);
        all.tips.extend_from_slice(&piece.tips[..kept]);
    }
    all
}

fn run_task(folder: &Path, task: &Task, from: Option<TaskCheckpoint>, teller: &Teller<'_>) -> Result<Value> {
    // The stresses that go with factors are for a folder that was asked for.
    let is_of_factors = matches!(task, Task::Factors { .. });
    let summary = perilife_runner::run(task, from, (!is_of_factors).then_some(folder), teller)?;
    if is_of_factors {
        write_json(folder, RESULT_FILE, &summary.result)?;
    }
    // A run of cycles that is refused is shown as such.
    let summary = if matches!(task, Task::Prediction { .. }) { summary } else { summary.counted()? };
    // A report of what cannot be read again is no reason to lose the run.
    let is_reported = matches!(task, Task::Prediction { .. } | Task::Fit(_));
    if let Some(source) = is_reported.then(|| paper::read(folder, &Opened::default()).ok()).flatten() {
        write_file(&folder.join(REPORT_FILE), paper::html(&source, &Signed::default()).as_bytes())?;
    }
    packed(folder)?;
    Ok(summary.figures)
}
