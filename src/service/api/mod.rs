//! The HTTP service: every route, its limits and its answers, and what `/openapi.json` says beyond what stands at the handlers.

mod app;
mod collections;
mod documents;
mod events;
mod knowledge;
mod results;
mod security;
mod watching;

use axum::Router;
use axum::extract::{DefaultBodyLimit, Request};
use axum::http::StatusCode;
use axum::middleware::{Next, from_fn, from_fn_with_state};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use percent_encoding::percent_decode_str;
use serde_json::{Map, Value, json};
use tower_http::catch_panic::CatchPanicLayer;
use tower_http::compression::CompressionLayer;
use tower_http::compression::predicate::{DefaultPredicate, NotForContentType, Predicate};
use utoipa::OpenApi;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;
use utoipa_swagger_ui::SwaggerUi;

use super::job::JobKind;
use super::problem::Problem;
pub use app::{App, Audit, Limits, Place, Places, Security};
pub use security::Crowded;
pub use watching::{start as start_counting, sum_up};

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
        .routes(routes!(knowledge::measured))
        .routes(routes!(knowledge::check))
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
    let docs = SwaggerUi::new("/docs").external_url_unchecked("/openapi.json", complete(&description));
    v1.merge(Router::from(docs))
        .route("/guide", get(knowledge::guide_index))
        .route("/guide/{page}", get(knowledge::guide_page))
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

/// What every request may be answered with: the door, the limits and the store stand before every handler.
const ALWAYS: [&str; 4] = ["401", "403", "429", "503"];
/// What the reading of a body may end with.
const WITH_BODY: [&str; 4] = ["400", "408", "413", "422"];
/// What a file may be answered with for headers that ask for a part of it, or for another than the one known.
const WITH_FILE: [(&str, &str); 3] =
    [("206", "The requested range"), ("304", "It is the one of If-None-Match"), ("416", "The range is beyond its end")];
/// What an address with a name in it may be answered with: one that is no text, one that nothing has.
const WITH_NAME: [&str; 2] = ["400", "404"];

/// What can be done with a job that was accepted.
const NEXT: [&str; 4] = ["show", "change", "cancel", "delete"];

const PROBLEM: &str = "application/problem+json";
const FORM: &str = "multipart/form-data";

/// Example of a job: it runs in a moment.
const EXAMPLE: &str = include_str!("../../../data/cases/hand_calculation.toml");

pub fn complete(handlers: &utoipa::openapi::OpenApi) -> Value {
    // Without failure: its keys are text.
    let mut api = serde_json::to_value(handlers).unwrap_or_default();
    for (path, id, summary, answer) in [
        ("/healthz", "health", "Liveness.", "It does"),
        ("/readyz", "ready", "Readiness.", "It can"),
        ("/metrics", "metrics", "Counters, in the text format of Prometheus.", "Names and numbers, a line each"),
    ] {
        let text = json!({ "text/plain": { "schema": { "type": "string" } } });
        api["paths"][path]["get"] = json!({
            "tags": ["watching"], "operationId": id, "summary": summary,
            "responses": { "200": { "description": answer, "content": text } },
        });
    }
    api["components"]["securitySchemes"]["bearer"] = json!({
        "type": "http", "scheme": "bearer",
        "description": "A token of `perilife token add`. A service without tokens, which answers its own machine only, needs none.",
    });
    complete_schemas(&mut api["components"]["schemas"]);
    let items = api["paths"].as_object_mut().into_iter().flat_map(Map::values_mut);
    for operation in items.filter_map(Value::as_object_mut).flat_map(Map::values_mut) {
        complete_operation(operation);
    }
    api
}

fn complete_schemas(schemas: &mut Value) {
    schemas["Collection"] = json!({
        "type": "string", "description": "Jobs of a kind.", "enum": JobKind::all().map(JobKind::collection).collect::<Vec<_>>(),
    });
    let request = &mut schemas["JobRequest"];
    request["required"] = json!(["input"]);
    let input = &mut request["properties"]["input"];
    input["oneOf"] = json!([{ "type": "string" }, { "type": "object" }]);
    input["example"] = EXAMPLE.into();
    // Files come as parts of their own; all else is text.
    let fields = request["properties"].as_object().into_iter().flatten().filter(|(name, _)| *name != "files");
    let text = |about: &Value| json!({ "type": "string", "description": about["description"] });
    let mut properties: Map<String, Value> = fields.map(|(name, about)| (name.clone(), text(about))).collect();
    properties.insert("file".to_owned(), files("Files that the input names (repeatable)."));
    schemas["JobForm"] = json!({
        "type": "object", "description": "The request as a form.", "properties": properties,
        "required": ["input"], "additionalProperties": false,
    });
}

fn files(about: &str) -> Value {
    json!({ "type": "array", "description": about, "items": { "type": "string", "format": "binary" } })
}

fn schema(name: &str) -> Value {
    json!({ "$ref": format!("#/components/schemas/{name}") })
}

fn complete_operation(operation: &mut Value) {
    operation["security"] = json!([{}, { "bearer": [] }]);
    let (mut statuses, mut takes_job) = (ALWAYS.to_vec(), false);
    for parameter in operation.get_mut("parameters").and_then(Value::as_array_mut).into_iter().flatten() {
        if parameter["in"] == "path" {
            statuses.extend(WITH_NAME);
        }
        if parameter["name"] == "collection" {
            parameter["description"] = "Kind of jobs.".into();
            parameter["schema"] = schema("Collection");
        }
        // No address says null: what is optional is left out.
        without_null(&mut parameter["schema"]);
    }
    if let Some(forms) = operation.pointer_mut("/requestBody/content") {
        statuses.extend(WITH_BODY);
        takes_job = forms["application/json"]["schema"] == schema("JobRequest");
        if takes_job {
            statuses.push("415");
            forms["application/toml"] = json!({ "schema": { "type": "string" }, "example": EXAMPLE });
            forms[FORM] = json!({ "schema": schema("JobForm") });
        } else if let Some(file) = forms.pointer_mut("/multipart~1form-data/schema/properties/file") {
            *file = files("Files of readings (repeatable).");
        }
        operation["requestBody"]["required"] = true.into();
    }
    let Some(responses) = operation["responses"].as_object_mut() else { return };
    if responses.get("200").is_some_and(|whole| whole.get("content").is_none()) {
        for (status, about) in WITH_FILE {
            responses.entry(status).or_insert_with(|| json!({ "description": about }));
        }
    }
    for status in statuses {
        responses.entry(status).or_insert_with(|| json!({ "content": { PROBLEM: { "schema": schema("Problem") } } }));
    }
    if let Some(accepted) = responses.get_mut("202").filter(|_| takes_job) {
        for next in NEXT {
            let job = json!({ "collection": "$request.path.collection", "id": "$response.body#/id" });
            accepted["links"][next] = json!({ "operationId": next, "parameters": job });
        }
    }
    responses.sort_keys();
    for (status, response) in responses {
        complete_response(status, response);
    }
}

fn complete_response(status: &str, response: &mut Value) {
    if response["description"].as_str().is_none_or(str::is_empty) {
        response["description"] = words(status).into();
    }
    match status {
        "401" => response["headers"]["WWW-Authenticate"] = json!({ "schema": { "type": "string" } }),
        "429" | "503" => {
            let about = "Retry after, s";
            response["headers"]["Retry-After"] = json!({ "description": about, "schema": { "type": "integer" } });
        }
        // A file of whatever kind; the first is what clients in typed languages take it for.
        "200" | "206" if response.get("content").is_none() => {
            let bytes = json!({ "schema": { "type": "string", "format": "binary" } });
            response["content"] = json!({ "application/octet-stream": bytes, "application/json": {}, "*/*": {} });
        }
        _ => {}
    }
    if let Some(content) = response.get_mut("content").and_then(Value::as_object_mut)
        && content.get("application/json").is_some_and(|json| json["schema"] == schema("Problem"))
        && let Some(problem) = content.remove("application/json")
    {
        content.insert(PROBLEM.to_owned(), problem);
    }
}

/// What a status means wherever nothing else is said of it.
fn words(status: &str) -> &'static str {
    match status {
        "200" => "The answer",
        "202" => "Accepted",
        "204" => "Done",
        "400" => "The request cannot be read",
        "401" => "It needs a token, or the one given is not known or its time is over",
        "403" => "The role of the token does not allow it, or a page of another origin asks",
        "404" => "There is no such thing",
        "408" => "The body did not come in time",
        "409" => "Conflict",
        "413" => "Too large: `/v1/service` has the limits",
        "415" => "The body is of a type that is not taken",
        "422" => "Wrong input: `detail` is the error, `input` its place and the fix",
        "429" => "More than this server takes of one caller at a time",
        "503" => "The store cannot be used just now, or there is too much to do; nothing that was accepted is lost",
        _ => "As the status says",
    }
}

fn without_null(schema: &mut Value) {
    for key in ["type", "oneOf"] {
        let Some(choices) = schema.get_mut(key).and_then(Value::as_array_mut) else { continue };
        choices.retain(|choice| *choice != "null" && choice["type"] != "null");
        if let [only] = &choices[..] {
            let only = only.clone();
            if key == "type" {
                schema[key] = only;
            } else {
                *schema = only;
            }
        }
    }
}
