//! One job from its claim to its end.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

use axum::http::StatusCode;

use super::results::{Results, of_fit, of_laws, of_run};
use super::watch::{Keep, Stop, Watch};
use super::{Shared, TRY_EVERY, milliseconds};
use crate::calibration::case::CalibrationCase;
use crate::calibration::laws::case::{LawCase, is_law_fit};
use crate::case::Case;
use crate::error::{Error, Result};
use crate::predict::checkpoint::Checkpoint;
use crate::predict::{Prediction, predict, resume};
use crate::service::job::{JobKind, State, Submission};
use crate::service::problem::Problem;
use crate::service::store::{Claim, Growth, Heartbeat, Outcome, is_gone};

/// Time between two signs of life, in which a wish to cancel comes back as well.
const BEAT: Duration = Duration::from_millis(400);
/// Tries to hand in a result when the process is to stop.
const LAST_TRIES: u32 = 3;

/// What is to be run.
enum Task {
    Prediction(Box<Case>, Option<Box<Checkpoint>>),
    Calibration(Box<CalibrationCase>),
    Laws(Box<LawCase>),
}

/// Works on a claimed job until it has ended, or is not this worker's any more.
pub fn work(shared: &Shared, pool: &rayon::ThreadPool, claim: &Claim) {
    tracing::info!(job = claim.id, kind = %claim.kind, attempt = claim.attempts, "job taken");
    let limit = shared.settings.attempts;
    if claim.cancel_asked {
        return hand_in(shared, claim, &ended(State::Cancelled, None));
    }
    if claim.attempts > limit {
        let detail = format!("given up: {limit} workers stopped while they had it, none of them getting as far as a checkpoint");
        let problem = Problem::new(StatusCode::INTERNAL_SERVER_ERROR, "Given up", detail);
        return hand_in(shared, claim, &ended(State::Failed, Some(&problem)));
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
    let task = match task(claim.kind, &submission, checkpoint) {
        Ok(task) => task,
        Err(error) => return hand_in(shared, claim, &ended(State::Failed, Some(&error.into()))),
    };
    let growth = growth_so_far(shared, claim, &task);
    let keep = |bytes: Vec<u8>| match shared.handle.block_on(shared.store.keep(claim, bytes)) {
        Ok(held) => held,
        Err(error) => {
            tracing::warn!(job = claim.id, "a checkpoint cannot be kept: {error}");
            false
        }
    };
    let (cracks, keep): (_, Option<Keep<'_>>) = match &task {
        Task::Prediction(case, _) => (case.specimen.cracks.clone(), Some(&keep)),
        Task::Calibration(calibration) => (calibration.case.specimen.cracks.clone(), None),
        Task::Laws(_) => (Vec::new(), None),
    };
    let watch = Watch::new(&cracks, &growth, keep, shared.settings.checkpoint_every);
    let outcome = run_watched(shared, pool, claim, task, &watch);
    conclude(shared, claim, outcome, watch.stopped());
}

/// Reads the input, and takes the checkpoint if it is one of it.
fn task(kind: JobKind, submission: &Submission, checkpoint: Option<Vec<u8>>) -> Result<Task> {
    let document = submission.document()?;
    if kind == JobKind::Calibration {
        if is_law_fit(&document.table) {
            return Ok(Task::Laws(Box::new(LawCase::from_document(&document)?)));
        }
        return Ok(Task::Calibration(Box::new(CalibrationCase::from_document(document)?)));
    }
    let case = Case::from_document(&document)?;
    let taken = checkpoint.and_then(|bytes| match Checkpoint::from_bytes(&bytes) {
        Ok(checkpoint) => checkpoint.belongs_to(&case).then(|| Box::new(checkpoint)),
        Err(error) => {
            tracing::warn!("the run begins anew: {error}");
            None
        }
    });
    Ok(Task::Prediction(Box::new(case), taken))
}

/// The curve that earlier workers have shown, as far as the checkpoint confirms it.
fn growth_so_far(shared: &Shared, claim: &Claim, task: &Task) -> Growth {
    let mut all = Growth::default();
    if claim.fence == 1 || !matches!(task, Task::Prediction(..)) {
        return all;
    }
    if let Task::Prediction(_, Some(checkpoint)) = task {
        let until = checkpoint.progress().cycles;
        let pieces = shared.handle.block_on(shared.store.growth(&claim.id, 0, None)).unwrap_or_default();
        for piece in pieces {
            let kept = piece.cycles.iter().take_while(|cycles| **cycles <= until).count();
            all.cycles.extend_from_slice(&piece.cycles[..kept]);
            all.crack_length_mm.extend_from_slice(&piece.crack_length_mm[..kept]);
            all.tips.extend_from_slice(&piece.tips[..kept]);
        }
    }
    if let Err(error) = shared.handle.block_on(shared.store.grow(claim, &all)) {
        tracing::warn!(job = claim.id, "the growing curve cannot be shown: {error}");
        return Growth::default();
    }
    all
}

/// Runs in the pool, while this thread gives signs of life; `None` after a panic.
fn run_watched(
    shared: &Shared,
    pool: &rayon::ThreadPool,
    claim: &Claim,
    task: Task,
    watch: &Watch<'_>,
) -> Option<Result<Results>> {
    let (done, end) = channel();
    pool.in_place_scope(|scope| {
        scope.spawn(move |_| {
            let outcome = catch_unwind(AssertUnwindSafe(|| run(task, watch))).ok();
            // Whoever waits for it waits until it comes.
            let _ = done.send(outcome);
        });
        loop {
            match end.recv_timeout(BEAT) {
                Ok(outcome) => break outcome,
                Err(RecvTimeoutError::Disconnected) => break None,
                Err(RecvTimeoutError::Timeout) => tell(shared, claim, watch),
            }
        }
    })
}

fn run(task: Task, watch: &Watch<'_>) -> Result<Results> {
    let of = |case: &Case, prediction: Result<Prediction>| of_run(case, &prediction?);
    match task {
        Task::Prediction(case, None) => of(&case, predict(&case, watch)),
        Task::Prediction(case, Some(checkpoint)) => of(&case, resume(&case, *checkpoint, watch)),
        Task::Calibration(calibration) => of_fit(&calibration, watch),
        Task::Laws(case) => of_laws(&case),
    }
}

/// Tells the store how far the run is, and the run what the store says.
fn tell(shared: &Shared, claim: &Claim, watch: &Watch<'_>) {
    if shared.is_stopping() {
        watch.stop(Stop::Shutdown);
    }
    let news = watch.news();
    let lease_ms = milliseconds(shared.settings.lease);
    let told = shared.handle.block_on(async {
        match shared.store.beat(claim, lease_ms, news.progress.as_ref()).await {
            Ok(Heartbeat::Held) => {}
            Ok(Heartbeat::Cancel) => watch.stop(Stop::Cancelled),
            Ok(Heartbeat::Lost) => watch.stop(Stop::Lost),
            Err(error) => {
                if let Some(growth) = news.growth {
                    watch.untold(growth);
                }
                return Err(error);
            }
        }
        if let Some(growth) = news.growth
            && let Err(error) = shared.store.grow(claim, &growth).await
        {
            watch.untold(growth);
            return Err(error);
        }
        if let Some((about, picture)) = news.look.and_then(|look| look.draw()) {
            shared.store.show(claim, &about, picture).await?;
        }
        Ok(())
    });
    if let Err(error) = told {
        // The run goes on: what it finds can be handed in when the database is back.
        tracing::warn!(job = claim.id, "no sign of life can be given: {error}");
    }
}

/// Hands in what came of a run.
fn conclude(shared: &Shared, claim: &Claim, outcome: Option<Result<Results>>, stopped: Option<Stop>) {
    let outcome = match (outcome, stopped) {
        (Some(Ok((summary, files))), _) => {
            Outcome { state: State::Succeeded, summary: Some(summary.to_string()), problem: None, files }
        }
        (Some(Err(_)), Some(Stop::Cancelled)) => ended(State::Cancelled, None),
        (Some(Err(_)), Some(Stop::Lost)) => {
            return tracing::warn!(job = claim.id, "the job is another worker's: this one was not heard of for too long");
        }
        (Some(Err(_)), Some(Stop::Shutdown)) => return give_back(shared, claim),
        (Some(Err(error @ Error::File { .. })), None) => {
            // The disk of this machine, not the job.
            tracing::error!(job = claim.id, "results cannot be written: {error}");
            // Longer each time, so that a disk that stays full costs little.
            let tries = u32::try_from(claim.fence.clamp(1, 30)).unwrap_or(1);
            shared.handle.block_on(shared.pause(TRY_EVERY * tries));
            return give_back(shared, claim);
        }
        (Some(Err(error)), None) => ended(State::Failed, Some(&error.into())),
        (None, _) => {
            tracing::error!(job = claim.id, "the run panicked");
            ended(State::Failed, Some(&Problem::internal()))
        }
    };
    hand_in(shared, claim, &outcome);
}

fn ended(state: State, problem: Option<&Problem>) -> Outcome {
    let problem = problem.and_then(|problem| serde_json::to_string(problem).ok());
    Outcome { state, summary: None, problem, files: Vec::new() }
}

/// Stores the end of a job; waits for a database that is gone, since what was computed should not be lost.
fn hand_in(shared: &Shared, claim: &Claim, outcome: &Outcome) {
    let mut tries = 0;
    loop {
        match shared.handle.block_on(shared.store.finish(claim, outcome)) {
            Ok(true) => {
                metrics::counter!("perilife_jobs_finished_total", "kind" => claim.kind.name(), "state" => outcome.state.name())
                    .increment(1);
                return tracing::info!(job = claim.id, state = %outcome.state, "job done");
            }
            Ok(false) => return tracing::warn!(job = claim.id, "the job is another worker's: its result is dropped"),
            Err(error) => {
                tracing::warn!(job = claim.id, "the result cannot be stored: {error}");
                tries += 1;
                if !is_gone(&error) && outcome.state == State::Succeeded {
                    return hand_in(shared, claim, &ended(State::Failed, Some(&Problem::internal())));
                }
                if !is_gone(&error) || (shared.is_stopping() && tries >= LAST_TRIES) {
                    return;
                }
                let beat = shared.store.beat(claim, milliseconds(shared.settings.lease), None);
                let _ = shared.handle.block_on(beat);
                std::thread::sleep(TRY_EVERY);
            }
        }
    }
}

fn give_back(shared: &Shared, claim: &Claim) {
    match shared.handle.block_on(shared.store.release(claim)) {
        Ok(()) => tracing::info!(job = claim.id, "job given back"),
        Err(error) => tracing::warn!(job = claim.id, "the job cannot be given back, others take it later: {error}"),
    }
}
