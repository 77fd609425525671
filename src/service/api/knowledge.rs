//! What the service is and knows: itself, every kind of every key, materials, its page, the guide; a look at input before anything is run.

use axum::extract::{Path, Request, State};
use axum::http::{HeaderMap, Method, Uri, header};
use axum::response::{Html, IntoResponse, Response};
use axum::{Extension, Json};
use pulldown_cmark::html::push_html;
use pulldown_cmark::{CowStr, Event, Options, Parser, Tag};
use rust_embed::Embed;
use serde::Serialize;
use serde_json::{Value, json};
use utoipa::ToSchema;

use super::App;
use super::app::Caller;
use super::documents::{self, JobRequest, look};
use crate::job::{FIELDS, Found, Look};
use crate::problem::{Answer, Problem};
use crate::store::{Role, hex};
use perilife_base::input::Folder;
use perilife_plate::material::growth_data;
use perilife_plate::material::library::{self, Property};
use perilife_runner::{catalogue, guide};

/// The service and what it allows.
#[derive(Serialize, ToSchema)]
pub struct Service {
    name: &'static str,
    version: &'static str,
    /// Whether requests need a token.
    needs_token: bool,
    /// What the caller may do; null if he may not do anything yet.
    role: Option<Role>,
    /// Jobs that this process runs at a time.
    workers: usize,
    limits: Allowed,
}

/// How much a request may ask for.
#[derive(Serialize, ToSchema)]
pub struct Allowed {
    body_bytes: usize,
    files: usize,
    points: f64,
    queued: i64,
}

/// The service and what it allows.
#[utoipa::path(get, path = "/v1/service", tag = "knowledge", responses((status = 200, body = Service)))]
pub async fn service(State(app): State<App>, caller: Option<Extension<Caller>>) -> Json<Service> {
    let limits = &app.limits;
    Json(Service {
        name: "perilife",
        version: env!("CARGO_PKG_VERSION"),
        needs_token: app.security.needs_token,
        role: caller.map(|Extension(caller)| caller.role),
        workers: app.workers.jobs,
        limits: Allowed { body_bytes: limits.body_bytes, files: limits.files, points: limits.points, queued: limits.queued },
    })
}

/// Every kind of every key of the input files.
#[utoipa::path(get, path = "/v1/kinds", tag = "knowledge", responses((status = 200, body = Value)))]
pub async fn kinds() -> Json<Value> {
    Json(catalogue::json(catalogue::lines()))
}

/// JSON Schema of case and calibration files, by which editors complete and check them.
#[utoipa::path(get, path = "/v1/schema", tag = "knowledge", responses((status = 200, body = Value)))]
pub async fn schema() -> Json<Value> {
    Json(catalogue::schema())
}

/// Materials by name, every number with its source.
#[utoipa::path(get, path = "/v1/materials", tag = "knowledge", responses((status = 200, body = Value)))]
pub async fn materials() -> Answer<Json<Value>> {
    let property = |property: &Property| json!({ "value": property.value, "source": property.source, "note": property.note });
    let material = |name: String| -> Answer<Value> {
        let file = library::find(&name, &Folder::none()).map_err(Problem::from)?;
        let known = |property_of: &Option<Property>| property_of.as_ref().map(property);
        Ok(json!({
            "name": name,
            "title": file.title,
            "youngs_modulus_gpa": property(&file.youngs_modulus_gpa),
            "poisson_ratio": property(&file.poisson_ratio),
            "yield_strength_mpa": known(&file.yield_strength_mpa),
            "toughness_mpa_sqrt_m": known(&file.toughness_mpa_sqrt_m),
            "fracture_energy_j_m2": known(&file.fracture_energy_j_m2),
            "density_kg_m3": known(&file.density_kg_m3),
            "tensile_strength_mpa": known(&file.tensile_strength_mpa),
            "has_growth_data": growth_data::record(&name).is_some(),
        }))
    };
    let names = library::titles().into_iter().map(|(name, _)| name);
    Ok(Json(json!({ "materials": names.map(material).collect::<Answer<Vec<_>>>()? })))
}

#[derive(Embed)]
#[folder = "page/"]
struct Files;

/// A file of the page; `/` is its beginning.
pub async fn page(method: Method, uri: Uri, headers: HeaderMap) -> Response {
    let name = match uri.path() {
        "/" => "index.html",
        path => path.trim_start_matches('/'),
    };
    let file = (method == Method::GET || method == Method::HEAD).then(|| Files::get(name)).flatten();
    let Some(file) = file else { return Problem::not_found("address").into_response() };
    let tag = format!("\"{}\"", hex(&file.metadata.sha256_hash()[..16]));
    let fixed = [(header::ETAG, &*tag), (header::CACHE_CONTROL, "no-cache")];
    if headers.get(header::IF_NONE_MATCH).is_some_and(|known| known.as_bytes() == tag.as_bytes()) {
        return (axum::http::StatusCode::NOT_MODIFIED, fixed).into_response();
    }
    let media_type = mime_guess::from_path(name).first_or_octet_stream().to_string();
    (fixed, [(header::CONTENT_TYPE, media_type)], file.data).into_response()
}

pub async fn guide_index() -> Answer<Html<String>> {
    html("index", "", "guide/")
}

pub async fn guide_page(Path(name): Path<String>) -> Answer<Html<String>> {
    html(&name, "../", "")
}

/// A page in the frame of the service; `root` and `guide` are relative addresses, so that a proxy may add a prefix.
fn html(name: &str, root: &str, guide: &str) -> Answer<Html<String>> {
    let text = guide::page(name).ok_or_else(|| Problem::not_found("page of the guide"))?;
    let title = text.lines().next().unwrap_or_default().trim_start_matches("# ");
    let mut body = String::new();
    push_html(&mut body, Parser::new_ext(text, Options::ENABLE_TABLES).map(|event| served(event, guide)));
    // What scrolls by itself on a narrow window must be reachable by keyboard.
    let body = body.replace("<pre>", "<pre tabindex=\"0\">").replace("<table>", "<table tabindex=\"0\">");
    Ok(Html(format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\
         <title>{title} · perilife</title><link rel=\"icon\" href=\"{root}icon.svg\" type=\"image/svg+xml\"><link rel=\"stylesheet\" href=\"{root}style.css\">\
         <link rel=\"stylesheet\" href=\"{root}guide.css\"><script src=\"{root}theme.js\"></script></head><body><header class=\"top\"><div class=\"top-inner\">\
         <span class=\"brand\">perilife</span><nav aria-label=\"Main\"><a href=\"{root}./\">Service</a><a href=\"{guide}index\">Guide</a>\
         <a href=\"{root}docs/\">API</a></nav><div class=\"theme\"><button type=\"button\" class=\"button bare\" id=\"theme\">Light / dark</button>\
         </div></div></header><main class=\"guide\">{body}</main></body></html>"
    )))
}

/// Links to pages of the guide are those of the service.
fn served<'a>(event: Event<'a>, guide: &str) -> Event<'a> {
    let Event::Start(Tag::Link { link_type, dest_url, title, id }) = event else { return event };
    let page = dest_url.strip_suffix(".md").filter(|page| guide::page(page).is_some());
    let dest_url = page.map_or_else(|| dest_url.clone(), |page| CowStr::from(format!("{guide}{page}")));
    Event::Start(Tag::Link { link_type, dest_url, title, id })
}

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
