//! The other side of a job's process: takes an order, runs it as the commands do, tells how far it is and where it could be taken up.

use std::fs;
use std::io::{self, Read as _};
use std::os::fd::AsFd;
use std::os::unix::net::UnixStream;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use rustix::process::{Signal, kill_current_process_group};
use serde_json::Value;

use super::process::{News, Order, Run, read_frame, write_frame};
use super::{bytes, packed};
use crate::job::JobProgress;
use crate::problem::Problem;
use crate::store::{Growth, free_bytes};
use perilife_base::error::{Error, Result};
use perilife_base::input::Opened;
use perilife_base::raster::{PointGrid, Snapshot};
use perilife_base::units::MM;
use perilife_base::watch::{Stage, Watch};
use perilife_calibration::calibrate::Calibration;
use perilife_growth::predict::checkpoint::Checkpoint;
use perilife_growth::predict::{Observer, Progress, TipRecord};
use perilife_plate::specimen::{Crack, Point};
use perilife_results::output::{Room, write_file, write_json};
use perilife_results::paper::{self, Signed};
use perilife_results::record::RESULT_FILE;
use perilife_results::snapshots::{DamagePicture, cycles_and_length};
use perilife_runner::scenes::{SceneObserver, SceneProgress};
use perilife_runner::{Task, TaskCheckpoint, Watcher};

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
            Some(TaskCheckpoint::Cycles(checkpoint)) => Some(checkpoint.kept.progress.cycles),
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
    let teller = Teller::new(&cracks, &shown.unwrap_or_default(), (keep, order.checkpoint_every), is_enough);
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
    let mut figures = summary.figures;
    // For the list of runs.
    figures["plate"] = Value::from_iter(["specimen", "material", "load"].map(|key| (key, summary.result["plate"][key].clone())));
    Ok(figures)
}

/// Entries of a growing curve from its start to its end: as many as a picture of it can show.
const ENTRIES: f64 = 800.0;

/// The plate as it was last seen, to be drawn by who has time for it.
#[derive(Debug)]
struct LivePicture {
    snapshot: Snapshot,
    grid: PointGrid,
    cracks: Vec<Crack>,
    paths: Vec<Vec<Point>>,
}

impl LivePicture {
    /// What is said of the picture, JSON, and its SVG; `None` if it cannot be drawn.
    fn draw(&self) -> Option<(String, Vec<u8>)> {
        let LivePicture { snapshot, grid, cracks, paths } = self;
        let caption = cycles_and_length(snapshot);
        let picture = DamagePicture { grid, snapshot, cracks, paths, caption: &caption };
        let about = serde_json::json!({ "cycles": snapshot.cycles, "crack_length_mm": snapshot.crack_length / MM });
        Some((about.to_string(), picture.svg().ok()?.into_bytes()))
    }
}

/// Takes a checkpoint's bytes to where they are kept; whether that worked.
pub type Keep<'a> = &'a (dyn Fn(Vec<u8>) -> bool + Sync);

/// Takes down what one run tells.
pub struct Teller<'a> {
    cracks: &'a [Crack],
    /// `None` for a calibration, which begins anew wherever it was broken off: it takes seconds.
    keep: Option<Keep<'a>>,
    keep_every: Duration,
    started: Instant,
    /// Whether a user takes the curve so far.
    is_enough: Arc<AtomicBool>,
    /// What the run does before it has rows to show.
    work: Arc<Watch>,
    /// Whether nobody has shown any of its curve yet.
    is_fresh: bool,
    told: Mutex<Pending>,
    /// When the last picture was drawn, and what it cost.
    drawn: Mutex<Option<(Instant, Duration)>>,
}

struct Pending {
    progress: Option<Progress>,
    /// Share at which this worker took it up, and when that was: what came before is no growth.
    first: Option<(f64, Instant)>,
    last: Option<Instant>,
    tips: Vec<Point>,
    /// Ways of the tips as far as entries show them.
    paths: Vec<Vec<Point>>,
    entries: Growth,
    last_entry: f64,
    look: Option<LivePicture>,
    kept: Instant,
    keep_cost: Duration,
}

impl Pending {
    /// A row of the growing curve, where it has gone far enough to be seen.
    fn add(&mut self, progress: &Progress) {
        if self.tips.is_empty() || progress.share < self.last_entry + 1.0 / ENTRIES {
            return;
        }
        self.last_entry = progress.share;
        self.entries.cycles.push(progress.cycles);
        self.entries.crack_length_mm.push(progress.crack_length / MM);
        let tips = std::mem::take(&mut self.tips);
        self.entries.tips.push(tips.iter().map(|tip| tip.map(|metres| metres / MM)).collect());
        self.paths.resize(tips.len(), Vec::new());
        self.paths.iter_mut().zip(tips).for_each(|(path, tip)| path.push(tip));
    }
}

/// Time between two pictures, at least.
const DRAW_EVERY: Duration = Duration::from_secs(1);
/// Time between two pictures or checkpoints over the time that one takes, at least: so they cost 5 % at most each.
const OVER_COST: u32 = 20;

impl<'a> Teller<'a> {
    /// For a run of a plate with these cracks, whose curve so far is `growth`.
    pub fn new(
        cracks: &'a [Crack],
        growth: &Growth,
        (keep, keep_every): (Option<Keep<'a>>, Duration),
        is_enough: Arc<AtomicBool>,
    ) -> Self {
        let tips = growth.tips.first().map_or(0, Vec::len);
        let path = |tip: usize| growth.tips.iter().filter_map(|entry| Some(entry.get(tip)?.map(|mm| mm * MM))).collect();
        let told = Pending {
            progress: None,
            first: None,
            last: None,
            tips: Vec::new(),
            paths: (0..tips).map(path).collect(),
            entries: Growth { from: growth.cycles.len(), ..Growth::default() },
            last_entry: f64::NEG_INFINITY,
            look: None,
            kept: Instant::now(),
            keep_cost: Duration::ZERO,
        };
        let is_fresh = growth.cycles.is_empty();
        let (told, drawn) = (Mutex::new(told), Mutex::default());
        Teller { is_enough, cracks, keep, keep_every, started: Instant::now(), work: Arc::default(), is_fresh, told, drawn }
    }

    /// Passes on what was told since the last time; a look at the plate stays until it is time for a picture.
    pub fn pass_on(&self, tell: &dyn Fn(&News) -> bool) {
        let mut drawn = self.drawn.lock().unwrap_or_else(PoisonError::into_inner);
        let is_due = drawn.is_none_or(|(at, cost)| at.elapsed() > DRAW_EVERY.max(OVER_COST * cost));
        let (progress, growth, look) = self.news(is_due);
        if let Some(growth) = growth {
            tell(&News::Growth(growth));
        }
        if let Some(look) = look {
            let begun = Instant::now();
            if let Some((about, picture)) = look.draw() {
                tell(&News::Picture(about, picture));
            }
            *drawn = Some((Instant::now(), begun.elapsed()));
        }
        if let Some(progress) = progress {
            tell(&News::Progress(serde_json::to_string(&progress).unwrap_or_default()));
        }
    }

    /// How far the run is, where its curve has got to and its latest look.
    fn news(&self, with_look: bool) -> (Option<JobProgress>, Option<Growth>, Option<LivePicture>) {
        let mut told = self.told.lock().unwrap_or_else(PoisonError::into_inner);
        let elapsed_s = self.started.elapsed().as_secs_f64();
        let first = told.first;
        let progress = told.progress.map(|Progress { cycles, crack_length, share }| {
            let share = if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.0 };
            let seconds_left = first.filter(|(from, _)| share > *from).map(|(from, at)| {
                // By the growth up to the last row; what has gone since then is not left any more.
                let since = told.last.unwrap_or(at);
                let left = (since - at).as_secs_f64() * (1.0 - share) / (share - from);
                (left - since.elapsed().as_secs_f64()).max(0.0)
            });
            JobProgress { cycles, crack_length_mm: crack_length / MM, share, elapsed_s, seconds_left, stage: None }
        });
        let before = |(stage, share): (Stage, f64)| JobProgress {
            elapsed_s,
            stage: Some(format!("{} {:.0} %", stage.words(), 100.0 * share)),
            ..JobProgress::default()
        };
        // One that is taken up is as far as it was until it has more to show.
        let begun = || self.work.now().map_or_else(|| JobProgress { elapsed_s, ..JobProgress::default() }, before);
        let progress = progress.or_else(|| self.is_fresh.then(begun));
        let growth = (!told.entries.cycles.is_empty()).then(|| {
            let next = told.entries.from + told.entries.cycles.len();
            std::mem::replace(&mut told.entries, Growth { from: next, ..Growth::default() })
        });
        (progress, growth, told.look.take_if(|_| with_look))
    }
}

impl Observer for Teller<'_> {
    fn is_enough(&self) -> bool {
        self.is_enough.load(Ordering::Relaxed)
    }

    fn watch(&self) -> Option<Arc<Watch>> {
        Some(self.work.clone())
    }

    fn begun(&self, start: &Progress, tips: &[TipRecord]) {
        self.grown(tips);
        let mut told = self.told.lock().unwrap_or_else(PoisonError::into_inner);
        told.first = Some((start.share, Instant::now()));
        told.add(start);
    }

    fn block_done(&self, progress: &Progress) -> bool {
        let mut told = self.told.lock().unwrap_or_else(PoisonError::into_inner);
        let now = Instant::now();
        told.first.get_or_insert((progress.share, now));
        told.last = Some(now);
        told.progress = Some(*progress);
        told.add(progress);
        true
    }

    fn grown(&self, tips: &[TipRecord]) {
        let mut told = self.told.lock().unwrap_or_else(PoisonError::into_inner);
        told.tips.clear();
        told.tips.extend(tips.iter().map(|tip| tip.position));
    }

    fn looked(&self, snapshot: &Snapshot, grid: &PointGrid) {
        let mut told = self.told.lock().unwrap_or_else(PoisonError::into_inner);
        let (snapshot, paths) = (snapshot.clone(), told.paths.clone());
        told.look = Some(LivePicture { snapshot, grid: grid.clone(), cracks: self.cracks.to_vec(), paths });
    }

    fn may_keep(&self, checkpoint: &dyn Fn() -> Checkpoint) {
        let Some(keep) = self.keep else { return };
        let mut told = self.told.lock().unwrap_or_else(PoisonError::into_inner);
        if told.kept.elapsed() < self.keep_every.max(OVER_COST * told.keep_cost) {
            return;
        }
        let begun = Instant::now();
        // Others may ask how far the run is meanwhile.
        drop(told);
        keep(checkpoint().to_bytes());
        told = self.told.lock().unwrap_or_else(PoisonError::into_inner);
        (told.kept, told.keep_cost) = (Instant::now(), begun.elapsed());
    }
}

impl SceneObserver for Teller<'_> {
    fn watch(&self) -> Option<Arc<Watch>> {
        Some(self.work.clone())
    }

    fn step_done(&self, progress: &SceneProgress) -> bool {
        Observer::block_done(self, &Progress { cycles: 0.0, crack_length: 0.0, share: progress.share })
    }
}

impl Watcher for Teller<'_> {}
