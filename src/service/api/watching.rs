//! For those who run the service: is it well, and what is it doing?

use std::path::PathBuf;
use std::sync::OnceLock;
use std::time::{Duration, Instant};

use axum::extract::{MatchedPath, Request, State as Shared};
use axum::http::{StatusCode, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use metrics_exporter_prometheus::{Matcher, PrometheusBuilder, PrometheusHandle};

use super::App;
use crate::job::State;
use crate::problem::{Answer, Problem};
use crate::store::{free_bytes, needed_bytes};

/// Bounds of the histogram of answer times, s.
const BOUNDS_S: [f64; 12] = [0.000_5, 0.001, 0.002_5, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1.0, 5.0];

/// Bounds of the histograms of jobs, s.
const BOUNDS_OF_JOBS_S: [f64; 10] = [0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0, 1000.0, 10_000.0, 100_000.0];
/// Bounds of the histogram of memory, MB.
const BOUNDS_MB: [f64; 8] = [50.0, 100.0, 200.0, 500.0, 1000.0, 2000.0, 4000.0, 8000.0];

/// The one recorder of a process.
fn recorder() -> Option<&'static PrometheusHandle> {
    static RECORDER: OnceLock<Option<PrometheusHandle>> = OnceLock::new();
    let install = || {
        let bounds: [(&str, &[f64]); 4] = [
            ("perilife_http_request_seconds", &BOUNDS_S),
            ("perilife_queue_seconds", &BOUNDS_OF_JOBS_S),
            ("perilife_job_seconds", &BOUNDS_OF_JOBS_S),
            ("perilife_job_memory_megabytes", &BOUNDS_MB),
        ];
        let with = |builder: PrometheusBuilder, (name, bounds): (&str, &[f64])| {
            builder.set_buckets_for_metric(Matcher::Full(name.to_owned()), bounds).ok()
        };
        bounds.into_iter().try_fold(PrometheusBuilder::new(), with)?.install_recorder().ok()
    };
    RECORDER.get_or_init(install).as_ref()
}

/// Sums up what was measured; now and then, or it piles up where nobody asks for it.
pub fn sum_up() {
    if let Some(recorder) = recorder() {
        recorder.run_upkeep();
    }
}

pub fn start() {
    sum_up();
    metrics::describe_counter!("perilife_http_requests_total", "Requests by route, method and status.");
    metrics::describe_histogram!("perilife_http_request_seconds", "Time to the beginning of the answer, s.");
    metrics::describe_counter!("perilife_jobs_finished_total", "Jobs ended by the workers of this process.");
    metrics::describe_gauge!("perilife_jobs", "Jobs in the store by state.");
    metrics::describe_gauge!("perilife_queue_age_seconds", "Time for which the oldest job that waits has waited, s.");
    metrics::describe_gauge!("perilife_disk_free_bytes", "Room for the database file and for temporary files.");
    metrics::describe_counter!("perilife_job_failures_total", "Ends of jobs that were not their fault, by reason.");
    metrics::describe_histogram!("perilife_queue_seconds", "Time from submission to the first worker, s.");
    metrics::describe_histogram!("perilife_job_seconds", "Time of a run by a worker of this process, s.");
    metrics::describe_histogram!("perilife_job_memory_megabytes", "Most memory that the process of a job had, MB.");
}

/// Counts a request. Routes are few, so their number stays bounded whatever is asked for.
pub async fn measure(request: Request, next: Next) -> Response {
    let route = request.extensions().get::<MatchedPath>().map_or("page", MatchedPath::as_str).to_owned();
    let method = request.method().clone();
    let begun = Instant::now();
    let response = next.run(request).await;
    let status = response.status().as_u16().to_string();
    let method = if ["GET", "HEAD", "POST", "PATCH", "DELETE"].contains(&method.as_str()) {
        method.to_string()
    } else {
        "other".to_owned()
    };
    metrics::counter!("perilife_http_requests_total", "route" => route.clone(), "method" => method, "status" => status)
        .increment(1);
    metrics::histogram!("perilife_http_request_seconds", "route" => route).record(begun.elapsed().as_secs_f64());
    response
}

/// `/healthz`: 200 while the process answers.
pub async fn health() -> &'static str {
    "ok\n"
}

/// `/readyz`: 200 while jobs are taken: the store can be written, its tables are of this version, disks have room; else 503 and why.
pub async fn ready(Shared(app): Shared<App>) -> Answer<&'static str> {
    let asked = tokio::time::timeout(READY_WITHIN, app.store.is_ready()).await;
    let asked = asked.map_err(|_| refused(format!("the database does not answer within {} s", READY_WITHIN.as_secs())))?;
    asked.map_err(|error| {
        tracing::warn!("the store is not ready: {error}");
        refused("the database cannot be written, or its tables are of another version; see the log".to_owned())
    })?;
    app.disks.iter().try_for_each(has_room).map(|()| "ready\n")
}

fn refused(why: String) -> Problem {
    Problem::new(StatusCode::SERVICE_UNAVAILABLE, "Not ready", why).later(TRY_AFTER_S)
}

/// Refuses a disk that is nearly full.
pub fn has_room((place, folder): &(&str, PathBuf)) -> Answer<()> {
    let (free, [needed, _]) = (free_bytes(folder).unwrap_or(0), needed_bytes(folder));
    if free >= needed {
        return Ok(());
    }
    let (free, needed) = (free >> 20, needed >> 20);
    Err(refused(format!("the {place} disk has {free} MB free, and {needed} are needed; make room on it, or delete jobs")))
}

/// Seconds after which a service that was not ready may be.
const TRY_AFTER_S: u32 = 10;

/// Time in which the store must answer.
const READY_WITHIN: Duration = Duration::from_secs(5);

/// `/metrics` in the text format of Prometheus.
pub async fn metrics(Shared(app): Shared<App>) -> Answer<Response> {
    let counts = app.store.counts().await?;
    // Those that no job is in as well.
    for state in State::all() {
        let count = counts.iter().find(|(name, _)| name == state.name()).map_or(0, |(_, count)| *count);
        metrics::gauge!("perilife_jobs", "state" => state.name()).set(count as f64);
    }
    metrics::gauge!("perilife_queue_age_seconds").set(app.store.queue_age_ms().await? as f64 / 1e3);
    for (place, folder) in app.disks.iter() {
        metrics::gauge!("perilife_disk_free_bytes", "place" => *place).set(free_bytes(folder).unwrap_or(0) as f64);
    }
    let text = recorder().map(PrometheusHandle::render).unwrap_or_default();
    Ok(([(header::CONTENT_TYPE, "text/plain; version=0.0.4")], text).into_response())
}
