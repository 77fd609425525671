//! What went wrong, as RFC 9457 has it; the words are those of the command line.

use std::time::Duration;

use axum::http::{HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::store;
use perilife_base::error::{Error, InputError, SENTENCE_MAX, VALUE_MAX};

/// Problem details.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Problem {
    /// Which kind of problem, as a URI.
    #[serde(rename = "type")]
    pub kind: String,
    /// The kind in words.
    pub title: String,
    /// HTTP status.
    pub status: u16,
    /// What went wrong here, and what would be right.
    pub detail: String,
    /// Where in the input it stands.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub input: Option<Box<Place>>,
    /// Retry after, s.
    #[serde(skip)]
    pub retry_after: Option<u32>,
}

/// Wrong input: where it stands, which value, what is wrong with it and what would be right.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Place {
    /// File it stands in.
    pub file: Option<String>,
    /// Line, counted from 1.
    pub line: Option<usize>,
    /// Key or column.
    pub key: Option<String>,
    /// The value as given.
    pub value: Option<String>,
    /// What is wrong with it.
    pub problem: String,
    /// What would be right.
    pub remedy: String,
}

/// Result of a request.
pub type Answer<T> = std::result::Result<T, Problem>;

/// Most characters of what went wrong, which may repeat what was sent.
const DETAIL_MAX: usize = 5000;

/// Seconds after which a database that was gone is asked for again.
const DATABASE_BACK_S: u32 = 2;

impl Problem {
    /// A problem without a place in the input.
    pub fn new(status: StatusCode, title: &str, detail: impl Into<String>) -> Self {
        let slug: String = title.to_lowercase().chars().map(|c| if c.is_alphanumeric() { c } else { '-' }).collect();
        Problem {
            kind: format!("urn:perilife:problem:{slug}"),
            title: title.to_owned(),
            status: status.as_u16(),
            detail: format!("{:.DETAIL_MAX$}", detail.into()),
            input: None,
            retry_after: None,
        }
    }

    /// There is no such thing.
    pub fn not_found(what: &str) -> Self {
        Problem::new(StatusCode::NOT_FOUND, "Not found", format!("there is no such {what}"))
    }

    /// The request itself cannot be read.
    pub fn bad_request(detail: impl Into<String>) -> Self {
        Problem::new(StatusCode::BAD_REQUEST, "Bad request", detail)
    }

    pub fn conflict(detail: impl Into<String>) -> Self {
        Problem::new(StatusCode::CONFLICT, "Conflict", detail)
    }

    /// More than this server takes.
    pub fn too_large(detail: impl Into<String>) -> Self {
        Problem::new(StatusCode::PAYLOAD_TOO_LARGE, "Too large", detail)
    }

    /// The body did not come in time.
    pub fn too_slow(within: Duration) -> Self {
        let detail = format!("the body did not come within {} s", within.as_secs());
        Problem::new(StatusCode::REQUEST_TIMEOUT, "Too slow", detail)
    }

    /// Come back later.
    pub fn too_many(detail: impl Into<String>, seconds: u32) -> Self {
        Problem::new(StatusCode::TOO_MANY_REQUESTS, "Too many requests", detail).later(seconds)
    }

    pub fn later(self, seconds: u32) -> Self {
        Problem { retry_after: Some(seconds), ..self }
    }

    /// A fault of this program: told without its inner workings, which stand in the log.
    pub fn internal() -> Self {
        let detail = "internal error (logged); please report it";
        Problem::new(StatusCode::INTERNAL_SERVER_ERROR, "Internal error", detail)
    }

    /// Without the line, which means nothing where the input was no text; those of files stay.
    pub fn without_line(mut self) -> Self {
        if let Some(input) = self.input.as_deref_mut().filter(|input| input.file.is_none()) {
            input.line = None;
        }
        self
    }
}

impl From<Error> for Problem {
    fn from(error: Error) -> Self {
        let detail = error.to_string();
        match error {
            Error::Input(input) => Problem {
                input: Some(Box::new((*input).into())),
                ..Problem::new(StatusCode::UNPROCESSABLE_ENTITY, "Wrong input", detail)
            },
            Error::Mechanics(_) | Error::LossOfStiffness => Problem::new(StatusCode::UNPROCESSABLE_ENTITY, "No result", detail),
            Error::File { .. } => {
                // Input from outside names no files: this is the disk of the server.
                tracing::error!("{detail}");
                let detail = "the disk of the server cannot be written just now; nothing is lost, try again";
                Problem::new(StatusCode::SERVICE_UNAVAILABLE, "Storage unavailable", detail).later(DATABASE_BACK_S)
            }
        }
    }
}

impl From<InputError> for Place {
    fn from(error: InputError) -> Self {
        let value = |text: String| format!("{text:.VALUE_MAX$}");
        Place {
            file: error.file.map(|file| file.display().to_string()),
            line: error.line,
            key: error.key.map(value),
            value: error.value.map(value),
            problem: format!("{:.SENTENCE_MAX$}", error.problem),
            remedy: format!("{:.SENTENCE_MAX$}", error.remedy),
        }
    }
}

impl From<sqlx::Error> for Problem {
    fn from(error: sqlx::Error) -> Self {
        if store::is_gone(&error) {
            tracing::warn!("the database cannot be used: {error}");
            let detail = "the database cannot be used just now; nothing that was accepted is lost, try again";
            return Problem::new(StatusCode::SERVICE_UNAVAILABLE, "Storage unavailable", detail).later(DATABASE_BACK_S);
        }
        tracing::error!("the database refuses a statement: {error}");
        Problem::internal()
    }
}

impl IntoResponse for Problem {
    fn into_response(self) -> Response {
        let status = StatusCode::from_u16(self.status).unwrap_or(StatusCode::INTERNAL_SERVER_ERROR);
        let body = serde_json::to_string(&self).unwrap_or_default();
        let mut response = (status, [(header::CONTENT_TYPE, "application/problem+json")], body).into_response();
        if let Some(seconds) = self.retry_after {
            response.headers_mut().insert(header::RETRY_AFTER, HeaderValue::from(seconds));
        }
        if status == StatusCode::TOO_MANY_REQUESTS {
            // Who has asked too much does not keep a place among the connections while he waits.
            response.headers_mut().insert(header::CONNECTION, HeaderValue::from_static("close"));
        }
        if status == StatusCode::UNAUTHORIZED {
            response.headers_mut().insert(header::WWW_AUTHENTICATE, HeaderValue::from_static("Bearer"));
        }
        response
    }
}
