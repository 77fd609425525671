//! Jobs: submit, list, look at, cancel, delete.

use std::time::{Duration, Instant};

use axum::extract::rejection::QueryRejection;
use axum::extract::{Path, Query, Request, State as Shared};
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{IntoResponse, Response};
use axum::{Extension, Json};
use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, utf8_percent_encode};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use utoipa::{IntoParams, ToSchema};

use super::App;
use super::app::Caller;
use super::documents::{self, JobRequest};
use super::watching::has_room;
use crate::job::{Job, JobKind, State, is_id};
use crate::problem::{Answer, Problem};
use crate::store::{Change, FileEntry, NewJob, Origin, Role, Room, Submitted, Wanted};
use perilife_base::error::input;
use perilife_results::paper::Signed;

/// Most jobs of one part of a list.
const LIST_MAX: u32 = 200;
/// Jobs of one part of a list unless asked otherwise.
const LIST: u32 = 20;
/// Longest idempotency key, bytes.
const KEY_MAX: usize = 200;
/// Longest note of a job, bytes.
const NOTE_MAX: usize = 2000;
/// Longest report data of a job, bytes.
const REPORT_MAX: usize = 20_000;
/// Seconds after which there may be room in the queue.
const QUEUE_MOVES_S: u32 = 10;

/// A job with its files and, where one job is asked for, its input.
#[derive(Serialize, ToSchema)]
pub struct JobView {
    #[serde(flatten)]
    job: Job,
    /// Files of its result.
    files: Vec<FileView>,
    /// Files that came with it.
    #[serde(skip_serializing_if = "Option::is_none")]
    inputs: Option<Vec<FileView>>,
    /// TOML as submitted.
    #[serde(skip_serializing_if = "Option::is_none")]
    input: Option<String>,
    /// Options as submitted, `NAME=VALUE`.
    #[serde(skip_serializing_if = "Option::is_none")]
    options: Option<Vec<String>>,
    /// The input as an object.
    #[serde(skip_serializing_if = "Option::is_none")]
    case: Option<Value>,
}

/// A file of a result.
#[derive(Serialize, ToSchema)]
pub struct FileView {
    name: String,
    media_type: String,
    bytes: i64,
    href: String,
}

/// Part of a list of jobs, newest first.
#[derive(Serialize, ToSchema)]
pub struct Page {
    items: Vec<JobView>,
    /// What to give as `after` for the next part; null at the end.
    next: Option<String>,
}

/// Which part of a list.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub struct Part {
    /// Jobs, 1 to 200; 20 if left out.
    limit: Option<u32>,
    /// Begin behind this job.
    after: Option<String>,
    /// Only jobs in this state.
    state: Option<State>,
    /// Only jobs with this text in name, note or owner.
    text: Option<String>,
    /// Also jobs that were put away.
    archived: Option<bool>,
}

/// The kind of a collection's name in a URL.
pub fn kind_of(collection: &str) -> Answer<JobKind> {
    // Jobs that an earlier version ran may still be stored.
    if collection == "charts" {
        let detail = "a service runs no charts and shows none of an earlier version; run `perilife chart` on a command line";
        return Err(Problem::new(StatusCode::GONE, "Gone", detail));
    }
    JobKind::all().find(|kind| kind.collection() == collection).ok_or_else(|| Problem::not_found("address"))
}

/// A job of a collection.
pub async fn job_of(app: &App, collection: &str, id: &str) -> Answer<Job> {
    let kind = kind_of(collection)?;
    if !is_id(id) {
        return Err(Problem::not_found(kind.name()));
    }
    app.store.job(kind, id).await?.ok_or_else(|| Problem::not_found(kind.name()))
}

/// What a name is written with as part of an address.
const IN_PATHS: AsciiSet = NON_ALPHANUMERIC.remove(b'.').remove(b'_').remove(b'-');

/// What is shown of a job.
pub async fn view(app: &App, job: Job, with_input: bool) -> Answer<JobView> {
    let views = |entries: Vec<FileEntry>, place: &str| -> Vec<FileView> {
        let base = format!("/v1/{}/{}/{place}", job.kind.collection(), job.id);
        let view = |FileEntry { name, media_type, bytes }| FileView {
            href: format!("{base}/{}", utf8_percent_encode(&name, &IN_PATHS)),
            name,
            media_type,
            bytes,
        };
        entries.into_iter().map(view).collect()
    };
    let has_result = job.state == State::Succeeded;
    let files = if has_result { app.store.file_entries(&job.id, Origin::Result).await? } else { Vec::new() };
    let files = views(files, "files");
    let (submission, inputs) = if with_input {
        let inputs = app.store.file_entries(&job.id, Origin::Input).await?;
        (app.store.submission(&job.id).await?, Some(views(inputs, "inputs")))
    } else {
        (None, None)
    };
    let case = submission.as_ref().and_then(|submission| serde_json::to_value(submission.text.parse::<toml::Table>().ok()?).ok());
    let (input, options) = submission.map(|submission| (submission.text, submission.options)).unzip();
    Ok(JobView { job, files, inputs, input, options, case })
}

/// Submits a job. With the header `Idempotency-Key` a repeated request gives the same job.
#[utoipa::path(post, path = "/v1/{collection}", tag = "jobs",
    params(("collection" = String, Path, description = "`calibrations`, `predictions`, `scenes`, `sweeps` or `sif`"),
        ("Idempotency-Key" = Option<String>, Header, description = "Text of the caller's choice, new for every new job")),
    request_body = JobRequest,
    responses((status = 202, body = JobView, description = "Accepted: it will be run, whatever happens to this server"),
        (status = 200, body = JobView, description = "The job of an earlier request with this key"),
        (status = 400, body = Problem), (status = 403, body = Problem), (status = 409, body = Problem),
        (status = 413, body = Problem), (status = 422, body = Problem), (status = 429, body = Problem),
        (status = 503, body = Problem)))]
pub async fn submit(
    Shared(app): Shared<App>,
    Path(collection): Path<String>,
    Extension(caller): Extension<Caller>,
    headers: HeaderMap,
    request: Request,
) -> Answer<Response> {
    let kind = kind_of(&collection)?;
    caller.must_be(Role::Run)?;
    let key = key_of(&headers)?;
    let body = documents::read(&app, &caller, request).await?;
    // The temporary disk is the workers' matter, who try again.
    app.disks.iter().filter(|(place, _)| *place == "store").try_for_each(has_room)?;
    let fingerprint = format!("{kind} {}", body.fingerprint);
    let calibration = body.asked.calibration.clone();
    // Asked before the body is looked into: what it refers to may be gone since it was accepted.
    let submitted = match app.store.submitted(&caller.name, key.as_deref(), &fingerprint).await? {
        Some(earlier) => earlier,
        None => {
            let (found, submission, _room) = documents::looked(&app, body, Some(kind)).await?;
            let new = NewJob {
                kind,
                owner: &caller.name,
                calibration: calibration.as_deref(),
                idempotency_key: key.as_deref(),
                fingerprint: &fingerprint,
                submission: &submission,
                room: found.parse().unwrap_or(0),
            };
            app.store.submit(&new, Room { queued: app.limits.queued, bytes: app.limits.quota_bytes }).await?
        }
    };
    let (id, status) = match submitted {
        Submitted::New(id) => {
            app.wake.notify_one();
            (id, StatusCode::ACCEPTED)
        }
        Submitted::Again(id) => (id, StatusCode::OK),
        Submitted::KeyTaken => {
            let detail = "this Idempotency-Key was used for another request; use a new one for every new job";
            return Err(Problem::conflict(detail));
        }
        Submitted::QueueFull => {
            let detail = format!("queue full: {} of your jobs are waiting (limit)", app.limits.queued);
            return Err(Problem::too_many(detail, QUEUE_MOVES_S));
        }
        Submitted::SpaceFull(stored, bytes) => {
            let mib = |bytes: i64| bytes as f64 / f64::from(1 << 20);
            let detail = format!(
                "your jobs have {:.1} MiB, inputs and what those that wait may write included; with the {:.1} MiB of this input they would \
                 have more than the {} MiB that this server keeps of one owner (--quota-mib): delete jobs that are not needed any more",
                mib(stored),
                mib(bytes),
                app.limits.quota_bytes >> 20
            );
            return Err(Problem::new(StatusCode::INSUFFICIENT_STORAGE, "No room", detail));
        }
    };
    let job = job_of(&app, &collection, &id).await?;
    let location = app.public(&format!("/v1/{collection}/{id}"));
    Ok((status, [(header::LOCATION, location)], Json(view(&app, job, false).await?)).into_response())
}

fn key_of(headers: &HeaderMap) -> Answer<Option<String>> {
    let Some(key) = headers.get("idempotency-key") else { return Ok(None) };
    let key = key.to_str().ok().filter(|key| !key.is_empty() && key.len() <= KEY_MAX);
    let refused = || Problem::bad_request(format!("the Idempotency-Key is not 1 to {KEY_MAX} characters of plain text"));
    key.map(|key| Some(key.to_owned())).ok_or_else(refused)
}

/// Lists jobs of a kind, newest first.
#[utoipa::path(get, path = "/v1/{collection}", tag = "jobs",
    params(("collection" = String, Path, description = "`calibrations`, `predictions`, `scenes`, `sweeps` or `sif`"), Part),
    responses((status = 200, body = Page), (status = 400, body = Problem), (status = 404, body = Problem)))]
pub async fn list(
    Shared(app): Shared<App>,
    Path(collection): Path<String>,
    part: Result<Query<Part>, QueryRejection>,
) -> Answer<Json<Page>> {
    listed(&app, Some(kind_of(&collection)?), part).await
}

/// Lists jobs of every kind, newest first.
#[utoipa::path(get, path = "/v1/jobs", tag = "jobs", params(Part),
    responses((status = 200, body = Page), (status = 400, body = Problem)))]
pub async fn list_all(Shared(app): Shared<App>, part: Result<Query<Part>, QueryRejection>) -> Answer<Json<Page>> {
    listed(&app, None, part).await
}

async fn listed(app: &App, kind: Option<JobKind>, part: Result<Query<Part>, QueryRejection>) -> Answer<Json<Page>> {
    let Query(part) = part.map_err(|rejection| Problem::bad_request(rejection.body_text()))?;
    let limit = part.limit.unwrap_or(LIST);
    if !(1..=LIST_MAX).contains(&limit) {
        return Err(Problem::bad_request(format!("limit = {limit} is not 1 to {LIST_MAX}")));
    }
    if let Some(after) = part.after.as_deref().filter(|after| !is_id(after)) {
        return Err(Problem::bad_request(format!("after = {after:?} is not what `next` of an earlier part gave")));
    }
    let text = part.text.as_deref().unwrap_or_default();
    if text.len() > NOTE_MAX || text.contains('\0') {
        return Err(Problem::bad_request(format!("text is not up to {NOTE_MAX} bytes without a null")));
    }
    let (archived, after) = (part.archived.unwrap_or(false), part.after.as_deref());
    let listing = app.store.list(Wanted { kind, state: part.state, text, archived, after, limit }).await?;
    let of_list = |job| JobView { job, files: Vec::new(), inputs: None, input: None, options: None, case: None };
    let items = listing.jobs.into_iter().map(of_list).collect();
    Ok(Json(Page { items, next: listing.next }))
}

/// What is to be said of a job from now on; at least one of them.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct ChangeRequest {
    /// Its name, 1 to 200 bytes.
    name: Option<String>,
    /// A note, up to 2000 bytes; empty for none.
    note: Option<String>,
    /// Report data, as section `[report]` of `report --data`, instead of those it had.
    #[schema(value_type = Option<std::collections::BTreeMap<String, String>>)]
    report: Option<toml::Table>,
    /// Whether it is put away: lists leave it out unless asked.
    archived: Option<bool>,
}

/// Changes name, note or report data of a job, or puts it away; its input and its result stay as they are.
#[utoipa::path(patch, path = "/v1/{collection}/{id}", tag = "jobs",
    params(("collection" = String, Path), ("id" = String, Path)), request_body = ChangeRequest,
    responses((status = 200, body = JobView), (status = 403, body = Problem), (status = 404, body = Problem),
        (status = 415, body = Problem), (status = 422, body = Problem)))]
pub async fn change(
    Shared(app): Shared<App>,
    Path((collection, id)): Path<(String, String)>,
    Extension(caller): Extension<Caller>,
    request: Request,
) -> Answer<Json<JobView>> {
    let job = job_of(&app, &collection, &id).await?;
    caller.must_own(&job.owner)?;
    let asked: ChangeRequest = documents::object(&app, &caller, request, "known are name, note, report, archived").await?;
    let ChangeRequest { name, note, report, archived } = asked;
    if name.is_none() && note.is_none() && report.is_none() && archived.is_none() {
        return Err(Problem::bad_request("nothing to change: give name, note, report or archived"));
    }
    name.as_deref().map_or(Ok(()), |name| documents::check_name("name", name))?;
    if let Some(note) =
        note.as_deref().filter(|note| note.len() > NOTE_MAX || note.contains(|c: char| c.is_control() && c != '\n'))
    {
        let remedy = format!("give up to {NOTE_MAX} bytes of plain text");
        return Err(input("note", format!("{} bytes", note.len()), "is no note", remedy).into());
    }
    report.clone().map(Signed::of).transpose()?;
    let report = report.map(|report| serde_json::to_string(&report).unwrap_or_default());
    if report.as_ref().is_some_and(|report| report.len() > REPORT_MAX) {
        return Err(Problem::too_large(format!("the report data are longer than {REPORT_MAX} bytes")));
    }
    if !app.store.change(&id, &Change { name, note, report, archived }).await? {
        return Err(Problem::not_found(job.kind.name()));
    }
    let job = job_of(&app, &collection, &id).await?;
    Ok(Json(view(&app, job, false).await?))
}

/// How long a look at a job may wait.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub struct Wait {
    /// Seconds, 0 to 50, after which the job is shown even if it has not ended.
    wait: Option<u32>,
}

/// Longest wait for the end of a job, s: below the time in which every answer begins.
const WAIT_MAX_S: u32 = 50;
/// Time between two looks at the store.
const LOOK_EVERY: Duration = Duration::from_millis(250);

/// A job: where it stands, its figures and files. With `wait` the answer comes when the job has ended, or that many seconds later.
#[utoipa::path(get, path = "/v1/{collection}/{id}", tag = "jobs",
    params(("collection" = String, Path), ("id" = String, Path), Wait),
    responses((status = 200, body = JobView), (status = 400, body = Problem), (status = 404, body = Problem)))]
pub async fn show(
    Shared(app): Shared<App>,
    Path((collection, id)): Path<(String, String)>,
    Extension(caller): Extension<Caller>,
    wait: Result<Query<Wait>, QueryRejection>,
) -> Answer<Json<JobView>> {
    let Query(Wait { wait }) = wait.map_err(|rejection| Problem::bad_request(rejection.body_text()))?;
    let mut job = job_of(&app, &collection, &id).await?;
    if let Some(seconds) = wait {
        if seconds > WAIT_MAX_S {
            return Err(Problem::bad_request(format!("wait = {seconds} is not 0 to {WAIT_MAX_S} s")));
        }
        let (_places, begun) = (app.stream(&caller)?, Instant::now());
        while !job.state.is_final() && begun.elapsed() < Duration::from_secs(seconds.into()) && !app.is_stopping() {
            tokio::time::sleep(LOOK_EVERY).await;
            let now = app.store.revision(&id).await?;
            if now != Some(job.revision) {
                job = job_of(&app, &collection, &id).await?;
            }
        }
    }
    Ok(Json(view(&app, job, true).await?))
}

/// How a job is to end.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub struct Ending {
    /// Only for predictions: whether one that runs ends after the next cycle block with the curve so far as its result.
    #[serde(default)]
    keep: bool,
}

/// Asks for the end of a job. One that runs ends with the next sign of life of its worker, one whose worker is silent at once.
#[utoipa::path(post, path = "/v1/{collection}/{id}/cancel", tag = "jobs",
    params(("collection" = String, Path), ("id" = String, Path), Ending),
    responses((status = 202, body = JobView), (status = 403, body = Problem), (status = 404, body = Problem),
        (status = 409, body = Problem, description = "It has ended already")))]
pub async fn cancel(
    Shared(app): Shared<App>,
    Path((collection, id)): Path<(String, String)>,
    Extension(caller): Extension<Caller>,
    ending: Result<Query<Ending>, QueryRejection>,
) -> Answer<(StatusCode, Json<JobView>)> {
    let Query(Ending { keep }) = ending.map_err(|rejection| Problem::bad_request(rejection.body_text()))?;
    let job = job_of(&app, &collection, &id).await?;
    caller.must_own(&job.owner)?;
    if keep && job.kind != JobKind::Prediction {
        return Err(Problem::bad_request("keep is for predictions only"));
    }
    if !app.store.cancel(&id, keep).await? {
        return Err(Problem::conflict(format!("the job already finished: {}", job.state)));
    }
    let job = job_of(&app, &collection, &id).await?;
    Ok((StatusCode::ACCEPTED, Json(view(&app, job, false).await?)))
}

/// Deletes a job that no worker has, with its results.
#[utoipa::path(delete, path = "/v1/{collection}/{id}", tag = "jobs",
    params(("collection" = String, Path), ("id" = String, Path)),
    responses((status = 204), (status = 403, body = Problem), (status = 404, body = Problem), (status = 409, body = Problem)))]
pub async fn delete(
    Shared(app): Shared<App>,
    Path((collection, id)): Path<(String, String)>,
    Extension(caller): Extension<Caller>,
) -> Answer<StatusCode> {
    let job = job_of(&app, &collection, &id).await?;
    caller.must_own(&job.owner)?;
    if !app.store.delete(&id).await? {
        return Err(Problem::conflict("the job is running; cancel it first"));
    }
    Ok(StatusCode::NO_CONTENT)
}
