//! The web page, built into the program.

use axum::http::{HeaderMap, Method, Uri, header};
use axum::response::{IntoResponse, Response};
use rust_embed::Embed;

use crate::service::problem::Problem;
use crate::service::store::hex;

#[derive(Embed)]
#[folder = "src/service/page/"]
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
