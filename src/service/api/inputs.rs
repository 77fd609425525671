//! Looking at input before anything is run: measured curves, and what a file would run.

use axum::Extension;
use axum::extract::{Request, State};
use axum::http::header;
use axum::response::{IntoResponse, Response};
use utoipa::ToSchema;

use super::App;
use super::caller::Caller;
use super::documents::{self, JobRequest, look};
use crate::look::{FIELDS, Found, Look};
use crate::problem::{Answer, Problem};

/// A form of files of readings.
#[derive(ToSchema)]
#[expect(dead_code, reason = "describes a form")]
struct Readings {
    /// Files (repeatable).
    #[schema(value_type = String, format = Binary)]
    file: Vec<u8>,
    /// `mm`, `inch` or `m`, where the header does not say it.
    length_unit: Option<String>,
    /// `cycles`, `kilocycles` or `megacycles`, where the header does not say it.
    cycle_unit: Option<String>,
    /// Unit of loads, where the header does not say it.
    load_unit: Option<String>,
    /// `.` or `,`, where the file leaves it open.
    decimal: Option<String>,
    /// Sheet of a workbook, by name or number.
    sheet: Option<String>,
    /// JSON object of columns by name, as `columns` of `[measured]`.
    columns: Option<String>,
    /// JSON list of rows that are left out by their lines, as `leave_out` of `[measured]`.
    leave_out: Option<String>,
}

/// Reads measured a-N curves: what was understood, and every row that is wrong.
#[utoipa::path(post, path = "/v1/measured", tag = "inputs",
    request_body(content = inline(Readings), content_type = "multipart/form-data"),
    responses((status = 200, body = Found), (status = 400, body = Problem), (status = 413, body = Problem)))]
pub async fn measured(State(app): State<App>, Extension(caller): Extension<Caller>, request: Request) -> Answer<Response> {
    let room = app.bodies.wait(&caller).await?;
    let (fields, files) = documents::form(&app, request).await?;
    if let Some(name) = fields.keys().find(|name| !FIELDS.contains(&name.as_str())) {
        return Err(Problem::bad_request(format!("the form has a field `{name}`; known are file, {}", FIELDS.join(", "))));
    }
    if files.is_empty() {
        return Err(Problem::bad_request("the form has no `file`: send at least one"));
    }
    let (found, ..) = look(&app, Look::Measured { fields, files }, room, true).await?;
    Ok(json(found))
}

/// JSON that a look has written.
fn json(text: String) -> Response {
    ([(header::CONTENT_TYPE, "application/json")], text).into_response()
}

/// Checks a case, a calibration, a sweep or a fracture scene without running it: what was understood, and a drawing.
#[utoipa::path(post, path = "/v1/check", tag = "inputs", request_body = JobRequest,
    responses((status = 200, body = Value), (status = 400, body = Problem), (status = 422, body = Problem)))]
pub async fn check(State(app): State<App>, Extension(caller): Extension<Caller>, request: Request) -> Answer<Response> {
    let body = documents::read(&app, &caller, request).await?;
    documents::looked(&app, body, None).await.map(|(found, ..)| json(found))
}
