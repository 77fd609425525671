//! The other side of a job's process: takes an order, runs it by the functions that the commands call, tells how far it is.

use std::fs;
use std::io::{self, Read as _};
use std::os::fd::AsFd;
use std::os::unix::net::UnixStream;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::path::Path;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use rustix::process::{Signal, kill_current_process_group};
use serde_json::Value;

use super::frames::{self, News, Order};
use super::telling::Teller;
use super::{free_bytes, results};
use crate::calibration::calibrate::Calibration;
use crate::case::Case;
use crate::error::{Error, Result};
use crate::fracture::Scene;
use crate::input::Document;
use crate::predict::checkpoint::Checkpoint;
use crate::predict::{Prediction, predict, resume};
use crate::report::output::Room;
use crate::report::{fracture, run};
use crate::service::job::JobKind;
use crate::service::problem::Problem;
use crate::service::store::Growth;

/// Time between two tellings.
const TELL_EVERY: Duration = Duration::from_millis(400);
/// Time between two pictures, and that time over the one that drawing takes, at least: so they cost 5 % at most.
const DRAW_EVERY: Duration = Duration::from_secs(1);
const OVER_COST: u32 = 20;

/// A job that a command without a growing curve runs: writes into the folder and returns the figures.
pub type Other<'a> = &'a (dyn Fn(&Order, Document) -> Result<Value> + Sync);

/// What is to be run.
enum Task<'a> {
    Prediction(Box<Case>, Option<Box<Checkpoint>>),
    Calibration(Calibration),
    Scene(Box<Scene>),
    Other(Other<'a>, Box<Document>),
}

/// Takes one order from the standard input and runs it to its end.
///
/// # Errors
/// The standard input is not the socket of a worker.
pub fn take(other: Other<'_>) -> Result<()> {
    let cannot = |error| Error::file(Path::new("standard input"), "brings no order of a worker", error);
    let socket = io::stdin().as_fd().try_clone_to_owned().map(UnixStream::from).map_err(cannot)?;
    let order: Option<Order> = frames::read(&socket).map_err(cannot)?;
    let mut order = order.ok_or_else(|| cannot(io::ErrorKind::UnexpectedEof.into()))?;
    order.submission.files = std::mem::take(&mut order.files);
    end_with_worker(socket.try_clone().map_err(cannot)?, &order);
    let threads = |error| Error::file(Path::new("threads"), "cannot be started", io::Error::other(error));
    rayon::ThreadPoolBuilder::new().num_threads(order.threads).build_global().map_err(threads)?;
    let socket = Mutex::new(socket);
    let tell = |news: &News| {
        let socket = socket.lock().unwrap_or_else(PoisonError::into_inner);
        // A worker that has gone ends this process.
        frames::write(&*socket, news).is_ok()
    };
    let mut room = Room::default();
    let end = match ended(&order, other, &mut room, &tell) {
        Ok(summary) => News::Done(summary.to_string()),
        Err(error @ Error::File { .. }) => News::NoRoom(error.to_string(), room.all.max(results::bytes(&order.folder))),
        Err(error) => News::Failed(serde_json::to_string(&Problem::from(error)).unwrap_or_default()),
    };
    tell(&end);
    Ok(())
}

/// Ends this process, all that it started and what it wrote when its worker is gone.
fn end_with_worker(mut socket: UnixStream, order: &Order) {
    let folder = order.folder.parent().unwrap_or(&order.folder).to_path_buf();
    std::thread::spawn(move || {
        // A worker says nothing more after its order.
        let _ = socket.read(&mut [0]);
        let _ = fs::remove_dir_all(folder);
        let _ = kill_current_process_group(Signal::KILL);
    });
}

/// Runs an order to its figures.
fn ended(order: &Order, other: Other<'_>, room: &mut Room, tell: &(dyn Fn(&News) -> bool + Sync)) -> Result<Value> {
    let task = task(order, other)?;
    *room = match &task {
        Task::Prediction(case, _) => run::room(case),
        Task::Scene(scene) => fracture::room(scene),
        Task::Calibration(_) | Task::Other(..) => Room::default(),
    };
    // Asked before the run, which would be for nothing.
    if free_bytes(&order.folder).is_some_and(|free| free < room.all) {
        return Err(Error::file(&order.folder, "has no room for the results", io::ErrorKind::StorageFull.into()));
    }
    let shown = order.shown.as_ref().map(|pieces| {
        let until = match &task {
            Task::Prediction(_, Some(checkpoint)) => Some(checkpoint.progress().cycles),
            _ => None,
        };
        let shown = shown_until(pieces, until);
        tell(&News::Growth(shown.clone()));
        shown
    });
    let keep = |bytes| tell(&News::Checkpoint(bytes));
    let (cracks, keep) = match &task {
        Task::Prediction(case, _) => (case.specimen.cracks.clone(), Some(&keep as _)),
        Task::Calibration(Calibration::Lives(calibration)) => (calibration.case.specimen.cracks.clone(), None),
        Task::Calibration(_) | Task::Scene(_) | Task::Other(..) => (Vec::new(), None),
    };
    let teller = Teller::new(&cracks, &shown.unwrap_or_default(), keep, order.checkpoint_every);
    let (done, end) = channel();
    std::thread::scope(|scope| {
        scope.spawn(|| {
            let outcome = catch_unwind(AssertUnwindSafe(|| run_task(order, task, &teller)));
            // Whoever waits for it waits until it comes.
            let _ = done.send(outcome);
        });
        let mut pictures = Pictures { drawn: None, cost: Duration::ZERO };
        loop {
            match end.recv_timeout(TELL_EVERY) {
                Ok(Ok(outcome)) => break outcome,
                Ok(Err(panic)) => resume_unwind(panic),
                Err(RecvTimeoutError::Disconnected) => {
                    break Err(Error::Mechanics("the run ended without an outcome".to_owned()));
                }
                Err(RecvTimeoutError::Timeout) => pictures.tell(&teller, tell),
            }
        }
    })
}

/// Reads the input, and takes the checkpoint if it is one of it.
fn task<'a>(order: &Order, other: Other<'a>) -> Result<Task<'a>> {
    let document = order.submission.document()?;
    match order.kind {
        JobKind::Calibration => Ok(Task::Calibration(Calibration::from_document(&document)?)),
        JobKind::Prediction => {
            let case = Case::from_document(&document)?;
            let taken = order.checkpoint.as_ref().and_then(|bytes| match Checkpoint::from_bytes(bytes) {
                Ok(checkpoint) => checkpoint.belongs_to(&case).then(|| Box::new(checkpoint)),
                Err(error) => {
                    tracing::warn!("the run begins anew: {error}");
                    None
                }
            });
            Ok(Task::Prediction(Box::new(case), taken))
        }
        JobKind::Scene => Ok(Task::Scene(Box::new(Scene::from_document(&document)?))),
        JobKind::Sweep | JobKind::Sif | JobKind::Chart => Ok(Task::Other(other, Box::new(document))),
    }
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

fn run_task(order: &Order, task: Task<'_>, teller: &Teller<'_>) -> Result<Value> {
    let of = |case: &Case, prediction: Result<Prediction>| results::of_run(&order.folder, case, &prediction?);
    match task {
        Task::Prediction(case, None) => of(&case, predict(&case, teller)),
        Task::Prediction(case, Some(checkpoint)) => of(&case, resume(&case, *checkpoint, teller)),
        Task::Calibration(calibration) => results::of_fit(&order.folder, &calibration, teller),
        Task::Scene(scene) => results::of_scene(&order.folder, &scene, teller),
        Task::Other(other, document) => {
            let summary = other(order, *document)?;
            results::packed(&order.folder)?;
            Ok(summary)
        }
    }
}

/// When the last picture was drawn, and what it cost.
struct Pictures {
    drawn: Option<Instant>,
    cost: Duration,
}

impl Pictures {
    fn tell(&mut self, teller: &Teller<'_>, tell: &dyn Fn(&News) -> bool) {
        let is_due = self.drawn.is_none_or(|drawn| drawn.elapsed() > DRAW_EVERY.max(OVER_COST * self.cost));
        let news = teller.news(is_due);
        if let Some(growth) = news.growth {
            tell(&News::Growth(growth));
        }
        if let Some(look) = news.look {
            let begun = Instant::now();
            if let Some((about, picture)) = look.draw() {
                tell(&News::Picture(about, picture));
            }
            (self.drawn, self.cost) = (Some(Instant::now()), begun.elapsed());
        }
        if let Some(progress) = news.progress {
            tell(&News::Progress(serde_json::to_string(&progress).unwrap_or_default()));
        }
    }
}
