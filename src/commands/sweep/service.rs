//! Cases of a sweep by the workers of a service, wherever they are.
//!
//! Every case is a prediction, submitted under the hash of its input: one that was submitted before, by a call that was broken off
//! or by another sweep, is not run again. What this process holds is nothing that could be lost; jobs go on without it.

use std::collections::VecDeque;
use std::fs;
use std::io::{Cursor, Read as _};
use std::path::Path;
use std::time::Duration;

use indicatif::ProgressBar;

use perilife_base::error::{Error, Result};
use perilife_calibration::sweep::DrawnCase;
use perilife_results::output::write_file;
use perilife_results::provenance::INPUTS;
use perilife_results::snapshots::PARAVIEW;
use perilife_results::sweep::Outcome;
use perilife_runner::sweep::SweepFolder;
use perilife_service::job::{Job, JobKind, State, Submission};
use perilife_service::store::{self, FileEntry, NewJob, Origin, Room, Store, Submitted, is_gone};
use perilife_service::with_store;

/// Who submits, as listings of jobs show it.
const OWNER: &str = "sweep";
/// Time between two looks at jobs.
const LOOK_EVERY: Duration = Duration::from_millis(250);
/// Time before another try of a database that does not answer.
const TRY_EVERY: Duration = Duration::from_secs(1);
/// Jobs looked at each time: they are taken in their order, so that those behind have hardly begun.
const LOOKED_AT: usize = 64;

/// A file of a result: name and content.
type File = (String, Vec<u8>);

const ROOM: Room = Room { queued: i64::MAX, bytes: i64::MAX };

/// Has cases run, and fetches what comes of them.
pub fn run(url: &str, cases: &[&DrawnCase], folder: &SweepFolder, with_files: bool, count: &ProgressBar) -> Result<()> {
    if cases.is_empty() {
        return Ok(());
    }
    with_store(url, async |store| {
        let mut waiting: VecDeque<(String, &DrawnCase)> = VecDeque::with_capacity(cases.len());
        for case in cases {
            waiting.push_back((submitted(store, case).await?, case));
        }
        while !waiting.is_empty() {
            let mut is_news = false;
            for _ in 0..waiting.len().min(LOOKED_AT) {
                let Some((id, case)) = waiting.pop_front() else { break };
                match patiently(async || store.job(JobKind::Prediction, &id).await).await? {
                    Some(job) if !job.state.is_final() => waiting.push_back((id, case)),
                    job => {
                        is_news = true;
                        if let Err(error) = fetch(store, job, case, folder, with_files).await? {
                            return Ok(Err(error));
                        }
                        count.inc(1);
                    }
                }
            }
            // Those that were looked at went to the end; back to their order.
            waiting.make_contiguous().sort_by_key(|(_, case)| case.number);
            if !is_news {
                tokio::time::sleep(LOOK_EVERY).await;
            }
        }
        Ok(Ok(()))
    })?
}

async fn patiently<T>(ask: impl AsyncFn() -> store::Result<T>) -> store::Result<T> {
    loop {
        match ask().await {
            Err(error) if is_gone(&error) => {
                tracing::warn!("database not reachable: {error}");
                tokio::time::sleep(TRY_EVERY).await;
            }
            answer => return answer,
        }
    }
}

/// The job of a case: a new one, or that of an earlier call unless it was cancelled or lost.
async fn submitted(store: &Store, case: &DrawnCase) -> store::Result<String> {
    let submission = Submission {
        name: case.name.clone(),
        text: case.text.clone(),
        with_fitted: false,
        options: Vec::new(),
        files: case.files.clone(),
    };
    let mut tries = 0;
    loop {
        let key = if tries == 0 { format!("sweep {}", case.hash) } else { format!("sweep {} {tries}", case.hash) };
        let new = NewJob {
            kind: JobKind::Prediction,
            owner: OWNER,
            calibration: None,
            idempotency_key: Some(&key),
            fingerprint: &case.hash,
            submission: &submission,
            room: 0,
        };
        match patiently(async || store.submit(&new, ROOM).await).await? {
            Submitted::New(id) => return Ok(id),
            Submitted::Again(id) => {
                let job = patiently(async || store.job(JobKind::Prediction, &id).await).await?;
                if job.is_some_and(|job| job.state != State::Cancelled && !is_lost(&job)) {
                    return Ok(id);
                }
            }
            // The key names its request, and the queue has no end here; another key is as good.
            Submitted::KeyTaken | Submitted::QueueFull | Submitted::SpaceFull(..) => {}
        }
        tries += 1;
    }
}

/// Whether a job failed by what its workers ran into, not by its input.
fn is_lost(job: &Job) -> bool {
    job.problem.as_ref().is_some_and(|problem| problem.status >= 500)
}

/// Puts what came of a job into the folder of its case.
async fn fetch(
    store: &Store,
    job: Option<Job>,
    case: &DrawnCase,
    folder: &SweepFolder,
    with_files: bool,
) -> store::Result<Result<()>> {
    let ended = |why: &str| {
        let text = format!("{}: its job {why}; run the same command to submit it again", case.name);
        Ok(Err(Error::Mechanics(text)))
    };
    let Some(job) = job else { return ended("was deleted") };
    if job.state == State::Cancelled {
        return ended("was canceled");
    }
    if let Some(problem) = &job.problem {
        let outcome = Outcome { try_again: is_lost(&job), ..Outcome::failed(case, &problem.detail, 0.0) };
        return Ok(folder.keep(case, |_| Ok(outcome)));
    }
    let Some(summary) = job.summary else { return ended("has no summary") };
    let mut files = Vec::new();
    if with_files {
        for FileEntry { name, .. } in patiently(async || store.file_entries(&job.id, Origin::Result).await).await? {
            let content = patiently(async || store.whole_file(&job.id, Origin::Result, &name).await).await?;
            files.extend(content.map(|content| (name, content)));
        }
    }
    Ok(folder.keep(case, |path| {
        files.iter().try_for_each(|file| unpacked(path, file))?;
        Ok(Outcome::of(case, &summary, with_files))
    }))
}

/// Writes a file of a job; an archive becomes the folder that it was made of.
fn unpacked(folder: &Path, (name, content): &File) -> Result<()> {
    let path = folder.join(name);
    let Some(archived) = [PARAVIEW, INPUTS].into_iter().find(|folder| *name == format!("{folder}.zip")) else {
        return write_file(&path, content);
    };
    let failed = |error: &dyn std::fmt::Display| Error::file(&path, "cannot unpack", std::io::Error::other(error.to_string()));
    let into = folder.join(archived);
    fs::create_dir(&into).map_err(|error| Error::file(&into, "cannot create the folder", error))?;
    let mut archive = zip::ZipArchive::new(Cursor::new(content)).map_err(|error| failed(&error))?;
    for i in 0..archive.len() {
        let mut entry = archive.by_index(i).map_err(|error| failed(&error))?;
        // Only names of this program stand in there; whatever comes is put into this folder and nowhere else.
        let name = entry.name().map_err(|error| failed(&error))?.into_owned();
        let name = Path::new(&name).file_name().map(std::ffi::OsStr::to_owned).unwrap_or_default();
        let mut content = Vec::new();
        entry.read_to_end(&mut content).map_err(|error| failed(&error))?;
        write_file(&into.join(name), &content)?;
    }
    Ok(())
}
