//! One job from its claim to its end.

use std::fs::File;
use std::path::Path;
use std::sync::mpsc::RecvTimeoutError;
use std::time::{Duration, Instant};

use super::process::{Death, JobProcess, News, Order, Run};
use super::{Shared, TRY_EVERY, files, job_folder, milliseconds};
use crate::job::{JobKind, State, Submission};
use crate::problem::Problem;
use crate::store::{Claim, Finish, Growth, Heartbeat, Outcome, Told, free_bytes, is_gone};
use axum::http::StatusCode;
use perilife_base::error::{Error, Result};
use tempfile::TempDir;

/// Time between two signs of life, in which a wish to cancel comes back as well.
const BEAT: Duration = Duration::from_millis(400);
/// Tries to hand in a result when the process is to stop.
const LAST_TRIES: u32 = 3;
/// Wait after the first end that was not the job's fault; twice as long after each further one.
const FIRST_WAIT: Duration = Duration::from_secs(1);
/// Time behind its last checkpoint that a job may lose by giving way.
const RUN_AGAIN: Duration = Duration::from_secs(10);
/// Bytes in a megabyte, as messages count them.
const MEGABYTE: u64 = 1_000_000;

enum End {
    /// With figures, JSON, and files in the folder.
    Done(String),
    /// Without a result, by its input: a problem as JSON.
    Failed(String),
    NoRoom(String),
    Died(Death),
    /// It took longer than a job may.
    OutOfTime,
    Cancelled,
    /// It waits again, from its checkpoint on, since jobs of others wait.
    GaveWay,
    /// The job is not this worker's any more.
    Lost,
    Shutdown,
}

/// Works on a claimed job until it has ended, or is not this worker's any more.
pub fn work(shared: &Shared, claim: &Claim) {
    tracing::info!(job = claim.id, kind = %claim.kind, attempt = claim.attempts, "job taken");
    metrics::histogram!("perilife_queue_seconds", "kind" => claim.kind.name()).record(claim.waited_ms as f64 / 1e3);
    let limit = shared.settings.attempts;
    if claim.cancel_asked {
        return hand_in(shared, claim, &ended(State::Cancelled, None), "cancelled");
    }
    if claim.attempts > limit {
        let detail = format!("failed: lost {limit} workers before the first checkpoint");
        return fail(shared, claim, StatusCode::INTERNAL_SERVER_ERROR, "Given up", &detail, "given_up");
    }
    let content = loop {
        match shared.handle.block_on(shared.store.content(claim)) {
            Ok(content) => break content,
            Err(error) if is_gone(&error) && !shared.is_stopping() => shared.handle.block_on(shared.pause(TRY_EVERY)),
            // Whoever takes it next may be luckier.
            Err(error) => return tracing::error!(job = claim.id, "the input of the job cannot be read: {error}"),
        }
    };
    // Deleted meanwhile.
    let (Some(submission), checkpoint) = content else { return };
    let begun = Instant::now();
    match begin(shared, claim, submission, checkpoint) {
        Ok((process, (folder, _lock))) => {
            // Its process has ended before anything else is done about it.
            let end = match relay(shared, claim, &process, begun) {
                Some(end) => {
                    drop(process);
                    end
                }
                None => End::Died(process.death()),
            };
            let seconds = begun.elapsed().as_secs_f64();
            metrics::histogram!("perilife_job_seconds", "kind" => claim.kind.name()).record(seconds);
            conclude(shared, claim, end, &folder.path().join(RESULTS));
        }
        Err(error) => {
            tracing::error!(job = claim.id, "no process of the job: {error}");
            conclude(shared, claim, End::NoRoom(CANNOT_BEGIN.to_owned()), Path::new(""));
        }
    }
}

/// Starts the process of a job, and makes the folder for its results.
fn begin(
    shared: &Shared,
    claim: &Claim,
    submission: Submission,
    checkpoint: Option<Vec<u8>>,
) -> Result<(JobProcess, (TempDir, File))> {
    let cannot = |error| Error::file(&std::env::temp_dir(), "cannot create a folder in", error);
    let (folder, lock) = job_folder().map_err(cannot)?;
    let results = folder.path().join(RESULTS);
    std::fs::create_dir(&results).map_err(|error| Error::file(&results, "cannot create", error))?;
    let shown = (claim.fence > 1 && claim.kind == JobKind::Prediction)
        .then(|| shared.handle.block_on(shared.store.growth(&claim.id, 0, None)).unwrap_or_default());
    let settings = &shared.settings;
    let order = Order::Run(Box::new(Run {
        kind: claim.kind,
        submission,
        checkpoint,
        shown,
        folder: results,
        threads: settings.threads,
        checkpoint_every: settings.checkpoint_every,
    }));
    let process = JobProcess::start(&settings.program, &order, settings.memory, settings.threads);
    let process = process.map_err(|error| Error::file(&settings.program, "cannot be started", error))?;
    Ok((process, (folder, lock)))
}

/// What a user is told of a worker that cannot begin; the log says more.
const CANNOT_BEGIN: &str = "a worker cannot write its temporary folder or start a process";

const RESULTS: &str = "results";

/// Tells the store what the process tells, until it ends or is to end; `None` if it ended without a word.
fn relay(shared: &Shared, claim: &Claim, process: &JobProcess, begun: Instant) -> Option<End> {
    let (mut untold, mut beaten) = (Told::default(), Instant::now());
    let (mut memory, mut kept) = (0, None::<Instant>);
    let end = loop {
        match process.news.recv_timeout(BEAT.saturating_sub(beaten.elapsed())) {
            Ok(News::Progress(progress)) => untold.progress = Some(progress),
            Ok(News::Growth(growth)) => add(&mut untold.growth, growth),
            Ok(News::Picture(about, picture)) => untold.picture = Some((about, picture)),
            Ok(News::Checkpoint(bytes)) => kept = keep(shared, claim, bytes).then(Instant::now).or(kept),
            Ok(News::Done(summary)) => break Some(End::Done(summary)),
            Ok(News::Failed(problem)) => break Some(End::Failed(problem)),
            Ok(News::NoRoom(why, bytes)) => {
                tracing::error!(job = claim.id, "the results cannot be written: {why}");
                break Some(End::NoRoom(room_needed(bytes)));
            }
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => break None,
        }
        if beaten.elapsed() >= BEAT {
            beaten = Instant::now();
            memory = process.memory().unwrap_or(0).max(memory);
            if process.touched().is_some_and(|touched| touched > shared.settings.memory) {
                break Some(End::Died(Death::OutOfMemory));
            }
            if let Some(end) = beat(shared, claim, process, &mut untold, begun.elapsed()) {
                break Some(end);
            }
            if kept.is_some_and(|kept| kept.elapsed() < RUN_AGAIN) && gives_way(shared, claim, begun.elapsed()) {
                break Some(End::GaveWay);
            }
        }
    };
    metrics::histogram!("perilife_job_memory_megabytes", "kind" => claim.kind.name()).record((memory / MEGABYTE) as f64);
    end
}

/// Puts a piece of a curve behind those that the store has not been told yet; a piece from the beginning starts over.
fn add(untold: &mut Option<Growth>, growth: Growth) {
    match untold {
        Some(earlier) if growth.from > 0 => {
            earlier.cycles.extend(growth.cycles);
            earlier.crack_length_mm.extend(growth.crack_length_mm);
            earlier.tips.extend(growth.tips);
        }
        _ => *untold = Some(growth),
    }
}

fn room_needed(bytes: u64) -> String {
    let free = free_bytes(&std::env::temp_dir()).unwrap_or(0) / MEGABYTE;
    // What was written until the disk was full is a part of it.
    let needed = bytes.div_ceil(MEGABYTE) + 1;
    format!("the temporary disk of a worker does not take the results: needs {needed} MB or more, has {free} MB free")
}

fn keep(shared: &Shared, claim: &Claim, checkpoint: Vec<u8>) -> bool {
    shared.handle.block_on(shared.store.keep(claim, checkpoint)).unwrap_or_else(|error| {
        tracing::warn!(job = claim.id, "a checkpoint cannot be kept: {error}");
        false
    })
}

/// Whether the job, held for so long, has given way to those of others.
fn gives_way(shared: &Shared, claim: &Claim, held: Duration) -> bool {
    // A database that is gone is the matter of the sign of life.
    shared.handle.block_on(shared.store.give_way(claim, shared.settings.jobs, held)).unwrap_or(false)
}

/// A sign of life; why the run is to end, if it is.
fn beat(shared: &Shared, claim: &Claim, process: &JobProcess, untold: &mut Told, elapsed: Duration) -> Option<End> {
    if shared.is_stopping() {
        return Some(End::Shutdown);
    }
    let spent = Duration::from_millis(u64::try_from(claim.spent_ms).unwrap_or(0)) + elapsed;
    if spent > shared.settings.time {
        return Some(End::OutOfTime);
    }
    let lease_ms = milliseconds(shared.settings.lease);
    match shared.handle.block_on(shared.store.beat(claim, lease_ms, elapsed, untold)) {
        Ok(heard @ (Heartbeat::Held | Heartbeat::Keep)) => {
            *untold = Told::default();
            if heard == Heartbeat::Keep {
                process.is_enough();
            }
            None
        }
        Ok(Heartbeat::Cancel) => Some(End::Cancelled),
        Ok(Heartbeat::Lost) => Some(End::Lost),
        Err(error) => {
            // The run goes on: what it finds can be handed in when the database is back.
            tracing::warn!(job = claim.id, "no sign of life can be given: {error}");
            None
        }
    }
}

/// Hands in what came of a run.
fn conclude(shared: &Shared, claim: &Claim, end: End, folder: &Path) {
    let settings = &shared.settings;
    match end {
        End::Done(summary) => match files(folder) {
            Ok(files) => {
                let done = Outcome { state: State::Succeeded, summary: Some(summary), problem: None, files };
                hand_in(shared, claim, &done, "done");
            }
            Err(error) => {
                tracing::error!(job = claim.id, "the results cannot be read: {error}");
                put_back(shared, claim, StatusCode::INSUFFICIENT_STORAGE, &room_needed(0), "disk");
            }
        },
        End::Failed(problem) => hand_in(shared, claim, &ended(State::Failed, Some(problem)), "input"),
        End::NoRoom(why) => put_back(shared, claim, StatusCode::INSUFFICIENT_STORAGE, &why, "disk"),
        End::Died(Death::OutOfMemory) => {
            let detail = format!(
                "memory limit exceeded ({} MB, --job-memory); give a coarser \
                 spacing or a smaller horizon_ratio, or run it with `perilife` on a machine with more",
                settings.memory / MEGABYTE
            );
            fail(shared, claim, StatusCode::UNPROCESSABLE_ENTITY, "Too large", &detail, "memory");
        }
        End::Died(Death::Panicked(said)) => {
            tracing::error!(job = claim.id, "the run panicked: {said}");
            hand_in(shared, claim, &failed(&Problem::internal()), "panic");
        }
        End::Died(Death::Other(why)) => {
            put_back(shared, claim, StatusCode::INTERNAL_SERVER_ERROR, &format!("the process of the job {why}"), "killed");
        }
        End::OutOfTime => {
            let detail = format!(
                "ended: it took longer than the {:.3} h that a job of this server may take (--job-hours)",
                settings.time.as_secs_f64() / 3600.0
            );
            fail(shared, claim, StatusCode::UNPROCESSABLE_ENTITY, "Too slow", &detail, "time");
        }
        End::Cancelled => hand_in(shared, claim, &ended(State::Cancelled, None), "cancelled"),
        End::GaveWay => tracing::info!(job = claim.id, "job given back: those of others wait"),
        End::Lost => tracing::warn!(job = claim.id, "lease lost: another worker took the job"),
        End::Shutdown => match shared.handle.block_on(shared.store.release(claim)) {
            Ok(()) => tracing::info!(job = claim.id, "job given back"),
            Err(error) => tracing::warn!(job = claim.id, "the job cannot be given back, others take it later: {error}"),
        },
    }
}

/// Counts an end that was not the job's fault: it waits longer each time, so that a disk that stays full costs little, and is given up
/// after as many as workers may die over it.
fn put_back(shared: &Shared, claim: &Claim, status: StatusCode, why: &str, reason: &'static str) {
    // The disk of this machine, or its memory, not the job.
    tracing::error!(job = claim.id, failures = claim.failures + 1, "no result: {why}");
    metrics::counter!("perilife_job_failures_total", "reason" => reason).increment(1);
    if claim.failures + 1 >= shared.settings.attempts {
        let detail = format!("given up after {} tries: {why}", claim.failures + 1);
        return fail(shared, claim, status, "Given up", &detail, reason);
    }
    let wait = FIRST_WAIT * (1 << claim.failures.clamp(0, 12));
    if let Err(error) = shared.handle.block_on(shared.store.put_back(claim, wait, why)) {
        tracing::warn!(job = claim.id, "the job cannot be given back, others take it later: {error}");
    }
}

fn fail(shared: &Shared, claim: &Claim, status: StatusCode, title: &str, detail: &str, reason: &'static str) {
    hand_in(shared, claim, &failed(&Problem::new(status, title, detail)), reason);
}

fn failed(problem: &Problem) -> Outcome {
    ended(State::Failed, serde_json::to_string(problem).ok())
}

fn ended(state: State, problem: Option<String>) -> Outcome {
    Outcome { state, summary: None, problem, files: Vec::new() }
}

/// Stores the end of a job; waits for a database that is gone, since what was computed should not be lost.
fn hand_in(shared: &Shared, claim: &Claim, outcome: &Outcome, reason: &'static str) {
    let (mut tries, begun) = (0, Instant::now());
    let wait = || {
        let (lease_ms, nothing) = (milliseconds(shared.settings.lease), Told::default());
        let heard = shared.handle.block_on(shared.store.beat(claim, lease_ms, begun.elapsed(), &nothing));
        std::thread::sleep(TRY_EVERY);
        heard
    };
    loop {
        // What the reserve of a full disk gave up is for those who make room.
        if outcome.state == State::Succeeded && !shared.store.has_room_for_results() && !shared.is_stopping() {
            tracing::warn!(job = claim.id, "the result waits for room on the disk of the database");
            match wait() {
                Ok(Heartbeat::Cancel) => return hand_in(shared, claim, &ended(State::Cancelled, None), "cancelled"),
                Ok(Heartbeat::Lost) => {
                    return tracing::warn!(job = claim.id, "the result is dropped: another worker has the job");
                }
                _ => continue,
            }
        }
        match shared.handle.block_on(shared.store.finish(claim, outcome)) {
            Ok(Finish::Stored) => {
                let (kind, state) = (claim.kind.name(), outcome.state.name());
                metrics::counter!("perilife_jobs_finished_total", "kind" => kind, "state" => state, "reason" => reason)
                    .increment(1);
                return tracing::info!(job = claim.id, state = %outcome.state, reason, "job done");
            }
            Ok(Finish::SpaceFull(bytes)) => {
                let detail = format!(
                    "ended: with its results your jobs would have {} MB, more than this server keeps of one owner (--quota-mib); \
                     delete jobs that are not needed any more and submit it again",
                    bytes as u64 / MEGABYTE
                );
                return fail(shared, claim, StatusCode::INSUFFICIENT_STORAGE, "No room", &detail, "quota");
            }
            Ok(Finish::Lost) => return tracing::warn!(job = claim.id, "the job is another worker's: its result is dropped"),
            Err(error) => {
                tracing::warn!(job = claim.id, "the result cannot be stored: {error}");
                tries += 1;
                if !is_gone(&error) && outcome.state == State::Succeeded {
                    return hand_in(shared, claim, &failed(&Problem::internal()), "store");
                }
                if !is_gone(&error) || (shared.is_stopping() && tries >= LAST_TRIES) {
                    return;
                }
                let _ = wait();
            }
        }
    }
}
