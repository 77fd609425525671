//! What the service is and knows: itself, every kind of every key, materials, its page.

use axum::extract::State;
use axum::http::{HeaderMap, Method, Uri, header};
use axum::response::{IntoResponse, Response};
use axum::{Extension, Json};
use rust_embed::Embed;
use serde::Serialize;
use serde_json::{Value, json};
use utoipa::ToSchema;

use super::App;
use super::caller::Caller;
use crate::problem::{Answer, Problem};
use crate::store::{Role, hex};
use perilife_base::input::Folder;
use perilife_plate::material::growth_data;
use perilife_plate::material::library::{self, Property};
use perilife_runner::catalogue;

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
    let names = library::names().into_iter().chain(growth_data::records().into_iter().map(|record| record.name));
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
