//! Results of finished jobs, a part of a file at a time, and the picture of one that runs.

use std::ops::Range;
use std::path::Path as FilePath;

use axum::body::Body;
use axum::extract::rejection::QueryRejection;
use axum::extract::{Path, Query, State as Shared};
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{Html, IntoResponse, Response};
use axum::{Extension, Json};
use serde::Deserialize;
use tokio::sync::OwnedSemaphorePermit;
use tokio::sync::mpsc::channel;
use tokio_stream::wrappers::ReceiverStream;
use utoipa::IntoParams;

use super::App;
use super::app::Caller;
use super::collections::job_of;
use crate::job::{Job, State, is_id};
use crate::problem::{Answer, Problem};
use crate::store::{FileEntry, Origin, PART, Store, media_type};
use crate::worker::child::REPORT_FILE;
use perilife_base::columns::Table;
use perilife_base::error::{Error, input};
use perilife_base::input::Opened;
use perilife_base::units::shown::within;
use perilife_base::units::us::System;
use perilife_calibration::inspection::{self, InspectFrom, Inspection};
use perilife_results::curve::{self, A_N_FILE, Row, Sampling};
use perilife_results::output::write_file;
use perilife_results::paper::{self, Signed, Source};
use perilife_results::record::TipEnds;

/// Rows of a resampled curve: as many as a table can show.
const POINTS: std::ops::RangeInclusive<u64> = 2..=100_000;

/// Where an a-N curve is wanted.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub struct Wanted {
    /// Only for `a_n.csv`: so many rows, equally spaced in cycles.
    points: Option<u64>,
    /// Only for `a_n.csv`: a row every so many cycles, and one at the end.
    every_cycles: Option<f64>,
}

/// A file of a finished job: `result.json`, `a_n.csv`, `fitted.toml`, pictures and so on, as the job lists them.
#[utoipa::path(get, path = "/v1/{collection}/{id}/files/{name}", tag = "results",
    params(("collection" = String, Path), ("id" = String, Path), ("name" = String, Path), Wanted),
    responses((status = 200, description = "The file"), (status = 206, description = "The requested range"),
        (status = 304, description = "It is the one of If-None-Match"), (status = 400, body = Problem), (status = 404, body = Problem),
        (status = 416, description = "The range is beyond its end"),
        (status = 409, body = Problem, description = "The job has no result"), (status = 422, body = Problem)))]
pub async fn file(
    Shared(app): Shared<App>,
    Path((collection, id, name)): Path<(String, String, String)>,
    Extension(caller): Extension<Caller>,
    wanted: Result<Query<Wanted>, QueryRejection>,
    headers: HeaderMap,
) -> Answer<Response> {
    let Query(wanted) = wanted.map_err(|rejection| Problem::bad_request(rejection.body_text()))?;
    // Names of other collections lead nowhere, even if the id is right.
    super::collections::kind_of(&collection)?;
    let sampling = match (wanted.points, wanted.every_cycles) {
        (None, None) => None,
        (Some(points), None) => Some(Sampling::Points(points)),
        (None, Some(step)) => Some(Sampling::EveryCycles(step)),
        (Some(_), Some(_)) => return Err(Problem::bad_request("give points or every_cycles, not both")),
    };
    if sampling.is_some() && name != A_N_FILE {
        return Err(Problem::bad_request("points and every_cycles are for a_n.csv only"));
    }
    let is_missing = async || -> Problem {
        match job_of(&app, &collection, &id).await.and_then(|job| must_have_result(&job)) {
            Ok(()) => Problem::not_found("file of this job"),
            Err(problem) => problem,
        }
    };
    let (media_type, content) = if let Some(sampling) = sampling {
        let Some(table) = resampled(&app, &id, sampling).await? else { return Err(is_missing().await) };
        (media_type(&name), table.into_response())
    } else {
        // No file of a result has another name, and not every database takes every character.
        let can_be = is_id(&id) && name.bytes().all(|byte| byte.is_ascii_graphic());
        let found = if can_be { app.store.open_file(&id, Origin::Result, &name).await? } else { None };
        let Some((entry, first)) = found else { return Err(is_missing().await) };
        let media_type = entry.media_type.clone();
        (media_type, Stored { store: app.store, job: id, origin: Origin::Result, entry, first }.answer(&headers))
    };
    let shown = matches!(&*media_type, "image/png" | "image/svg+xml" | "application/json");
    let disposition = format!("{}; filename=\"{name}\"", if shown { "inline" } else { "attachment" });
    let fixed = [
        (header::CONTENT_TYPE, media_type),
        (header::CONTENT_DISPOSITION, disposition),
        // A result never changes; but whoever uses the browser next, or has lost his token, may not have it.
        (
            header::CACHE_CONTROL,
            if caller.token.is_empty() { "private, max-age=86400, immutable" } else { "no-store" }.to_owned(),
        ),
    ];
    Ok((fixed, content).into_response())
}

async fn resampled(app: &App, id: &str, sampling: Sampling) -> Answer<Option<String>> {
    if let Sampling::Points(points) = sampling
        && !POINTS.contains(&points)
    {
        let problem = format!("is not {} to {}", POINTS.start(), POINTS.end());
        return Err(input("points", points, problem, "give for example 400").into());
    }
    let Some((table, room)) = table(app, id).await? else { return Ok(None) };
    let rows = Row::of_table(&table)?;
    if let Sampling::EveryCycles(step) = sampling {
        let count = (rows[rows.len() - 1].cycles - rows[0].cycles) / step;
        if count > *POINTS.end() as f64 {
            let problem = format!("gives {count:.0} rows, more than {}", POINTS.end());
            return Err(input("every_cycles", step, problem, "give a larger step").into());
        }
    }
    let work = move || {
        let _room = room;
        Ok(Some(curve::table(&sampling.of(&rows, "every_cycles")?).csv()))
    };
    tokio::task::spawn_blocking(work).await.map_err(|_| Problem::internal())?
}

/// The table of a stored curve, with its room among those that may be in memory; `None` if there is no curve.
async fn table(app: &App, id: &str) -> Answer<Option<(Table, OwnedSemaphorePermit)>> {
    if !is_id(id) {
        return Ok(None);
    }
    // Never closed.
    let room = app.curves.clone().acquire_owned().await.map_err(|_| Problem::internal())?;
    let Some(table) = app.store.whole_file(id, Origin::Result, A_N_FILE).await? else { return Ok(None) };
    let text = String::from_utf8(table).map_err(|_| Problem::internal())?;
    Ok(Some((Table::read(&text, FilePath::new(A_N_FILE))?, room)))
}

fn must_have_result(job: &Job) -> Answer<()> {
    match job.state {
        State::Succeeded => Ok(()),
        state => Err(Problem::conflict(format!("the job has no result: it is {state}"))),
    }
}

/// A file that came with a job, as it came: `inputs` of the job names them.
#[utoipa::path(get, path = "/v1/{collection}/{id}/inputs/{name}", tag = "results",
    params(("collection" = String, Path), ("id" = String, Path), ("name" = String, Path)),
    responses((status = 200, description = "The file"), (status = 404, body = Problem)))]
pub async fn input_file(
    Shared(app): Shared<App>,
    Path((collection, id, name)): Path<(String, String, String)>,
    headers: HeaderMap,
) -> Answer<Response> {
    job_of(&app, &collection, &id).await?;
    // Names are text without line breaks; the rest would be none of a database's.
    let can_be = !name.chars().any(char::is_control);
    let found = if can_be { app.store.open_file(&id, Origin::Input, &name).await? } else { None };
    let (entry, first) = found.ok_or_else(|| Problem::not_found("file of this job"))?;
    // Whatever it claims to be, it is somebody's upload: saved, never shown.
    let fixed = [(header::CONTENT_TYPE, "application/octet-stream"), (header::CONTENT_DISPOSITION, "attachment")];
    let stored = Stored { store: app.store, job: id, origin: Origin::Input, entry, first };
    Ok((fixed, stored.answer(&headers)).into_response())
}

/// The plate of a running prediction as it was last seen: damage and crack paths.
#[utoipa::path(get, path = "/v1/{collection}/{id}/live/damage.svg", tag = "results",
    params(("collection" = String, Path), ("id" = String, Path)),
    responses((status = 200, description = "SVG", content_type = "image/svg+xml"), (status = 404, body = Problem)))]
pub async fn picture(Shared(app): Shared<App>, Path((collection, id)): Path<(String, String)>) -> Answer<Response> {
    super::collections::kind_of(&collection)?;
    if !is_id(&id) {
        return Err(Problem::not_found("picture"));
    }
    let picture = app.store.picture(&id).await?.ok_or_else(|| Problem::not_found("picture"))?;
    Ok(([(header::CONTENT_TYPE, "image/svg+xml")], picture).into_response())
}

/// From which length on, and with which factor.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub struct From {
    /// Crack length today; required for a remaining life.
    crack_length_mm: Option<f64>,
    /// What the remaining life is divided by for the inspection interval; 3 if left out.
    factor: Option<f64>,
    /// Tip of a plate whose crack has that length; the one that ends the life if left out.
    tip: Option<usize>,
    /// Units of the report: si or us.
    #[param(value_type = Option<String>)]
    units: Option<System>,
}

/// Remaining life from a crack length on, and an inspection interval.
#[utoipa::path(get, path = "/v1/predictions/{id}/remaining", tag = "results",
    params(("id" = String, Path), From),
    responses((status = 200, body = Inspection), (status = 400, body = Problem), (status = 404, body = Problem),
        (status = 409, body = Problem), (status = 422, body = Problem)))]
pub async fn remaining(
    Shared(app): Shared<App>,
    Path(id): Path<String>,
    from: Result<Query<From>, QueryRejection>,
) -> Answer<Json<Inspection>> {
    inspection_of(&app, &id, from).await.map(Json)
}

async fn inspection_of(app: &App, id: &str, from: Result<Query<From>, QueryRejection>) -> Answer<Inspection> {
    let Query(from) = from.map_err(|rejection| Problem::bad_request(rejection.body_text()))?;
    let names = ["crack_length_mm", "factor", "tip"];
    let factor = from.factor.unwrap_or(inspection::FACTOR);
    let missing = || Problem::bad_request("missing field `crack_length_mm`");
    let crack_length_mm = from.crack_length_mm.ok_or_else(missing)?;
    let from = InspectFrom { crack_length_mm, tip: from.tip, factor, names };
    from.check()?;
    let Some((table, _room)) = table(app, id).await? else {
        must_have_result(&job_of(app, "predictions", id).await?)?;
        return Err(Problem::not_found("curve"));
    };
    let (rows, left) = (Row::of_table(&table)?, curve::left_of_table(&table)?);
    let summary = job_of(app, "predictions", id).await?.summary;
    if summary.as_ref().is_some_and(|summary| summary["life_cycles"].is_null()) {
        return Err(Problem::conflict("unlimited life: no crack grows under these loads"));
    }
    if let Some(refused) = summary.as_ref().and_then(|summary| summary["refused"].as_str()) {
        return Err(Problem::conflict(format!("the run has no life: {refused}")));
    }
    let tips: Vec<TipEnds> = match summary.as_ref().map(|summary| &summary["tips"]).filter(|tips| !tips.is_null()) {
        Some(tips) => {
            Deserialize::deserialize(tips).map_err(|_| Problem::conflict("the job is of an earlier version: submit it again"))?
        }
        None => Vec::new(),
    };
    let tips = TipEnds::lengths(&tips, &table)?;
    let is_lower_bound = summary.is_some_and(|summary| summary["life_is_lower_bound"] == true);
    Ok(Inspection::of(&curve::curve(&rows), tips.as_ref(), left.as_deref(), from, is_lower_bound)?)
}

/// The report of a prediction or calibration with the report data of its job; with `crack_length_mm` also an inspection interval.
#[utoipa::path(get, path = "/v1/{collection}/{id}/report", tag = "results",
    params(("collection" = String, Path), ("id" = String, Path), From),
    responses((status = 200, description = "A page to be printed", body = String, content_type = "text/html"),
        (status = 400, body = Problem), (status = 404, body = Problem), (status = 409, body = Problem), (status = 422, body = Problem)))]
pub async fn report(
    Shared(app): Shared<App>,
    Path((collection, id)): Path<(String, String)>,
    from: Result<Query<From>, QueryRejection>,
) -> Answer<Html<String>> {
    let job = job_of(&app, &collection, &id).await?;
    must_have_result(&job)?;
    app.store.open_file(&id, Origin::Result, REPORT_FILE).await?.ok_or_else(|| Problem::not_found("report of this job"))?;
    let is_plain = from.as_ref().is_ok_and(|from| from.crack_length_mm.is_none() && from.factor.is_none() && from.tip.is_none());
    let units = from.as_ref().ok().and_then(|from| from.units).unwrap_or(System::Si);
    let inspection = if is_plain { None } else { Some(inspection_of(&app, &id, from).await?) };
    let signed =
        Signed::of(job.report.map(serde_json::from_value).transpose().map_err(|_| Problem::internal())?.unwrap_or_default())?;
    // Never closed.
    let _room = app.curves.clone().acquire_owned().await.map_err(|_| Problem::internal())?;
    let mut files = Vec::new();
    for entry in app.store.file_entries(&id, Origin::Result).await? {
        if ["application/json", "text/csv", "image/svg+xml"].contains(&&*entry.media_type) {
            files.extend(app.store.whole_file(&id, Origin::Result, &entry.name).await?.map(|content| (entry.name, content)));
        }
    }
    let work = move || -> perilife_base::error::Result<Html<String>> {
        let folder =
            tempfile::tempdir().map_err(|error| Error::file(&std::env::temp_dir(), "cannot create a folder in", error))?;
        files.iter().try_for_each(|(name, content)| write_file(&folder.path().join(name), content))?;
        let mut source = paper::read(folder.path(), &Opened::default())?;
        if let (Source::Run { run, .. }, Some(_)) = (&mut source, &inspection) {
            run.inspection = inspection;
        }
        Ok(Html(within(units, || paper::html(&source, &signed))))
    };
    Ok(tokio::task::spawn_blocking(work).await.map_err(|_| Problem::internal())??)
}

/// Whose file it is, and what is known of it.
pub struct Stored {
    pub store: Store,
    pub job: String,
    pub origin: Origin,
    pub entry: FileEntry,
    pub first: Vec<u8>,
}

#[derive(Debug, Clone, PartialEq, Eq)]
enum Asked {
    All,
    Part(Range<i64>),
    Nothing,
    Beyond,
}

impl Stored {
    /// Never another for the same file: neither inputs nor results of a job change.
    fn tag(&self) -> String {
        let name = perilife_base::input::sha256(self.entry.name.as_bytes());
        format!("\"{}-{}-{}\"", self.job, self.entry.bytes, &name[..12])
    }

    pub fn answer(self, headers: &HeaderMap) -> Response {
        let (tag, bytes) = (self.tag(), self.entry.bytes);
        let head = [(header::ETAG, tag.clone()), (header::ACCEPT_RANGES, "bytes".to_owned())];
        match asked(headers, &tag, bytes) {
            Asked::Nothing => (StatusCode::NOT_MODIFIED, head).into_response(),
            Asked::Beyond => {
                let range = [(header::CONTENT_RANGE, format!("bytes */{bytes}"))];
                (StatusCode::RANGE_NOT_SATISFIABLE, head, range).into_response()
            }
            Asked::All => (head, [(header::CONTENT_LENGTH, bytes)], self.body(0..bytes)).into_response(),
            Asked::Part(span) => {
                let range = format!("bytes {}-{}/{bytes}", span.start, span.end - 1);
                let sizes = [(header::CONTENT_RANGE, range), (header::CONTENT_LENGTH, (span.end - span.start).to_string())];
                (StatusCode::PARTIAL_CONTENT, head, sizes, self.body(span)).into_response()
            }
        }
    }

    /// The bytes of a span: no part is read before its reader has taken the last but one.
    fn body(self, span: Range<i64>) -> Body {
        let Stored { store, job, origin, entry, mut first } = self;
        if first.len() as i64 == entry.bytes {
            return Body::from(first.drain(span.start as usize..span.end as usize).collect::<Vec<u8>>());
        }
        let (parts, reader) = channel(1);
        let part_bytes = PART as i64;
        tokio::spawn(async move {
            let mut number = span.start / part_bytes;
            loop {
                let part = match number {
                    0 => Ok(Some(std::mem::take(&mut first))),
                    number => store.file_part(&job, origin, &entry.name, number).await,
                };
                // Deleted meanwhile: an error, since a packed answer does not show that something is missing.
                let part = part.and_then(|part| part.ok_or(sqlx::Error::RowNotFound));
                let begin = number * part_bytes;
                let next = part.map(|mut part| {
                    let end = (span.end - begin).clamp(0, part.len() as i64) as usize;
                    part.truncate(end);
                    part.split_off(((span.start - begin).max(0) as usize).min(end))
                });
                let is_last = next.is_err() || begin + part_bytes >= span.end;
                // Who went away needs no more.
                if parts.send(next).await.is_err() || is_last {
                    return;
                }
                number += 1;
            }
        });
        Body::from_stream(ReceiverStream::new(reader))
    }
}

/// What the headers ask of a file with this tag and size. Of several ranges none is taken: all of the file is an answer to that.
fn asked(headers: &HeaderMap, tag: &str, bytes: i64) -> Asked {
    let text = |name| headers.get(name).and_then(|value| value.to_str().ok());
    let names_it =
        |list: &str| list.split(',').map(|one| one.trim().trim_start_matches("W/")).any(|one| one == tag || one == "*");
    if text(header::IF_NONE_MATCH).is_some_and(names_it) {
        return Asked::Nothing;
    }
    // The rest of something else is of no use.
    if text(header::IF_RANGE).is_some_and(|one| one.trim() != tag) {
        return Asked::All;
    }
    let Some((from, to)) = text(header::RANGE).and_then(|range| range.trim().strip_prefix("bytes=")?.split_once('-')) else {
        return Asked::All;
    };
    let number = |text: &str| text.trim().parse::<i64>().ok().filter(|number| *number >= 0);
    let span = match (number(from), number(to)) {
        (Some(from), _) if to.trim().is_empty() => from..bytes,
        (Some(from), Some(to)) if from <= to => from..bytes.min(to.saturating_add(1)),
        (None, Some(last)) if from.trim().is_empty() => (bytes - last).max(0)..bytes,
        _ => return Asked::All,
    };
    if span.start < span.end { Asked::Part(span) } else { Asked::Beyond }
}
