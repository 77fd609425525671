//! Who may ask, how often, and what browsers are told; who has changed what, and who was refused, a line of JSON each.

use std::net::{IpAddr, SocketAddr};
use std::time::Duration;

use axum::body::{Body, HttpBody, to_bytes};
use axum::extract::{ConnectInfo, Request, State};
use axum::http::request::Parts;
use axum::http::uri::Authority;
use axum::http::{HeaderMap, HeaderValue, Method, StatusCode, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use tokio::time::timeout;
use tokio_stream::StreamExt;

use super::app::Caller;
use super::{App, Security};
use crate::problem::{Answer, Problem};
use crate::store::{Role, hash};

/// Lets a request through, or not.
pub async fn guard(
    State(app): State<App>,
    ConnectInfo(connected): ConnectInfo<SocketAddr>,
    request: Request,
    next: Next,
) -> Response {
    // The body, which may not be shared, is left aside.
    let (mut head, body) = request.into_parts();
    let address = address_of(&app, connected.ip(), &head.headers);
    let (method, path) = (head.method.clone(), head.uri.path().to_owned());
    let length = content_length(&head.headers);
    let (caller, response) = match caller_of(&app, address, &head).await {
        Ok(Some(caller)) => {
            head.extensions.insert(caller.clone());
            (Some(caller), next.run(Request::from_parts(head, body)).await)
        }
        // What everybody may see takes no body.
        Ok(None) => (None, unread(next.run(Request::from_parts(head, Body::empty())).await, length, body).await),
        Err(problem) => (None, unread(problem.into_response(), length, body).await),
    };
    if let Some(audit) = &app.audit {
        let place = response.headers().get(header::LOCATION).and_then(|place| place.to_str().ok());
        audit.write(caller.as_ref(), address, &method, place.unwrap_or(&path), response.status());
    }
    response
}

/// What proxies add to a request.
const OF_PROXIES: [&str; 8] = [
    "forwarded", "via", "x-forwarded-for", "x-forwarded-host", "x-forwarded-port", "x-forwarded-proto", "x-forwarded-server",
    "x-real-ip",
];

/// Where a request comes from: what the proxy nearest to here says, if it is believed.
fn address_of(app: &App, connected: IpAddr, headers: &HeaderMap) -> IpAddr {
    if !app.security.trusts_proxy {
        return connected;
    }
    let last = |name: &str| headers.get_all(name).iter().next_back()?.to_str().ok()?.rsplit(',').next()?.trim().parse().ok();
    last("x-forwarded-for").or_else(|| last("x-real-ip")).unwrap_or(connected)
}

/// Who asks; `None` for what everybody may see.
async fn caller_of(app: &App, address: IpAddr, head: &Parts) -> Answer<Option<Caller>> {
    let is_write = !matches!(head.method, Method::GET | Method::HEAD);
    let security = &app.security;
    // A proxy on this machine makes everybody look as if he were here.
    let is_forwarded = !security.trusts_proxy && OF_PROXIES.iter().any(|name| head.headers.contains_key(*name));
    let needs_token = security.needs_token || is_forwarded;
    check_origin(security, needs_token, &head.headers, is_write)?;
    let path = head.uri.path();
    if IS_WELL.contains(&path) {
        return Ok(None);
    }
    let token = token_of(&head.headers).filter(|_| needs_token);
    let hash = token.map(hash);
    let known = match &hash {
        Some(hash) => app.known_token(hash).await,
        None => None,
    };
    // Who guesses tokens is held to the limit of his address before the store is asked; who is known has his own, even behind
    // the same proxy.
    if !app.may_ask(known.as_ref().map(|(token, _)| &*token.name), address, is_write) {
        return Err(Problem::too_many("rate limit exceeded; retry later", 1));
    }
    if !needs_token {
        return Ok(Some(Caller { name: String::new(), role: Role::Admin, token: String::new() }));
    }
    let known = match (known, &hash) {
        (Some((token, true)), _) => Some(token),
        (_, Some(hash)) => app.token(hash).await?,
        _ => None,
    };
    let is_open = !(path.starts_with("/v1/") || path == "/metrics") || path == "/v1/service";
    match known {
        Some(token) => Ok(Some(Caller { name: token.name, role: token.role, token: hash.unwrap_or_default() })),
        None if is_open => Ok(None),
        None => {
            let detail = match token {
                None if is_forwarded && !security.needs_token => {
                    "this came through a proxy and needs a token (`Authorization: Bearer TOKEN`, made by `perilife token add`), unless \
                     the service is started with --trust-proxy"
                }
                None => "this needs a token: send the header `Authorization: Bearer TOKEN`",
                Some(_) => "invalid or expired token",
            };
            Err(Problem::new(StatusCode::UNAUTHORIZED, "Unauthorized", detail))
        }
    }
}

/// Asked by those who watch over the service, who are always answered.
pub const IS_WELL: [&str; 2] = ["/healthz", "/readyz"];

/// The token of a request; the name of the scheme is written in any case (RFC 9110, 11.1).
fn token_of(headers: &HeaderMap) -> Option<&str> {
    let (scheme, token) = headers.get(header::AUTHORIZATION)?.to_str().ok()?.trim().split_once(' ')?;
    scheme.eq_ignore_ascii_case("bearer").then(|| token.trim())
}

/// Refuses what a page of somebody else makes a browser send: names that merely lead here (DNS rebinding), and changes from
/// other origins.
fn check_origin(security: &Security, needs_token: bool, headers: &HeaderMap, is_write: bool) -> Answer<()> {
    let refused = |detail: &str| Err(Problem::new(StatusCode::FORBIDDEN, "Forbidden", detail));
    let text = |name: header::HeaderName| headers.get(name).and_then(|value| value.to_str().ok());
    let of_url = |url: &str| {
        url.split_once("://").and_then(|(_, rest)| rest.split('/').next()?.to_ascii_lowercase().parse::<Authority>().ok())
    };
    if headers.get_all(header::HOST).iter().count() > 1 {
        return Err(Problem::bad_request("the request has more than one Host; send one"));
    }
    let host = text(header::HOST).map(str::to_ascii_lowercase).and_then(|host| host.parse::<Authority>().ok());
    let public = security.public_url.as_deref().and_then(of_url);
    if !needs_token {
        let is_here = host.as_ref().is_some_and(|host| {
            let name = host.host().trim_matches(['[', ']']);
            let is_public = security.trusts_proxy && public.as_ref().is_some_and(|public| public.host() == host.host());
            is_public || name == "localhost" || name.parse::<IpAddr>().is_ok_and(|address| address.is_loopback())
        });
        if !is_here {
            return refused("without tokens only 127.0.0.1, [::1] and localhost are accepted");
        }
    }
    if let Some(origin) = text(header::ORIGIN)
        && is_write
    {
        let origin = of_url(origin);
        if origin.is_none() || (origin != host && origin != public) {
            return refused("a page of another origin may not change anything here");
        }
    }
    Ok(())
}

/// A connection beyond those that there are for everybody, or for one address: only who watches over the service is answered.
#[derive(Debug, Clone, Copy)]
pub struct Crowded;

/// Refuses requests on connections beyond those that there are for everybody, before anything of them is waited for.
pub async fn in_room(request: Request, next: Next) -> Response {
    let is_watching = IS_WELL.contains(&request.uri().path()) && request.body().is_end_stream();
    if is_watching || request.extensions().get::<Crowded>().is_none() {
        return next.run(request).await;
    }
    let problem = Problem::new(StatusCode::SERVICE_UNAVAILABLE, "Too many connections", "all connections are taken; try again");
    closed(problem.later(1).into_response())
}

/// An answer after which the connection is closed.
fn closed(mut response: Response) -> Response {
    response.headers_mut().insert(header::CONNECTION, HeaderValue::from_static("close"));
    response
}

/// Ends a request whose answer does not begin in time.
pub async fn in_time(State(limit): State<Duration>, request: Request, next: Next) -> Response {
    timeout(limit, next.run(request)).await.unwrap_or_else(|_| {
        let detail = format!("no answer within {} s; try again when the server has less to do", limit.as_secs());
        Problem::new(StatusCode::SERVICE_UNAVAILABLE, "Too slow", detail).into_response()
    })
}

/// Largest body that is read before anything is answered.
const SMALL_BYTES: usize = 64 << 10;

/// Time in which such a body must have come.
const SMALL_WITHIN: Duration = Duration::from_secs(5);
/// Time in which any body must have come: until then it takes up room.
pub const BODY_WITHIN: Duration = Duration::from_secs(20);
/// Time in which a small body has come that was sent with its head.
const AT_ONCE: Duration = Duration::from_millis(200);

/// Leaves the connection in a state that the answer tells: a small body is read whole first, so that a refusal which does not look
/// at it does not cut off the next request on the same connection; after a refusal of a larger one the connection is closed, and
/// the answer says so.
pub async fn in_whole(request: Request, next: Next) -> Response {
    if request.body().is_end_stream() {
        return next.run(request).await;
    }
    if content_length(request.headers()).is_some_and(|length| length <= SMALL_BYTES) {
        let (head, body) = request.into_parts();
        return match timeout(SMALL_WITHIN, to_bytes(body, SMALL_BYTES)).await {
            Ok(Ok(body)) => next.run(Request::from_parts(head, Body::from(body))).await,
            Ok(Err(error)) => Problem::bad_request(format!("the body cannot be read: {error}")).into_response(),
            Err(_) => closed(Problem::too_slow(SMALL_WITHIN).into_response()),
        };
    }
    let response = next.run(request).await;
    if response.status().is_success() { response } else { closed(response) }
}

/// An answer that needs nothing of the body. One that came with its head is read, so that the connection serves the next request; no
/// other is waited for.
async fn unread(response: Response, length: Option<usize>, body: Body) -> Response {
    let small = length.is_some_and(|length| length <= SMALL_BYTES);
    let is_read =
        body.is_end_stream() || (small && timeout(AT_ONCE, to_bytes(body, SMALL_BYTES)).await.is_ok_and(|read| read.is_ok()));
    if is_read { response } else { closed(response) }
}

fn content_length(headers: &HeaderMap) -> Option<usize> {
    headers.get(header::CONTENT_LENGTH)?.to_str().ok()?.parse().ok()
}

/// Bytes of a body that is too large that are read and forgotten: who sends it hears an answer only when all is sent.
const FORGOTTEN_BYTES: usize = 256 << 20;

/// Refuses a body that says itself that it is too large, once it has come.
pub async fn in_size(State(limit): State<usize>, request: Request, next: Next) -> Response {
    if content_length(request.headers()).is_none_or(|length| length <= limit) {
        return next.run(request).await;
    }
    let mut rest = request.into_body().into_data_stream();
    let forget = async {
        let mut forgotten = 0;
        while let Some(Ok(piece)) = rest.next().await {
            forgotten += piece.len();
            if forgotten > FORGOTTEN_BYTES {
                break;
            }
        }
    };
    let _ = timeout(BODY_WITHIN, forget).await;
    Problem::too_large(format!("the body is larger than the {limit} bytes this server takes")).into_response()
}

/// What the page may load: only what comes from here.
const PAGE: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; connect-src 'self'; \
                    font-src 'self'; manifest-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
/// The description of the API is shown by a page that styles its elements.
const DOCS: &str = "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data:; \
                    connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
/// Results are looked at, never run.
const DATA: &str = "default-src 'none'; style-src 'unsafe-inline'; sandbox; frame-ancestors 'none'";

pub async fn headers(request: Request, next: Next) -> Response {
    let path = request.uri().path().to_owned();
    let mut response = next.run(request).await;
    let policy = match &*path {
        path if path.starts_with("/docs") => DOCS,
        path if path.starts_with("/v1/") || path == "/openapi.json" || path == "/metrics" => DATA,
        _ => PAGE,
    };
    let fixed = [
        (header::CONTENT_SECURITY_POLICY, policy),
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (header::X_FRAME_OPTIONS, "DENY"),
        (header::REFERRER_POLICY, "no-referrer"),
        (header::HeaderName::from_static("cross-origin-opener-policy"), "same-origin"),
        (header::HeaderName::from_static("cross-origin-resource-policy"), "same-origin"),
        (header::HeaderName::from_static("permissions-policy"), "camera=(), geolocation=(), microphone=()"),
    ];
    // What is packed is not the same byte by byte (RFC 9110, 8.8.3.3).
    let tag = response.headers().get(header::ETAG).filter(|_| response.headers().contains_key(header::CONTENT_ENCODING));
    if let Some(weak) = tag.and_then(|tag| HeaderValue::try_from(format!("W/{}", tag.to_str().ok()?)).ok()) {
        response.headers_mut().insert(header::ETAG, weak);
    }
    for (name, value) in fixed {
        response.headers_mut().insert(name, HeaderValue::from_static(value));
    }
    if path.starts_with("/v1/") {
        response.headers_mut().entry(header::CACHE_CONTROL).or_insert(HeaderValue::from_static("no-store"));
    }
    response
}
