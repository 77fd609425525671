//! For those who run the service: is it well, and what is it doing?

use std::sync::OnceLock;
use std::time::Instant;

use axum::extract::{MatchedPath, Request, State as Shared};
use axum::http::header;
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use metrics_exporter_prometheus::{Matcher, PrometheusBuilder, PrometheusHandle};

use super::App;
use crate::service::job::State;
use crate::service::problem::Answer;

/// Bounds of the histogram of answer times, s.
const BOUNDS_S: [f64; 12] = [0.000_5, 0.001, 0.002_5, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1.0, 5.0];

/// The one recorder of a process.
fn recorder() -> Option<&'static PrometheusHandle> {
    static RECORDER: OnceLock<Option<PrometheusHandle>> = OnceLock::new();
    let install = || {
        let bounds = Matcher::Suffix("seconds".to_owned());
        PrometheusBuilder::new().set_buckets_for_metric(bounds, &BOUNDS_S).ok()?.install_recorder().ok()
    };
    RECORDER.get_or_init(install).as_ref()
}

/// Sums up what was measured; now and then, or it piles up where nobody asks for it.
pub fn sum_up() {
    if let Some(recorder) = recorder() {
        recorder.run_upkeep();
    }
}

/// Starts counting.
pub fn start() {
    sum_up();
    metrics::describe_counter!("perilife_http_requests_total", "Requests by route, method and status.");
    metrics::describe_histogram!("perilife_http_request_seconds", "Time to the beginning of the answer, s.");
    metrics::describe_counter!("perilife_jobs_finished_total", "Jobs ended by the workers of this process.");
    metrics::describe_gauge!("perilife_jobs", "Jobs in the store by state.");
}

/// Counts a request. Routes are few, so their number stays bounded whatever is asked for.
pub async fn measure(request: Request, next: Next) -> Response {
    let route = request.extensions().get::<MatchedPath>().map_or("page", MatchedPath::as_str).to_owned();
    let method = request.method().clone();
    let begun = Instant::now();
    let response = next.run(request).await;
    let status = response.status().as_u16().to_string();
    let method =
        if ["GET", "HEAD", "POST", "DELETE"].contains(&method.as_str()) { method.to_string() } else { "other".to_owned() };
    metrics::counter!("perilife_http_requests_total", "route" => route.clone(), "method" => method, "status" => status)
        .increment(1);
    metrics::histogram!("perilife_http_request_seconds", "route" => route).record(begun.elapsed().as_secs_f64());
    response
}

/// `/healthz`: 200 while the store answers, else 503.
pub async fn health(Shared(app): Shared<App>) -> Answer<&'static str> {
    app.store.ping().await?;
    Ok("ok\n")
}

/// `/metrics` in the text format of Prometheus.
pub async fn metrics(Shared(app): Shared<App>) -> Answer<Response> {
    let counts = app.store.counts().await?;
    // Those that no job is in as well.
    for state in State::ALL {
        let count = counts.iter().find(|(name, _)| name == state.name()).map_or(0, |(_, count)| *count);
        metrics::gauge!("perilife_jobs", "state" => state.name()).set(count as f64);
    }
    let text = recorder().map(PrometheusHandle::render).unwrap_or_default();
    Ok(([(header::CONTENT_TYPE, "text/plain; version=0.0.4")], text).into_response())
}
