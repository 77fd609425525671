//! The HTTP service: every route, its limits and its answers.

mod app;
mod caller;
mod collections;
mod description;
mod documents;
mod events;
mod guide;
mod inputs;
mod knowledge;
mod results;
mod sending;
mod security;
mod watching;

pub use app::{App, Limits, Place, Places, Security};
pub use caller::Audit;

pub use security::Crowded;
pub use watching::{start as start_counting, sum_up};

use axum::Router;
use axum::extract::{DefaultBodyLimit, Request};
use axum::http::StatusCode;
use axum::middleware::{Next, from_fn, from_fn_with_state};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use percent_encoding::percent_decode_str;
use tower_http::catch_panic::CatchPanicLayer;
use tower_http::compression::CompressionLayer;
use tower_http::compression::predicate::{DefaultPredicate, NotForContentType, Predicate};
use utoipa::OpenApi;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;
use utoipa_swagger_ui::SwaggerUi;

use super::problem::Problem;

/// What `/openapi.json` says of the service as a whole.
#[derive(OpenApi)]
#[openapi(
    info(
        title = "perilife",
        description = "Fatigue-life prediction of cracked plates by peridynamics: fit the fatigue law to measured a-N curves, \
                       predict the life of plates nobody tested. Inputs are those of the command line, as TOML text or as JSON \
                       of the same keys; what is wrong with them is said in the same words.",
        license(name = "MIT OR Apache-2.0")
    ),
    components(schemas(Problem))
)]
struct Description;

/// What is not packed already.
fn worth_packing() -> impl Predicate {
    let not = NotForContentType::const_new;
    DefaultPredicate::new().and(not("application/zip")).and(not("application/vnd.apache.parquet"))
}

/// Refuses an address that is no text, before a handler does in words that are not the service's.
async fn in_text(request: Request, next: Next) -> Response {
    if percent_decode_str(request.uri().path()).decode_utf8().is_err() {
        return Problem::bad_request("the address is not UTF-8 text").into_response();
    }
    next.run(request).await
}

pub fn router(app: App) -> Router {
    let (v1, description) = OpenApiRouter::with_openapi(Description::openapi())
        .routes(routes!(knowledge::service))
        .routes(routes!(knowledge::kinds))
        .routes(routes!(knowledge::schema))
        .routes(routes!(knowledge::materials))
        .routes(routes!(inputs::measured))
        .routes(routes!(inputs::check))
        .routes(routes!(collections::list_all))
        .routes(routes!(collections::submit, collections::list))
        .routes(routes!(collections::show, collections::change, collections::delete))
        .routes(routes!(collections::cancel))
        .routes(routes!(events::events))
        .routes(routes!(results::file))
        .routes(routes!(results::input_file))
        .routes(routes!(results::picture))
        .routes(routes!(results::remaining))
        .routes(routes!(results::report))
        .split_for_parts();
    let limits = app.limits.clone();
    let docs = SwaggerUi::new("/docs").external_url_unchecked("/openapi.json", description::complete(&description));
    v1.merge(Router::from(docs))
        .route("/guide", get(guide::index))
        .route("/guide/{page}", get(guide::page))
        .route("/healthz", get(watching::health))
        .route("/readyz", get(watching::ready))
        .route("/metrics", get(watching::metrics))
        .fallback(knowledge::page)
        .method_not_allowed_fallback(|| async {
            Problem::new(StatusCode::METHOD_NOT_ALLOWED, "Method not allowed", "this address does not take that method")
        })
        .layer(from_fn(in_text))
        .layer(DefaultBodyLimit::max(limits.body_bytes))
        .layer(from_fn_with_state(limits.body_bytes, security::in_size))
        .layer(from_fn(security::in_whole))
        .layer(from_fn_with_state(app.clone(), security::guard))
        .layer(from_fn(watching::measure))
        .layer(from_fn_with_state(limits.answer_within, security::in_time))
        .layer(from_fn(security::in_room))
        .layer(CompressionLayer::new().compress_when(worth_packing()))
        .layer(CatchPanicLayer::custom(|_| Problem::internal().into_response()))
        .layer(from_fn(security::headers))
        .with_state(app)
}
